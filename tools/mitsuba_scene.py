#!/usr/bin/env python3
"""Describes a scene file to Mitsuba 3 and renders it there.

    tools/mitsuba_scene.py scenes/cornell_box.toml --spp 256 --png cornell.png

Brightness: Mitsuba divides XYZ by 106.7502594 nm, etalon by the integral of ȳ, 106.8569149 nm, so
that an equal-energy spectrum of value 1 has Y = 1. Results here are multiplied by 106.7502594 /
106.8569149. Mitsuba's observer has 5 nm steps, which leaves up to 2e-3 in X and Z and 1e-3 in Y of a
red or green paint; `--film observer` makes it use the published 1 nm table (and its wavelengths).

What is not the same: dispersion (Mitsuba's glass has the index at 550 nm at every wavelength;
reference.py goes one wavelength at a time), a plane is a square that ends 100 000 camera distances away,
implicit surfaces and some curved lights are fine meshes (meshes.py). Ellipsoids are right in `scalar` variants
only (`needs_double`). A lens in parallel projection, checkerboards on anything but squares and cubes, and emitting
implicit surfaces have no counterpart.
Russian roulette starts at Mitsuba's own default depth.
"""

import argparse
import sys
import warnings
from dataclasses import replace
from itertools import product
from pathlib import Path

import mitsuba as mi
import numpy as np
import OpenEXR

import meshes
import scene_file
import spectra
from scene_file import SceneError

MITSUBA_VERSION = "3.9.1"
DEFAULT_VARIANT = "llvm_ad_spectral"
MITSUBA_Y_INTEGRAL = 106.7502594
ETALON_Y_INTEGRAL = 106.856914916767
# Half sizes, in camera distances, of the squares that make up a plane.
PLANE_EXTENTS = [8, 1000, 100_000]
# The same where only the time counts: one square.
FAST_EXTENTS = [1000]
# Suffix of the part of a shape that is curved, see `canonical_parts`.
CURVED_PART = {"sphere": "", "cylinder": "_side"}
# Distance from which on the camera sees something, in camera distances: a thousandth would let parallel
# rays begin behind what they start beside.
NEAR_CLIP = 1e-6
# Distance between the two copies of a surface that emits on both sides, over the largest coordinate on
# the way to it: 64 roundings of single precision, so that rays tell the copies apart.
SIDES_GAP = 64 * 2.0**-24
# Sellmeier coefficients B and C (µm²) of src/lanes/spectrum/glass.rs, where the sources are named.
GLASSES = {
    "n-bk7": ([1.03961212, 0.231792344, 1.01046945], [0.00600069867, 0.0200179144, 103.560653]),
    "n-sf10": ([1.62153902, 0.256287842, 1.64447552], [0.0122241457, 0.0595736775, 147.468793]),
    "n-sf11": ([1.73759695, 0.313747346, 1.89878101], [0.013188707, 0.0623068142, 155.23629]),
    "f2": ([1.34533359, 0.209073176, 0.937357162], [0.00997743871, 0.0470450767, 111.886764]),
    "sf10": ([1.61625977, 0.259229334, 1.07762317], [0.0127534559, 0.0581983954, 116.60768]),
    "sf11": ([1.73848403, 0.311168974, 1.17490871], [0.0136068604, 0.0615960463, 121.922711]),
    "fused-silica": ([0.6961663, 0.4079426, 0.8974794], [0.0684043**2, 0.1162414**2, 9.896161**2]),
    "water": (
        [0.5684027565, 0.1726177391, 0.02086189578, 0.1130748688],
        [0.005101829712, 0.01821153936, 0.02620722293, 10.69792721],
    ),
    "diamond": ([0.3306, 4.3356], [0.175**2, 0.106**2]),
}


