#!/usr/bin/env python3
"""Compares Gonio's files of the RGL database with Mitsuba 3's `measured` on 10,000 random pairs of directions and samples each.

Run from the repository root, with `pip install mitsuba==3.9.1 numpy` in the Python that runs it:

    python benches/peers/compare_measured.py FOLDER/*.bsdf

Prints, for each file, the largest relative difference |a - b| / max(|a|, |b|, floor), of colours in their largest component: of
f·cosθ, of the density, and of samples drawn from the same numbers: the length of the difference of their directions, and weight and
density; then the share of numbers that draw a direction in both, and of those compared. Exits 1 if a difference is above 1e-4.

Mitsuba computes in single precision, which calls for two allowances. The floor is a tenth of the mean over the hemisphere (of a density:
1/2π). For a point of the square is found by a sum of up to 128 numbers, whose error is up to 128 · 6e-8 = 8e-6, and values may
rise by their largest between two of 32 nodes: by 2e-4 of it over that error. And samples with half vectors within 1.5° of the normal
are left out, 1 to 6 % of them: the square's first coordinate is √θh, so that the direction goes with the root of the error, and the
density has that root in its denominator. Mitsuba limits the latter to 1e-6.

Mitsuba's wi is the viewer and its wo the light, its eval includes the cosine, and it keeps negative values, which are 0 here.
A sample is compared where both draw a direction; the others are below the horizon.
"""

import subprocess
import sys

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

COUNT = 10_000
BOUND = 1e-4
FLOOR = 0.1
NEAR_NORMAL = np.cos(np.radians(1.5))


def gonio(path):
    command = ["cargo", "run", "--release", "-q", "-p", "gonio-brdf", "--example", "dump_values", "--"]
    out = subprocess.run(command + [f"table:{path}", str(COUNT)], check=True, capture_output=True)
    return np.loadtxt(out.stdout.decode().splitlines(), delimiter=",")


def mitsuba(path, rows):
    """f·cosθ, density; wi, weight, density of samples; lost or not."""
    bsdf = mi.load_dict({"type": "measured", "filename": path})
    context = mi.BSDFContext()
    values, samples = np.zeros((len(rows), 4)), np.zeros((len(rows), 7))
    for k, row in enumerate(rows):
        si = mi.SurfaceInteraction3f()
        si.wi = mi.Vector3f(row[3:6])
        wo = mi.Vector3f(row[0:3])
        values[k] = [*bsdf.eval(context, si, wo), bsdf.pdf(context, si, wo)]
        sample, weight = bsdf.sample(context, si, 0.5, mi.Point2f(row[11], row[12]))
        samples[k] = [*sample.wo, *weight, sample.pdf]
    return values, samples


def difference(a, b, mean=None):
    a, b = np.maximum(a, 0), np.maximum(b, 0)
    floor = FLOOR * (a.mean() if mean is None else mean)
    scale = np.maximum(a, b).reshape(len(a), -1).max(axis=1)
    apart = np.abs(a - b).reshape(len(a), -1).max(axis=1)
    return float(np.max(apart / np.maximum(scale, floor)))


def main():
    worst = 0.0
    names = ["f cos", "pdf", "wi", "weight", "its pdf"]
    print(f"{'file':<32}" + "".join(f"{n:>9}" for n in names) + f"{'drawn':>9}{'compared':>9}")
    for path in sys.argv[1:]:
        rows = gonio(path)
        values, samples = mitsuba(path, rows)
        drawn = (rows[:, 20] > 0) & (samples[:, 6] > 0) & (samples[:, 2] > 0)
        half = rows[:, 14:17] + rows[:, 3:6]
        half /= np.linalg.norm(half, axis=1)[:, None]
        compared = drawn & (half[:, 2] < NEAR_NORMAL)
        ours, theirs = rows[compared], samples[compared]
        uniform = 1 / (2 * np.pi)
        all_of = [
            difference(rows[:, 6:9], values[:, :3]),
            difference(rows[:, 9], values[:, 3], uniform),
            np.linalg.norm(ours[:, 14:17] - theirs[:, :3], axis=1).max(),
            difference(ours[:, 17:20], theirs[:, 3:6]),
            difference(ours[:, 20], theirs[:, 6], uniform),
        ]
        worst = max(worst, *all_of)
        name = path.rsplit("/", 1)[-1]
        print(f"{name:<32}" + "".join(f"{d:9.1e}" for d in all_of) + f"{drawn.mean():9.4f}{compared.mean():9.4f}")
    print(f"largest: {worst:.1e} (bound {BOUND:.0e})")
    return 0 if 0 < worst <= BOUND else 1


if __name__ == "__main__":
    sys.exit(main())
