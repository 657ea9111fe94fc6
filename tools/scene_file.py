"""Scene files (scenes/README.md) as plain values: overlays, placed shapes, materials' indices.

The renderer checks scene files thoroughly; here they are taken to be valid.
"""

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

# Keys that exclude each other: laying one over a table removes the others, and their companions.
RIVALS = [
    {"diffuse", "mirror", "glass", "checkerboard", "black"},
    {"fov", "orthographic"},
    {"table", "csv", "blackbody", "rgb", "name", "constant", "radiance"},
    {"ior", "cauchy", "sellmeier"},
    {"ideal", "n"},
    {"ideal", "k"},
    {"sphere", "cube", "cylinder", "disk", "rectangle", "plane", "implicit"},
]
COMPANIONS = {
    "checkerboard": ["cell"],
    "implicit": ["inside", "parameters", "closed", "finder", "steps"],
} | dict.fromkeys(RIVALS[2], ["scale"])
IMAGE_KEYS = {"size", "spp", "max_depth", "sampler", "replicates", "seed", "precision", "wavelengths"}


class SceneError(Exception):
    """A scene that cannot be described to the other renderer."""


@dataclass
class Placed:
    """A shape in canonical coordinates ([-1, 1]³, unit radius) and where it is.

    `size` (3): object coordinates per canonical coordinate; `to_world` (4×4): canonical to world.
    `form`: what the scene file says about the shape.
    """

    kind: str
    name: str
    material: str
    size: np.ndarray
    to_world: np.ndarray
    form: dict


def merge(base, over):
    """Lays the table `over` over `base`, key by key, in place."""
    for key, value in over.items():
        for group in (group for group in RIVALS if key in group):
            for rival in group - {key} & base.keys():
                for gone in [rival, *COMPANIONS.get(rival, [])]:
                    base.pop(gone, None)
        if isinstance(base.get(key), dict) and isinstance(value, dict):
            merge(base[key], value)
        else:
            base[key] = value


def panel_names(path):
    """Names of the panels of a scene file, in its order."""
    with Path(path).open("rb") as file:
        return [panel["name"] for panel in tomllib.load(file).get("panel", [])]


def load(path, panel=None, overrides=()):
    """The tables of a scene file with a panel and then `key=value` overrides laid over it."""
    with Path(path).open("rb") as file:
        scene = tomllib.load(file)
    panels = {entry["name"]: entry for entry in scene.pop("panel", [])}
    if panel is not None:
        if panel not in panels:
            raise SceneError(f"{path} has no panel {panel!r}; there are: {', '.join(panels) or 'none'}")
        chosen = {key: value for key, value in panels[panel].items() if key != "name"}
        image = {key: chosen.pop(key) for key in IMAGE_KEYS & chosen.keys()}
        merge(scene, chosen | ({"image": image} if image else {}))
    for override in overrides:
        lay(scene, override)
    return scene


def lay(scene, override):
    """Lays one `key=value` over a scene, as `etalon render --set` does: a dotted key, and a TOML
    value or a bare word."""
    path, _, text = override.partition("=")
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        value = text
    *parents, last = path.split(".")
    table = scene
    for name in parents:
        table = table[int(name)] if isinstance(table, list) else table.setdefault(name, {})
    if isinstance(table, list):
        table[int(last)] = value
    else:
        merge(table, {last: value})


def csv_files(value):
    """Files that the spectra in a table of a scene file name, sorted."""
    if isinstance(value, dict):
        own = {value["csv"]} if isinstance(value.get("csv"), str) else set()
        return sorted(own.union(*(csv_files(part) for part in value.values())))
    if isinstance(value, list):
        return sorted(set().union(*(csv_files(part) for part in value)))
    return []


def sin_cos_degrees(degrees):
    """Sine and cosine of an angle in degrees, exact at multiples of 90."""
    quarters = round(degrees / 90)
    rest = math.radians(degrees - 90 * quarters)
    sin, cos = math.sin(rest), math.cos(rest)
    return [(sin, cos), (cos, -sin), (-sin, -cos), (-cos, sin)][quarters % 4]


def rotation(axis, degrees):
    """4×4 rotation about `axis`, counterclockwise seen against it (Rodrigues 1840)."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    sin, cos = sin_cos_degrees(degrees)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    matrix = np.eye(4)
    matrix[:3, :3] += sin * cross + (1 - cos) * cross @ cross
    return matrix


def step(description):
    """The 4×4 matrix of one transform of a scene file."""
    ((kind, value),) = description.items()
    matrix = np.eye(4)
    match kind:
        case "translate":
            matrix[:3, 3] = value
        case "rotate_x" | "rotate_y" | "rotate_z":
            return rotation(np.eye(3)["xyz".index(kind[-1])], value)
        case "rotate":
            return rotation(value["axis"], value["angle"])
        case "scale":
            matrix[range(3), range(3)] = value
        case "shear":
            for axes, factor in value.items():
                matrix["xyz".index(axes[0]), "xyz".index(axes[1])] = factor
        case "matrix":
            matrix[: len(value)] = value
        case _:
            raise SceneError(f"unknown transform {kind!r}")
    return matrix


def placed(entry):
    """The [[object]] table `entry` as a [`Placed`]."""
    shape = entry["shape"]
    if isinstance(shape, str):
        shape = {shape: {}}
    if "implicit" in shape:
        shape = {"implicit": shape}
    ((kind, form),) = shape.items()
    size = canonical_size(kind, form)
    matrix = np.diag([*size, 1.0])
    matrix[:3, 3] = form.get("center", [0, 0, 0])
    for transform in entry.get("transform", []):
        matrix = step(transform) @ matrix
    return Placed(kind, entry.get("name", kind), entry["material"], size, matrix, form)


def canonical_size(kind, form):
    """Half the extent of a shape along each of its axes, scene units (1 where it has none)."""
    match kind:
        case "sphere":
            return np.full(3, form.get("radius", 1.0))
        case "cube":
            return np.broadcast_to(form.get("size", form.get("side", 2.0)), 3) / 2
        case "cylinder":
            return np.array([form.get("radius", 1.0)] * 2 + [form.get("height", 2.0) / 2])
        case "disk":
            return np.array([form.get("radius", 1.0)] * 2 + [1.0])
        case "rectangle":
            return np.array([*np.array(form.get("size", [2.0, 2.0])) / 2, 1.0])
        case "plane" | "implicit":
            return np.ones(3)
    raise SceneError(f"unknown shape {kind!r}")
