#!/usr/bin/env python3
"""Prefilters one panorama with Filament's cmgen and with Gonio, and compares both with brute force.

    cargo build --release -p gonio-ibl --example prefilter
    python benches/peers/prefilter.py --gonio target/release/examples/prefilter --work /tmp/prefilter

cmgen is in Debian's libfilament-tools. The panorama is 2048 x 1024, a sky with a sun of 1 degree and radiance 6000 over a chequered floor.
Brute force sums D(h) n.l over every texel (each in 2 x 2 parts, bilinear) in double precision, with N = V = R, for some texels of each
level. Both are given the same roughness (Filament's), and times are wall seconds of the whole process, the best of three, in turn.

The harmonics' reference is the sum of the basis over the same points; the table's a product rule in double precision over half vectors,
where the shader looks a texel up: (n.v, roughness) at its middle. `--only-small` compares harmonics and table alone.
"""

import argparse, json, os, struct, subprocess, time
import numpy as np


def panorama(width=2048, height=1024):
    u = (np.arange(width) + 0.5) / width
    v = (np.arange(height) + 0.5) / height
    phi, theta = np.meshgrid(2 * np.pi * (u - 0.5), np.pi * v)
    x, y, z = np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)
    sky = np.stack([0.3 + 0.4 * (1 - y), 0.5 + 0.3 * (1 - y), np.ones_like(y)], -1)
    safe = np.where(np.abs(y) < 1e-3, 1e-3, y)
    check = (np.floor(3 * x / safe) + np.floor(3 * z / safe)) % 2
    floor = (0.1 + 0.2 * check)[..., None] * np.array([1.0, 0.9, 0.7])
    image = np.where((y > 0)[..., None], sky, floor)
    sun = np.array([0.5, 0.6, -0.3]) / np.linalg.norm([0.5, 0.6, -0.3])
    inside = x * sun[0] + y * sun[1] + z * sun[2] > np.cos(np.radians(0.5))
    image[inside] = [6000, 5700, 5000]
    return image.astype(np.float32)


def write_hdr(path, image):
    """Radiance HDR without run lengths; returns the values that the file holds."""
    largest = image.max(-1)
    _, exponent = np.frexp(largest)
    scale = np.ldexp(1.0, 8 - exponent)
    codes = np.floor(image * scale[..., None]).clip(0, 255).astype(np.uint8)
    rgbe = np.concatenate([codes, (exponent + 128).astype(np.uint8)[..., None]], -1)
    with open(path, "wb") as f:
        f.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % image.shape[:2])
        f.write(rgbe.tobytes())
    return (codes / scale[..., None]).astype(np.float64)


