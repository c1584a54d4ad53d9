#!/usr/bin/env python3
"""A BSDF of Mitsuba 3 for Gonio to check:

    gonio brdf check --exec 'python3 bsdf.py roughplastic alpha=0.3 distribution=ggx'

The first word is the plugin, the others are its parameters: numbers, words, `true` and `false`, and colours as r/g/b.
Needs `pip install mitsuba numpy`; tried with Mitsuba 3.9.1. `--variant` chooses another variant than llvm_ad_rgb.

What is bridged:

- Mitsuba's wi is the viewer and its wo the light: the other way round here.
- Its eval has the cosine of the light's direction. It is divided by that here, and taken as 0 where the cosine is 0.
- Its random numbers: sample1 chooses among lobes (our third number), sample2 places the direction.
"""

import argparse
import json
import sys

import mitsuba as mi
import numpy as np

COUNT_BYTES = 12


def value(text):
    """A parameter's value from a word."""
    if "/" in text and all(part.replace(".", "", 1).isdigit() for part in text.split("/")):
        return {"type": "rgb", "value": [float(part) for part in text.split("/")]}
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return text


parser = argparse.ArgumentParser()
parser.add_argument("--variant", default="llvm_ad_rgb")
parser.add_argument("--declare-not", action="append", default=[], choices=["reciprocal", "energy_conserving", "isotropic"])
parser.add_argument("plugin")
parser.add_argument("parameter", nargs="*")
arguments = parser.parse_args()
mi.set_variant(arguments.variant)

parameters = {key: value(text) for key, text in (word.split("=", 1) for word in arguments.parameter)}
bsdf = mi.load_dict({"type": arguments.plugin, **parameters})
context = mi.BSDFContext()
single = "double" not in arguments.variant
number = "<f4" if single else "<f8"


def vectors(rows):
    return mi.Vector3f(np.ascontiguousarray(rows.T))


def interaction(viewer):
    """A point on a surface whose frame is the world's, seen from `viewer`."""
    si = mi.SurfaceInteraction3f()
    si.wi = vectors(viewer)
    si.n = mi.Normal3f(0, 0, 1)
    si.sh_frame = mi.Frame3f(mi.Vector3f(0, 0, 1))
    return si


def columns(x, count):
    """A Mitsuba array as rows of numpy, one for each of `count` entries; constants are repeated."""
    x = np.asarray(x, dtype=number)
    rows = x.T if x.ndim == 2 else x.reshape(-1, 1)
    return np.broadcast_to(rows, (count, rows.shape[1]))


def evaluate(light, viewer):
    f = columns(bsdf.eval(context, interaction(viewer), vectors(light)), len(light))
    cos = np.abs(light[:, 2:])
    return np.where(cos > 0, f / np.where(cos > 0, cos, 1), 0)


def density(light, viewer):
    return columns(bsdf.pdf(context, interaction(viewer), vectors(light)), len(light))


def sample(viewer, u):
    place = mi.Point2f(np.ascontiguousarray(u[:, :2].T))
    s, weight = bsdf.sample(context, interaction(viewer), mi.Float(np.ascontiguousarray(u[:, 2])), place)
    n = len(viewer)
    delta = columns(mi.has_flag(s.sampled_type, mi.BSDFFlags.Delta), n)
    return np.column_stack([columns(s.wo, n), columns(weight, n), columns(s.pdf, n), delta])


def relative_ior():
    """Index of refraction below the surface over the one above; None if nothing passes through."""
    if not mi.has_flag(bsdf.flags(), mi.BSDFFlags.Transmission):
        return None
    if arguments.plugin == "thindielectric":
        return 1.0
    # Light straight through a smooth body of the same parameters tells it.
    eta = mi.traverse(bsdf)["eta"]
    return float(np.asarray(eta).ravel()[0])


asked, answers = sys.stdin.buffer, sys.stdout.buffer
asked.readline()
hello = {
    "id": 0,
    "name": f"mitsuba {arguments.plugin}",
    "offers": ["eval", "pdf", "sample"],
    "batches": "float32" if single else "float64",
    "parameters": {**{k: v["value"] if isinstance(v, dict) else v for k, v in parameters.items()}, "variant": arguments.variant},
    **{name: False for name in arguments.declare_not},
}
if (n := relative_ior()) is not None:
    hello["relative_ior"] = n
answers.write(json.dumps(hello).encode() + b"\n")
answers.flush()

functions = {b"eval": evaluate, b"pdf ": density, b"samp": sample}
size = 4 if single else 8
while header := asked.read(12):
    count = int.from_bytes(header[4:8], "little")
    a, b = np.frombuffer(asked.read(6 * size * count), number).reshape(2, count, 3)
    answer = functions[header[:4]](a, b)
    answers.write(header + np.ascontiguousarray(answer, number).tobytes())
    answers.flush()
