#!/usr/bin/env python3
"""Time to equal error: means of Candela's frames against Mitsuba's `direct`, on one device. See README.md."""

import argparse
import json
import statistics
import subprocess
import sys
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
# Lanes that Mitsuba works on at once.
WAVEFRONT = 1 << 26
# Timed runs; their median counts.
RUNS = 3
# Means of the two programs may differ by this: normals are packed in Candela, and edges are not the same to both.
SAME_MEAN = 0.02
PLAN = """
title = "Time to equal error"
size = [{width}, {height}]
replicas = 2
steady = {{ ms = 2000.0, window_ms = 200.0 }}
settings = {{ history_cap = 20.0 }}

[[scene]]
name = "scene"
source = "{source}"
lights = [{lights}]

[[series]]
name = "candela"
[[series.arm]]
name = "default"

[accumulate]
ms = {ms}
frames = 512
targets = {targets}
"""


def run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"error: {' '.join(command)} failed")
    return done.stdout


def candela_curve(args, size):
    """[(ms of GPU time, relMSE)] of means of more and more frames from a fresh history, and the name of the device."""
    plan = args.output / "plan.toml"
    source = Path(args.scene).resolve() if Path(args.scene).exists() else args.scene
    plan.write_text(PLAN.format(
        width=size[0], height=size[1], source=source, lights=args.lights, ms=args.ms, targets=args.targets,
    ))
    run(args.candela, "sweep", str(plan), "-o", str(args.output / "candela"))
    found = json.loads((args.output / "candela/points.json").read_text())
    measured = found["rows"][0]["measured"]
    return [(point["ms"], point["rel_mse"]["mean"]) for point in measured["curve"]], found["about"]["device"]["name"]


def candela_mean(args, size):
    """Mean luminance of the sum over all lights, nit."""
    path = args.output / "truth.exr"
    picture = f"{size[0]}x{size[1]}"
    run(args.candela, "reference", args.scene, str(args.lights), "--size", picture, "-o", str(path))
    pixels = np.array(mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32))
    return float((pixels @ LUMINANCE).mean())


