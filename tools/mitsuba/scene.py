"""A folder that `candela export` wrote -> a Mitsuba scene."""

import json
from pathlib import Path

import mitsuba as mi
import numpy as np

import gltf_bsdf  # noqa: F401 (registers)
import gltf_spot  # noqa: F401

VERSION = 1
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
        materials = root["materials"]
        self.objects = {"type": "scene", "sensor": sensor(root["camera"], size)}
        # Name -> emitter. Those of meshes belong to the mesh of the same name.
        self.lights = {}
        for i, shape in enumerate(root["shapes"]):
            material = materials[shape["material"]]
            self.objects[f"shape{i}"] = mesh(folder / shape["file"], material, plant)
            if any(material["emission"]):
                self.lights[f"shape{i}"] = area(material)
        for i, light in enumerate(root["point_lights"]):
            self.lights[f"point{i}"] = {
                "type": "point",
                "position": light["position"],
                "intensity": rgb(light["intensity"]),
            }
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
        return not light.startswith(("shape", "sky"))

    def lit_by(self, light):
        """The Mitsuba scene with this light alone: light adds up, and no sample is spent on choosing one."""
        objects = dict(self.objects)
        if light in objects:
            objects[light] = objects[light] | {"emitter": self.lights[light]}
        else:
            objects[light] = self.lights[light]
        return mi.load_dict(objects)


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


def mesh(path, material, plant):
    colored = b"property float r\n" in path.read_bytes()[:1024]
    return {"type": "ply", "filename": str(path), "bsdf": bsdf(material, colored, plant)}


def area(material):
    if material["double_sided"]:
        raise SceneError(f"{material['name']}: Mitsuba's area lights emit from one side only")
    return {"type": "area", "radiance": rgb(material["emission"])}


def bsdf(material, colored, plant):
    """c_diff and F0 of glTF 2.0, B.3.5, or of KHR_materials_pbrSpecularGlossiness."""
    base, f0 = np.array(material["base_color"]), np.array(material["specular"])
    if material["workflow"] == "specular-glossiness":
        diffuse = base * (1 - f0.max())
    else:
        metallic = material["metallic"]
        if colored and metallic > 0:
            raise SceneError(f"{material['name']}: a metal with vertex colors")
        diffuse, f0 = base * (1 - metallic), f0 + metallic * (base - f0)
    diffuse = rgb(diffuse)
    if colored:
        if base.min() < 1 or base.max() > 1:
            raise SceneError(f"{material['name']}: vertex colors over a base color that is not white")
        diffuse = {"type": "mesh_attribute", "name": "vertex_color"}
    return {
        "type": "gltf",
        "diffuse": diffuse,
        "f0": rgb(f0),
        "roughness": material["roughness"],
        "double_sided": material["double_sided"],
        "smith": "separable" if plant == "separable-smith" else "correlated",
    }


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
