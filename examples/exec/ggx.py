#!/usr/bin/env python3
"""A rough gold-like metal for Gonio to check, in plain Python:

    gonio brdf check --exec 'python3 ggx.py 0.5'

Directions leave the surface: wi to the light, wo to the viewer; the normal is +z.
"""

import json
import math
import sys

ROUGHNESS = float(sys.argv[1]) if len(sys.argv) > 1 else 0.5
A2 = ROUGHNESS**4  # alpha = roughness², and here its square
F0 = (1.0, 0.78, 0.34)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def half(wi, wo):
    """The half vector, and the cosine between it and either direction: |wi + wo| / 2, which can't be negative."""
    h = [a + b for a, b in zip(wi, wo)]
    length = math.sqrt(dot(h, h))
    return [x / length for x in h], length / 2


def distribution(h):
    """D of GGX (Walter et al. 2007, eq. 33)."""
    return A2 / (math.pi * (h[2] * h[2] * (A2 - 1) + 1) ** 2)


def evaluate(wi, wo):
    """f in sr⁻¹, without the cosine."""
    if wi[2] <= 0 or wo[2] <= 0:
        return [0, 0, 0]
    h, cos = half(wi, wo)
    schlick = (1 - cos) ** 5
    # Smith's masking of both directions over 4 cosθi cosθo (Heitz 2014, eq. 99).
    a = wo[2] * math.sqrt(A2 + (1 - A2) * wi[2] ** 2)
    b = wi[2] * math.sqrt(A2 + (1 - A2) * wo[2] ** 2)
    common = distribution(h) / (2 * (a + b))
    return [common * (f0 + (1 - f0) * schlick) for f0 in F0]


def density(wi, wo):
    """Density per solid angle with which `sample` draws wi."""
    if wi[2] <= 0 or wo[2] <= 0:
        return 0
    h, cos = half(wi, wo)
    return distribution(h) * h[2] / (4 * cos)


def sample(wo, u):
    """A direction, its weight f cosθi / pdf, and its density; None if nothing is drawn."""
    if wo[2] <= 0:
        return None, 0, 0
    z = math.sqrt((1 - u[0]) / (1 + (A2 - 1) * u[0]))
    r, phi = math.sqrt(max(0, 1 - z * z)), 2 * math.pi * u[1]
    h = (r * math.cos(phi), r * math.sin(phi), z)
    d = 2 * dot(wo, h)
    wi = [d * b - a for a, b in zip(wo, h)]
    pdf = density(wi, wo)
    if pdf <= 0:
        return None, 0, 0
    return wi, [f * wi[2] / pdf for f in evaluate(wi, wo)], pdf


for line in sys.stdin:
    question = json.loads(line)
    answer = {"id": question["id"]}
    match question["ask"]:
        case "hello":
            answer |= {
                "name": "ggx.py",
                "offers": ["eval", "pdf", "sample"],
                "parameters": {"roughness": ROUGHNESS},
            }
        case "eval":
            answer["f"] = [evaluate(*pair) for pair in zip(question["wi"], question["wo"])]
        case "pdf":
            answer["pdf"] = [density(*pair) for pair in zip(question["wi"], question["wo"])]
        case "sample":
            drawn = [sample(*pair) for pair in zip(question["wo"], question["u"])]
            answer["wi"], answer["weight"], answer["pdf"] = zip(*drawn)
    print(json.dumps(answer), flush=True)
