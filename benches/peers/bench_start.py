#!/usr/bin/env python3
"""First pixel, memory, and a large mesh.

    python benches/peers/bench_start.py --gonio target/release/gonio --work OUT

Prints the seconds from the start of the process to the first picture of `--preview` on disk, beside the time of `import mitsuba` alone; the peak memory of both
for the mesh of 998,000 triangles; and what a closed mesh of ten million triangles takes.
"""

import argparse
import pathlib
import resource
import subprocess
import sys
import time

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

import compare_images
import mitsuba_to_gonio as convert
import scenes

MITSUBA = """
import mitsuba as mi
mi.set_variant("llvm_ad_rgb")
import sys
sys.path.insert(0, {folder!r})
import compare_images, scenes, mitsuba_to_gonio as convert
import numpy
numpy.array(mi.render(mi.load_dict(convert.adapted(scenes.get("mesh", 512), compare_images.DIFFUSE)), spp=16))
"""


def peak(command):
    """Seconds and megabytes of a process of its own, asked through another so that only it counts."""
    code = "import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True); print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1000)"
    start = time.perf_counter()
    out = subprocess.run([sys.executable, "-c", code, *map(str, command)], check=True, capture_output=True, text=True)
    return time.perf_counter() - start, float(out.stdout.split()[-1])


def first_picture(args, toml):
    preview = args.work / "preview.png"
    preview.unlink(missing_ok=True)
    command = [args.gonio, "render", toml, "-o", args.work / "start.exr", "--preview", preview, "--spp", 16, "--quiet"]
    start = time.perf_counter()
    with subprocess.Popen(list(map(str, command))) as process:
        while not preview.exists() and process.poll() is None:
            time.sleep(0.002)
        seconds = time.perf_counter() - start
        process.terminate()
    return seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--gonio", type=pathlib.Path, required=True, help="the release build of the command")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for scenes and images")
    args = parser.parse_args()
    args.work.mkdir(parents=True, exist_ok=True)
    toml = {}
    for name in ("cornell", "mesh"):
        adapted = convert.adapted(scenes.get(name, 512), compare_images.DIFFUSE)
        toml[name] = convert.write(name, adapted, args.work.resolve())

    starts = [peak([sys.executable, "-c", "import mitsuba as mi; mi.set_variant('llvm_ad_rgb')"])[0] for _ in range(5)]
    firsts = [first_picture(args, toml["cornell"]) for _ in range(5)]
    print(f"first picture: Gonio {np.median(firsts):.3f} s, cornell; Mitsuba's import alone {np.median(starts):.3f} s")

    ours = peak([args.gonio, "render", toml["mesh"], "-o", args.work / "m.exr", "--spp", 16, "--size", "512x512", "--quiet"])[1]
    theirs = peak([sys.executable, "-c", MITSUBA.format(folder=str(pathlib.Path(__file__).parent))])[1]
    print(f"peak memory, 998,000 triangles, 512 x 512: Gonio {ours:.0f} MB, Mitsuba {theirs:.0f} MB, ratio {ours / theirs:.2f}")

    large = args.work / "large.ply"
    vertices, triangles = scenes.mesh_arrays(3170, 1581)
    scenes.write_ply(large, vertices, triangles)
    text = toml["mesh"].read_text().replace(str(scenes.ASSETS / "mesh.ply"), str(large))
    (args.work / "large.toml").write_text(text)
    seconds, megabytes = peak([args.gonio, "render", args.work / "large.toml", "-o", args.work / "l.exr", "--spp", 4, "--size", "512x512", "--quiet"])
    print(f"closed mesh of {len(triangles):,} triangles: read, built and rendered (512 x 512, 4 samples) in {seconds:.1f} s, {megabytes:.0f} MB")


if __name__ == "__main__":
    main()