def ktx2(path):
    data = open(path, "rb").read()
    fmt, _, width = struct.unpack_from("<III", data, 12)
    levels = struct.unpack_from("<I", data, 40)[0]
    assert fmt == 109, "expected four floats a texel"
    out = []
    for k in range(levels):
        offset, length = struct.unpack_from("<QQ", data, 80 + 24 * k)
        n = max(width >> k, 1)
        out.append(np.frombuffer(data, "<f4", length // 4, offset).reshape(6, n, n, 4)[..., :3])
    return out


def cmgen_levels(folder, name, count):
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    faces = ["px", "nx", "py", "ny", "pz", "nz"]
    out = []
    for k in range(count):
        level = []
        for face in faces:
            bitmap = mi.Bitmap(os.path.join(folder, name, f"m{k}_{face}.exr"))
            level.append(np.array(bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)))
        out.append(np.stack(level))
    return out


def directions(n):
    at = (2 * np.arange(n) + 1) / n - 1
    b, a = np.meshgrid(at, at, indexing="ij")
    o = np.ones_like(a)
    faces = [(o, -b, -a), (-o, -b, a), (a, o, b), (a, -o, -b), (a, -b, o), (-a, -b, -o)]
    d = np.stack([np.stack(f, -1) for f in faces])
    return d / np.linalg.norm(d, axis=-1, keepdims=True)


def look_up(image, d):
    h, w = image.shape[:2]
    u = 0.5 + np.arctan2(d[..., 0], -d[..., 2]) / (2 * np.pi)
    v = np.arccos(np.clip(d[..., 1], -1, 1)) / np.pi
    return image[np.minimum((v * h).astype(int), h - 1), np.minimum((u * w).astype(int), w - 1)]


def points(image, split=2):
    """Parts of texels: directions, solid angles, interpolated radiance."""
    h, w = image.shape[:2]
    y = np.clip((np.arange(h * split) + 0.5) / split - 0.5, 0, h - 1)
    x = (np.arange(w * split) + 0.5) / split - 0.5
    y0 = np.minimum(y.astype(int), h - 1)
    y1, ty = np.minimum(y0 + 1, h - 1), (y - y0)[:, None, None]
    x0 = np.floor(x).astype(int)
    tx = (x - x0)[None, :, None]
    rows = image[y0] * (1 - ty) + image[y1] * ty
    rgb = rows[:, x0 % w] * (1 - tx) + rows[:, (x0 + 1) % w] * tx
    theta = np.pi * (np.arange(h * split) + 0.5) / (h * split)
    phi = 2 * np.pi * ((np.arange(w * split) + 0.5) / (w * split) - 0.5)
    s, c = np.sin(theta)[:, None], np.cos(theta)[:, None]
    d = np.stack([s * np.sin(phi), np.broadcast_to(c, (h * split, w * split)), -s * np.cos(phi)], -1)
    omega = np.broadcast_to(s, (h * split, w * split))
    return d.reshape(-1, 3), omega.reshape(-1), rgb.reshape(-1, 3)


def brute(lights, axis, alpha):
    d, omega, rgb = lights
    q = ((d - axis) ** 2).sum(-1)
    k = np.maximum(1 - q / 2, 0) / (alpha**2 + (1 - alpha**2) * q / 4) ** 2 * omega
    return k @ rgb / k.sum()


def harmonics(lights):
    """Irradiance / pi in three bands, times the constants of 1, y, z, x, xy, yz, 3z^2 - 1, zx, x^2 - y^2: Filament's form."""
    d, omega, rgb = lights
    x, y, z = d.T
    one = np.ones_like(x)
    poly = np.stack([one, y, z, x, x * y, y * z, 3 * z * z - 1, z * x, x * x - y * y])
    c1, c2, c20 = 3 / (4 * np.pi), 15 / (4 * np.pi), 5 / (16 * np.pi)
    squared = np.array([1 / (4 * np.pi), c1, c1, c1, c2, c2, c20, c2, c2 / 4])
    band = np.array([1] + [2 / 3] * 3 + [1 / 4] * 5)
    weights = omega * (4 * np.pi / omega.sum())
    return (squared * band)[:, None] * ((poly * weights) @ rgb)


def cmgen_harmonics(path):
    rows = []
    for line in open(path):
        inside = line[line.find("(") + 1 : line.find(")")] if "(" in line else ""
        parts = inside.split(",")
        if len(parts) == 3:
            rows.append([float(p) for p in parts])
    return np.array(rows)


def table(mu, roughness, nodes=1024):
    """(bias, whole) of GGX with the correlated Smith masking: the integral over half vectors drawn by D(h) n.h, midpoints in u and the azimuth."""
    a2 = roughness**4
    # Crowded at both ends: s^2 (3 - 2 s).
    s = (np.arange(nodes) + 0.5) / nodes
    u, w = s * s * (3 - 2 * s), 6 * s * (1 - s) / nodes
    cos_h = np.sqrt((1 - u) / (1 + (a2 - 1) * u))
    sin_h = np.sqrt(np.maximum(1 - cos_h**2, 0))
    phi = np.pi * (np.arange(nodes) + 0.5) / nodes
    v = np.array([np.sqrt(1 - mu * mu), 0, mu])
    vh = v[0] * sin_h[:, None] * np.cos(phi) + v[2] * cos_h[:, None]
    nl = 2 * vh * cos_h[:, None] - mu
    ok = (nl > 0) & (vh > 0)
    nl, vh = np.where(ok, nl, 1), np.where(ok, vh, 1)
    smith = 0.5 / (nl * np.sqrt(mu * mu * (1 - a2) + a2) + mu * np.sqrt(nl * nl * (1 - a2) + a2))
    f = np.where(ok, 4 * smith * nl * vh / cos_h[:, None], 0) * w[:, None] / nodes
    return (f * (1 - vh) ** 5).sum(), f.sum()


def exr(path):
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    return np.array(mi.Bitmap(path).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))


