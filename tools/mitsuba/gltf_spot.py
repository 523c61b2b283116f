"""KHR_lights_punctual's spot light as a Mitsuba emitter: Mitsuba's own falls off linearly in the angle."""

import drjit as dr
import mitsuba as mi


class GltfSpot(mi.Emitter):
    """Radiant intensity `intensity` (cd) on the axis, times clamp((cos - cos_outer) / (cos_inner - cos_outer), 0, 1)^2.

    Parameters: `position`, `axis` (the way it shines), `intensity` (texture), `inner_angle`, `outer_angle` (radians from the axis).
    """

    def __init__(self, props):
        super().__init__(props)
        self.intensity = props.get_unbounded_texture("intensity")
        self.position = mi.Point3f(props["position"])
        self.axis = dr.normalize(mi.Vector3f(props["axis"]))
        cos_inner, self.cos_outer = dr.cos(props["inner_angle"]), dr.cos(props["outer_angle"])
        # 0.001: the extension's own guard.
        self.scale = 1 / max(cos_inner - self.cos_outer, 0.001)
        self.m_flags = mi.EmitterFlags.DeltaPosition
        self.m_needs_sample_2 = False
        self.m_needs_sample_3 = False

    def attenuation(self, cos):
        return dr.square(dr.clip((cos - self.cos_outer) * self.scale, 0, 1))

    def sample_direction(self, it, sample, active):
        ds = dr.zeros(mi.DirectionSample3f)
        ds.p = self.position
        ds.d = ds.p - it.p
        distance2 = dr.squared_norm(ds.d)
        ds.dist = dr.sqrt(distance2)
        ds.d /= ds.dist
        ds.n = self.axis
        ds.time = it.time
        ds.pdf = 1
        ds.delta = True
        ds.emitter = mi.EmitterPtr(self)
        return ds, self.value(it, ds, active) / distance2

    def value(self, it, ds, active):
        si = dr.zeros(mi.SurfaceInteraction3f)
        si.wavelengths = it.wavelengths
        return self.intensity.eval(si, active) * self.attenuation(-dr.dot(ds.d, self.axis))

    def pdf_direction(self, it, ds, active):
        return mi.Float(0)

    def eval_direction(self, it, ds, active):
        return self.value(it, ds, active) / dr.square(ds.dist)

    def eval(self, si, active):
        return mi.Color3f(0)

    def bbox(self):
        return mi.ScalarBoundingBox3f()

    def to_string(self):
        return f"GltfSpot[position = {self.position}, axis = {self.axis}]"


mi.register_emitter("gltf_spot", GltfSpot)
