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

Then each file is written once more as a spectral one, its colours at 450, 550 and 650 nm, and once as a spectral, anisotropic one, with
nine azimuths of the viewer of which each is darker than the one before; f·cosθ of these is compared at the three wavelengths.
"""

import math
import pathlib
import struct
import subprocess
import sys
import tempfile

import mitsuba as mi
import numpy as np

COUNT = 10_000
BOUND = 1e-4
FLOOR = 0.1
NM = [450.0, 550.0, 650.0]
TYPES = {1: "u1", 5: "<u2", 10: "<f4"}
NEAR_NORMAL = np.cos(np.radians(1.5))


def gonio(example, of, skip=0):
    command = ["cargo", "run", "--release", "-q", "-p", "gonio-brdf", "--example", example, "--"]
    out = subprocess.run(command + [of, str(COUNT)], check=True, capture_output=True)
    return np.loadtxt(out.stdout.decode().splitlines(), delimiter=",", skiprows=skip)


def read(path):
    data = pathlib.Path(path).read_bytes()
    count, at, fields = struct.unpack_from("<I", data, 14)[0], 18, {}
    for _ in range(count):
        length = struct.unpack_from("<H", data, at)[0]
        name = data[at + 2 : at + 2 + length].decode()
        rank, kind, offset = struct.unpack_from("<HBQ", data, at + 2 + length)
        shape = struct.unpack_from(f"<{rank}Q", data, at + 13 + length)
        at += 13 + length + 8 * rank
        if kind in TYPES:
            array = np.frombuffer(data, TYPES[kind], math.prod(shape), offset)
            fields[name] = (kind, array.reshape(shape))
    return fields


def write(path, fields):
    header = b"tensor_file\0" + struct.pack("<2BI", 1, 0, len(fields))
    offset = len(header) + sum(13 + len(n.encode()) + 8 * a.ndim for n, (_, a) in fields.items())
    body = b""
    for name, (kind, array) in fields.items():
        body += b"\0" * (-(offset + len(body)) % 8)
        header += struct.pack("<H", len(name.encode())) + name.encode()
        header += struct.pack("<HBQ", array.ndim, kind, offset + len(body))
        header += struct.pack(f"<{array.ndim}Q", *array.shape)
        body += np.ascontiguousarray(array, TYPES[kind]).tobytes()
    pathlib.Path(path).write_bytes(header + body)


def spectral(fields, anisotropic):
    """The file with its colours as spectra; one azimuth, or nine."""
    out = {n: f for n, f in fields.items() if n not in ("rgb", "valid")}
    spectra = fields["rgb"][1][:, :, ::-1]
    if anisotropic:
        darker = np.linspace(1, 0.2, 9)
        out["phi_i"] = (10, np.linspace(-np.pi, np.pi, 9))
        for name in ("vndf", "luminance"):
            out[name] = (10, np.repeat(fields[name][1], 9, axis=0))
        spectra = spectra * darker[:, None, None, None, None]
    out["wavelengths"], out["spectra"] = (10, np.array(NM)), (10, spectra)
    return out


def compare_spectra(path, rows):
    bsdf = mi.load_dict({"type": "measured", "filename": path})
    context = mi.BSDFContext()
    theirs = np.zeros((len(rows), 3))
    for k, row in enumerate(rows):
        si = mi.SurfaceInteraction3f()
        si.wi = mi.Vector3f(row[3:6])
        si.wavelengths = [*NM, NM[0]]
        theirs[k] = list(bsdf.eval(context, si, mi.Vector3f(row[0:3])))[:3]
    return difference(rows[:, 6:9], theirs)


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
        mi.set_variant("scalar_rgb")
        rows = gonio("dump_values", f"table:{path}")
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
        mi.set_variant("scalar_spectral")
        with tempfile.TemporaryDirectory() as folder:
            for kind in ("spectral", "anisotropic"):
                made = f"{folder}/{kind}.bsdf"
                write(made, spectral(read(path), kind == "anisotropic"))
                apart = compare_spectra(made, gonio("dump_spectrum", made, skip=1))
                worst = max(worst, apart)
                print(f"{'  as ' + kind:<32}{apart:9.1e}")
    print(f"largest: {worst:.1e} (bound {BOUND:.0e})")
    return 0 if 0 < worst <= BOUND else 1


if __name__ == "__main__":
    sys.exit(main())