def spectrum(value):
    """A spectrum of [`spectra`] as a Mitsuba dict."""
    if isinstance(value, float):
        return {"type": "uniform", "value": value}
    nm, values = value
    steps = np.diff(nm)
    text = ",".join(repr(float(v)) for v in values)
    if np.ptp(steps) == 0:
        return {"type": "regular", "wavelength_min": float(nm[0]), "wavelength_max": float(nm[-1]), "values": text}
    return {"type": "irregular", "wavelengths": ",".join(repr(float(x)) for x in nm), "values": text}


def transform(matrix):
    """A 4×4 matrix as Mitsuba's."""
    return mi.ScalarTransform4f(np.asarray(matrix, np.float64))


class Builder:
    """One scene file on its way to a Mitsuba dict; glass has the index at `wavelength` nm."""

    def __init__(self, scene, folder, wavelength=None, extents=PLANE_EXTENTS):
        self.scene = scene
        self.extents = extents
        self.wavelength = wavelength
        self.spectra = spectra.Spectra(scene.get("spectra", {}), folder)
        camera = scene["camera"]
        self.view = np.linalg.norm(np.subtract(camera["to"], camera["from"]))

    def reflectance(self, form):
        """A spectrum of the file that is not an emission."""
        return spectrum(self.spectra.read(form, emission=False))

    def emission(self, form):
        """A spectrum of the file that is emitted."""
        return spectrum(self.spectra.read(form, emission=True))

    def build(self, sampler, seed, film):
        """The whole scene; see [`render`] for the choices."""
        image = self.scene["image"]
        if image.get("sampler") == "center":
            raise SceneError('sampler = "center" has no counterpart: Mitsuba\'s samplers fill the pixel')
        result = {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": image.get("max_depth", -1)},
            "sensor": self.sensor()
            | {
                "film": film,
                "sampler": {"type": sampler, "sample_count": image["spp"], "seed": seed},
            },
        }
        for index, entry in enumerate(self.scene.get("object", [])):
            place = scene_file.placed(entry)
            for part, shape in self.object(place, f"object{index}").items():
                result[part] = shape
        for index, light in enumerate(self.scene.get("light", [])):
            result[f"light{index}"] = self.light(light)
        environment = self.scene.get("environment")
        if isinstance(environment, dict):
            environment = environment.get("radiance", environment)
        if environment is not None:
            result["environment"] = {"type": "constant", "radiance": self.emission(environment)}
        return result

    def sensor(self):
        """The camera. Mitsuba's looks along its +z, and what is to the right in the picture is the same."""
        camera = self.scene["camera"]
        up = camera.get("up", [0, 1, 0])
        place = mi.ScalarTransform4f().look_at(origin=camera["from"], target=camera["to"], up=up)
        clip = {"near_clip": float(NEAR_CLIP * self.view), "far_clip": float(1e7 * self.view)}
        lens = camera.get("lens", {"radius": 0})
        width, height = self.scene["image"]["size"]
        if "orthographic" in camera:
            if lens["radius"] > 0:
                raise SceneError("Mitsuba has no lens in parallel projection")
            half = camera["orthographic"] / 2 * width / height
            return {"type": "orthographic", "to_world": place @ transform(np.diag([half, half, 1, 1]))} | clip
        sensor = {"type": "perspective", "to_world": place, "fov": float(camera["fov"]), "fov_axis": "y"} | clip
        if lens["radius"] > 0:
            focus = float(lens["focus"])
            sensor |= {"type": "thinlens", "aperture_radius": float(lens["radius"]), "focus_distance": focus}
        return sensor

    def light(self, light):
        """A light without a surface."""
        if "point" in light:
            intensity = self.emission(light["intensity"])
            return {"type": "point", "position": [float(x) for x in light["point"]], "intensity": intensity}
        direction = [float(x) for x in light["direction"]]
        return {"type": "directional", "direction": direction, "irradiance": self.emission(light["irradiance"])}

    def object(self, place, key):
        """The Mitsuba shapes of an object, by name; two copies where both sides emit."""
        material = self.scene["materials"][place.material]
        if "emit" not in material:
            return self.shapes(place, material, key, {})
        emitter = {"emitter": {"type": "area", "radiance": self.emission(material["emit"])}}
        sides = material.get("sides", "front")
        if "glass" in material and sides != "front":
            raise SceneError(f"{place.name}: Mitsuba cannot tell the inside of glass that emits inwards")
        result = {}
        for side in ["front", "back"] if sides == "both" else [sides]:
            extra = emitter | ({"flip_normals": True} if side == "back" else {})
            copy = moved(place, side, SIDES_GAP * (self.view + reach(place))) if sides == "both" else place
            result |= self.shapes(copy, material, f"{key}_{side}", extra)
        return result

    def shapes(self, place, material, key, extra):
        """The Mitsuba shapes of a placed shape with the further properties `extra`."""
        if place.kind == "cube" and "checkerboard" in material:
            if extra:
                raise SceneError(f"{place.name}: a checkered cube that emits has no counterpart in Mitsuba")
            return self.checkered_cube(place, material, key)
        if place.kind == "plane":
            return self.plane(place, material, key, extra)
        bsdf = {"bsdf": self.bsdf(place, material)}
        if place.kind == "implicit":
            if extra:
                raise SceneError(f"{place.name}: a mesh of an implicit surface that emits is no counterpart")
            return {key: meshes.implicit(place, bsdf["bsdf"])}
        to_world = unmirrored(place.to_world)
        parts = {
            part: {"type": kind, "to_world": transform(to_world @ local)} | bsdf | extra
            for part, (kind, local) in canonical_parts(place.kind).items()
        }
        if meshes.is_light_meshed(place, material):
            side = "back" if "flip_normals" in extra else "front"
            parts[CURVED_PART[place.kind]] = meshes.light(place, side, bsdf["bsdf"], extra["emitter"])
        elif place.kind == "sphere" and not meshes.is_circular(place):
            if not mi.variant().startswith("scalar"):
                warnings.warn(
                    f"{place.name}: ellipsoids are too dark in {mi.variant()}, see `needs_double`", stacklevel=2
                )
            group = {"type": "shapegroup", "shape": {"type": "sphere"} | bsdf}
            reference = {"type": "ref", "id": f"{key}_group"}
            instance = {"type": "instance", "to_world": transform(to_world), "group": reference}
            return {f"{key}_group": group, key: instance}
        elif place.kind == "sphere":
            radius = float(np.linalg.norm(to_world[:3, 0]))
            center = [float(x) for x in to_world[:3, 3]]
            parts[""] = {"type": "sphere", "center": center, "radius": radius} | bsdf | extra
        return {key + part: shape for part, shape in parts.items()}

    def checkered_cube(self, place, material, key):
        """Six checkered rectangles: Mitsuba's texture is over u, v, the scene's over x, y, z."""
        result = {}
        for axis, side in product(range(3), (-1, 1)):
            order = [(axis + 1) % 3, (axis + 2) % 3, axis]
            face = np.zeros((4, 4))
            face[order, range(3)], face[3, 3] = (1, 1, 1), 1
            face[axis, 3] = side
            size = np.array([*place.size[order[:2]], 1.0])
            colours = material["checkerboard"]
            if np.floor(side * place.size[axis] / material["cell"]) % 2:
                colours = colours[::-1]
            rectangle = replace(place, kind="rectangle", size=size, to_world=place.to_world @ face)
            board = {"checkerboard": colours, "cell": material["cell"]}
            result |= self.shapes(rectangle, board, f"{key}_face{axis}{'-+'[side > 0]}", {})
        return result

    def plane(self, place, material, key, extra):
        """A square about the origin and rings of four rectangles around it, out to the last of
        the extents: single precision resolves places on a rectangle to 6e-8 of its size only."""
        unit = self.view / np.linalg.norm(place.to_world[:3, :2], axis=0)
        result = {}
        for part, corners in plane_parts(unit, self.extents).items():
            (x0, x1), (y0, y1) = corners
            half = np.array([(x1 - x0) / 2, (y1 - y0) / 2, 1.0])
            centre = np.array([(x0 + x1) / 2, (y0 + y1) / 2, 0.0])
            local = scene_file.step({"translate": centre}) @ np.diag([*half, 1.0])
            tile = replace(place, kind="rectangle", size=half, to_world=place.to_world @ local)
            if "checkerboard" in material:
                board = self.checkerboard(tile, material, centre)
                bsdf = two_sided({"type": "diffuse", "reflectance": board})
            else:
                bsdf = self.bsdf(tile, material)
            to_world = transform(unmirrored(tile.to_world))
            result[key + part] = {"type": "rectangle", "to_world": to_world, "bsdf": bsdf} | extra
        return result

    def bsdf(self, place, material):
        """The scattering of a material on a shape."""
        if "diffuse" in material:
            return two_sided({"type": "diffuse", "reflectance": self.reflectance(material["diffuse"])})
        if "mirror" in material:
            return two_sided(self.conductor(material["mirror"]))
        if "glass" in material:
            if self.wavelength is None and has_dispersion(material["glass"]):
                warnings.warn(f"{place.name}: Mitsuba has no dispersion; n is that at 550 nm", stacklevel=2)
            return {"type": "dielectric", "int_ior": glass_index(material["glass"], self.wavelength), "ext_ior": 1.0}
        if "checkerboard" in material:
            return two_sided({"type": "diffuse", "reflectance": self.checkerboard(place, material)})
        return two_sided({"type": "diffuse", "reflectance": spectrum(0.0)})

    def conductor(self, mirror):
        """A smooth mirror: a metal of the project's own tables, n and k, or an ideal reflectance."""
        if isinstance(mirror, dict) and "ideal" in mirror:
            reflectance = self.reflectance(mirror["ideal"])
            return {"type": "conductor", "material": "none", "specular_reflectance": reflectance}
        if isinstance(mirror, dict):
            return {"type": "conductor", "eta": self.reflectance(mirror["n"]), "k": self.reflectance(mirror["k"])}
        nm, n, k = spectra.read_csv(spectra.DATA / f"{mirror.lower()}.csv")
        return {"type": "conductor", "eta": spectrum((nm, n)), "k": spectrum((nm, k))}

    def checkerboard(self, place, material, centre=(0.0, 0.0)):
        """A texture over u, v of a rectangle about `centre`, in object coordinates: a Mitsuba tile is
        two cells by two."""
        if place.kind != "rectangle":
            raise SceneError(f"{place.name}: Mitsuba has no checkerboard in object coordinates on a {place.kind}")
        tiles = place.size[:2] / material["cell"]
        to_uv = np.diag([*tiles, 1.0])
        to_uv[:2, 2] = -tiles / 2
        if np.linalg.det(place.to_world[:3, :3]) < 0:
            to_uv[0] *= -1
        to_uv[:2, 2] += np.array(centre[:2]) / (2 * material["cell"])
        even, odd = (self.reflectance(form) for form in material["checkerboard"])
        return {"type": "checkerboard", "color0": even, "color1": odd, "to_uv": mi.ScalarTransform3f(to_uv)}


