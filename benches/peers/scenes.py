"""The five scenes of the comparison with other renderers, as Mitsuba 3 dictionaries, and what they are made of.

`get(name, resolution)` for `ibl`, `cornell`, `mesh`, `lights` and `veach`; `make_assets(folder)` writes a panorama with a sun and a mesh of 998,000
triangles once. Paths of seven reflections, box filter.
"""

import pathlib

import mitsuba as mi
import numpy as np

NAMES = ["ibl", "cornell", "mesh", "lights", "veach"]
ASSETS = pathlib.Path(__file__).resolve().parents[2] / "target" / "peers" / "assets"
DEPTH = 8


def _panorama(path, width=1024, height=512):
    """A sky over brown ground, and a sun 2 degrees wide, 6000 times as bright as the sky."""
    v, u = np.meshgrid((np.arange(height) + 0.5) / height, (np.arange(width) + 0.5) / width, indexing="ij")
    theta, phi = v * np.pi, u * 2 * np.pi
    d = np.stack([np.sin(phi) * np.sin(theta), np.cos(theta), -np.cos(phi) * np.sin(theta)], -1)
    up = np.sqrt(np.clip(d[..., 1:2], 0, 1))
    sky = (1 - up) * [0.9, 0.85, 0.8] + up * [0.18, 0.35, 0.8]
    picture = np.where(d[..., 1:2] > 0, sky, [0.20, 0.16, 0.12])
    sun = np.array([0.55, 0.62, 0.56])
    cosine = (d * sun / np.linalg.norm(sun)).sum(-1, keepdims=True)
    picture = picture + (cosine > np.cos(np.radians(1.0))) * np.array([6000.0, 5400.0, 4500.0])
    picture = picture + np.exp(-(1 - np.clip(cosine, -1, 1)) / 0.003) * [3.0, 2.7, 2.2]
    mi.Bitmap(picture.astype(np.float32)).write(str(path))


def mesh_arrays(columns=1000, rows=501):
    """Vertices and triangles of a sphere with three octaves of bumps."""
    theta = np.linspace(0, np.pi, rows)[:, None]
    phi = (np.arange(columns) / columns * 2 * np.pi)[None]
    x, y, z = np.sin(theta) * np.cos(phi), np.cos(theta) + 0 * phi, np.sin(theta) * np.sin(phi)
    r = 1 + 0.06 * np.sin(9 * x + 1) * np.sin(11 * y) * np.sin(10 * z + 0.5)
    r += 0.02 * np.sin(37 * x) * np.sin(41 * y + 0.3) * np.sin(43 * z)
    r += 0.004 * np.sin(151 * x) * np.sin(163 * y) * np.sin(157 * z)
    vertices = np.stack([x * r, y * r + 1.06, z * r], -1).reshape(-1, 3).astype("<f4")
    i, j = np.arange(rows - 1)[:, None], np.arange(columns)[None]
    a, b = i * columns + j, i * columns + (j + 1) % columns
    c, d = a + columns, b + columns
    quads = [np.stack(t, -1).reshape(-1, 3) for t in ([a, b, c], [b, d, c])]
    triangles = np.concatenate(quads).astype("<i4")
    p = vertices[triangles]
    area = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1)
    return vertices, triangles[area > 1e-12]


def write_ply(path, vertices, triangles):
    faces = np.zeros(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}"]
    header += [f"property float {axis}" for axis in "xyz"]
    header += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header", ""]
    path.write_bytes("\n".join(header).encode() + vertices.tobytes() + faces.tobytes())


def make_assets(folder=ASSETS):
    folder.mkdir(parents=True, exist_ok=True)
    if not (folder / "sky.exr").exists():
        _panorama(folder / "sky.exr")
    if not (folder / "mesh.ply").exists():
        write_ply(folder / "mesh.ply", *mesh_arrays())


def _rgb(*c):
    return {"type": "rgb", "value": list(c) if len(c) == 3 else [c[0]] * 3}


def _camera(eye, target, fov, resolution):
    film = {"type": "hdrfilm", "width": resolution, "height": resolution, "rfilter": {"type": "box"}}
    film |= {"pixel_format": "rgb", "component_format": "float32"}
    to_world = mi.ScalarTransform4f().look_at(origin=eye, target=target, up=[0, 1, 0])
    return {"type": "perspective", "fov": fov, "to_world": to_world, "film": film, "sampler": {"type": "independent"}}


def _metal(name, alpha):
    return {"type": "roughconductor", "material": name, "distribution": "ggx", "alpha": alpha}


