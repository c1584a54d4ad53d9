#!/usr/bin/env python3
"""Values a second of Gonio's batches and of Mitsuba 3, one thread each, in turn.

Run from the repository root, with `pip install mitsuba==3.9.1 numpy` in the Python that runs it (the variant llvm_ad_rgb needs LLVM's
shared library, see DRJIT_LIBLLVM_PATH):

    cargo bench -p gonio-brdf --bench throughput --no-run
    python benches/peers/bench_brdf.py [--rounds 3] [--measured FILE.bsdf ...]

Both read 2^20 random pairs of directions from memory and write what they find. Of each round the best of 15 runs counts, which other programs
disturb least, and of the rounds the median. Mitsuba's first run, which compiles, doesn't count. The scalar variant can only be called from a loop in
Python, which takes most of its time; it is far slower.
"""

import argparse
import statistics
import subprocess
import time

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
dr.set_thread_count(1)
COUNT = 1 << 20
OPERATIONS = ("eval", "pdf", "sample")


def cases(measured):
    c = [0.6, 0.3, 0.2]
    rgb = {"type": "rgb", "value": c}
    principled = {"type": "principled", "roughness": 0.4, "metallic": 0.3, "specular": 0.5, "base_color": rgb}
    disney = "disney:" + "/".join(map(str, c)) + ",roughness=0.4,metallic=0.3,specular=0.5"
    smith = "alpha=0.2,masking=smith,interreflection=none"
    yield "rough conductor", f"ggx:{smith},metal=gold", {"type": "roughconductor", "material": "Au", "distribution": "ggx", "alpha": 0.2}
    yield (
        "rough dielectric",
        f"rough-dielectric:{smith},ior=1.5",
        {"type": "roughdielectric", "distribution": "ggx", "alpha": 0.2, "int_ior": 1.5, "ext_ior": 1.0},
    )
    yield "principled", disney, principled
    yield "principled, coat and sheen", disney + ",clearcoat=0.6,sheen=0.5", {**principled, "clearcoat": 0.6, "sheen": 0.5}
    yield "principled, glass", disney + ",spec_trans=0.7", {**principled, "spec_trans": 0.7}
    for path in measured:
        yield path.rsplit("/", 1)[-1], f"table:file={path}", {"type": "measured", "filename": path}


def gonio(description):
    command = ["cargo", "bench", "--quiet", "-p", "gonio-brdf", "--bench", "throughput", "--", description, str(COUNT)]
    out = subprocess.run(command, check=True, stdout=subprocess.PIPE)
    return {name: float(rate) for name, rate in (line.split() for line in out.stdout.decode().splitlines())}


def mitsuba(scene):
    bsdf = mi.load_dict(scene)
    both_sides = scene["type"] == "roughdielectric" or "spec_trans" in scene
    rng = np.random.default_rng(3)

    def directions():
        z, turn = rng.random(COUNT), rng.random(COUNT) * 2 * np.pi
        s = np.sqrt(1 - z * z)
        if both_sides:
            z *= np.where(rng.random(COUNT) < 0.5, -1, 1)
        return mi.Vector3f(np.stack([s * np.cos(turn), s * np.sin(turn), z]).astype("f4"))

    si = dr.zeros(mi.SurfaceInteraction3f, COUNT)
    si.wi = directions()
    wo = directions()
    u = rng.random((3, COUNT)).astype("f4")
    u1, u2 = mi.Float(u[0]), mi.Point2f(u[1:])
    dr.eval(si, wo, u1, u2)
    dr.sync_thread()
    context = mi.BSDFContext()
    runs = {
        "eval": lambda: bsdf.eval(context, si, wo),
        "pdf": lambda: bsdf.pdf(context, si, wo),
        "sample": lambda: bsdf.sample(context, si, u1, u2),
    }
    rates = {}
    for name, run in runs.items():
        times = []
        for _ in range(16):
            start = time.perf_counter()
            result = run()
            dr.eval(result)
            dr.sync_thread()
            times.append(time.perf_counter() - start)
            del result
        rates[name] = COUNT / min(times[1:]) / 1e6
    return rates


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--measured", nargs="*", default=[], help="files of the RGL database")
    arguments = parser.parse_args()
    print(f"{'':28}" + "".join(f"{name + ' Gonio':>16}{'Mitsuba':>9}{'ratio':>7}" for name in OPERATIONS))
    for title, description, scene in cases(arguments.measured):
        rounds = [(gonio(description), mitsuba(scene)) for _ in range(arguments.rounds)]
        line = f"{title:28}"
        for name in OPERATIONS:
            ours, theirs = (statistics.median(r[k][name] for r in rounds) for k in (0, 1))
            line += f"{ours:16.1f}{theirs:9.1f}{ours / theirs:7.2f}"
        print(line, flush=True)


if __name__ == "__main__":
    main()
