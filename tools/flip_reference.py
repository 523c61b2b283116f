#!/usr/bin/env python3
"""Reference numbers of FLIP for runner/lab/src/measure/flip.rs, computed by its authors' program.

    pip install flip-evaluator numpy
    python3 tools/flip_reference.py > runner/lab/src/measure/fixtures/flip.json
"""

import json

import flip_evaluator
import numpy as np

WIDTH, HEIGHT = 48, 36


def pictures():
    """A picture with edges, ramps, saturated colors and fine detail; the same with noise, a shift, a tint, dots."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH].astype(np.float64)
    picture = np.stack([x / WIDTH, y / HEIGHT, 0.5 + 0.5 * np.sin(x * 0.9) * np.cos(y * 0.7)], axis=-1)
    picture[8:20, 10:22] = [0.9, 0.1, 0.1]
    picture[14:30, 30:34] = [0.05, 0.05, 0.6]
    picture[:, 40:] = np.where(((x + y) % 2 == 0)[..., None], 0.9, 0.2)[:, 40:]
    changed = picture.copy()
    random = np.random.default_rng(7)
    changed[:18] += random.normal(0.0, 0.08, changed[:18].shape)
    changed[8:20, 10:22] = np.roll(changed[8:20, 10:22], 2, axis=1) * [0.8, 1.0, 1.2]
    changed[22:, :14] *= [1.1, 0.95, 0.8]
    changed[25, 20] = changed[31, 5] = [1.0, 1.0, 1.0]
    changed[:, 44:] = 0.55
    return [np.rint(np.clip(p, 0.0, 1.0) * 255.0).astype(np.uint8) for p in (picture, changed)]


def main():
    reference, test = pictures()
    as_floats = [p.astype(np.float32) / np.float32(255.0) for p in (reference, test)]
    error_map, mean, parameters = flip_evaluator.evaluate(*as_floats, "LDR", applyMagma=False)
    document = {
        "program": "PyPI flip-evaluator 1.7",
        "pixels_per_degree": round(float(parameters["ppd"]), 6),
        "width": WIDTH,
        "height": HEIGHT,
        "reference": reference.tobytes().hex(),
        "test": test.tobytes().hex(),
        "mean": float(mean),
        "map": [round(float(e), 6) for e in np.asarray(error_map).reshape(HEIGHT, WIDTH, -1)[..., 0].flat],
    }
    print(json.dumps(document, separators=(",", ":")))


if __name__ == "__main__":
    main()
