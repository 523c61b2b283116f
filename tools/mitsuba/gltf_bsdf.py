"""glTF 2.0's reflection model (appendix B) as a Mitsuba BSDF, written from the specification and Heitz 2014."""

import drjit as dr
import mitsuba as mi

# A mirror lit by a point light has no finite radiance: Candela's narrowest lobe.
MIN_ALPHA = 1e-3


class GltfBsdf(mi.BSDF):
    """f = (1 - F) diffuse/pi + F D G / (4 cos_i cos_o), 1/sr, linear RGB.

    `base`, `metallic`, `roughness` (perceptual, alpha = roughness^2) and `specular` as in Candela's scene.json; `workflow`
    `metallic-roughness` or `specular-glossiness`. Textures multiply them where they are given: `base_map` and `color` the base,
    the green and blue channels of `reflectance_map` roughness and metal, or `reflectance_map` the specular color and
    `gloss_map` 1 - roughness. `double_sided`: else the back is black. `smith`: `correlated` (the specification's), or
    `separable`, a planted error for negative controls.
    """

    def __init__(self, props):
        super().__init__(props)
        self.glossy = props["workflow"] == "specular-glossiness"
        self.base, self.specular = (props.get_texture(name) for name in ("base", "specular"))
        self.metallic, self.roughness = props["metallic"], props["roughness"]
        maps = ("base_map", "color", "reflectance_map", "gloss_map")
        self.maps = {name: props.get_texture(name) for name in maps if props.has_property(name)}
        self.double_sided = props["double_sided"]
        self.separable = props.get("smith", "correlated") == "separable"
        sides = mi.BSDFFlags.FrontSide | (mi.BSDFFlags.BackSide if self.double_sided else mi.BSDFFlags.Empty)
        self.m_components = [mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.GlossyReflection | sides]
        self.m_flags = self.m_components[0]

    def cosines(self, si, wo):
        cos_i, cos_o = mi.Frame3f.cos_theta(si.wi), mi.Frame3f.cos_theta(wo)
        if self.double_sided:
            wo = dr.mulsign(wo, cos_i)
            wi = dr.mulsign(si.wi, cos_i)
            return wi, wo, dr.abs(cos_i), dr.mulsign(cos_o, cos_i)
        return si.wi, wo, cos_i, cos_o

    def reflectance(self, si, active):
        """Diffuse color, F0 and alpha (glTF 2.0, B.3.5; KHR_materials_pbrSpecularGlossiness)."""
        def texel(name):
            return self.maps[name].eval(si, active) if name in self.maps else mi.Color3f(1)
        base = self.base.eval(si, active) * texel("base_map") * texel("color")
        specular, texels = self.specular.eval(si, active), texel("reflectance_map")
        if self.glossy:
            f0 = specular * texels
            diffuse = base * (1 - dr.max(f0))
            roughness = 1 - (1 - self.roughness) * texel("gloss_map").x
        else:
            metallic, roughness = self.metallic * texels.z, self.roughness * texels.y
            diffuse, f0 = base * (1 - metallic), specular + metallic * (base - specular)
        return diffuse, f0, dr.maximum(dr.square(roughness), MIN_ALPHA)

    def eval(self, ctx, si, wo, active):
        """f times the cosine of `wo`."""
        wi, wo, cos_i, cos_o = self.cosines(si, wo)
        active = active & (cos_i > 0) & (cos_o > 0)
        half = dr.normalize(wi + wo)
        diffuse, f0, alpha = self.reflectance(si, active)
        fresnel = f0 + (1 - f0) * dr.clip(1 - dr.dot(wi, half), 0, 1) ** 5
        a2 = dr.square(alpha)
        # Trowbridge & Reitz: sin^2 from x and y, which keeps its digits at narrow lobes.
        d = a2 / (dr.pi * dr.square(dr.square(half.x) + dr.square(half.y) + a2 * dr.square(half.z)))
        # Smith's Lambda (Heitz 2014, eq. 72); height-correlated G (eq. 99) or the product of both sides.
        def smith_lambda(cos):
            return 0.5 * (dr.sqrt(1 + a2 * (1 / dr.square(cos) - 1)) - 1)
        li, lo = smith_lambda(cos_i), smith_lambda(cos_o)
        g = 1 / ((1 + li) * (1 + lo)) if self.separable else 1 / (1 + li + lo)
        f = (1 - fresnel) * diffuse * dr.inv_pi + fresnel * d * g / (4 * cos_i * cos_o)
        return dr.select(active, f * cos_o, 0)

    def pdf(self, ctx, si, wo, active):
        """Of `sample`: half by the cosine, half by Mitsuba's visible normals."""
        wi, wo, cos_i, cos_o = self.cosines(si, wo)
        half = dr.normalize(wi + wo)
        lobe = self.microfacets(si, active).pdf(wi, half) / (4 * dr.dot(wo, half))
        return dr.select(active & (cos_i > 0) & (cos_o > 0), 0.5 * (cos_o * dr.inv_pi + lobe), 0)

    def microfacets(self, si, active):
        alpha = self.reflectance(si, active)[2]
        return mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha, True)

    def sample(self, ctx, si, sample1, sample2, active):
        cos_i = mi.Frame3f.cos_theta(si.wi)
        wi = dr.mulsign(si.wi, cos_i) if self.double_sided else si.wi
        half, _ = self.microfacets(si, active).sample(wi, sample2)
        wo = dr.select(sample1 < 0.5, mi.warp.square_to_cosine_hemisphere(sample2), mi.reflect(wi, half))
        if self.double_sided:
            wo = dr.mulsign(wo, cos_i)
        bs = mi.BSDFSample3f(wo)
        bs.pdf = self.pdf(ctx, si, wo, active)
        bs.eta = 1
        bs.sampled_type = mi.UInt32(+self.m_flags)
        bs.sampled_component = 0
        active = active & (bs.pdf > 0)
        return bs, dr.select(active, self.eval(ctx, si, wo, active) / bs.pdf, 0)

    def eval_pdf(self, ctx, si, wo, active):
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def traverse(self, callback):
        callback.put("base", self.base, mi.ParamFlags.Differentiable)
        callback.put("specular", self.specular, mi.ParamFlags.Differentiable)

    def to_string(self):
        return f"GltfBsdf[roughness = {self.roughness}, base = {self.base}, specular = {self.specular}]"


mi.register_bsdf("gltf", GltfBsdf)
