#!/usr/bin/env python3
"""Renders folders that `candela export` wrote: direct light, or light that bounces; radiance in nit, linear Rec. 709. See README.md."""

import argparse
import json
import sys
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

from scene import Scene, SceneError, pixel_rays  # noqa: E402 (needs the variant)

# Camera rays of a pixel at once, their light samples stratified; the spread between such batches gives the standard error.
BATCH = 4096
# Pixels are to be compared at 1 % of (pixel + a tenth of the mean), so must be known better: largest standard error.
CONVERGED = 3e-3
# Of light that bounces, whose pictures say how noisy they are.
CONVERGED_BOUNCES = 3e-2
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
# m: both programs start their shadow rays a little off the surface (about 0.3 mm here), which moves hard shadows as much.
SHADOW_EDGE = 1e-3
# Candela turns shading normals until their cosine with the direction to the camera is this.
LEAST_COSINE = 0.01
# Two rays see the same surface if they hit the same shape and the normals differ by less (cosine).
SAME_NORMAL = 0.94


def direct_integrators():
    """Lights are seen too, as in Candela. Mitsuba's sampling of lights alone is unbiased for every BSDF."""
    return [(1, mi.load_dict({"type": "direct", "emitter_samples": 1, "bsdf_samples": 0}))]


def bounce_integrators(bounces):
    """Light that was reflected 1 to `bounces` times (-1: any number) on its way to what the camera sees: what paths of that depth
    find more than those that end there. Both walk the same paths, as they get the same numbers.
    """
    def path(depth):
        return mi.load_dict({"type": "path", "max_depth": depth, "rr_depth": 16})
    return [(1, path(-1 if bounces < 0 else bounces + 2)), (-1, path(2))]


