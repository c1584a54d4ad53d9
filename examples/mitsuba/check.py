#!/usr/bin/env python3
"""Checks Mitsuba 3's reflection functions with Gonio, and prints the verdicts as a table in Markdown:

    python3 check.py [--measured FILE.bsdf] [--effort quick] [--variant llvm_ad_rgb] [WORD ...]

Only those whose description contains one of the words, if any are given. `--measured` names a file of the RGL database.
Needs `gonio` in the PATH (or --gonio), and `pip install mitsuba numpy`.
"""

import argparse
import json
import pathlib
import shlex
import subprocess
import sys

CASES = [
    "diffuse reflectance=0.8",
    "roughconductor material=Au alpha=0.3",
    "roughconductor material=Au alpha=0.3 distribution=ggx",
    "roughconductor material=Au alpha_u=0.1 alpha_v=0.4 distribution=ggx",
    "roughplastic alpha=0.3",
    "roughplastic alpha=0.1 distribution=ggx nonlinear=true",
    "roughdielectric alpha=0.3 int_ior=1.5 ext_ior=1.0",
    "roughdielectric alpha=0.3 int_ior=1.5 ext_ior=1.0 distribution=ggx",
    "principled roughness=0.5",
    "principled roughness=0.3 metallic=0.7 clearcoat=1.0",
    "principled roughness=0.4 spec_trans=0.8",
]


def number(x):
    if x is None:
        return "not finite"
    return f"{x:.3g}"


def direction(name, w):
    if w is None:
        return ""
    theta, phi = (f"{x:.2f}".rstrip("0").rstrip(".") if x is not None else "?" for x in (w["theta_deg"], w["phi_deg"]))
    return f"{name} {theta}°, {phi}°"


def witness(verdict):
    w = verdict["witness"]
    if w is None:
        return verdict["detail"]
    places = [direction("ωi", w["wi"]), direction("ωr", w["wo"])]
    values = [f"{v['name']} = {number(v['value'])}" for v in w["values"][:2]]
    return "; ".join([", ".join(p for p in places if p)] + values)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--gonio", default="gonio")
    parser.add_argument("--measured", help="a file of the RGL database")
    parser.add_argument("--effort", default="quick")
    parser.add_argument("--variant", default="llvm_ad_rgb")
    parser.add_argument("word", nargs="*")
    arguments = parser.parse_args()
    cases = CASES + ([f"measured filename={shlex.quote(arguments.measured)}"] if arguments.measured else [])
    bsdf = pathlib.Path(__file__).with_name("bsdf.py")
    print("| BSDF | passed | fails | figure (bound) | witness: θ, φ |\n|---|---|---|---|---|")
    for case in cases:
        if arguments.word and not any(word in case for word in arguments.word):
            continue
        program = f"{shlex.quote(sys.executable)} {shlex.quote(str(bsdf))} --variant {arguments.variant} {case}"
        done = subprocess.run(
            [arguments.gonio, "brdf", "check", "--exec", program, "--effort", arguments.effort, "--json"],
            capture_output=True,
            text=True,
        )
        if not done.stdout:
            sys.exit(done.stderr)
        (report,) = json.loads(done.stdout)
        verdicts = report["verdicts"]
        passed = sum(v["outcome"] == "pass" for v in verdicts)
        name = case.split("=")[0] + f"={pathlib.Path(arguments.measured).name}" if case.startswith("measured") else case
        first = f"`{name}` | {passed}"
        failures = [v for v in verdicts if v["outcome"] == "fail"]
        for v in failures:
            figure = f"{number(v['figure'])} ({number(v['bound'])})"
            print(f"| {first} | {v['property'].replace('_', ' ')} | {figure} | {witness(v)} |", flush=True)
            first = " | "
        if not failures:
            print(f"| {first} | | | |", flush=True)


main()