class Mitsuba:
    """Direct light of the exported scene, all of its lights at once."""

    def __init__(self, folder, size):
        from scene import Scene

        self.size, scene = size, Scene(folder, size)
        self.scene = scene.lit_by(scene.lights)

    def launch(self, spp, seed):
        """One picture of `spp` camera rays a pixel: the sum over them, three channels of the device's memory."""
        from scene import pixel_rays

        # One light sample a camera ray: of several, Mitsuba 3.9.1 counts each of a point light whole.
        integrator = mi.load_dict({"type": "direct", "emitter_samples": 1, "bsdf_samples": 0})
        sampler = mi.load_dict({"type": "multijitter", "sample_count": spp})
        sampler.set_samples_per_wavefront(spp)
        # Opaque: another seed is no other program.
        sampler.seed(dr.opaque(mi.UInt32, seed), self.size[0] * self.size[1] * spp)
        rays = pixel_rays(self.scene.sensors()[0], self.size, repeat=spp)
        radiance, _, _ = integrator.sample(self.scene, sampler, rays)
        sums = [dr.block_sum(channel, spp) for channel in radiance]
        dr.eval(sums)
        return sums

    def picture(self, spp, seed):
        """(luminance of each pixel, ms that kernels ran on the device: recording them in Python costs more, and is left out)"""
        batch = spp
        while batch > 1 and batch * self.size[0] * self.size[1] > WAVEFRONT:
            batch //= 4
        dr.kernel_history_clear()
        sums = [0, 0, 0]
        for i in range(spp // batch):
            part = self.launch(batch, seed * (spp // batch) + i)
            sums = [total + more for total, more in zip(sums, part)]
            dr.eval(sums)
        ms = sum(kernel["execution_time"] for kernel in dr.kernel_history())
        return np.stack([np.array(channel, np.float64) for channel in sums], -1) @ LUMINANCE / spp, ms

    def curve(self, largest):
        """[(ms, relMSE)] of more and more camera rays a pixel, and the mean luminance.

        The error is Mitsuba's own variance: half of the squared difference of two independent pictures, over the mean of those
        with the most rays. So what the programs see differently at edges counts against neither of them.
        """
        counts = [4**i for i in range(largest.bit_length()) if 4**i <= largest]
        pictures, times = [], []
        for spp in counts:
            print(f"mitsuba: {spp} camera rays a pixel", file=sys.stderr)
            self.picture(spp, 0)  # compiles
            runs = [self.picture(spp, 1 + seed) for seed in range(RUNS)]
            pictures.append([picture for picture, _ in runs[:2]])
            times.append(statistics.median(ms for _, ms in runs))
        truth = np.mean(pictures[-1], 0)
        guard = 1e-3 * truth.mean() ** 2
        return [(ms, float(variance(*pair, truth, guard))) for ms, pair in zip(times, pictures)], float(truth.mean())


def variance(x, y, truth, guard):
    return (0.5 * (x - y) ** 2 / (truth**2 + guard)).mean()


def time_to(target, curve):
    """(ms, is it beyond the last point), log-log between the points of a curve, by error ~ 1 / ms beyond; None before its first."""
    if curve[0][1] <= target:
        return None, False
    for (ms0, error0), (ms1, error1) in zip(curve, curve[1:]):
        if error1 <= target < error0:
            share = np.log(error0 / target) / np.log(error0 / error1)
            return float(ms0 * (ms1 / ms0) ** share), False
    ms, error = curve[-1]
    return ms * error / target, True


def table(targets, candela, mitsuba):
    """Markdown; a star where a time is beyond what was rendered."""
    lines = ["| relMSE | Candela, ms | Mitsuba `direct`, ms | times |", "|---|---|---|---|"]
    for target in targets:
        times = [time_to(target, curve) for curve in (candela, mitsuba)]
        shown = ["first frame" if ms is None else f"{ms:.3g}{'*' * beyond}" for ms, beyond in times]
        ratio = "" if None in (times[0][0], times[1][0]) else f"{times[1][0] / times[0][0]:.3g}"
        lines.append(f"| {target:g} | {' | '.join(shown)} | {ratio} |")
    return "\n".join(lines)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("candela", help="the program")
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder for the table and what it is made from")
    parser.add_argument("--scene", default="atrium", help="a file, or a built-in scene")
    parser.add_argument("--lights", type=int, default=500)
    parser.add_argument("--size", default="1280x720", help="width x height in pixels")
    parser.add_argument("--variant", help="of Mitsuba: cuda_ad_rgb on an NVIDIA GPU (the default where it works), llvm_ad_rgb")
    parser.add_argument("--spp", type=int, default=256, help="most camera rays a pixel of Mitsuba")
    parser.add_argument("--ms", type=float, default=400, help="GPU time of a run of Candela")
    parser.add_argument("--targets", type=float, nargs="+", default=[1, 0.3, 0.1, 0.03, 0.01], help="relMSE")
    args = parser.parse_args()
    try:
        size = tuple(int(side) for side in args.size.split("x"))
        _, _ = size
    except ValueError:
        parser.error("--size: expected WIDTHxHEIGHT, such as 1280x720")
    return args, size


def works(variant):
    """Has this machine what the variant needs?"""
    try:
        mi.set_variant(variant)
        dr.eval(mi.Float(0) + dr.opaque(mi.Float, 1))
    except Exception:  # Dr.Jit's own, of no public class
        return False
    return True


def main():
    args, size = arguments()
    variant = args.variant or ("cuda_ad_rgb" if works("cuda_ad_rgb") else "llvm_ad_rgb")
    if not works(variant):
        sys.exit(f"error: Mitsuba's variant {variant} does not work here")
    dr.set_flag(dr.JitFlag.KernelHistory, True)
    from scene import SceneError

    args.output.mkdir(parents=True, exist_ok=True)
    exported = args.output / "scene"
    run(args.candela, "export", args.scene, str(args.lights), "-o", str(exported))
    candela, device = candela_curve(args, size)
    try:
        mitsuba, mean = Mitsuba(exported, size).curve(args.spp)
    except SceneError as error:
        sys.exit(f"error: {error}")
    ratio = candela_mean(args, size) / mean
    text = table(args.targets, candela, mitsuba)
    said = {
        "mitsuba": mi.__version__, "variant": variant, "device": device, "size": size, "scene": args.scene,
        "lights": args.lights, "mean_ratio": ratio, "candela": candela, "direct": mitsuba, "table": text,
    }
    (args.output / "equal-error.json").write_text(json.dumps(said, indent=2) + "\n")
    print(f"{args.scene}, {args.lights} lights, {args.size}, {device}; Mitsuba {mi.__version__} ({variant}); "
          f"mean of Candela over Mitsuba's: {ratio:.4f}\n\n{text}")
    if abs(ratio - 1) > SAME_MEAN:
        sys.exit("error: the programs do not render the same picture")


if __name__ == "__main__":
    main()
