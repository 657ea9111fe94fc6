"""Meshes that stand for what Mitsuba lacks or gets wrong: implicit surfaces, and curved lights.

A curved light is meshed (`is_light_meshed`) where Mitsuba's own shape is wrong, see reference/README.md: it samples
every cylinder as a circular one and refuses ellipsoids, and from inside a sphere, or between the two
copies of a surface that emits on both sides, its single-precision hits are not good enough.
"""

import json
from functools import cache

import mitsuba as mi
import numpy as np

import implicit_mesh
import scene_file
from scene_file import SceneError

# Facets around the axis; spheres have half as many from pole to pole. The middle of a facet is
# 1 - cos(π/512) = 1.9e-5 of the radius inside of a cylinder, of a sphere twice that.
LONGITUDES = 512


def is_light_meshed(place, material):
    """Whether a placed shape is a curved light that Mitsuba's own shape gets wrong."""
    if "emit" not in material or place.kind not in ("sphere", "cylinder"):
        return False
    return material.get("sides", "front") != "front" or not is_circular(place)


def is_circular(place):
    """Whether a map leaves a sphere a sphere, or a cylinder right and circular, up to rounding."""
    gram = place.to_world[:3, :3].T @ place.to_world[:3, :3]
    wanted = np.eye(3) * gram[0, 0]
    if place.kind == "cylinder":
        wanted[2, 2] = gram[2, 2]
    return np.allclose(gram, wanted, rtol=0, atol=1e-12 * np.abs(gram).max())


def light(place, side, bsdf, emitter):
    """A Mitsuba mesh of the curved part of a light that emits on one side, "front" or "back"."""
    vertices, triangles = curved(place.kind)
    normals = vertices * ([1, 1, 0] if place.kind == "cylinder" else [1, 1, 1])
    if side == "back":
        normals, triangles = -normals, triangles[:, ::-1]
    return shape((vertices, normals, triangles), place.to_world, {"bsdf": bsdf, "emitter": emitter})


@cache
def curved(kind):
    """Vertices and triangles, counterclockwise seen from outside, of the unit sphere or of the tube
    from z = -1 to 1, all vertices on the surface."""
    rows = LONGITUDES // 2 if kind == "sphere" else 1
    down = np.linspace(0, 1, rows + 1)[:, None]
    around = 2 * np.pi * np.arange(LONGITUDES) / LONGITUDES
    ring, height = (np.sin(np.pi * down), np.cos(np.pi * down)) if kind == "sphere" else (1 + 0 * down, 1 - 2 * down)
    vertices = np.stack(np.broadcast_arrays(ring * np.cos(around), ring * np.sin(around), height), axis=-1)
    upper = np.arange(rows)[:, None] * LONGITUDES
    here, right = np.arange(LONGITUDES), (np.arange(LONGITUDES) + 1) % LONGITUDES
    corners = [upper + here, upper + LONGITUDES + here, upper + LONGITUDES + right, upper + right]
    first, second = np.stack(corners[:3], axis=-1), np.stack([corners[0], corners[2], corners[3]], axis=-1)
    if kind == "sphere":
        # At the poles one corner of each cell meets another.
        first, second = first[:-1], second[1:]
    return vertices.reshape(-1, 3), np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])


def implicit(place, bsdf):
    """A Mitsuba mesh of an implicit surface."""
    try:
        _, parts = implicit_parts(json.dumps(place.form))
    except SceneError as error:
        raise SceneError(f"{place.name}: {error}") from None
    return shape(parts, place.to_world, {"bsdf": bsdf})


@cache
def implicit_parts(text):
    """Field and mesh of the shape that a JSON text describes."""
    field = implicit_mesh.Field(json.loads(text))
    return field, implicit_mesh.mesh(field)


def shape(parts, to_world, plugins):
    """A Mitsuba mesh with smooth normals: vertices (n×3), normals (n×3) and triangles (m×3) under a map,
    with its bsdf and emitter."""
    vertices, normals, triangles = parts
    linear = to_world[:3, :3]
    vertices = vertices @ linear.T + to_world[:3, 3]
    normals = implicit_mesh.unit(normals @ np.linalg.inv(linear))
    if np.linalg.det(linear) < 0:
        triangles = triangles[:, ::-1]
    properties = mi.Properties()
    for name, plugin in plugins.items():
        properties[name] = mi.load_dict(plugin)
    result = mi.Mesh("mesh", len(vertices), len(triangles), props=properties, has_vertex_normals=True)
    values = mi.traverse(result)
    values["vertex_positions"] = np.ravel(vertices).astype(np.float32)
    values["vertex_normals"] = np.ravel(normals).astype(np.float32)
    values["faces"] = np.ravel(triangles).astype(np.uint32)
    values.update()
    return result


def notes(tables):
    """What the meshes of a scene are and how far they are from their surfaces, in object coordinates."""
    result = []
    for entry in tables.get("object", []):
        place = scene_file.placed(entry)
        if place.kind == "implicit":
            result.append(implicit_note(place))
        elif is_light_meshed(place, tables["materials"][place.material]):
            _, triangles = curved(place.kind)
            facets = 1 - np.cos(np.pi / LONGITUDES)
            facets *= place.size.max() * (2 if place.kind == "sphere" else 1)
            result.append(
                f"{place.name}: mesh of {len(triangles)} triangles; largest distance to the surface {facets:.1e}"
            )
    return result


def implicit_note(place):
    """The same for one implicit surface, measured."""
    field, parts = implicit_parts(json.dumps(place.form))
    found = implicit_mesh.distances(field, *parts)
    return (
        f"{place.name}: mesh of {len(parts[2])} triangles; largest distance to the surface "
        f"{found['outside']:.1e}, mean {found['mean']:.1e}; of the surface to it {found['missed']:.1e}; "
        f"99.9 % of normals within {found['normal']:.1e} rad"
    )
