"""A folder that `candela export` wrote -> a Mitsuba scene."""

import json
import sys
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

import gltf_bsdf  # noqa: F401 (registers)
import gltf_spot  # noqa: F401

VERSION = 3
# Copies of each texel of an environment map along its sides: see `environment`.
ENVIRONMENT_WIDTH = 4096


class SceneError(Exception):
    """What can't be rendered, and why: one line."""


class Scene:
    """The scene in `folder` for a picture of `size` = (width, height) pixels.

    `plant`: `separable-smith` or `mitsuba-spot`, an error for negative controls.
    """

    def __init__(self, folder, size, plant=None):
        folder = Path(folder)
        try:
            root = json.loads((folder / "scene.json").read_text())
        except (OSError, ValueError) as error:
            raise SceneError(f"{folder / 'scene.json'}: {error}") from None
        if (root.get("format"), root.get("version")) != ("candela-scene", VERSION):
            raise SceneError(f"{folder / 'scene.json'}: not a candela-scene of version {VERSION}; export it again")
        materials, textures = root["materials"], Textures(folder, root["textures"])
        self.objects = {"type": "scene", "sensor": sensor(root["camera"], size)}
        # Name -> emitter. Those of meshes belong to the mesh of the same name.
        self.lights = {}
        for i, shape in enumerate(root["shapes"]):
            material = materials[shape["material"]]
            self.objects[f"shape{i}"] = mesh(folder / shape["file"], material, textures, plant)
            if any(material["emission"]):
                self.lights[f"shape{i}"] = area(material, textures)
        for i, light in enumerate(root["point_lights"]):
            if light["radius"]:
                self.lights[f"sphere{i}"] = sphere(light)
                continue
            self.lights[f"point{i}"] = {
                "type": "point",
                "position": light["position"],
                "intensity": rgb(light["intensity"]),
            }
        for i, light in enumerate(root["panel_lights"]):
            self.lights[f"panel{i}"] = panel(light)
        for i, light in enumerate(root["spot_lights"]):
            self.lights[f"spot{i}"] = spot(light, plant)
        for i, light in enumerate(root["directional_lights"]):
            direction = [-x for x in light["direction"]]
            irradiance = rgb(light["illuminance"])
            self.lights[f"sun{i}"] = {"type": "directional", "direction": direction, "irradiance": irradiance}
        if root["environment"]:
            self.lights["sky"] = environment(folder / root["environment"]["file"])

    def is_exact(self, light):
        """One sample says it all: the light has no extent."""
        return not light.startswith(("shape", "sphere", "panel", "sky"))

    def lit_by(self, lights):
        """The Mitsuba scene with these lights. With one alone no sample is spent on choosing, and light adds up."""
        objects = dict(self.objects)
        for light in lights:
            emitter = self.lights[light]
            objects[light] = objects[light] | {"emitter": emitter} if light in objects else emitter
        return mi.load_dict(objects)


def pixel_rays(sensor, size, offset=(0.5, 0.5), repeat=1):
    """`repeat` rays through each pixel, at `offset` in it."""
    index = dr.arange(mi.UInt32, size[0] * size[1] * repeat) // repeat
    x, y = index % size[0], index // size[0]
    place = mi.Point2f((mi.Float(x) + offset[0]) / size[0], (mi.Float(y) + offset[1]) / size[1])
    return sensor.sample_ray(0, 0, place, mi.Point2f(0.5))[0]


def rgb(value):
    """Linear Rec. 709, as it is."""
    return {"type": "rgb", "value": list(value)}


def look_at(position, direction, up=None):
    """+z to `direction`."""
    target = np.add(position, direction)
    if up is None:
        up = [0, 1, 0] if abs(direction[1]) < 0.9 else [1, 0, 0]
    return mi.ScalarTransform4f().look_at(origin=list(position), target=list(target), up=list(up))


def sensor(camera, size):
    return {
        "type": "perspective",
        "to_world": look_at(camera["position"], camera["forward"], camera["up"]),
        "fov": float(np.degrees(camera["fov_y"])),
        "fov_axis": "y",
        "near_clip": 1e-4,
        "far_clip": 1e6,
        "film": {"type": "hdrfilm", "width": size[0], "height": size[1], "rfilter": {"type": "box"}},
    }


def mesh(path, material, textures, plant):
    colored = b"property float r\n" in path.read_bytes()[:1024]
    return {"type": "ply", "filename": str(path), "bsdf": bsdf(material, textures, colored, plant)}


