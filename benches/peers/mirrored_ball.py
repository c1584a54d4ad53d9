"""A mirrored ball photographed by Mitsuba 3, captured by Gonio, compared with the panorama that lit it.

    python benches/peers/mirrored_ball.py PANORAMA.hdr GONIO_COMMAND [FOLDER]

Two viewpoints, a quarter turn apart, 12 radii away, a smooth conductor of chromium; three exposures of each through the sRGB
curve in 8 bits. Prints the rotation that was found, the error of directions, and the errors of radiance and irradiance.
"""

import math
import os
import re
import subprocess
import sys
import tempfile

import drjit as dr
import mitsuba as mi

mi.set_variant("scalar_rgb" if "--scalar" in sys.argv else "llvm_ad_rgb")
import numpy as np

SIZE, DISTANCE, FOV, YAW = (960, 720), 12.0, 15.0, 80.0
STOPS = (1.0, 1 / 8, 1 / 64)


def photograph(panorama, yaw_deg):
    """What the camera sees that looks from `yaw_deg` about +y, counter-clockwise from above; 0 looks along −z."""
    a = math.radians(yaw_deg)
    eye = [DISTANCE * math.sin(a), 0, DISTANCE * math.cos(a)]
    scene = mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 3},
        "sensor": {
            "type": "perspective", "fov": FOV, "fov_axis": "x",
            "to_world": mi.ScalarTransform4f().look_at(eye, [0, 0, 0], [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": SIZE[0], "height": SIZE[1], "rfilter": {"type": "box"}},
            "sampler": {"type": "independent", "sample_count": 32},
        },
        "light": {"type": "envmap", "filename": panorama},
        "ball": {"type": "sphere", "bsdf": {"type": "conductor", "material": "Cr"}},
    })
    return np.array(mi.render(scene))


def latlong(picture, d):
    """Bilinear look-up, by the convention of Gonio: the middle column is −z, u grows towards +x."""
    h, w = picture.shape[:2]
    u = 0.5 + np.arctan2(d[..., 0], -d[..., 2]) / (2 * np.pi)
    v = np.arccos(np.clip(d[..., 1], -1, 1)) / np.pi
    x, y = u * w - 0.5, np.clip(v * h - 0.5, 0, h - 1)
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    s, t = (x - i)[..., None], (y - j)[..., None]
    at = lambda i, j: picture[np.minimum(j, h - 1), i % w]
    return (at(i, j) * (1 - s) + at(i + 1, j) * s) * (1 - t) + (at(i, j + 1) * (1 - s) + at(i + 1, j + 1) * s) * t


def directions(h):
    theta = (np.arange(h) + 0.5) / h * np.pi
    phi = ((np.arange(2 * h) + 0.5) / (2 * h) - 0.5) * 2 * np.pi
    t, p = np.meshgrid(theta, phi, indexing="ij")
    return np.stack([np.sin(t) * np.sin(p), np.cos(t), -np.sin(t) * np.cos(p)], -1), np.sin(t) * (np.pi / h) ** 2


def irradiance(picture, d, omega, n):
    return (picture * (omega * np.maximum(d @ n, 0))[..., None]).sum((0, 1))


def main():
    panorama, gonio = sys.argv[1], sys.argv[2]
    folder = sys.argv[3] if len(sys.argv) > 3 else tempfile.mkdtemp()
    os.makedirs(folder, exist_ok=True)
    names = []
    for view, yaw in enumerate((0.0, YAW)):
        seen = photograph(panorama, yaw)
        for k, stop in enumerate(STOPS):
            x = np.clip(seen * stop, 0, 1)
            code = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
            name = f"{folder}/view{view}-{k}.png"
            mi.Bitmap((255 * code + 0.5).astype(np.uint8)).write(name)
            names.append(name)
    out = f"{folder}/probe.exr"
    said = subprocess.run(
        [gonio, "env", "capture", *names, "-o", out, "--views", "2", "--fov", str(FOV), "--fill",
         "--exposures", ",".join(map(str, STOPS)), "--size", "256", "--explain", f"{folder}/steps"],
        check=True, capture_output=True, text=True,
    ).stdout
    print(said)
    turned = re.search(r"yaw ([-0-9.]+)°, pitch ([-0-9.]+)°, roll ([-0-9.]+)°", said)
    yaw, pitch, roll = map(float, turned.groups())
    print(f"rotation: off by {math.hypot(yaw - YAW, math.hypot(pitch, roll)):.3f}°")
    radius = float(re.search(r"radius ([0-9.]+) px", said)[1])
    focal = 0.5 * SIZE[0] / math.tan(math.radians(FOV / 2))
    print(f"ball: radius {radius:.2f} px, true {focal / math.sqrt(DISTANCE ** 2 - 1):.2f} px")

    layers = dict(mi.Bitmap(out).split())
    found = np.array(layers["<root>"].convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))
    sure = np.array(layers["confidence"])[..., 0] > 0.5
    # Mitsuba's panorama has its middle column at −z of its own frame, with u growing to the right seen from inside, as Gonio's.
    truth_file = np.array(mi.Bitmap(panorama).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))
    d, omega = directions(256)
    best = None
    # The panorama's own orientation in Mitsuba: one of four quarter turns, found as the best.
    for quarter in range(4):
        truth = latlong(np.roll(truth_file, quarter * truth_file.shape[1] // 4, 1), d)
        ratio = found[sure].sum(-1) / np.maximum(truth[sure].sum(-1), 1e-9)
        gain = np.median(ratio)
        error = np.abs(ratio / gain - 1)
        if best is None or np.median(error) < best[0]:
            normals = [np.array(n, float) / math.sqrt(sum(c * c for c in n)) for n in
                       [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)] if any(n)]
            worst = max(abs(irradiance(found, d, omega, n)[1] / gain / irradiance(truth, d, omega, n)[1] - 1) for n in normals)
            best = (np.median(error), np.quantile(error, 0.95), worst, quarter)
    print(f"radiance: median {100 * best[0]:.2f} %, 95 % {100 * best[1]:.1f} %; irradiance: worst of 26 normals {100 * best[2]:.2f} % "
          f"(panorama rolled by {90 * best[3]}°)")


main()