def two_sided(bsdf):
    """The same scattering on both sides."""
    return {"type": "twosided", "bsdf": bsdf}


def canonical_parts(kind):
    """Mitsuba's shapes, by suffix, that make up a canonical shape, each with its 4×4 placement."""
    if kind != "cylinder":
        return {"": (kind, np.eye(4))}
    side = scene_file.step({"translate": [0, 0, -1]}) @ np.diag([1, 1, 2, 1])
    top = scene_file.step({"translate": [0, 0, 1]})
    bottom = scene_file.rotation([1, 0, 0], 180) @ top
    return {"_side": ("cylinder", side), "_top": ("disk", top), "_bottom": ("disk", bottom)}


def plane_parts(unit, extents):
    """Rectangles ((x from, to), (y from, to)) by suffix that make up a plane out to each of `extents`,
    in units of the camera's distance, which is `unit` (2) in canonical coordinates."""
    parts, inner = {}, np.zeros(2)
    for index, extent in enumerate(extents):
        (a, b), (x, y) = inner, extent * unit
        if index == 0:
            parts[""] = ((-x, x), (-y, y))
        else:
            parts |= {
                f"_left{index}": ((-x, -a), (-y, y)),
                f"_right{index}": ((a, x), (-y, y)),
                f"_below{index}": ((-a, a), (-y, -b)),
                f"_above{index}": ((-a, a), (b, y)),
            }
        inner = extent * unit
    return parts


