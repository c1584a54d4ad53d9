#!/usr/bin/env python3
"""Error at equal time: 1 / (CPU seconds x mean squared error) of Gonio and of Mitsuba 3's llvm_ad_rgb, each at the best of its settings, in one run.

    python benches/peers/bench_error.py --gonio target/release/gonio --work OUT [SCENE ...]

The scenes are those of `scenes.py`, at 256 x 256 pixels. The error of a setting is the variance of its `--seeds` pictures, pixel by pixel
and relative, s^2 / (r^2 + 0.01), of which the thousandth of the pixels with the largest is left out: one path that finds a lamp by chance would decide otherwise. The
reference r of a scene is Mitsuba's mean of `--reference` samples, kept in OUT and used again. It is too noisy to tell the errors of the better settings; that the
pictures have its mean is printed, and `compare_images.py` tells it more exactly. Seconds are those of all
threads; scenes are loaded, and Mitsuba's kernels compiled, before.

With `--denoise` a second table follows: Gonio's pictures after Open Image Denoise (the wheel `pyoidn`), as `gonio render --denoise` filters them, its seconds included. That is
biased, so their error is (x - r)^2 / (r^2 + 0.01) against the reference, what is wrong with them included, and not their variance. Mitsuba's own denoiser needs a GPU.
"""

import argparse
import itertools
import os
import pathlib
import resource
import subprocess
import sys

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

import compare_images
import mitsuba_to_gonio as convert
import scenes

RESOLUTION = 256
# Sampler, the reflections before roulette, and how many times as many samples: errors of even points fall faster than their number grows.
THEIRS = [*itertools.product(["independent", "stratified", "multijitter", "ldsampler"], [5, 1000], [1]), ("multijitter", 5, 4), ("ldsampler", 5, 4)]
# Options, and how many times as many samples.
OURS = [("", 1), ("--roulette efficiency", 1), ("--adaptive", 1), ("--splitting 4", 1), ("--splitting 4 --adaptive", 2), ("--light-samples 4 --splitting 2 --adaptive", 2)]
# Added where there is a sky.
SKY = "--env-sampling compensated"


def cpu_seconds(who):
    used = resource.getrusage(who)
    return used.ru_utime + used.ru_stime


def theirs(adapted, setting, args):
    sampler, roulette, times = setting
    spp = args.spp * times
    adapted["sensor"] = dict(adapted["sensor"], sampler={"type": sampler, "sample_count": spp})
    adapted["integrator"] = dict(adapted["integrator"], rr_depth=roulette)
    scene = mi.load_dict(adapted)
    pictures, seconds = [], []
    for seed in range(args.seeds + 1):
        start = cpu_seconds(resource.RUSAGE_SELF)
        pictures.append(np.array(mi.render(scene, spp=spp, seed=seed)))
        seconds.append(cpu_seconds(resource.RUSAGE_SELF) - start)
    # The first compiles.
    return pictures[1:], np.median(seconds[1:])


def ours(toml, options, times, args):
    spp = args.spp * times
    pictures, filtered, seconds, more = [], [], [], []
    out = args.work / "error.exr"

    def render(spp, seed):
        command = [args.gonio, "render", toml, "-o", out, "--size", f"{RESOLUTION}x{RESOLUTION}", "--filter", "box", "--max-bounces", 7]
        command += ["--spp", spp, "--seed", seed, "--quiet", *options.split()]
        start = cpu_seconds(resource.RUSAGE_CHILDREN)
        subprocess.run([str(x) for x in command], check=True)
        return cpu_seconds(resource.RUSAGE_CHILDREN) - start

    for seed in range(args.seeds):
        start = render(1, seed)
        seconds.append((render(spp, seed) - start) * spp / (spp - 1))
        layers = dict(mi.Bitmap(str(out)).split())
        picture, albedo, normal = (np.array(layers[name], dtype=np.float32)[..., :3] for name in ("<root>", "albedo", "normal"))
        pictures.append(picture)
        if args.denoise:
            import pyoidn

            start = cpu_seconds(resource.RUSAGE_SELF)
            filtered.append(pyoidn.denoise(picture, albedo=np.clip(albedo, 0, 1), normal=normal, hdr=True))
            more.append(cpu_seconds(resource.RUSAGE_SELF) - start)
    return pictures, np.median(seconds), filtered, np.median(more) if more else 0.0


