#!/usr/bin/env python3
"""Compares Gonio's reflection functions with Mitsuba 3's on 10,000 random pairs of directions.

Run from the repository root, with `pip install mitsuba==3.9.1 numpy` in the Python that runs it:

    python benches/peers/compare_brdf.py

Prints, for each model, the largest relative difference of f·cosθ and of the density, |a - b| / max(|a|, |b|), over
all pairs whose value is above 1e-6 of the model's largest; exits 1 if one is above 1e-4.

Mitsuba's wi is the viewer and its wo the light, and its eval includes the cosine. Its masking is Smith's,
separable. It computes in single precision.
"""

import subprocess
import sys

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

COUNT = 10_000
BOUND = 1e-4
ETA, K = "0.2/0.9/1.1", "3.9/2.4/2.2"


def rgb(text):
    return {"type": "rgb", "value": [float(x) for x in text.split("/")]}


def rough(distribution, alpha_u, alpha_v, visible):
    return {
        "type": "roughconductor",
        "distribution": distribution,
        "alpha_u": alpha_u,
        "alpha_v": alpha_v,
        "sample_visible": visible,
        "eta": rgb(ETA),
        "k": rgb(K),
    }


CASES = [("lambertian:0.2/0.5/0.8", {"type": "diffuse", "reflectance": rgb("0.2/0.5/0.8")})]
for alphas in [(0.1, 0.1), (0.3, 0.3), (0.7, 0.7), (0.1, 0.4), (0.5, 0.2)]:
    for name, visible in [("ggx", True), ("beckmann", False)]:
        ours = (
            f"{name}:alpha_x={alphas[0]},alpha_y={alphas[1]},masking=smith,"
            f"interreflection=none,eta={ETA},k={K}"
        )
        CASES.append((ours, rough(name, *alphas, visible)))
CASES.append((f"mirror:eta={ETA},k={K}", {"type": "conductor", "eta": rgb(ETA), "k": rgb(K)}))


def gonio(description):
    command = ["cargo", "run", "-q", "-p", "gonio-brdf", "--example", "dump_values", "--"]
    out = subprocess.run(command + [description, str(COUNT)], check=True, capture_output=True)
    return np.loadtxt(out.stdout.decode().splitlines(), delimiter=",")


def mitsuba(scene, rows):
    bsdf = mi.load_dict(scene)
    context = mi.BSDFContext()
    values = np.zeros((len(rows), 4))
    for k, row in enumerate(rows):
        si = mi.SurfaceInteraction3f()
        si.wi = mi.Vector3f(row[3:6])
        if scene["type"] == "conductor":
            sample, weight = bsdf.sample(context, si, 0.5, mi.Point2f(0.5, 0.5))
            values[k] = [*weight, sample.pdf]
            assert np.allclose(sample.wo, row[0:3], atol=1e-6)
            continue
        wo = mi.Vector3f(row[0:3])
        values[k] = [*bsdf.eval(context, si, wo), bsdf.pdf(context, si, wo)]
    return values


def largest_difference(a, b):
    scale = np.maximum(np.abs(a), np.abs(b))
    counted = scale > 1e-6 * scale.max()
    return float(np.max(np.abs(a - b)[counted] / scale[counted]))


def main():
    worst = 0.0
    print(f"{'model':<88} {'f cos':>9} {'pdf':>9}")
    for description, scene in CASES:
        rows = gonio(description)
        theirs = mitsuba(scene, rows)
        f = largest_difference(rows[:, 6:9], theirs[:, :3])
        pdf = largest_difference(rows[:, 9], theirs[:, 3])
        worst = max(worst, f, pdf)
        print(f"{description:<88} {f:9.1e} {pdf:9.1e}")
    print(f"largest: {worst:.1e} (bound {BOUND:.0e})")
    return 0 if worst <= BOUND else 1


if __name__ == "__main__":
    sys.exit(main())
