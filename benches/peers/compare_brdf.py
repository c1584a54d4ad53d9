#!/usr/bin/env python3
"""Compares Gonio's reflection functions with Mitsuba 3's on 10,000 random pairs of directions each, over random parameters.

Run from the repository root, with `pip install mitsuba==3.9.1 numpy` in the Python that runs it:

    python benches/peers/compare_brdf.py [--sets 6] [WORD ...]

Only cases whose description contains one of the words, if any are given. Prints, for each, the largest relative difference of
f·|cosθ| and of the density, |a - b| / max(|a|, |b|), over all pairs whose value is above 1e-6 of the largest; exits 1 if one is above 1e-4.

What is bridged:

- Mitsuba's wi is the viewer and its wo the light, and its eval includes the cosine. Its masking is Smith's, separable.
- It computes in single precision. Where a refracting facet is seen at a grazing angle, or is the small difference of two directions, its
  cosine has few digits left: pairs with |ω·(ωi + η ωr)| < 0.2 for either ω are left out, a tenth (η = 2.4) to a quarter (1.1) of the refracted
  ones.
- `disney`: the density is Gonio's own choice, as is that of `rough-dielectric` with Beckmann's distribution (Mitsuba widens it). Mitsuba's
  `principled` leaves the 1/(4 cosθi cosθr) of a microfacet lobe out of its clearcoat; Burley 2012 has it. The clearcoat, the
  difference of the values with and without it, is divided by that here, where that is above 0.25. Its gloss is at most a
  half, because Mitsuba's distribution takes sin² from 1 - cos², which in single precision is off by 1e-4 of a glossier peak.
"""

import argparse
import subprocess
import sys

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

COUNT = 10_000
BOUND = 1e-4


def rgb(text):
    return {"type": "rgb", "value": [float(x) for x in text.split("/")]}


def cases(sets):
    """Descriptions of Gonio's, scenes of Mitsuba's, and whether the densities are of one choice."""
    rng = np.random.default_rng(20)

    def draw(low, high):
        return round(float(rng.uniform(low, high)), 3)

    def colour():
        return "/".join(str(draw(0.05, 0.95)) for _ in range(3))

    out = []
    for _ in range(sets):
        c = colour()
        out.append((f"lambertian:{c}", {"type": "diffuse", "reflectance": rgb(c)}, True))
        alphas = draw(0.05, 1.0), draw(0.05, 1.0)
        eta, k = (f"{draw(0.2, 3)}/{draw(0.2, 3)}/{draw(0.2, 3)}" for _ in range(2))
        metal = {"eta": rgb(eta), "k": rgb(k)}
        out.append((f"mirror:eta={eta},k={k}", {"type": "conductor", **metal}, True))
        ior = draw(1.05, 2.5)
        for name, visible in [("ggx", True), ("beckmann", False)]:
            facets = {"distribution": name, "alpha_u": alphas[0], "alpha_v": alphas[1], "sample_visible": visible}
            rough = f"alpha_x={alphas[0]},alpha_y={alphas[1]},masking=smith,interreflection=none"
            out.append((f"{name}:{rough},eta={eta},k={k}", {"type": "roughconductor", **facets, **metal}, True))
            glass = {"type": "roughdielectric", **facets, "int_ior": ior, "ext_ior": 1.0}
            out.append((f"rough-dielectric:distribution={name},{rough},ior={ior}", glass, visible))
        out.append((f"smooth-dielectric:ior={ior}", {"type": "dielectric", "int_ior": ior, "ext_ior": 1.0}, True))
        out.append((f"thin-dielectric:ior={ior}", {"type": "thindielectric", "int_ior": ior, "ext_ior": 1.0}, True))
        values = {
            "roughness": draw(0.1, 1),
            "metallic": draw(0, 1),
            "anisotropic": draw(0, 1),
            "specular_tint": draw(0, 1),
            "sheen": draw(0, 1),
            "sheen_tint": draw(0, 1),
            "flatness": draw(0, 1),
        }
        for extra in [{}, {"clearcoat": draw(0.2, 1), "clearcoat_gloss": draw(0, 0.5)}, {"spec_trans": draw(0.1, 0.9)}]:
            ours = ",".join(f"{k}={v}" for k, v in {**values, **extra}.items())
            theirs = {k.replace("specular_tint", "spec_tint"): v for k, v in {**values, **extra}.items()}
            scene = {"type": "principled", "base_color": rgb(c), "eta": ior, **theirs}
            out.append((f"disney:{c},ior={ior},{ours}", scene, False))
    return out


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
        if scene["type"] in ("conductor", "dielectric", "thindielectric"):
            sample, weight = bsdf.sample(context, si, row[10], mi.Point2f(0.5, 0.5))
            values[k] = [*weight, sample.pdf]
            assert np.allclose(sample.wo, row[0:3], atol=1e-5)
            continue
        wo = mi.Vector3f(row[0:3])
        values[k] = [*bsdf.eval(context, si, wo), bsdf.pdf(context, si, wo)]
    return values


def has_digits(rows, ior):
    """Whether single precision has enough digits for the facet of each pair."""
    wi, wo = rows[:, 0:3], rows[:, 3:6]
    n = [np.where(w[:, [2]] < 0, ior, 1.0) for w in (wi, wo)]
    total = wi * n[0] + wo * n[1]
    cosines = [np.abs(np.sum(w * total, axis=1)) for w in (wi, wo)]
    reflected = wi[:, 2] * wo[:, 2] > 0
    return reflected | (np.minimum(*cosines) > 0.2)


def largest_difference(a, b):
    scale = np.maximum(np.abs(a), np.abs(b))
    counted = scale > 1e-6 * scale.max()
    return float(np.max(np.abs(a - b)[counted] / scale[counted]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sets", type=int, default=6, help="sets of random parameters")
    parser.add_argument("words", nargs="*", help="only descriptions that contain one of these")
    arguments = parser.parse_args()
    worst = 0.0
    print(f"{'f |cos|':>9} {'pdf':>9}  model")
    for description, scene, same_density in cases(arguments.sets):
        if arguments.words and not any(word in description for word in arguments.words):
            continue
        rows = gonio(description)
        if scene["type"] in ("roughdielectric", "principled"):
            ior = scene.get("int_ior") or scene["eta"]
            rows = rows[has_digits(rows, ior)]
        if "clearcoat" in scene:
            rows = rows[4 * rows[:, 2] * rows[:, 5] > 0.25]
        theirs = mitsuba(scene, rows)
        if "clearcoat" in scene:
            without = mitsuba({**scene, "clearcoat": 0.0}, rows)
            theirs = without + (theirs - without) / (4 * rows[:, [2]] * rows[:, [5]])
        f = largest_difference(rows[:, 6:9], theirs[:, :3])
        pdf = largest_difference(rows[:, 9], theirs[:, 3]) if same_density else float("nan")
        worst = max(worst, f, 0.0 if np.isnan(pdf) else pdf)
        print(f"{f:9.1e} {pdf:9.1e}  {description}", flush=True)
    print(f"largest: {worst:.1e} (bound {BOUND:.0e})")
    return 0 if worst <= BOUND else 1


if __name__ == "__main__":
    sys.exit(main())
