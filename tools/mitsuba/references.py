#!/usr/bin/env python3
"""Remakes tests/references: exports the scenes of tests/common/outside.rs and renders them, and the planted errors."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCENES = ROOT / "out/outside-truth"
RENDER = [sys.executable, str(Path(__file__).with_name("render.py")), "-o", str(ROOT / "tests/references")]
EXPORT = ["cargo", "test", "-p", "tests", "--test", "outside_truth", "export_scenes", "--", "--ignored"]

subprocess.run(EXPORT, cwd=ROOT, check=True)
folders = sorted(str(path.parent) for path in SCENES.glob("*/scene.json") if not path.parent.name.endswith("-room"))
subprocess.run([*RENDER, *folders], check=True)
# As in `bounced` of tests/common/outside.rs.
BOUNCED = {"cornell-box": "1 2 inf", "environment": "2", "metal-room": "1 inf", "dielectric-room": "2", "textured-room": "1 2 inf"}
for scene, depths in BOUNCED.items():
    spp = "8192" if scene == "textured-room" else "16384" if scene == "environment" else "32768"
    for depth in depths.split():
        subprocess.run([*RENDER, str(SCENES / scene), "--size", "32x24", "--spp", spp, "--bounces", depth, "--noisy"], check=True)
for scene, plant in [("metal", "separable-smith"), ("spot", "mitsuba-spot")]:
    subprocess.run([*RENDER, str(SCENES / scene), "--plant", plant], check=True)