def small(ours, work, hdr, image):
    """Errors of harmonics and table."""
    truth = harmonics(points(image))
    found = np.array(json.load(open(os.path.join(ours, "harmonics.json")))["coefficients"])
    print("harmonics, three bands: largest difference by band, relative to the first coefficient")
    files = {"cmgen": "no", "cmgen, as it is by default": "auto"}
    other = {"Gonio": found}
    for name, window in files.items():
        path = os.path.join(work, f"sh-{window}.txt")
        subprocess.run(["cmgen", "-q", "--sh=3", "--sh-irradiance", "--sh-shader", f"--sh-window={window}", f"--sh-output={path}", hdr], check=True)
        other[name] = cmgen_harmonics(path)
    for name, c in other.items():
        # cmgen mirrors its axes: the signs that fit are its convention.
        if name != "Gonio":
            best = None
            for flip in [(1, 1), (1, -1), (-1, 1), (-1, -1)]:
                sx, sz = flip
                sign = np.array([1, 1, sz, sx, sx, sz, 1, sx * sz, 1])
                e = np.abs(c * sign[:, None] - truth).max()
                if best is None or e < best[0]:
                    best = (e, sign)
            c = c * best[1][:, None]
        e = np.abs(c - truth) / truth[0]
        print(f"  {name:28} L0 {e[0].max():.1e}  L1 {e[1:4].max():.1e}  L2 {e[4:].max():.1e}")
    a, b = exr(os.path.join(ours, "dfg.exr")), exr(os.path.join(work, "dfg.exr"))
    n = a.shape[0]
    rng = np.random.default_rng(3)
    rows = {"cmgen": [], "cmgen, its rows where it means them": [], "Gonio": []}
    for x, y in rng.integers(0, n, (200, 2)):
        mu, low = (x + 0.5) / n, (n - y - 0.5) / n
        exact = np.array(table(mu, low))
        rows["Gonio"].append(a[y, x, :2] - exact)
        rows["cmgen"].append(b[y, x, :2] - exact)
        rows["cmgen, its rows where it means them"].append(b[y, x, :2] - np.array(table(mu, min((n - y + 0.5) / n, 1))))
    print("table, bias and whole, over 200 texels: mean and largest absolute difference")
    for name, e in rows.items():
        e = np.abs(np.array(e))
        print(f"  {name:36} mean {e.mean():.2e}  largest {e.max():.2e}")
    converged = max(abs(np.array(table(m, r)) - np.array(table(m, r, 2048))).max() for m in (0.02, 0.3, 0.9) for r in (0.05, 0.4, 1))
    print(f"  the reference itself: twice as many nodes change it by {converged:.1e} at most")


