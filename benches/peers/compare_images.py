#!/usr/bin/env python3
"""Compares images that Gonio renders with Mitsuba 3's, scene by scene.

Needs mitsuba 3.9 and numpy in the Python that runs it (and libLLVM for its variant llvm_ad_rgb), and a release build of Gonio:

    python benches/peers/compare_images.py --gonio target/release/gonio --work OUT [SCENE ...]

The scenes are those of `scenes.py` and `glass_scenes.py`, beside this file; `--peers` names another folder with a `scenes.py`.

Gonio makes `--seeds` independent images of `--spp` samples a pixel, Mitsuba 16, which are kept in OUT and used again.
`SCENE@N` renders Mitsuba's depth N instead of 8: N - 1 reflections; `SCENE@direct` compares Gonio's direct integrator with
Mitsuba's depth 2.

The columns of the table, for each scene and channel:

    gonio, mitsuba   mean of the image
    sigma            their difference in combined standard errors, from the scatter of the images' means; at most 3 passes
    pixels           share of pixels whose difference has a p value above 1 % (Welch's t; 99 % expected), in percent
    blocks           the same for means of 8 x 8 pixels, which show smaller errors
    rms              root of the mean t^2 of the blocks over what Student's distribution gives: 1 if there is no difference
    spp/s            samples of a pixel a second of user time, in thousands of pixels: both renderers, this machine

Exits 1 if a mean differs by more than 3 sigma, or the share of blocks is below 97 %.
"""

import argparse
import importlib.util
import math
import os
import pathlib
import resource
import subprocess
import sys

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

import glass_scenes
import mitsuba_to_gonio as convert

RESOLUTION = 256
BLOCK = 8
SEEDS_MITSUBA = 16
MAX_SIGMA = 3.0
MIN_BLOCKS = 0.97
# Pixels may differ by this share of their value besides their noise: the panorama's rows are resampled.
FLOOR = 3e-4

# Materials that stand for one that Gonio doesn't have, in both renderers.
DIFFUSE = {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.6, 0.25, 0.1]}}
GOLD = {"type": "roughconductor", "material": "Au", "distribution": "ggx", "alpha": 0.15}


def scenes_of(folder):
    """The module `scenes.py` of a folder."""
    spec = importlib.util.spec_from_file_location("peer_scenes", folder.resolve() / "scenes.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def scene_named(module, name):
    """The scene dictionary: `mesh-gold` is the scene `mesh` with gold for what is replaced."""
    base, _, depth = name.partition("@")
    if base in glass_scenes.NAMES:
        material, scene = "", dict(glass_scenes.get(base, RESOLUTION))
    else:
        base, _, material = base.partition("-")
        scene = dict(module.get(base, RESOLUTION))
    kind = scene["integrator"]["type"]
    scene["integrator"] = {"type": kind, "max_depth": 2 if depth == "direct" else int(depth or 8)}
    return convert.adapted(scene, GOLD if material == "gold" else DIFFUSE)


def user_seconds(who):
    return resource.getrusage(who).ru_utime


def mitsuba_images(scene, args, file):
    """Images [seed, y, x, channel] and the user seconds they took, without loading and compiling."""
    if file.exists():
        kept = np.load(file)
        if kept["images"].shape[0] >= SEEDS_MITSUBA and kept["spp"] == args.spp:
            return kept["images"], float(kept["seconds"])
    loaded = mi.load_dict(scene)
    np.array(mi.render(loaded, spp=args.spp, seed=99))
    images, start = [], user_seconds(resource.RUSAGE_SELF)
    for k in range(SEEDS_MITSUBA):
        images.append(np.array(mi.render(loaded, spp=args.spp, seed=100 + k)))
    seconds = (user_seconds(resource.RUSAGE_SELF) - start) / SEEDS_MITSUBA
    np.savez(file, images=np.array(images), spp=args.spp, seconds=seconds)
    return np.array(images), seconds


def gonio_images(toml, name, args):
    """Images and the user seconds of one, loading included."""
    depth = name.partition("@")[2]
    integrator = ["--integrator", "direct"] if depth == "direct" else ["--max-bounces", str(int(depth or 8) - 1)]
    images, start = [], user_seconds(resource.RUSAGE_CHILDREN)
    for k in range(args.seeds):
        out = args.work / f"{name}_{k}.exr"
        size = f"{RESOLUTION}x{RESOLUTION}"
        command = [args.gonio, "render", toml, "-o", out, "--size", size, "--filter", "box", "--sampler", args.sampler]
        command += ["--seed", 1000 + k, "--spp", args.spp, "--quiet"]
        subprocess.run([str(x) for x in command + integrator], check=True)
        layers = dict(mi.Bitmap(str(out)).split())
        layer = layers.get("<root>") or layers.get("root") or next(iter(layers.values()))
        images.append(np.array(layer.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)))
        out.unlink()
    return np.array(images), (user_seconds(resource.RUSAGE_CHILDREN) - start) / args.seeds


