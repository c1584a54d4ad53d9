#!/usr/bin/env python3
"""The metal of ggx.py with numpy and batches of numbers instead of text:

    gonio brdf check --exec 'python3 ggx_numpy.py 0.5'
"""

import json
import sys

import numpy as np

ROUGHNESS = float(sys.argv[1]) if len(sys.argv) > 1 else 0.5
A2 = ROUGHNESS**4
F0 = np.array([1.0, 0.78, 0.34])


def half(wi, wo):
    h = wi + wo
    length = np.linalg.norm(h, axis=-1)
    return h / length[:, None], length / 2


def distribution(h):
    return A2 / (np.pi * (h[:, 2] ** 2 * (A2 - 1) + 1) ** 2)


def above(wi, wo):
    return (wi[:, 2] > 0) & (wo[:, 2] > 0)


def evaluate(wi, wo):
    (h, cos), zi, zo = half(wi, wo), wi[:, 2], wo[:, 2]
    schlick = (1 - cos) ** 5
    a = zo * np.sqrt(A2 + (1 - A2) * zi**2)
    b = zi * np.sqrt(A2 + (1 - A2) * zo**2)
    common = distribution(h) / (2 * (a + b))
    f = common[:, None] * (F0 + (1 - F0) * schlick[:, None])
    return np.where(above(wi, wo)[:, None], f, 0)


def density(wi, wo):
    h, cos = half(wi, wo)
    return np.where(above(wi, wo), distribution(h) * h[:, 2] / (4 * cos), 0)


def sample(wo, u):
    z = np.sqrt((1 - u[:, 0]) / (1 + (A2 - 1) * u[:, 0]))
    r, phi = np.sqrt(np.maximum(0, 1 - z * z)), 2 * np.pi * u[:, 1]
    h = np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)
    wi = 2 * np.sum(wo * h, axis=-1, keepdims=True) * h - wo
    pdf = density(wi, wo)
    drawn = pdf > 0
    weight = evaluate(wi, wo) * wi[:, 2:] / np.where(drawn, pdf, 1)[:, None]
    # Eight columns: wi, weight, pdf, and whether the direction is a Dirac delta's. A pdf of 0 says that nothing was drawn.
    return np.column_stack([wi, np.where(drawn[:, None], weight, 0), pdf, np.zeros(len(wo))])


# The hello is a line of JSON. It asks for batches of numbers.
asked, answers = sys.stdin.buffer, sys.stdout.buffer
asked.readline()
hello = {
    "id": 0,
    "name": "ggx_numpy.py",
    "offers": ["eval", "pdf", "sample"],
    "batches": "float64",
    "parameters": {"roughness": ROUGHNESS},
}
answers.write(json.dumps(hello).encode() + b"\n")
answers.flush()

# Where nothing is reflected, the formulas may divide by 0 before their result is replaced.
np.seterr(all="ignore")
functions = {b"eval": evaluate, b"pdf ": density, b"samp": sample}
while header := asked.read(12):
    count = int.from_bytes(header[4:8], "little")
    a, b = np.frombuffer(asked.read(48 * count), "<f8").reshape(2, count, 3)
    answer = functions[header[:4]](a, b)
    answers.write(header + answer.astype("<f8").tobytes())
    answers.flush()
