"""Gonio's sky against Mitsuba's `sunsky`, whose tables are the same.

    python compare_sky.py target/release/gonio

Radiance of the sky at each texel above the horizon of a panorama, the sun left out, within 1e-3; then the sun's irradiance. Mitsuba
divides its RGB by the integral of the CIE curve y, 106.75 nm, and cuts off nothing: where a channel is negative it is 0 in Gonio.

Known differences: Mitsuba 3.9.1's RGB sun is of even radiance over the disc, of an irradiance tabulated every 3° and constant below 2°; Gonio's has
limb darkening, and the model's polynomials in elevation.
"""
import subprocess
import sys
import tempfile

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
Y = 106.7502593994140625
ROWS = 64


def gonio(command, words):
    with tempfile.TemporaryDirectory() as folder:
        path = f"{folder}/sky.exr"
        subprocess.run([command, "env", "sky", words, "-o", path, "--height", str(ROWS)], check=True, capture_output=True)
        return np.array(mi.Bitmap(path).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))


def direction(x, y):
    phi, theta = 2 * np.pi * ((x + 0.5) / (2 * ROWS) - 0.5), np.pi * (y + 0.5) / ROWS
    return np.array([np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)])


def emitter(towards, turbidity, albedo, sun, sky):
    # Mitsuba's up is +z: (x, y, z) here is (x, -z, y) there.
    x, y, z = towards
    return mi.load_dict({
        "type": "sunsky", "turbidity": turbidity, "albedo": {"type": "rgb", "value": albedo},
        "sun_direction": [x, -z, y], "sun_scale": float(sun), "sky_scale": float(sky),
    })


def look(light, d):
    si = mi.SurfaceInteraction3f()
    si.wi = -mi.Vector3f(d[0], -d[2], d[1])
    return np.array(light.eval(si)) * Y


def main():
    command = sys.argv[1]
    worst, count = 0.0, 0
    for elevation, azimuth, turbidity, albedo in [
        (60, 180, 3, [0.3, 0.3, 0.3]), (5, 90, 2, [0.0, 0.0, 0.0]), (33.3, 250, 6.4, [0.1, 0.4, 0.9]), (89, 10, 9.5, [1, 1, 1]),
        (0.5, 300, 4, [0.2, 0.2, 0.2]),
    ]:
        words = f"azimuth={azimuth},elevation={elevation},turbidity={turbidity},albedo={'/'.join(map(str, albedo))},ground=off"
        e, a = np.radians(elevation), np.radians(azimuth)
        towards = [np.cos(e) * np.sin(a), np.sin(e), -np.cos(e) * np.cos(a)]
        picture = gonio(command, words + ",sun=off")
        light = emitter(towards, turbidity, albedo, 0, 1)
        for y in range(ROWS // 2):
            for x in range(2 * ROWS):
                expected = np.maximum(look(light, direction(x, y)), 0)
                error = np.abs(picture[y, x] - expected) / max(expected.max(), 1e-9)
                worst, count = max(worst, error.max()), count + 1
        # The sun's power: the disc by 64 × 64 points, and the panorama's texels by their solid angles.
        picture = gonio(command, words + ",sky=off").astype(float)
        rows = np.arange(ROWS)
        solid = (np.cos(np.pi * rows / ROWS) - np.cos(np.pi * (rows + 1) / ROWS)) * np.pi / ROWS
        ours = (picture * solid[:, None, None]).sum((0, 1))
        light, radius, n = emitter(towards, turbidity, albedo, 1, 0), np.radians(0.5358 / 2), 64
        frame = mi.Frame3f(mi.Vector3f(*towards))
        theirs = np.zeros(3)
        for k in range(n * n):
            u = mi.Point2f((k % n + 0.5) / n, (k // n + 0.5) / n)
            theirs += np.maximum(look(light, np.array(frame.to_world(mi.warp.square_to_uniform_cone(u, np.cos(radius))))), 0)
        theirs *= 2 * np.pi * (1 - np.cos(radius)) / (n * n)
        print(f"{words}: sun, Gonio / Mitsuba: {np.round(ours / np.maximum(theirs, 1e-9), 4)}")
    print(f"sky: {count} directions, largest difference {worst:.1e} of the brightest channel")
    sys.exit(worst > 1e-3)


main()