def _lights(scene, count=1000):
    """Small bright spheres, of all colours, strewn over the floor."""
    random = np.random.default_rng(7)
    for i in range(count):
        radius = float(random.uniform(0.015, 0.04))
        centre = [float(random.uniform(*b)) for b in ((-4, 4), (0.3, 2.5), (-4, 4))]
        hue = random.uniform(0.3, 1, 3)
        radiance = hue / hue.mean() * 12 * (0.03 / radius) ** 2 * random.uniform(0.2, 2)
        shape = {"type": "sphere", "center": centre, "radius": radius}
        scene[f"light{i}"] = shape | {"emitter": {"type": "area", "radiance": _rgb(*map(float, radiance))}}


def _veach(scene):
    """Four plates of different roughness below four lights of different size: Veach & Guibas 1995, figure 2."""
    plates = [
        ((-2.70651, 0.25609), (-2.08375, -0.526323), 0.005),
        ((-3.28825, 1.36972), (-2.83856, 0.476536), 0.02),
        ((-3.73096, 2.70046), (-3.43378, 1.74564), 0.05),
        ((-3.99615, 4.0667), (-3.82069, 3.08221), 0.1),
    ]
    for i, ((y0, z0), (y1, z1), alpha) in enumerate(plates):
        u, v = np.array([4.0, 0, 0]), np.array([0, (y1 - y0) / 2, (z1 - z0) / 2])
        m = np.eye(4)
        m[:3, 0], m[:3, 1], m[:3, 2] = u, v, np.cross(u, v) / np.linalg.norm(np.cross(u, v))
        m[:3, 3] = [0, (y0 + y1) / 2, (z0 + z1) / 2]
        plate = _metal("none", alpha) | {"specular_reflectance": _rgb(0.9)}
        scene[f"plate{i}"] = {"type": "rectangle", "to_world": mi.ScalarTransform4f(m.tolist()), "bsdf": plate}
    grey = {"type": "diffuse", "reflectance": _rgb(0.4)}
    t = mi.ScalarTransform4f()
    floor = t.translate([0, -4.14615, 0]).rotate([1, 0, 0], -90).scale(20)
    scene["floor"] = {"type": "rectangle", "to_world": floor, "bsdf": grey}
    scene["wall"] = {"type": "rectangle", "to_world": t.translate([0, 0, -2]).scale(20), "bsdf": grey}
    for i, (x, radius, e) in enumerate([(-3.75, 0.0333, 901.803), (-1.25, 0.1, 100.0), (1.25, 0.3, 11.1111), (3.75, 0.9, 1.23457)]):
        emitter = {"type": "area", "radiance": _rgb(e)}
        scene[f"light{i}"] = {"type": "sphere", "center": [x, 0, 0], "radius": radius, "emitter": emitter}


def get(name, resolution=512):
    """The scene dictionary."""
    make_assets()
    integrator = {"type": "path", "max_depth": DEPTH}
    if name == "cornell":
        scene = mi.cornell_box()
        scene["integrator"] = integrator
        scene["sensor"]["film"].update(width=resolution, height=resolution, rfilter={"type": "box"}, component_format="float32")
        return scene
    scene = {"type": "scene", "integrator": integrator}
    floor = mi.ScalarTransform4f().rotate([1, 0, 0], -90).scale(20)
    floor = {"type": "rectangle", "to_world": floor, "bsdf": {"type": "diffuse", "reflectance": _rgb(0.5)}}
    if name in ("ibl", "mesh"):
        scene["sensor"] = _camera([0, 2.2, 6], [0, 0.9, 0], 32, resolution)
        scene["sky"] = {"type": "envmap", "filename": str(ASSETS / "sky.exr")}
        scene["floor"] = floor
        if name == "ibl":
            scene["ball"] = {"type": "sphere", "center": [0, 1, 0], "radius": 1, "bsdf": _metal("Au", 0.2)}
        else:
            red = {"type": "diffuse", "reflectance": _rgb(0.6, 0.25, 0.1)}
            scene["ball"] = {"type": "ply", "filename": str(ASSETS / "mesh.ply"), "face_normals": True, "bsdf": red}
    elif name == "lights":
        scene["sensor"] = _camera([0, 3.2, 8], [0, 0.7, 0], 38, resolution)
        scene["floor"] = floor
        balls = [(-1.8, 0.5, 0.05), (0, -0.6, 0.2), (1.9, 0.3, 0.4), (-0.7, 2, 0.1), (1.0, 2.2, 0.3)]
        for i, (x, z, alpha) in enumerate(balls):
            bsdf = _metal("Al", alpha) if i % 2 == 0 else {"type": "diffuse", "reflectance": _rgb(0.7, 0.4, 0.3)}
            scene[f"ball{i}"] = {"type": "sphere", "center": [x, 0.6, z], "radius": 0.6, "bsdf": bsdf}
        _lights(scene)
    elif name == "veach":
        scene["sensor"] = _camera([0, 2, 15], [0, -2, 2.5], 28, resolution)
        _veach(scene)
    else:
        raise ValueError(f"no scene `{name}`: {', '.join(NAMES)}")
    return scene
