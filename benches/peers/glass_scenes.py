"""Mitsuba 3 scenes of glass, for `compare_images.py`: `get(name, resolution)`, as the folder of other scenes has it.

- `glass`: a clear ball, a ball scaled in colour and a tilted thin pane on a plane, before a panorama and a lamp
- `absorbing-glass`: the same with a ball that absorbs and a grey one inside of another, by Mitsuba's volumetric path tracer
- `rough-glass`: the same with rough boundaries
"""

import pathlib

import mitsuba as mi

PANORAMA = pathlib.Path(__file__).resolve().parents[2] / "assets/preview/sunset.hdr"
NAMES = ("glass", "absorbing-glass", "rough-glass")


def _rgb(*value):
    return {"type": "rgb", "value": list(value)}


def _absorbing(*sigma):
    # Mitsuba takes a colour above 1 for a mistake.
    return {"type": "homogeneous", "albedo": 0.0, "sigma_t": _rgb(*(s / 2 for s in sigma)), "scale": 2.0}


def get(name, resolution):
    transform = mi.ScalarTransform4f
    scene = {
        "type": "scene",
        "integrator": {"type": "volpath" if name == "absorbing-glass" else "path"},
        "sensor": {
            "type": "perspective",
            "fov": 32,
            "to_world": transform().look_at(origin=[0, 2.4, 6.5], target=[0, 0.8, 0], up=[0, 1, 0]),
            "film": {
                "type": "hdrfilm",
                "width": resolution,
                "height": resolution,
                "rfilter": {"type": "box"},
                "pixel_format": "rgb",
                "component_format": "float32",
            },
        },
        "environment": {"type": "envmap", "filename": str(PANORAMA)},
        "floor": {
            "type": "rectangle",
            "to_world": transform().rotate([1, 0, 0], -90).scale(20),
            "bsdf": {"type": "diffuse", "reflectance": _rgb(0.5, 0.45, 0.4)},
        },
        "lamp": {
            "type": "rectangle",
            "to_world": transform().look_at(origin=[-3, 5, 2], target=[0, 0, 0], up=[0, 1, 0]).scale(1.2),
            "emitter": {"type": "area", "radiance": _rgb(12, 10, 8)},
        },
        "ball": {"type": "sphere", "center": [-1.15, 0.9, -0.2], "radius": 0.9, "bsdf": {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}},
        "tinted": {
            "type": "sphere",
            "center": [1.15, 0.9, -0.2],
            "radius": 0.9,
            "bsdf": {
                "type": "dielectric",
                "int_ior": 1.33,
                "ext_ior": 1.0,
                "specular_transmittance": _rgb(0.6, 0.9, 0.8),
                "specular_reflectance": _rgb(1.0, 0.8, 0.6),
            },
        },
        "pane": {
            "type": "rectangle",
            "to_world": transform().translate([0.1, 0.75, 1.3]).rotate([0, 1, 0], 40).rotate([1, 0, 0], -10).scale([0.6, 0.7, 1]),
            "bsdf": {"type": "thindielectric", "int_ior": 1.7, "ext_ior": 1.0},
        },
    }
    if name == "absorbing-glass":
        del scene["tinted"]["bsdf"]["specular_transmittance"], scene["tinted"]["bsdf"]["specular_reflectance"]
        scene["tinted"]["interior"] = _absorbing(1.5, 0.3, 0.1)
        scene["ball"]["interior"] = _absorbing(0.1, 0.6, 1.2)
        # Inside a body, Mitsuba has to be told which medium a surface lies in.
        scene["bead"] = {
            "type": "sphere",
            "center": [-1.0, 0.8, 0.0],
            "radius": 0.35,
            "bsdf": {"type": "diffuse", "reflectance": _rgb(0.7, 0.7, 0.7)},
            "exterior": _absorbing(0.1, 0.6, 1.2),
        }
    elif name == "rough-glass":
        scene["ball"]["bsdf"].update(type="roughdielectric", distribution="ggx", alpha=0.1)
        scene["tinted"]["bsdf"].update(type="roughdielectric", distribution="ggx", alpha=0.35)
    return scene
