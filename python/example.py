"""How fast does the error of the mean fall, with reuse and without? Run by CI: every step is checked."""

import tempfile

import candela

SCENE = dict(scene="knot", lights=30, size=(96, 64))

truth = candela.reference(**SCENE)
print(f"truth: {truth.shape[1]} x {truth.shape[0]} pixels, {truth.mean():.4f} nit in the mean")
assert truth.shape == (64, 96, 3) and truth.dtype == "float32"

errors = {}
for reuse in (True, False):
    for frames in (4, 16, 64):
        mean = candela.render(**SCENE, frames=frames, accumulate=True, temporal=reuse, spatial=reuse)
        measured = candela.compare(mean, truth)
        errors[reuse, frames] = measured["rel_mse"]
        print(f"{'with' if reuse else 'without'} reuse, {frames:2} frames: relMSE {measured['rel_mse']:.5f},"
              f" energy {measured['energy_ratio']:.4f}")
        assert abs(measured["energy_ratio"] - 1) < 0.05
assert errors[False, 64] < errors[False, 16] < errors[False, 4]

# A picture that is 10 % too bright is seen.
assert abs(candela.compare(1.1 * truth, truth)["energy_ratio"] - 1.1) < 0.001

layers = candela.render(**SCENE, layers=True)
print("layers:", ", ".join(f"{name or 'picture'} {array.shape}" for name, array in sorted(layers.items())))
assert abs(layers["diffuse"] + layers["specular"] + layers["emission"] - layers[""]).max() < 1e-3 * layers[""].max()

print("lights:", candela.info("knot", lights=30)["lights"])
pixel = candela.explain(48, 32, **SCENE, frames=2)
print("explained:", ", ".join(list(pixel)[:8]))

with tempfile.TemporaryDirectory() as folder:
    points = candela.sweep("smoke", folder, only="RIS only", replicas=1, frames=2)
    print(f"sweep: {len(points)} points")

try:
    candela.render("no-such-file.glb")
    raise AssertionError("a missing file is an error")
except candela.Error as error:
    assert error.code == 2
    print("error:", error)
