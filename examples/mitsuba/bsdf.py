#!/usr/bin/env python3
"""A BSDF of Mitsuba 3 for Gonio to check:

    gonio brdf check --exec 'python3 bsdf.py roughplastic alpha=0.3 distribution=ggx'

The first word is the plugin, the others are its parameters: numbers, words, `true` and `false`, and colours as r/g/b.
Needs `pip install mitsuba numpy`; tried with Mitsuba 3.9.1. `--variant scalar_rgb` asks the scalar code, some ten times slower.

What is bridged:

- Mitsuba's wi is the viewer and its wo the light: the other way round here.
- Its eval has the cosine of the light's direction. It is divided by that here, and taken as 0 where the cosine is 0.
- Of its random numbers sample1 chooses among lobes (here the third number), and sample2 places the direction.
- A sample of weight 0 is none: Mitsuba's integrators end the path there, and its own χ² test leaves such samples out.
- An anisotropic one (alpha_u and alpha_v, `anisotropic`) says so.
"""

import argparse
import json
import sys

import mitsuba as mi
import numpy as np


def value(text):
    """A parameter's value from a word."""
    if "/" in text and all(part.replace(".", "", 1).isdigit() for part in text.split("/")):
        return {"type": "rgb", "value": [float(part) for part in text.split("/")]}
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return text


parser = argparse.ArgumentParser()
parser.add_argument("--variant", default="llvm_ad_rgb", help="llvm_ad_rgb or scalar_rgb")
parser.add_argument("plugin")
parser.add_argument("parameter", nargs="*", help="name=value")
arguments = parser.parse_args()
mi.set_variant(arguments.variant)
scalar = arguments.variant.startswith("scalar")

parameters = {key: value(text) for key, text in (word.split("=", 1) for word in arguments.parameter)}
bsdf = mi.load_dict({"type": arguments.plugin, **parameters})
context = mi.BSDFContext()


def interaction(viewer):
    """A point on a surface whose frame is the world's, seen from `viewer`."""
    si = mi.SurfaceInteraction3f()
    si.wi = viewer
    si.n = mi.Normal3f(0, 0, 1)
    si.sh_frame = mi.Frame3f(mi.Vector3f(0, 0, 1))
    return si


def vectors(rows):
    return mi.Vector3f(np.ascontiguousarray(rows.T))


def columns(x, count):
    """An array of Mitsuba's as rows of numpy, one for each of `count` entries; what is the same for all is repeated."""
    x = np.asarray(x, np.float32)
    rows = x.T if x.ndim == 2 else x.reshape(-1, 1)
    return np.broadcast_to(rows, (count, rows.shape[1]))


def call_eval(light, viewer):
    if scalar:
        return np.array([bsdf.eval(context, interaction(v), mi.Vector3f(l)) for l, v in zip(light, viewer)])
    return columns(bsdf.eval(context, interaction(vectors(viewer)), vectors(light)), len(light))


def evaluate(light, viewer):
    cos = np.abs(light[:, 2:])
    return np.where(cos > 0, call_eval(light, viewer) / np.where(cos > 0, cos, 1), 0)


def density(light, viewer):
    if scalar:
        return np.array([bsdf.pdf(context, interaction(v), mi.Vector3f(l)) for l, v in zip(light, viewer)])
    return columns(bsdf.pdf(context, interaction(vectors(viewer)), vectors(light)), len(light))


def row(viewer, u):
    s, weight = bsdf.sample(context, interaction(viewer), float(u[2]), mi.Point2f(u[:2]))
    return [*s.wo, *weight, s.pdf, mi.has_flag(s.sampled_type, mi.BSDFFlags.Delta)]


def draw(viewer, u):
    if scalar:
        return np.array([row(mi.Vector3f(v), x) for v, x in zip(viewer, u)], float)
    place = mi.Point2f(np.ascontiguousarray(u[:, :2].T))
    s, weight = bsdf.sample(context, interaction(vectors(viewer)), mi.Float(np.ascontiguousarray(u[:, 2])), place)
    delta = mi.has_flag(s.sampled_type, mi.BSDFFlags.Delta)
    return np.column_stack([columns(x, len(viewer)) for x in (s.wo, weight, s.pdf, delta)])


def sample(viewer, u):
    drawn = draw(viewer, u)
    drawn[np.all(drawn[:, 3:6] == 0, axis=1)] = 0
    return drawn


def relative_ior():
    """Index of refraction below the surface over the one above; None if nothing passes through."""
    if not mi.has_flag(bsdf.flags(), mi.BSDFFlags.Transmission):
        return None
    if "thin" in arguments.plugin:
        return 1.0
    if arguments.plugin == "principled":
        # `eta`, if it is given; else that of `specular`, 0.5 unless given: ((η − 1)/(η + 1))² = 0.08 specular.
        root = (0.08 * parameters.get("specular", 0.5)) ** 0.5
        return parameters.get("eta", (1 + root) / (1 - root))
    return float(np.asarray(mi.traverse(bsdf)["eta"]).ravel()[0])


asked, answers = sys.stdin.buffer, sys.stdout.buffer
asked.readline()
hello = {
    "id": 0,
    "name": f"mitsuba {arguments.plugin}",
    "offers": ["eval", "pdf", "sample"],
    "batches": "float32",
    "parameters": {k: v["value"] if isinstance(v, dict) else v for k, v in parameters.items()},
}
if parameters.get("anisotropic") or parameters.get("alpha_u") != parameters.get("alpha_v"):
    hello["isotropic"] = False
if (n := relative_ior()) is not None:
    hello["relative_ior"] = n
answers.write(json.dumps(hello).encode() + b"\n")
answers.flush()

functions = {b"eval": evaluate, b"pdf ": density, b"samp": sample}
while header := asked.read(12):
    count = int.from_bytes(header[4:8], "little")
    a, b = np.frombuffer(asked.read(24 * count), "<f4").reshape(2, count, 3)
    answer = np.ascontiguousarray(functions[header[:4]](a, b), "<f4")
    answers.write(header + answer.tobytes())
    answers.flush()
