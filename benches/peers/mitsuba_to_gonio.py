"""Writes a Mitsuba 3 scene dictionary as a Gonio scene (TOML).

What is read: `perspective` sensors of square images, `envmap` and `constant` emitters, `rectangle`, `cube`, `sphere` and `ply` shapes,
`area` emitters, the materials `diffuse`, `roughconductor` (GGX), and both inside `twosided`, and the materials that transmit, `dielectric`,
`thindielectric` and `roughdielectric` (GGX), with media inside that absorb alone. Anything else is an error.

Differences between the two renderers that this has to bridge:

- A Mitsuba material reflects on one side and is black on the other unless it is `twosided`; Gonio's reflect on both.
  `adapted` wraps every material of a dictionary, so that both render the same.
- Mitsuba's panorama starts at -z and goes round to +x; its rows are nodes from pole to pole (row j at θ = jπ/(H - 1)). Gonio's centre
  column is -z, and rows lie at texel centres (θ = (j + ½)π/H). So the panorama is turned by half a circle and its rows are
  resampled to 2 `FINER` (H - 1) + 1 rows: for even H this puts rows, to a thousandth of their distance, where Mitsuba has its two
  rows on both sides of the horizon, at whose edge the radiance usually jumps.
- A medium belongs to a shape in Mitsuba, inside or outside of it; in Gonio it is a parameter of the boundary's material, and what lies in the
  body needs to say nothing.
- Mitsuba's masking is Smith's, separable, without light that facets pass on: `masking = "smith"`, `interreflection = "none"`.
- Shapes that name no material are `diffuse` of 0.5, or black if they are lights.
"""

import copy

import mitsuba as mi
import numpy as np

FINER = 4

# The cube's faces as rectangles: columns are the images of x, y, z and the centre; the normal points out.
_FACES = [
    ([1, 0, 0], [0, 1, 0], [0, 0, 1]),
    ([-1, 0, 0], [0, 1, 0], [0, 0, -1]),
    ([0, 0, -1], [0, 1, 0], [1, 0, 0]),
    ([0, 0, 1], [0, 1, 0], [-1, 0, 0]),
    ([1, 0, 0], [0, 0, -1], [0, 1, 0]),
    ([1, 0, 0], [0, 0, 1], [0, -1, 0]),
]


# Materials that are of both sides.
_TRANSMITTING = ("dielectric", "thindielectric", "roughdielectric")


def _default(shape):
    shines = any(isinstance(v, dict) and v.get("type") == "area" for v in shape.values())
    return {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.0 if shines else 0.5] * 3}}


def _bsdf_key(shape):
    """The key under which a shape has its material, or `bsdf`."""
    materials = ("diffuse", "roughconductor", "roughplastic", "twosided", "ref", *_TRANSMITTING)
    return next((k for k, v in shape.items() if isinstance(v, dict) and v.get("type") in materials), "bsdf")


def _shapes(scene):
    kinds = ("rectangle", "cube", "sphere", "ply")
    return {k: v for k, v in scene.items() if isinstance(v, dict) and v.get("type") in kinds}


def adapted(scene, replacement):
    """A copy of the scene dictionary that both renderers can render: every material two-sided and in place, and
    `replacement` for materials that Gonio has no equal of (`roughplastic`)."""
    scene = copy.copy(scene)
    for name, shape in _shapes(scene).items():
        shape = dict(shape)
        key = _bsdf_key(shape)
        bsdf = shape.get(key) or _default(shape)
        if bsdf["type"] == "ref":
            bsdf = scene[bsdf["id"]]
        if bsdf["type"] == "roughplastic":
            bsdf = replacement
        if bsdf["type"] not in ("twosided", *_TRANSMITTING):
            bsdf = {"type": "twosided", "inside": bsdf}
        shape[key] = bsdf
        scene[name] = shape
    return scene


def _rgb(value):
    if isinstance(value, dict):
        value = value["value"]
    return [float(x) for x in (value if hasattr(value, "__len__") else [value] * 3)]


def _list(values):
    return "[" + ", ".join(repr(float(x)) for x in np.asarray(values).ravel()) + "]"


def _transmitting(bsdf, absorption):
    """The model of a boundary or a pane. Its index is what Mitsuba makes of the media's numbers or names."""
    eta = float(np.array(mi.traverse(mi.load_dict(bsdf))["eta"]).ravel()[0])
    names = {"dielectric": "smooth-dielectric", "thindielectric": "thin-dielectric", "roughdielectric": "rough-dielectric"}
    parameters = [f"ior = {eta!r}"]
    for theirs, ours in (("specular_reflectance", "reflectance"), ("specular_transmittance", "transmittance")):
        if theirs in bsdf:
            parameters.append(f"{ours} = {_list(_rgb(bsdf[theirs]))}")
    if absorption:
        parameters.append(f"absorption = {_list(absorption)}")
    if bsdf["type"] == "roughdielectric":
        if bsdf.get("distribution", "beckmann") != "ggx":
            raise ValueError(f"no equal of the material {bsdf}")
        parameters += [f"alpha = {float(bsdf['alpha'])!r}", 'masking = "smith"', 'interreflection = "none"']
    return f'model = "{names[bsdf["type"]]}"\nparams = {{ {", ".join(parameters)} }}'


def _absorption(shape):
    """The absorption coefficient of what is inside a shape; nothing without a medium there."""
    medium = shape.get("interior")
    if medium is None:
        return None
    if medium["type"] != "homogeneous" or medium.get("albedo") != 0.0:
        raise ValueError(f"only media that absorb alone are written, not {medium}")
    return [medium.get("scale", 1.0) * sigma for sigma in _rgb(medium["sigma_t"])]


