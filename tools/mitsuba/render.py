#!/usr/bin/env python3
"""Renders folders that `candela export` wrote: direct light, radiance in nit, linear Rec. 709. See README.md."""

import argparse
import json
import sys
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

from scene import SceneError, load  # noqa: E402 (needs the variant)

# Rays at once: bounds memory.
BATCH = 1 << 22
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
# Two rays see the same surface if they hit the same shape and the normals differ by less (cosine).
SAME_NORMAL = 0.94


def pixel_rays(sensor, size, offset=(0.5, 0.5), repeat=1):
    """`repeat` rays through each pixel, at `offset` in it."""
    index = dr.arange(mi.UInt32, size[0] * size[1] * repeat) // repeat
    x, y = index % size[0], index // size[0]
    place = mi.Point2f((mi.Float(x) + offset[0]) / size[0], (mi.Float(y) + offset[1]) / size[1])
    return sensor.sample_ray(0, 0, place, mi.Point2f(0.5))[0]


def render(scene, sensor, size, spp):
    """Mean and standard error of each pixel's radiance through its middle: (height, width, 3) and (height, width)."""
    # Everything that Candela shows: lights are seen too. Only lights are sampled: no BSDF here is narrower than a light
    # is for Mitsuba's estimator to be finite.
    integrator = mi.load_dict({"type": "direct", "emitter_samples": 1, "bsdf_samples": 0})
    pixels = size[0] * size[1]
    batch = max(1, min(spp, BATCH // pixels))
    batches = -(-spp // batch)
    means = []
    for i in range(batches):
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(i, pixels * batch)
        radiance, _, _ = integrator.sample(scene, sampler, pixel_rays(sensor, size, repeat=batch))
        means.append(np.stack([np.array(dr.block_sum(c, batch), np.float64) / batch for c in radiance], -1))
    means = np.stack(means)
    mean = means.mean(0)
    # From the spread of the batches.
    luminance = means @ LUMINANCE
    error = luminance.std(0, ddof=1) / np.sqrt(batches) if batches > 1 else np.full(pixels, np.nan)
    return mean.reshape(size[1], size[0], 3), error.reshape(size[1], size[0])


def away_from_edges(scene, sensor, size):
    """Where the rays through a pixel's corners meet the shape that its middle meets, and much the same normal."""
    def hits(offset):
        si = scene.ray_intersect(pixel_rays(sensor, size, offset))
        shape = np.array(dr.reinterpret_array(mi.UInt32, si.shape))
        return shape, np.array(si.sh_frame.n).T if si.sh_frame.n.shape[0] == 3 else np.array(si.sh_frame.n)

    shape, normal = hits((0.5, 0.5))
    same = np.ones(shape.shape, bool)
    for offset in [(0, 0), (1, 0), (0, 1), (1, 1)]:
        other, other_normal = hits(offset)
        same &= (other == shape) & ((shape == 0) | ((normal * other_normal).sum(-1) > SAME_NORMAL))
    return same.reshape(size[1], size[0])


def write(folder, output, size, spp, plant):
    """OUTPUT/NAME.exr: RGB radiance, alpha 1 away from edges; NAME.json: how it was made and its standard error."""
    scene, sensor = load(folder, size, plant)
    mean, error = render(scene, sensor, size, spp)
    valid = away_from_edges(scene, sensor, size)
    name = Path(folder).name + (f"-{plant}" if plant else "")
    picture = np.concatenate([mean, valid[..., None]], -1).astype(np.float32)
    luminance = mean @ LUMINANCE
    lit = luminance > 1e-3 * luminance.mean()
    said = {
        "mitsuba": mi.__version__,
        "variant": mi.variant(),
        "samples_per_pixel": spp,
        "mean_luminance": float(luminance.mean()),
        "relative_standard_error_of_the_mean": float(np.sqrt((error**2).sum()) / luminance.sum()),
        "largest_relative_standard_error_of_a_pixel": float((error[lit] / luminance[lit]).max()),
        "pixels_away_from_edges": int(valid.sum()),
    }
    output.mkdir(parents=True, exist_ok=True)
    mi.Bitmap(picture, mi.Bitmap.PixelFormat.RGBA).write(str(output / f"{name}.exr"))
    (output / f"{name}.json").write_text(json.dumps(said, indent=2) + "\n")
    print(name, json.dumps(said))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path, help="written by `candela export`")
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder for the pictures")
    parser.add_argument("--size", default="64x48", help="width x height in pixels")
    parser.add_argument("--spp", type=int, default=65536, help="samples per pixel")
    parser.add_argument("--plant", choices=["separable-smith", "mitsuba-spot"], help="an error, for negative controls")
    args = parser.parse_args()
    try:
        width, height = (int(x) for x in args.size.split("x"))
    except ValueError:
        parser.error("--size: expected WIDTHxHEIGHT, such as 64x48")
    try:
        for folder in args.folders:
            write(folder, args.output, (width, height), args.spp, args.plant)
    except SceneError as error:
        sys.exit(f"error: {error}")


if __name__ == "__main__":
    main()