def unmirrored(to_world):
    """A placement of the same canonical shape without mirroring: all are symmetric in x, and Mitsuba
    turns the geometric normals of mirrored cubes and rectangles around."""
    if np.linalg.det(to_world[:3, :3]) < 0:
        return to_world @ np.diag([-1, 1, 1, 1])
    return to_world


def needs_double(tables):
    """Whether a scene has ellipsoids. In `llvm` variants Mitsuba solves their equation in single
    precision, and what they scatter starts inside of them: too dark, the smaller the worse (reference/README.md)."""
    places = [scene_file.placed(entry) for entry in tables.get("object", [])]
    materials = tables["materials"]
    return any(
        place.kind == "sphere"
        and not meshes.is_circular(place)
        and not meshes.is_light_meshed(place, materials[place.material])
        for place in places
    )


def reach(place):
    """Bound of the coordinates of a shape."""
    return float(np.abs(place.to_world[:3]).sum(axis=1).max())


def moved(place, side, gap):
    """A copy of a placed shape for one of two emitting sides, `gap` apart: flat shapes part along their
    normal, and of closed ones the inner copy is smaller."""
    matrix = place.to_world
    if place.kind in ("disk", "rectangle", "plane"):
        normal = np.cross(matrix[:3, 0], matrix[:3, 1]) * np.sign(np.linalg.det(matrix[:3, :3]))
        shift = gap / 2 * normal / np.linalg.norm(normal)
        matrix = scene_file.step({"translate": shift if side == "front" else -shift}) @ matrix
    elif side == "back":
        # The planes where a canonical coordinate is 0 and 1 are 1/|its row of the inverse| apart.
        heights = 1 / np.linalg.norm(np.linalg.inv(matrix[:3, :3]), axis=1)
        matrix = matrix @ np.diag([*(1 - gap / heights), 1])
    return replace(place, to_world=matrix)


