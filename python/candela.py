"""Candela's pictures, truths and measurements as numpy arrays.

Every function runs the program `candela`: the one that the environment variable CANDELA names, or the first on the PATH.
Pictures are linear RGB radiance in nit: float32, height x width x 3, rows from the top.

Keyword arguments are options of the command (`candela render --help`), with underscores for dashes: `size=(640, 360)`,
`camera="nave"` or `camera=(x, y, z, tx, ty, tz)`, `frames=64`, `accumulate=True`, `temporal=False`.
"""

import json
import os
import subprocess
import tempfile
import warnings
from pathlib import Path

import numpy
import OpenEXR

__all__ = ["Error", "compare", "explain", "info", "read", "reference", "render", "sweep", "write"]


class Error(RuntimeError):
    """The program's message; `code` is its exit code: 2 is bad input, see docs/command-line.md."""

    def __init__(self, code, message):
        super().__init__(message)
        self.code = code


def render(scene="atrium", *, layers=False, **options):
    """A frame of ReSTIR, or with `accumulate=True` the mean of all `frames`; with `layers` a dict of arrays."""
    return _picture("render", scene, layers, options)


def reference(scene="atrium", *, layers=False, **options):
    """The sum over all lights without resampling; with `bounces=N` or `"inf"` and indirect light by path tracing."""
    return _picture("reference", scene, layers, options)


def compare(picture, truth, maps=None):
    """Error measures of a picture, as a dict (docs/measuring.md defines them); heat maps go to the folder `maps`.

    Both are arrays, or paths of .exr files.
    """
    with tempfile.TemporaryDirectory() as folder:
        paths = [_path(image, Path(folder) / name) for image, name in ((picture, "x.exr"), (truth, "y.exr"))]
        return json.loads(_run("compare", *paths, "--json", *_options({"output": maps})))


def explain(x, y, scene="atrium", **options):
    """The replay of one pixel on the CPU, as a dict: every candidate, ray, weight and choice."""
    return json.loads(_run("explain", str(x), str(y), str(scene), "--json", *_options(options)))


def info(scene="atrium", **options):
    """Contents of a scene, as a dict."""
    return json.loads(_run("info", str(scene), "--json", *_options(options)))


def sweep(plan, directory, **options):
    """Measures a plan (docs/measuring.md) to `directory`, which also gets the report; gives its rows, one a point, as dicts."""
    _run("sweep", str(plan), "--output", str(directory), *_options(options))
    return json.loads((Path(directory) / "points.json").read_text())["rows"]


def read(path):
    """Layers of an .exr file: arrays by name, `""` is the picture. One channel is height x width, several are x channels."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
    layers = {}
    for name in channels:
        layer, _, _ = name.rpartition(".")
        layers.setdefault(layer, []).append(name)
    order = "RGBAXYZ"
    for layer, names in layers.items():
        names.sort(key=lambda name: order.index(name[-1]))
        arrays = [numpy.asarray(channels[name], dtype=numpy.float32) for name in names]
        layers[layer] = arrays[0] if len(arrays) == 1 else numpy.stack(arrays, axis=-1)
    return layers


def write(path, picture):
    """Writes an array, height x width x 3, as .exr."""
    pixels = numpy.ascontiguousarray(picture, dtype=numpy.float32)
    if pixels.ndim != 3 or pixels.shape[2] != 3:
        raise ValueError(f"a picture is height x width x 3, not {' x '.join(map(str, pixels.shape))}")
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {"RGB": pixels}) as file:
        file.write(str(path))


def _picture(command, scene, layers, options):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.exr"
        _run(command, str(scene), "--output", str(path), *_options({**options, "layers": layers or None}))
        found = read(path)
    return found if layers else found[""]


def _path(image, path):
    if isinstance(image, (str, os.PathLike)):
        return str(image)
    write(path, image)
    return str(path)


def _options(options):
    words = []
    for name, value in options.items():
        name = name.replace("_", "-")
        if value is None:
            continue
        if value is True:
            words.append(f"--{name}")
        elif value is False:
            words.append(f"--no-{name}")
        else:
            if isinstance(value, (tuple, list)):
                value = ("x" if name == "size" else ",").join(map(str, value))
            words.append(f"--{name}={value}")
    return words


def _run(*arguments):
    program = os.environ.get("CANDELA", "candela")
    try:
        done = subprocess.run([program, *arguments], capture_output=True, text=True)
    except OSError as error:
        raise Error(None, f"can't start {program}: {error}; set CANDELA to the program") from error
    lines = done.stderr.splitlines()
    if done.returncode != 0:
        errors = [line for line in lines if line.startswith("error: ")]
        raise Error(done.returncode, (errors or lines or ["no message"])[-1].removeprefix("error: "))
    for line in lines:
        if line.startswith("warning: "):
            warnings.warn(line.removeprefix("warning: "), stacklevel=3)
    return done.stdout