def timed(command, runs=3):
    best = 1e9
    for _ in range(runs):
        start = time.time()
        text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        best = min(best, time.time() - start)
    return best, text


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--gonio", default="target/release/examples/prefilter")
    parser.add_argument("--work", default="/tmp/prefilter")
    parser.add_argument("--texels", type=int, default=24)
    parser.add_argument("--only-small", action="store_true")
    a = parser.parse_args()
    os.makedirs(a.work, exist_ok=True)
    hdr = os.path.join(a.work, "sky.hdr")
    image = write_hdr(hdr, panorama())
    ours, theirs = os.path.join(a.work, "gonio"), os.path.join(a.work, "cmgen")
    os.makedirs(ours, exist_ok=True)
    if a.only_small:
        subprocess.run([a.gonio, hdr, ours], check=True, capture_output=True)
        subprocess.run(["cmgen", "-q", "--size=128", f"--ibl-dfg={a.work}/dfg.exr", "--ibl-dfg-multiscatter"], check=True)
        return small(ours, a.work, hdr, image)
    t = {}
    best = {"cmgen": 1e9, "gonio": 1e9}
    for _ in range(3):
        seconds, _ = timed(["cmgen", "-q", "--size=256", "-f", "exr", "--ibl-samples=1024", "--ibl-min-lod-size=1",
                            f"--ibl-ld={theirs}", hdr], 1)
        best["cmgen"] = min(best["cmgen"], seconds)
        seconds, text = timed([a.gonio, hdr, ours], 1)
        best["gonio"] = min(best["gonio"], seconds)
    t["sh"], _ = timed(["cmgen", "-q", "--sh=3", "--sh-irradiance", f"--sh-output={a.work}/sh.txt", hdr])
    t["dfg"], _ = timed(["cmgen", "-q", "--size=128", "--ibl-samples=1024", f"--ibl-dfg={a.work}/dfg.exr", "--ibl-dfg-multiscatter"])
    print(text)
    own = {line.split()[0]: line.split()[1] for line in text.splitlines() if line.count(" ") == 1}
    print(f"chain, harmonics, table, all files: cmgen (chain alone) {best['cmgen']:.2f} s, Gonio {best['gonio']:.2f} s: "
          f"{best['cmgen'] / best['gonio']:.1f} times as fast")
    print(f"harmonics: cmgen {t['sh']:.2f} s, Gonio {own['load']} s to load + {own['harmonics']} s")
    print(f"table: cmgen {t['dfg']:.2f} s, Gonio {own['table']} s")
    small(ours, a.work, hdr, image)
    mine = ktx2(os.path.join(ours, "specular.ktx2"))
    other = cmgen_levels(theirs, "sky", len(mine))
    # cmgen mirrors its cubes and turns its panoramas by its own rule: the reflection that fits level 0 best is its convention.
    d = directions(other[0].shape[1])
    flips = [np.diag([sx, 1, sz]) for sx in (1, -1) for sz in (1, -1)]
    flips += [np.array([[0, 0, sx], [0, 1, 0], [sz, 0, 0]]) for sx in (1, -1) for sz in (1, -1)]
    fit = [np.abs(np.log(look_up(image, d @ f.T) + 1e-3) - np.log(other[0] + 1e-3)).mean() for f in flips]
    flip = flips[int(np.argmin(fit))]
    print(f"cmgen's axes: {flip.tolist()}, mean log difference of level 0: {min(fit):.4f}, next {sorted(fit)[1]:.4f}")
    lights = points(image)
    rng = np.random.default_rng(7)
    print("level  size  alpha    cmgen mean  largest     Gonio mean  largest   ratio of means")
    for k in range(1, len(mine)):
        n = mine[k].shape[1]
        p = 1 - np.sqrt(1 - k / (len(mine) - 1))
        d = directions(n).reshape(-1, 3)
        chosen = rng.choice(len(d), min(a.texels, len(d)), replace=False)
        errors = {"cmgen": [], "gonio": []}
        for i in chosen:
            for name, level, axis in [("gonio", mine[k], d[i]), ("cmgen", other[k], flip @ d[i])]:
                truth = brute(lights, axis, p * p)
                errors[name].append(np.abs(level.reshape(-1, 3)[i] / truth - 1))
        c, g = np.array(errors["cmgen"]), np.array(errors["gonio"])
        print(f"{k:5} {n:5} {p * p:6.4f}  {100 * c.mean():9.3f} % {100 * c.max():7.2f} %  {100 * g.mean():9.4f} % {100 * g.max():7.3f} %"
              f"   {c.mean() / g.mean():6.1f}")


if __name__ == "__main__":
    main()