def has_dispersion(glass):
    """Whether the index of refraction depends on the wavelength."""
    return not (isinstance(glass, dict) and "ior" in glass)


def glass_index(glass, nm=None):
    """The index of refraction at a wavelength, 550 nm if none is given."""
    squared = (1e-3 * (nm or 550)) ** 2
    if not has_dispersion(glass):
        return float(glass["ior"])
    if isinstance(glass, dict) and "cauchy" in glass:
        return float(sum(a / squared**i for i, a in enumerate(glass["cauchy"])))
    b, c = GLASSES[glass.lower()] if isinstance(glass, str) else (glass["sellmeier"]["b"], glass["sellmeier"]["c"])
    return float(np.sqrt(1 + sum(b * squared / (squared - c) for b, c in zip(b, c, strict=True))))


def box(low, high):
    """The sensitivity 1 between two wavelengths in nm. Its edges are ramps of 0.1 nm about them,
    which changes the mean of a smooth spectrum by less than 1e-6."""
    ramp = 0.05
    nm = np.array([low - ramp, low + ramp, high - ramp, high + ramp])
    return spectrum((nm, np.array([0.0, 1.0, 1.0, 0.0])))


def make_film(size, kind, bands=()):
    """A film with a box filter in single precision: "standard", Mitsuba's own XYZ, or "observer",
    the published colour-matching functions and further `bands` [low, high] in nm."""
    film = {"width": size[0], "height": size[1], "component_format": "float32", "rfilter": {"type": "box"}}
    if kind == "standard":
        return film | {"type": "hdrfilm", "pixel_format": "xyz"}
    bars, _ = spectra.observer()
    # Mitsuba sorts channels by name.
    responses = {f"axis{i}": spectrum((spectra.WHOLE_NM, bar)) for i, bar in enumerate(bars)}
    responses |= {f"band{i:03}": box(*band) for i, band in enumerate(bands)}
    return film | {"type": "specfilm"} | responses


