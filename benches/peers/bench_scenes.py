#!/usr/bin/env python3
"""Samples a CPU second of whole scenes: Gonio against Mitsuba 3's llvm_ad_rgb, in turn, in one run.

Needs mitsuba 3.9 and numpy in the Python that runs it, libLLVM, and a release build of Gonio; `cargo xtask bench peers scenes` sees to that:

    python benches/peers/bench_scenes.py --gonio target/release/gonio --work OUT [SCENE ...]

Both follow paths of seven reflections at 512 x 512 pixels, plain multiple importance sampling, box filter. Gonio is measured twice: with Mitsuba's choices, lights chosen
evenly and independent random numbers, and as it is when nobody says anything, with a tree of lights and Sobol' points. Mitsuba's scene is loaded and its
kernel compiled before; of Gonio, the time of an image of one sample is taken off. The medians of `--runs` pairs are compared. Seconds of
user and system time of all threads: other work on the machine slows both.
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

RESOLUTION = 512


def plain_panorama(source, path):
    """The panorama as it is: its rows are half a texel off, which matters not for time."""
    image = mi.Bitmap(source).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)
    image.write(str(path))


def cpu_seconds(who):
    used = resource.getrusage(who)
    return used.ru_utime + used.ru_stime


def mitsuba_seconds(scene, spp, seed):
    start = cpu_seconds(resource.RUSAGE_SELF)
    np.array(mi.render(scene, spp=spp, seed=seed))
    return cpu_seconds(resource.RUSAGE_SELF) - start


ALIKE = "--light-choice uniform --sampler independent"


def gonio_seconds(args, toml, spp, options):
    command = [args.gonio, "render", toml, "-o", args.work / "bench.exr", "--size", f"{RESOLUTION}x{RESOLUTION}"]
    command += ["--filter", "box", "--max-bounces", 7, "--spp", spp, "--quiet", *options.split(), *args.options.split()]
    start = cpu_seconds(resource.RUSAGE_CHILDREN)
    subprocess.run([str(x) for x in command], check=True)
    return cpu_seconds(resource.RUSAGE_CHILDREN) - start


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", default=["ibl", "cornell", "mesh", "lights", "veach"])
    parser.add_argument("--peers", type=pathlib.Path, default=pathlib.Path(__file__).parent, help="another folder with a scenes.py")
    parser.add_argument("--gonio", type=pathlib.Path, required=True, help="the release build of the command")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for scenes and images")
    parser.add_argument("--spp", type=int, default=32)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--options", default="", help="more options for Gonio")
    args = parser.parse_args()
    args.work.mkdir(parents=True, exist_ok=True)
    convert.write_panorama = plain_panorama
    module = compare_images.scenes_of(args.peers)
    print("million samples a CPU second   gonio  mitsuba  ratio  gonio by itself  ratio   load")
    for name in args.scenes:
        adapted = convert.adapted(dict(module.get(name, RESOLUTION)), compare_images.DIFFUSE)
        toml = convert.write(name, adapted, args.work.resolve())
        scene = mi.load_dict(adapted)
        mitsuba_seconds(scene, args.spp, 1)
        theirs, ours = [], {ALIKE: [], "": []}
        for run in range(args.runs):
            theirs.append(mitsuba_seconds(scene, args.spp, 2 + run))
            for options, seconds in ours.items():
                start = gonio_seconds(args, toml, 1, options)
                seconds.append((gonio_seconds(args, toml, args.spp, options) - start) * args.spp / (args.spp - 1))
        samples = RESOLUTION**2 * args.spp / 1e6
        mitsuba = samples / np.median(theirs)
        alike, itself = (samples / np.median(seconds) for seconds in ours.values())
        print(
            f"{name:30s} {alike:6.2f} {mitsuba:8.2f} {alike / mitsuba:6.2f} {itself:16.2f} {itself / mitsuba:6.2f} {os.getloadavg()[0]:6.1f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
