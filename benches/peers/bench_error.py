#!/usr/bin/env python3
"""Error at equal time: 1 / (CPU seconds x mean squared error) of Gonio and of Mitsuba 3's llvm_ad_rgb, each at the best of its settings, in one run.

    python benches/peers/bench_error.py --gonio target/release/gonio --work OUT [SCENE ...]

The scenes are those of `scenes.py`, at 256 x 256 pixels. The reference of a scene is Mitsuba's mean of `--reference` samples, kept in OUT and used again; its
own variance is taken off. Each setting makes `--seeds` pictures of `--spp` samples. The error is that relative to the reference, (x - r)^2 / (r^2 + 0.01), of which
the thousandth of the pixels with the largest is left out: one path that finds a lamp by chance would decide otherwise. Seconds are those of all
threads; scenes are loaded, and Mitsuba's kernels compiled, before.
"""

import argparse
import os
import pathlib
import resource
import subprocess

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

import compare_images
import mitsuba_to_gonio as convert
import scenes

RESOLUTION = 256
THEIRS = ["independent", "stratified", "multijitter", "ldsampler"]
OURS = {"default": "", "compensated": "--env-sampling compensated"}


def cpu_seconds(who):
    used = resource.getrusage(who)
    return used.ru_utime + used.ru_stime


def theirs(adapted, sampler, args):
    adapted["sensor"] = dict(adapted["sensor"], sampler={"type": sampler, "sample_count": args.spp})
    scene = mi.load_dict(adapted)
    pictures, seconds = [], []
    for seed in range(args.seeds + 1):
        start = cpu_seconds(resource.RUSAGE_SELF)
        pictures.append(np.array(mi.render(scene, spp=args.spp, seed=seed)))
        seconds.append(cpu_seconds(resource.RUSAGE_SELF) - start)
    # The first compiles.
    return pictures[1:], np.median(seconds[1:])


def ours(toml, options, args):
    pictures, seconds = [], []
    out = args.work / "error.exr"

    def render(spp, seed):
        command = [args.gonio, "render", toml, "-o", out, "--size", f"{RESOLUTION}x{RESOLUTION}", "--filter", "box", "--max-bounces", 7]
        command += ["--spp", spp, "--seed", seed, "--quiet", *options.split()]
        start = cpu_seconds(resource.RUSAGE_CHILDREN)
        subprocess.run([str(x) for x in command], check=True)
        return cpu_seconds(resource.RUSAGE_CHILDREN) - start

    for seed in range(args.seeds):
        start = render(1, seed)
        seconds.append((render(args.spp, seed) - start) * args.spp / (args.spp - 1))
        layers = dict(mi.Bitmap(str(out)).split())
        pictures.append(np.array(layers["<root>"], dtype=np.float32)[..., :3])
    return pictures, np.median(seconds)


def reference(name, scene, args):
    """The mean picture, and the variance of its pixels."""
    path = args.work / f"reference_{name}.npz"
    if path.exists():
        kept = np.load(path)
        return kept["mean"], kept["variance"]
    passes = [np.array(mi.render(scene, spp=64, seed=1000 + k), dtype=np.float64) for k in range(max(args.reference // 64, 2))]
    mean, variance = np.mean(passes, 0), np.var(passes, 0, ddof=1) / len(passes)
    np.savez(path, mean=mean, variance=variance)
    return mean, variance


def error(pictures, mean, variance):
    each = np.mean([((p - mean) ** 2 - variance) / (mean**2 + 0.01) for p in pictures], 0).mean(-1).ravel()
    return float(np.sort(each)[: int(0.999 * each.size)].mean())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", default=scenes.NAMES)
    parser.add_argument("--gonio", type=pathlib.Path, required=True, help="the release build of the command")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for scenes and images")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--reference", type=int, default=8192, help="samples of the reference")
    args = parser.parse_args()
    args.work.mkdir(parents=True, exist_ok=True)
    print("| scene | Mitsuba | error | CPU s | Gonio | error | CPU s | efficiency, Gonio / Mitsuba | load |\n|---|---|---|---|---|---|---|---|---|")
    for name in args.scenes:
        adapted = convert.adapted(scenes.get(name, RESOLUTION), compare_images.DIFFUSE)
        toml = convert.write(name, adapted, args.work.resolve())
        best = {}
        loaded = mi.load_dict(adapted)
        mean, variance = reference(name, loaded, args)
        for sampler in THEIRS:
            pictures, seconds = theirs(adapted, sampler, args)
            found = (1 / (seconds * error(pictures, mean, variance)), sampler, error(pictures, mean, variance), seconds)
            best["theirs"] = max(best.get("theirs", found), found)
        for setting, options in OURS.items():
            pictures, seconds = ours(toml, options, args)
            found = (1 / (seconds * error(pictures, mean, variance)), setting, error(pictures, mean, variance), seconds)
            best["ours"] = max(best.get("ours", found), found)
        (a, *theirs_), (b, *ours_) = best["theirs"], best["ours"]
        row = [name] + [f"{x:.3g}" if isinstance(x, float) else x for x in [*theirs_, *ours_]]
        print("| " + " | ".join(row) + f" | {b / a:.2f} | {os.getloadavg()[0]:.1f} |", flush=True)


if __name__ == "__main__":
    main()