def load(path, panel=None, image=None, sampler="independent", seed=0, film="standard", fast=False):
    """A scene file as a Mitsuba scene; `image` replaces keys of its [image]. See `load_tables`."""
    tables = scene_file.load(path, panel)
    tables["image"] = tables["image"] | (image or {})
    film = make_film(tables["image"]["size"], film)
    return load_tables(tables, Path(path).parent, sampler, seed, film, fast=fast)


def load_tables(tables, folder, sampler, seed, film, wavelength=None, fast=False):
    """The tables of a scene as a Mitsuba scene. Its optimiser is left out: it joins rectangles of the
    same material, and rays then leak through the plane of figure 2 (+0.07 % light). `fast` leaves such
    care out, for measuring time."""
    builder = Builder(tables, folder, wavelength, FAST_EXTENTS if fast else PLANE_EXTENTS)
    return mi.load_dict(builder.build(sampler, seed, film), optimize=fast)


def render(scene, seed=0):
    """Linear XYZ in etalon's normalisation (height×width×3, float64) of a loaded scene."""
    xyz = np.array(mi.render(scene, seed=seed), np.float64)[..., :3]
    observer = scene.sensors()[0].film().class_name() == "SpecFilm"
    return xyz / ETALON_Y_INTEGRAL * (1 if observer else MITSUBA_Y_INTEGRAL)


def to_rgb(xyz):
    """Linear sRGB of XYZ (last axis)."""
    return xyz @ spectra.XYZ_TO_RGB.T


def set_variant(variant, threads):
    """Chooses the variant and the number of threads."""
    if mi.__version__ != MITSUBA_VERSION:
        warnings.warn(f"written for Mitsuba {MITSUBA_VERSION}, this is {mi.__version__}", stacklevel=2)
    mi.set_variant(variant)
    if threads:
        import drjit

        drjit.set_thread_count(threads)


def main():
    """Renders one scene file."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("scene", type=Path)
    parser.add_argument("--panel")
    parser.add_argument("--spp", type=int)
    parser.add_argument("--size", type=int, nargs=2, metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--sampler", default="independent", help="a Mitsuba sampler (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--film", choices=["standard", "observer"], default="standard")
    parser.add_argument("--variant", default=DEFAULT_VARIANT)
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--exr", type=Path, help="linear sRGB, 32 bits")
    parser.add_argument("--png", type=Path)
    arguments = parser.parse_args()
    set_variant(arguments.variant, arguments.threads)
    image = {key: getattr(arguments, key) for key in ("spp", "size") if getattr(arguments, key)}
    try:
        scene = load(arguments.scene, arguments.panel, image, arguments.sampler, film=arguments.film)
    except SceneError as error:
        sys.exit(f"error: {arguments.scene}: {error}")
    xyz = render(scene, arguments.seed)
    print("mean XYZ", *xyz.mean(axis=(0, 1)))
    rgb = to_rgb(xyz).astype(np.float32)
    if arguments.exr:
        # Mitsuba's own writer waits for ever where there is only one thread.
        OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION}, {"RGB": rgb}).write(str(arguments.exr))
    if arguments.png:
        mi.util.write_bitmap(str(arguments.png), mi.Bitmap(rgb, mi.Bitmap.PixelFormat.RGB))


if __name__ == "__main__":
    main()