def render(scene, size, spp, integrators):
    """Mean and squared standard error of each pixel's radiance through its middle: (height, width, 3), (height, width).

    `integrators`: factors and integrators, whose sum it is.
    """
    pixels = size[0] * size[1]
    batch = min(BATCH, spp)
    batches = -(-spp // batch)
    means = []
    for i in range(batches):
        total = 0
        for factor, integrator in integrators:
            sampler = mi.load_dict({"type": "multijitter", "sample_count": batch})
            sampler.set_samples_per_wavefront(batch)
            sampler.seed(i, pixels * batch)
            rays = pixel_rays(scene.sensors()[0], size, repeat=batch)
            radiance, _, _ = integrator.sample(scene, sampler, rays)
            sums = [np.array(dr.block_sum(c, batch), np.float64) / batch for c in radiance]
            total = total + factor * np.stack(sums, -1)
        means.append(total)
    means = np.stack(means)
    # From the spread of the batches.
    variance = (means @ LUMINANCE).var(0, ddof=1) / batches if batches > 1 else np.zeros(pixels)
    return means.mean(0).reshape(size[1], size[0], 3), variance.reshape(size[1], size[0])


def away_from_edges(scene, size):
    """Where the rays through a pixel's corners meet the shape that its middle meets, with much the same normal, or the
    same color of the sky."""
    def hits(offset):
        si = scene.ray_intersect(pixel_rays(scene.sensors()[0], size, offset))
        sky = scene.environment()
        sky = np.array(sky.eval(si)) if sky else np.zeros((3, 1))
        shape = np.array(dr.reinterpret_array(mi.UInt32, si.shape))
        return shape, np.array(si.sh_frame.n), sky

    shape, normal, sky = hits((0.5, 0.5))
    facing = shading_normals_face_the_camera(scene, size)
    same = np.ones(shape.shape, bool)
    for offset in [(0, 0), (1, 0), (0, 1), (1, 1)]:
        other, other_normal, other_sky = hits(offset)
        same_normal = (normal * other_normal).sum(0) > SAME_NORMAL
        same_sky = (np.abs(sky - other_sky) <= 1e-5 * sky).all(0)
        same &= (other == shape) & np.where(shape != 0, same_normal & facing, same_sky)
    return same.reshape(size[1], size[0])


def shading_normals_face_the_camera(scene, size):
    """Where they do not, Mitsuba is black, and Candela turns them until they do: see README.md."""
    rays = pixel_rays(scene.sensors()[0], size)
    si = scene.ray_intersect(rays)
    side = dr.sign(dr.dot(si.n, -rays.d))
    return np.array(side * dr.dot(si.sh_frame.n, -rays.d)) >= LEAST_COSINE


def away_from_hard_shadows(scene, size):
    """Where points around what the middle of a pixel meets agree on whether they see the scene's one light."""
    si = scene.ray_intersect(pixel_rays(scene.sensors()[0], size))

    def is_lit(x, y):
        moved = mi.SurfaceInteraction3f(si)
        moved.p = si.p + SHADOW_EDGE * (x * si.sh_frame.s + y * si.sh_frame.t)
        _, weight = scene.sample_emitter_direction(moved, mi.Point2f(0.5), True)
        return np.array(weight).max(0) > 0

    middle = is_lit(0, 0)
    same = [is_lit(x, y) == middle for x, y in [(1, 0), (-1, 0), (0, 1), (0, -1)]]
    return np.logical_and.reduce(same).reshape(size[1], size[0])


def direct(name, scene, size, spp):
    """Light that comes straight from lights: its mean and squared standard error, and where it may be compared."""
    mean, variance, valid = 0, 0, True
    for i, light in enumerate(scene.lights):
        print(f"{name}: light {i + 1} of {len(scene.lights)}", file=sys.stderr)
        lit = scene.lit_by([light])
        part, part_variance = render(lit, size, 1 if scene.is_exact(light) else spp, direct_integrators())
        mean, variance = mean + part, variance + part_variance
        valid = valid & away_from_edges(lit, size)
        if scene.is_exact(light):
            valid = valid & away_from_hard_shadows(lit, size)
    return mean, variance, valid


def bounced(scene, size, spp, bounces):
    """The same of light that bounces."""
    lit = scene.lit_by(scene.lights)
    return *render(lit, size, spp, bounce_integrators(bounces)), away_from_edges(lit, size)


def write(folder, output, size, spp, bounces, plant, noisy):
    """OUTPUT/NAME.exr: RGB radiance, alpha 1 away from edges, of bounced light its standard error there; NAME.json: how it was made."""
    depth = {None: "", -1: "-bounces-inf"}.get(bounces, f"-bounces-{bounces}")
    name = folder.name + depth + (f"-{plant}" if plant else "")
    scene = Scene(folder, size, plant)
    if not scene.lights:
        raise SceneError(f"{name}: nothing in it shines")
    if bounces is None:
        mean, variance, valid = direct(name, scene, size, spp)
    else:
        mean, variance, valid = bounced(scene, size, spp, bounces)
    error = np.sqrt(variance)
    luminance = mean @ LUMINANCE
    # Light that bounces is noisy: the picture says how much.
    alpha = valid if bounces is None else np.where(valid, np.maximum(error, 1e-9), 0)
    picture = np.concatenate([mean, alpha[..., None]], -1).astype(np.float32)
    largest = float((error / (luminance + 0.1 * luminance.mean()))[valid].max())
    if largest > (CONVERGED if bounces is None else CONVERGED_BOUNCES) and not noisy:
        raise SceneError(f"{name}: a pixel's standard error is {largest:.2e} of it; render with more --spp, or --noisy")
    said = {
        "mitsuba": mi.__version__,
        "variant": mi.variant(),
        "samples_per_pixel_and_area_light" if bounces is None else "paths_per_pixel": spp,
        "mean_luminance": float(luminance.mean()),
        "relative_standard_error_of_the_mean": float(np.sqrt(variance.sum()) / luminance.sum()),
        "largest_standard_error_over_pixel_plus_tenth_of_mean": largest,
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
    parser.add_argument("--spp", type=int, default=65536, help="samples per pixel and light with an extent")
    parser.add_argument("--bounces", help="light alone that was reflected 1 to BOUNCES times (`inf`: any number) before it is seen")
    parser.add_argument("--plant", choices=["separable-smith", "mitsuba-spot"], help="an error, for negative controls")
    parser.add_argument("--noisy", action="store_true", help="write pictures that have not converged, too")
    args = parser.parse_args()
    try:
        width, height = (int(x) for x in args.size.split("x"))
    except ValueError:
        parser.error("--size: expected WIDTHxHEIGHT, such as 64x48")
    try:
        bounces = {None: None, "inf": -1}[args.bounces] if args.bounces in (None, "inf") else int(args.bounces)
    except ValueError:
        parser.error("--bounces: expected a number, or inf")
    try:
        for folder in args.folders:
            write(folder, args.output, (width, height), args.spp, bounces, args.plant, args.noisy)
    except SceneError as error:
        sys.exit(f"error: {error}")


if __name__ == "__main__":
    main()