def reference(name, scene, args):
    """The mean picture."""
    path = args.work / f"reference_{name}.npz"
    if path.exists():
        return np.load(path)["mean"]
    count = max(args.reference // 64, 2)
    mean = sum(np.array(mi.render(scene, spp=64, seed=1000 + k), dtype=np.float64) for k in range(count)) / count
    np.savez(path, mean=mean)
    return mean


def error(pictures, reference, biased=False):
    squares = np.mean((np.array(pictures) - reference) ** 2, 0) if biased else np.var(pictures, 0, ddof=1)
    each = (squares / (reference**2 + 0.01)).mean(-1).ravel()
    return float(np.sort(each)[: int(0.999 * each.size)].mean())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", default=scenes.NAMES)
    parser.add_argument("--gonio", type=pathlib.Path, required=True, help="the release build of the command")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for scenes and images")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--options", action="append", help="of Gonio, as they are, in place of the list; may be said several times")
    parser.add_argument("--denoise", action="store_true", help="a second table, of denoised pictures")
    parser.add_argument("--reference", type=int, default=8192, help="samples of the reference")
    args = parser.parse_args()
    args.work.mkdir(parents=True, exist_ok=True)
    print("| scene | Mitsuba | error | CPU s | Gonio | error | CPU s | efficiency, Gonio / Mitsuba | load |\n|---|---|---|---|---|---|---|---|---|")
    second = []
    for name in args.scenes:
        adapted = convert.adapted(scenes.get(name, RESOLUTION), compare_images.DIFFUSE)
        toml = convert.write(name, adapted, args.work.resolve())
        best = {}
        loaded = mi.load_dict(adapted)
        mean = reference(name, loaded, args)
        for setting in THEIRS:
            pictures, seconds = theirs(adapted, setting, args)
            off = error(pictures, mean)
            found = (1 / (seconds * off), "{}, roulette after {}, {} samples".format(*setting[:2], args.spp * setting[2]), off, seconds)
            best["theirs"] = max(best.get("theirs", found), found)
        under_a_sky = any(isinstance(v, dict) and v.get("type") == "envmap" for v in adapted.values())
        for options, times in [(o, 1) for o in args.options] if args.options else OURS:
            options = f"{options} {SKY}".strip() if under_a_sky and not args.options else options
            pictures, seconds, filtered, more = ours(toml, options, times, args)
            if filtered:
                off = error(filtered, mean, biased=True)
                found = (1 / ((seconds + more) * off), f"{args.spp * times} samples {options}".strip(), off, seconds + more)
                best["denoised"] = max(best.get("denoised", found), found)
            off = error(pictures, mean)
            found = (1 / (seconds * off), f"{args.spp * times} samples {options}".strip(), off, seconds)
            best["ours"] = max(best.get("ours", found), found)
            print(f"{name}: {found[1]}: error {off:.3g}, {seconds:.3g} s, {found[0]:.4g}; mean off the reference's by {np.mean(pictures) / mean.mean() - 1:+.2%}", file=sys.stderr, flush=True)
        (a, *theirs_), (b, *ours_) = best["theirs"], best["ours"]
        row = [name] + [f"{x:.3g}" if isinstance(x, float) else x for x in [*theirs_, *ours_]]
        print("| " + " | ".join(row) + f" | {b / a:.2f} | {os.getloadavg()[0]:.1f} |", flush=True)
        if args.denoise:
            c, options, off, seconds = best["denoised"]
            second.append(f"| {name} | {options} | {off:.3g} | {seconds:.3g} | {c / a:.2f} |")
    if second:
        print("\n| scene | Gonio, denoised | error | CPU s | efficiency, to Mitsuba without |\n|---|---|---|---|---|\n" + "\n".join(second))


if __name__ == "__main__":
    main()