def _model(bsdf, absorption=None):
    """The model and its parameters, as lines of TOML."""
    if bsdf["type"] in _TRANSMITTING:
        return _transmitting(bsdf, absorption)
    while bsdf["type"] == "twosided":
        bsdf = next(v for v in bsdf.values() if isinstance(v, dict))
    if bsdf["type"] == "diffuse":
        return f'model = "lambertian"\nparams = {{ reflectance = {_list(_rgb(bsdf["reflectance"]))} }}'
    if bsdf["type"] != "roughconductor" or bsdf.get("distribution", "beckmann") != "ggx":
        raise ValueError(f"no equal of the material {bsdf}")
    common = f'alpha = {float(bsdf["alpha"])!r}, masking = "smith", interreflection = "none"'
    if bsdf["material"] == "none":
        if len(set(_rgb(bsdf["specular_reflectance"]))) != 1:
            raise ValueError("only grey specular_reflectance is written")
        scale = _rgb(bsdf["specular_reflectance"])[0]
        inside = common.replace('"', "").replace(" ", "")
        return f'model = "scaled({scale!r}, ggx:{inside},fresnel=none)"'
    if "specular_reflectance" in bsdf:
        raise ValueError("specular_reflectance of a metal isn't written")
    # Mitsuba knows its metals as spectra; what it makes of them in RGB is what it renders with.
    parameters = mi.traverse(mi.load_dict(bsdf))
    eta, k = (np.array(parameters[f"{name}.value"]).ravel() for name in ("eta", "k"))
    return f'model = "ggx"\nparams = {{ eta = {_list(eta)}, k = {_list(k)}, fresnel = "conductor", {common} }}'


def _matrix(transform):
    return np.array(transform.matrix, dtype=np.float64).reshape(4, 4)


def _placements(shape):
    """Kind and the matrices of the Gonio shapes that make up a Mitsuba shape."""
    world = _matrix(shape["to_world"]) if "to_world" in shape else np.eye(4)
    if shape["type"] == "cube":
        faces = []
        for x, y, z in _FACES:
            face = np.eye(4)
            face[:3, 0], face[:3, 1], face[:3, 2], face[:3, 3] = x, y, z, z
            faces.append(world @ face)
        return "rectangle", faces
    if shape["type"] == "sphere":
        local = np.diag([shape.get("radius", 1.0)] * 3 + [1.0])
        local[:3, 3] = shape.get("center", [0, 0, 0])
        return "sphere", [world @ local]
    return {"ply": "mesh"}.get(shape["type"], shape["type"]), [world]


def write_panorama(source, path):
    """Writes Mitsuba's panorama with rows where Gonio has them."""
    image = np.array(mi.Bitmap(source).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False), dtype=np.float64)
    height = image.shape[0]
    finer = 2 * FINER * (height - 1) + 1
    at = (np.arange(finer) + 0.5) / finer * (height - 1)
    below = np.minimum(at.astype(int), height - 2)
    t = (at - below)[:, None, None]
    rows = (1 - t) * image[below] + t * image[below + 1]
    mi.Bitmap(rows.astype(np.float32)).write(str(path))


def _camera(sensor):
    if sensor["type"] != "perspective":
        raise ValueError(f"no equal of the sensor {sensor['type']}")
    film = sensor["film"]
    if film["width"] != film["height"]:
        raise ValueError("only square images: fov_axis would matter")
    world = _matrix(sensor["to_world"])
    eye, forward, up = world[:3, 3], world[:3, 2], world[:3, 1]
    return (
        f"[film]\nsize = [{film['width']}, {film['height']}]\n\n"
        f"[camera]\neye = {_list(eye)}\ntarget = {_list(eye + forward)}\nup = {_list(up)}\nfov_deg = {float(sensor['fov'])!r}\n"
    )


def write(name, scene, folder):
    """Writes `scene`, as [`adapted`] gives it, to `folder/name.toml` and returns that path."""
    text = [f'name = "{name}"\n']
    for key, item in scene.items():
        kind = item.get("type") if isinstance(item, dict) else None
        if kind == "perspective":
            text.append(_camera(item))
        elif kind == "envmap":
            write_panorama(item["filename"], folder / f"{name}_env.exr")
            text.append(f'[environment]\nfile = "{name}_env.exr"\nlayout = "lat-long"\nrotate_deg = 180\n')
        elif kind == "constant":
            text.append(f"[environment]\nuniform = {_list(_rgb(item['radiance']))}\n")
    for key, shape in _shapes(scene).items():
        emitter = next((v for v in shape.values() if isinstance(v, dict) and v.get("type") == "area"), None)
        emission = f"emission = {_list(_rgb(emitter['radiance']))}\n" if emitter else ""
        text.append(f'[[material]]\nname = "{key}"\n{_model(shape[_bsdf_key(shape)], _absorption(shape))}\n{emission}')
        kind, places = _placements(shape)
        if kind == "mesh" and not shape.get("face_normals"):
            raise ValueError("only meshes with face_normals")
        file = f'file = "{shape["filename"]}"\n' if kind == "mesh" else ""
        for place in places:
            text.append(f'[[shape]]\nkind = "{kind}"\n{file}material = "{key}"\nmatrix = {_list(place[:3])}\n')
    path = folder / f"{name}.toml"
    path.write_text("\n".join(text))
    return path