def normal_from_t(t, dof):
    """The normal deviate with the tail probability of Student's t (Wallace 1959, within 1 % of its value)."""
    return np.sign(t) * np.sqrt(dof * np.log1p(t * t / dof)) * (8 * dof + 1) / (8 * dof + 3)


def welch(a, b):
    """Difference over its standard error along axis 0, its degrees of freedom, and where both are without noise and
    agree (lights and panoramas seen directly)."""
    va, vb = a.var(0, ddof=1) / len(a), b.var(0, ddof=1) / len(b)
    ma, mb = a.mean(0), b.mean(0)
    same = np.abs(ma - mb) <= 3 * FLOOR * np.maximum(np.abs(ma), np.abs(mb)) + 1e-7
    total = va + vb + (FLOOR * mb) ** 2
    quiet = va + vb <= (1e-6 * np.maximum(np.abs(ma), 1e-6)) ** 2
    safe = np.where(quiet, 1.0, total)
    t = np.where(quiet, np.where(same, 0.0, 1e3), (ma - mb) / np.sqrt(safe))
    spread = va**2 / (len(a) - 1) + vb**2 / (len(b) - 1)
    dof = np.where(quiet, len(a) + len(b) - 2, safe**2 / np.where(spread > 0, spread, 1.0))
    return t, np.clip(dof, 1.0, 1e6), quiet & same


def blocks(images):
    n, h, w, c = images.shape
    return images.reshape(n, h // BLOCK, BLOCK, w // BLOCK, BLOCK, c).mean((2, 4))


def write_map(t, path):
    """Red where Gonio is brighter, blue where Mitsuba is; full at 5 standard errors."""
    x = np.clip(t.mean(-1) / 5, -1, 1)
    rgb = np.stack([1 - np.maximum(-x, 0), 1 - np.abs(x), 1 - np.maximum(x, 0)], -1)
    mi.Bitmap(rgb.astype(np.float32)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.UInt8, False).write(str(path))


def compare(name, ours, theirs, seconds, args):
    """Prints the rows of a scene; whether it passes."""
    ours, theirs = ours.astype(np.float64), theirs.astype(np.float64)
    t, dof, exact = welch(ours, theirs)
    tb, dofb, exactb = welch(blocks(ours), blocks(theirs))
    write_map(tb, args.work / f"{name}_t.png")
    np.savez(args.work / f"{name}_gonio.npz", images=ours.astype(np.float32))
    rates = [RESOLUTION**2 * args.spp / s / 1e3 for s in seconds]
    passed = True
    limit = 2.5758
    for c in range(3):
        ma, mb = ours[..., c].mean((1, 2)), theirs[..., c].mean((1, 2))
        error = math.sqrt(ma.var(ddof=1) / len(ma) + mb.var(ddof=1) / len(mb))
        sigma = (ma.mean() - mb.mean()) / error
        pixels = (np.abs(normal_from_t(t[..., c], dof[..., c])) <= limit).mean()
        z = normal_from_t(tb[..., c], dofb[..., c])
        share = (np.abs(z) <= limit).mean()
        noisy = ~exactb[..., c]
        rms = math.sqrt((z[noisy] ** 2).mean()) if noisy.any() else 0.0
        good = abs(sigma) <= MAX_SIGMA and share >= MIN_BLOCKS
        passed &= good
        print(
            f"{name:14s} {'RGB'[c]}  {ma.mean():.6f}  {mb.mean():.6f}  {sigma:+6.2f}  {100 * (ma.mean() / mb.mean() - 1):+8.4f} %"
            f"  {100 * pixels:6.2f}  {100 * share:6.2f}  {rms:5.2f}  {rates[0]:7.0f}  {rates[1]:7.0f}  {'ok' if good else 'DIFFERS'}",
            flush=True,
        )
    return passed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", default=["cornell", "cornell@direct", "ibl", "mesh", "mesh-gold", "lights", "veach"])
    parser.add_argument("--peers", type=pathlib.Path, default=pathlib.Path(__file__).parent, help="another folder with a scenes.py")
    parser.add_argument("--gonio", type=pathlib.Path, required=True, help="the release build of the command")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for scenes, images and maps")
    parser.add_argument("--seeds", type=int, default=16, help="images of Gonio, at least 2")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--sampler", default="independent")
    args = parser.parse_args()
    args.work.mkdir(parents=True, exist_ok=True)
    module = scenes_of(args.peers)
    print(f"{'scene':16s} {'gonio':>9s} {'mitsuba':>9s} {'sigma':>7s} {'difference':>11s} {'pixels':>8s} {'blocks':>7s} {'rms':>6s}   spp/s of gonio, mitsuba [thousands]")
    passed = True
    for name in args.scenes:
        scene = scene_named(module, name)
        toml = convert.write(name, scene, args.work.resolve())
        theirs, their_seconds = mitsuba_images(scene, args, args.work / f"{name}_mitsuba.npz")
        ours, our_seconds = gonio_images(toml, name, args)
        passed &= compare(name, ours, theirs, (our_seconds, their_seconds), args)
    sys.exit(0 if passed else 1)


if __name__ == "__main__":
    main()