def area(material, textures):
    if material["double_sided"]:
        raise SceneError(f"{material['name']}: Mitsuba's area lights emit from one side only")
    use, emission = material["emissive_texture"], material["emission"]
    return {"type": "area", "radiance": textures.bitmap(use, factor=emission) if use else rgb(emission)}


def bsdf(material, textures, colored, plant):
    """See gltf_bsdf.py."""
    if material["normal_texture"]:
        print(f"warning: {material['name']}: its normal texture is not read", file=sys.stderr)
    gltf = {
        "type": "gltf",
        "workflow": material["workflow"],
        "base": rgb(material["base_color"]),
        "metallic": material["metallic"],
        "roughness": material["roughness"],
        "specular": rgb(material["specular"]),
        "double_sided": material["double_sided"],
        "smith": "separable" if plant == "separable-smith" else "correlated",
    }
    if colored:
        gltf["color"] = {"type": "mesh_attribute", "name": "vertex_color"}
    if use := material["base_color_texture"]:
        gltf["base_map"] = textures.bitmap(use)
    if use := material["reflectance_texture"]:
        gltf["reflectance_map"] = textures.bitmap(use)
        if material["workflow"] == "specular-glossiness":
            gltf["gloss_map"] = textures.bitmap(use, alpha=True)
    return gltf


class Textures:
    """Those of a scene, as Mitsuba reads them: the finest mip level alone."""

    WRAPS = {"repeat": "repeat", "mirrored-repeat": "mirror", "clamp-to-edge": "clamp"}

    def __init__(self, folder, textures):
        self.folder, self.textures = folder, textures

    def bitmap(self, use, alpha=False, factor=1):
        texture = self.textures[use["texture"]]
        if use["set"] != 0:
            raise SceneError(f"{texture['file']}: a second set of texture coordinates")
        if texture["wrap"][0] != texture["wrap"][1]:
            raise SceneError(f"{texture['file']}: Mitsuba wraps both sides alike")
        texels = np.array(mi.Bitmap(str(self.folder / texture["file"]))).astype(np.float32) / 255
        color = texels[..., 3:].repeat(3, axis=2) if alpha else texels[..., :3]
        if texture["srgb"] and not alpha:
            # Decoded before it is interpolated, as hardware does.
            color = np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4)
        (a, b, c), (d, e, f) = use["u"], use["v"]
        return {
            "type": "bitmap",
            "bitmap": mi.Bitmap(np.ascontiguousarray(color * np.asarray(factor), np.float32)),
            "raw": True,
            "filter_type": "bilinear" if texture["linear"] else "nearest",
            "wrap_mode": self.WRAPS[texture["wrap"][0]],
            "to_uv": mi.ScalarTransform4f([[a, b, 0, c], [d, e, 0, f], [0, 0, 1, 0], [0, 0, 0, 1]]),
        }


def sphere(light):
    radius = light["radius"]
    radiance = np.divide(light["intensity"], np.pi * radius**2)
    emitter = {"type": "area", "radiance": rgb(radiance)}
    return {"type": "sphere", "center": light["position"], "radius": radius, "emitter": emitter}


def panel(light):
    half = [side / 2 for side in light["size"]]
    place = look_at(light["position"], light["axis"], light["up"])
    emitter = {"type": "area", "radiance": rgb(light["radiance"])}
    return {"type": light["shape"], "to_world": place @ mi.ScalarTransform4f().scale([*half, 1]), "emitter": emitter}


def spot(light, plant):
    intensity = rgb(light["intensity"])
    if plant == "mitsuba-spot":
        return {
            "type": "spot",
            "to_world": look_at(light["position"], light["axis"]),
            "intensity": intensity,
            "cutoff_angle": float(np.degrees(light["outer_angle"])),
            "beam_width": float(np.degrees(light["inner_angle"])),
        }
    geometry = {name: light[name] for name in ("position", "axis", "inner_angle", "outer_angle")}
    return {"type": "gltf_spot", "intensity": intensity, **geometry}


def environment(path):
    """Mitsuba interpolates between the middles of texels, Candela's texels are constant: each is repeated so often that
    interpolation is left with a seam of 1/4096 of the map's width. Mitsuba's map has -Z at its left end, Candela's -X.
    """
    texels = np.array(mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32))
    copies = max(1, ENVIRONMENT_WIDTH // texels.shape[1])
    texels = texels.repeat(copies, axis=0).repeat(copies, axis=1)
    return {"type": "envmap", "bitmap": mi.Bitmap(texels), "to_world": mi.ScalarTransform4f().rotate([0, 1, 0], 90)}
