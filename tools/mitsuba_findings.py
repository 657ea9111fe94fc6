#!/usr/bin/env python3
"""Small experiments on what Mitsuba 3 gets right and wrong, each with its number.

    tools/mitsuba_findings.py              all, as a Markdown table
    tools/mitsuba_findings.py spheres      those whose name contains this

What follows from them is said in reference/README.md.
"""

import argparse
import os
import subprocess
import sys

import mitsuba as mi
import numpy as np

import mitsuba_scene
import scene_file
import spectra

RAYS = 100_000
# A shear and a scale that differ by axis.
GENERAL = np.array([[1.0, 0.4, 0, 0.2], [0, 0.6, 0.3, -0.1], [0.2, 0, 1.4, 0], [0, 0, 0, 1]])
SIMILAR = np.diag([0.8, 0.8, 0.8, 1.0])
FINDINGS = {}


def finding(function):
    """Enters an experiment, which returns what it saw as text."""
    FINDINGS[function.__name__] = function
    return function


def transform(matrix):
    """A 4×4 matrix as Mitsuba's."""
    return mi.ScalarTransform4f(matrix)


def picture(content, spp=64, seed=0, size=(16, 16), sampler="independent", film=None, depth=-1, sensor=None):
    """Values (height×width×channel) of a scene seen from (0, 0, 5) towards the origin."""
    look = transform(np.eye(4)) @ mi.ScalarTransform4f().look_at(origin=[0, 0, 5], target=[0, 0, 0], up=[0, 1, 0])
    film = film or mitsuba_scene.make_film(size, "standard")
    camera = {"type": "orthographic", "to_world": look} | (sensor or {})
    camera |= {"film": film, "sampler": {"type": sampler, "sample_count": spp}}
    integrator = {"type": "path", "max_depth": depth}
    scene = mi.load_dict({"type": "scene", "integrator": integrator, "sensor": camera} | content)
    return np.array(mi.render(scene, seed=seed), np.float64)


def flat(value=1.0):
    """The same radiance from everywhere, at all wavelengths."""
    return {"type": "constant", "radiance": {"type": "uniform", "value": value}}


def rays():
    """Random rays through the ball of radius 3: origins and unit directions."""
    random = np.random.default_rng(1)
    origins = unit_vectors(random) * 6
    targets = random.uniform(-1.2, 1.2, (RAYS, 3))
    directions = targets - origins
    return origins, directions / np.linalg.norm(directions, axis=1)[:, None]


def unit_vectors(random):
    """Unit vectors, uniformly."""
    vectors = random.normal(size=(RAYS, 3))
    return vectors / np.linalg.norm(vectors, axis=1)[:, None]


def hits(shapes, origins, directions):
    """Whether rays hit, by Mitsuba."""
    scene = mi.load_dict({"type": "scene"} | shapes)
    ray = mi.Ray3f(mi.Point3f(*origins.T.astype(np.float32)), mi.Vector3f(*directions.T.astype(np.float32)))
    return np.array(scene.ray_test(ray))


def exact_hits(kind, matrix, origins, directions):
    """Whether rays hit a canonical shape under an affine map, in double precision, and whether that
    is clear: further from the silhouette than single precision can be wrong."""
    inverse = np.linalg.inv(matrix)
    o, d = origins @ inverse[:3, :3].T + inverse[:3, 3], directions @ inverse[:3, :3].T
    with np.errstate(divide="ignore", invalid="ignore"):
        margin = {"sphere": ball, "cube": slabs, "disk": flat_shape, "rectangle": flat_shape, "cylinder": tube}[kind](
            o, d, kind
        )
    return margin > 0, np.abs(margin) > 1e-4


def ball(o, d, _):
    """1 less the square of the distance of the line from the origin."""
    along = np.einsum("ij,ij->i", o, d) / np.einsum("ij,ij->i", d, d)
    return 1 - np.sum((o - along[:, None] * d) ** 2, axis=1)


def slabs(o, d, _):
    """Length of the line's part in the cube."""
    near, far = (-np.sign(d) - o) / d, (np.sign(d) - o) / d
    return far.min(axis=1) - near.max(axis=1)


def flat_shape(o, d, kind):
    """How far inside the outline the line crosses z = 0."""
    p = o - (o[:, 2] / d[:, 2])[:, None] * d
    return 1 - (np.hypot(p[:, 0], p[:, 1]) if kind == "disk" else np.abs(p[:, :2]).max(axis=1))


def tube(o, d, _):
    """How far inside an open tube from z = -1 to 1 the better of two crossings is."""
    a, b, c = (d[:, :2] ** 2).sum(axis=1), (o[:, :2] * d[:, :2]).sum(axis=1), (o[:, :2] ** 2).sum(axis=1) - 1
    root = b * b - a * c
    z = [1 - np.abs(o[:, 2] + (-b + s * np.sqrt(np.maximum(root, 0))) / a * d[:, 2]) for s in (-1, 1)]
    return np.where(root < 0, root, np.minimum(np.abs(root), 1) * np.maximum(*z))


def placed(kind, matrix):
    """A Mitsuba shape with canonical coordinates [-1, 1]³ under a map."""
    if kind == "cylinder":
        matrix = matrix @ np.diag([1, 1, 2, 1.0]) @ (np.eye(4) + np.outer([0, 0, -0.5, 0], [0, 0, 0, 1]))
    return {"shape": {"type": kind, "to_world": transform(matrix)}}


def wrong_share(kind, matrix, shapes=None):
    """Share of clear rays that Mitsuba gets wrong, as text."""
    o, d = rays()
    truth, clear = exact_hits(kind, matrix, o, d)
    found = hits(shapes or placed(kind, matrix), o, d)
    return f"{np.mean((found != truth)[clear]):.2%}"


def grouped(matrix):
    """A sphere as an instance under a map."""
    group = {"type": "shapegroup", "sphere": {"type": "sphere"}}
    instance = {"type": "instance", "to_world": transform(matrix), "group": {"type": "ref", "id": "group"}}
    return {"group": group, "instance": instance}


@finding
def spheres_under_general_maps():
    """The shape `sphere` under scale by axis and shear, rays that hit or miss wrongly."""
    direct, instance = wrong_share("sphere", GENERAL), wrong_share("sphere", GENERAL, grouped(GENERAL))
    similar = wrong_share("sphere", SIMILAR)
    return f"`sphere` {direct} of rays wrong, as an `instance` {instance}; uniform scale {similar}"


@finding
def other_shapes_under_general_maps():
    """The other shapes under the same map."""
    kinds = ["cube", "rectangle", "disk", "cylinder"]
    return ", ".join(f"`{kind}` {wrong_share(kind, GENERAL)}" for kind in kinds) + " of rays wrong"


@finding
def ellipsoids_in_single_precision():
    """A white ellipsoid seen from afar in light from everywhere, direct light: 1 is right."""
    stretched = np.diag([0.5, 0.2, 0.2, 1.0]) @ (np.eye(4) - 0.9 * np.outer([1, 0, 0, 0], [0, 0, 1, 0]))
    white = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "uniform", "value": 1.0}}}
    group = {"type": "shapegroup", "sphere": {"type": "sphere", "bsdf": white}}
    before, cells = mi.variant(), []
    for variant in (mitsuba_scene.DEFAULT_VARIANT, "scalar_spectral"):
        mi.set_variant(variant)
        instance = {"type": "instance", "to_world": transform(stretched), "group": {"type": "ref", "id": "group"}}
        look = mi.ScalarTransform4f().look_at(origin=[0, 0, 6], target=[0, 0, 0], up=[0, 1, 0])
        camera = {"to_world": look @ mi.ScalarTransform4f().scale(0.1)}
        mean = relative_y({"group": group, "instance": instance, "sky": flat()}, sensor=camera)
        cells.append(f"`{variant}` {mean[0]:.4f} ± {mean[1]:.4f}")
    mi.set_variant(before)
    return ", ".join(cells)


@finding
def lights_under_general_maps():
    """A white floor below a light of radiance 1 under a general map, and a sky of 1, direct light: 1 is right."""
    white = {"type": "diffuse", "reflectance": {"type": "uniform", "value": 1.0}}
    light = {"type": "area", "radiance": {"type": "uniform", "value": 1.0}}
    cells = []
    for kind in ("cube", "rectangle", "disk", "cylinder"):
        floor = transform(np.diag([20, 20, 1, 1.0]) + np.outer([0, 0, -2, 0], [0, 0, 0, 1]))
        shape = placed(kind, GENERAL @ scene_file.rotation([1, 0, 0], 180))["shape"] | {"emitter": light}
        scene = {"floor": {"type": "rectangle", "to_world": floor, "bsdf": white}, "light": shape, "sky": flat()}
        # Seen from below the light, so that only the floor is.
        look = mi.ScalarTransform4f().look_at(origin=[0, 0, -1.9], target=[0, 0, -2], up=[0, 1, 0])
        mean = relative_y(scene, sensor={"to_world": look})
        cells.append(f"`{kind}` {mean[0]:.4f} ± {mean[1]:.4f}")
    return ", ".join(cells)


def relative_y(scene, sensor):
    """Mean Y of direct light in 16 pictures, over that of radiance 1, and its standard error."""
    values = [picture(scene, spp=1024, seed=seed, depth=2, sensor=sensor)[..., 1].mean() for seed in range(16)]
    values = np.array(values) * mitsuba_scene.MITSUBA_Y_INTEGRAL / mitsuba_scene.ETALON_Y_INTEGRAL
    return values.mean(), values.std(ddof=1) / 4


@finding
def closed_lights():
    """A floor beside a black cylinder, or cube, whose walls emit inward only: 0 is right."""
    light = {"type": "area", "radiance": {"type": "uniform", "value": 1.0}}
    black = {"type": "diffuse", "reflectance": {"type": "uniform", "value": 0.0}}
    white = {"type": "diffuse", "reflectance": {"type": "uniform", "value": 1.0}}
    floor = transform(np.diag([20, 20, 1, 1.0]) + np.outer([0, 0, -2, 0], [0, 0, 0, 1]))
    tilted = scene_file.rotation([1, 0.7, 0], 35)
    cells = []
    for kind in ("cylinder", "cube"):
        scene = {"floor": {"type": "rectangle", "to_world": floor, "bsdf": white}}
        for part, (type_name, local) in mitsuba_scene.canonical_parts(kind).items():
            inward = {"flip_normals": True, "bsdf": black, "emitter": light}
            scene[f"light{part}"] = {"type": type_name, "to_world": transform(tilted @ local)} | inward
        look = mi.ScalarTransform4f().look_at(origin=[3, 0, 1], target=[3, 0, 0], up=[0, 1, 0])
        mean, error = relative_y(scene, sensor={"to_world": look})
        cells.append(f"`{kind}` {mean:.1e} ± {error:.1e}")
    return "Y " + ", ".join(cells)


@finding
def near_shadows():
    """Points of a floor under a card at some height, a lamp above: share whose shadow ray sees the lamp."""
    random = np.random.default_rng(2)
    places = random.uniform(-1, 1, (RAYS, 2))
    cells = []
    for height in (1e-5, 1e-4, 2e-4, 3e-4, 1e-3):
        card = transform(np.diag([2, 2, 1, 1.0]) + np.outer([0, 0, height, 0], [0, 0, 0, 1]))
        floor = {"type": "rectangle", "to_world": transform(np.diag([2, 2, 1, 1.0]))}
        scene = mi.load_dict({"type": "scene", "card": {"type": "rectangle", "to_world": card}, "floor": floor})
        origins = np.column_stack([places, np.full(RAYS, height / 2)]).T.astype(np.float32)
        seen = scene.ray_intersect(mi.Ray3f(mi.Point3f(*origins), mi.Vector3f(0, 0, -1)))
        hidden = np.array(scene.ray_test(seen.spawn_ray_to(mi.Point3f(0, 0, 3))))
        cells.append(f"{height:g}: {1 - hidden.mean():.0%}")
    return ", ".join(cells) + " (0 is right)"


@finding
def mirrored_spheres():
    """A diffuse ball of albedo 0.5 under a reflection, in light from everywhere."""
    bsdf = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "uniform", "value": 0.5}}}
    values = []
    for x in (1, -1):
        ball = {"type": "sphere", "to_world": transform(np.diag([2 * x, 2, 2, 1.0])), "bsdf": bsdf["bsdf"]}
        values.append(picture({"ball": ball, "sky": flat()}, spp=256)[..., 1].mean())
    return f"Y {values[0]:.4f} as it is, {values[1]:.4f} mirrored (0.5 times 1.0009 is right)"


@finding
def white_point():
    """Y of radiance 1 at all wavelengths."""
    standard = picture({"sky": flat()}, spp=4096, sampler="multijitter")[..., 1].mean()
    film = mitsuba_scene.make_film((16, 16), "observer")
    observer = picture({"sky": flat()}, spp=4096, sampler="multijitter", film=film)[..., 1].mean()
    observer /= mitsuba_scene.ETALON_Y_INTEGRAL
    ratio = mitsuba_scene.ETALON_Y_INTEGRAL / mitsuba_scene.MITSUBA_Y_INTEGRAL
    return f"`hdrfilm` {standard:.5f} ({ratio:.5f} follows from its constant), `specfilm`, 1 nm table {observer:.5f}"


@finding
def observer_table():
    """Colours of narrow lights by Mitsuba's observer and by the published one."""
    worst = np.zeros(3)
    for centre in range(420, 681, 20):
        nm = np.array([centre - 11, centre - 10, centre + 10, centre + 11.0])
        light = {"type": "constant", "radiance": mitsuba_scene.spectrum((nm, np.array([0, 1.0, 1, 0])))}
        options = {"spp": 4096, "sampler": "multijitter", "size": (4, 4)}
        own = picture({"sky": light}, **options).mean(axis=(0, 1)) * mitsuba_scene.MITSUBA_Y_INTEGRAL
        fine = np.linspace(nm[0], nm[-1], 2201)
        values = np.interp(fine, nm, [0, 1, 1, 0])
        true = [np.trapezoid(values * np.interp(fine, spectra.WHOLE_NM, bar), fine) for bar in spectra.observer()[0]]
        worst = np.maximum(worst, np.abs(own - true) / max(true))
    return "20 nm wide lights: largest error of X, Y, Z over the largest of them " + ", ".join(
        f"{w:.1e}" for w in worst
    )


@finding
def inside_of_an_emitting_sphere():
    """Albedo and emission 0.5 all round, seen from 5 units off the middle: 1 is right."""
    values = []
    grey = {"type": "diffuse", "reflectance": {"type": "uniform", "value": 0.5}}
    light = {"type": "area", "radiance": {"type": "uniform", "value": 0.5}}
    for kind, size in (("sphere", 5.2), ("sphere", 10), ("sphere", 100), ("cube", 10), ("cube", 100)):
        to_world = transform(np.diag([size, size, size, 1.0]))
        shape = {"type": kind, "flip_normals": True, "bsdf": grey, "emitter": light, "to_world": to_world}
        replicates = [picture({"shape": shape}, spp=4096, seed=seed)[..., 1].mean() for seed in range(4)]
        mean = np.mean(replicates) / mitsuba_scene.ETALON_Y_INTEGRAL * mitsuba_scene.MITSUBA_Y_INTEGRAL
        values.append(f"`{kind}` of half size {size}: {mean:.5f} ± {np.std(replicates, ddof=1) / 2:.5f}")
    return ", ".join(values)


@finding
def response_on_hdrfilm():
    """A sensor response on `hdrfilm`, Y over the true one; and a band on `specfilm`, which should be 1."""
    cells = []
    ramp, edges = np.array([[360.0, 0.0], [830, 1]]), np.array([[499.95, 0], [500.05, 1], [599.95, 1], [600.05, 0]])
    for name, (nm, values) in {"a ramp": ramp.T, "a box": edges.T}.items():
        sensor = {"srf": mitsuba_scene.spectrum((nm, values))}
        y = picture({"sky": flat()}, spp=4096, sampler="multijitter", sensor=sensor)[..., 1].mean()
        fine = np.linspace(360, 830, 47001)
        weight = np.interp(fine, nm, values) * np.interp(fine, spectra.WHOLE_NM, spectra.observer()[0][1])
        cells.append(f"`hdrfilm` {name} {y * mitsuba_scene.MITSUBA_Y_INTEGRAL / np.trapezoid(weight, fine):.5f}")
    film = mitsuba_scene.make_film((16, 16), "standard") | {"type": "specfilm", "box": mitsuba_scene.box(500, 600)}
    film.pop("pixel_format")
    box = picture({"sky": flat()}, spp=4096, sampler="multijitter", film=film)[..., 0].mean() / 100
    return ", ".join(cells) + f", `specfilm` {box:.5f}"


@finding
def single_precision_sums():
    """Y of one picture of constant radiance with many samples, over that with few."""
    cells = []
    options = {"size": (4, 4)}
    for value in (0.11, 1.0):
        few = picture({"sky": flat(value)}, spp=4096, sampler="multijitter", **options)[..., 1].mean()
        for spp in (65536, 262144, 1048576):
            many = picture({"sky": flat(value)}, spp=spp, **options)[..., 1].mean()
            cells.append(f"radiance {value}, {spp} spp {many / few - 1:+.3%}")
    return ", ".join(cells)


@finding
def sample_counts():
    """Samples that the samplers take when asked for 500."""
    kinds = ["independent", "stratified", "multijitter", "orthogonal", "ldsampler"]
    return ", ".join(f"`{kind}` {mi.load_dict({'type': kind, 'sample_count': 500}).sample_count()}" for kind in kinds)


@finding
def samplers_between_seeds():
    """Mean over pixels of the squared error of 256 joined pictures, over what their spread promises."""
    scene = {
        "ball": {"type": "sphere", "radius": 0.7, "bsdf": {"type": "diffuse"}},
        "lamp": {"type": "point", "position": [1, 2, 3], "intensity": {"type": "uniform", "value": 1.0}},
        "sky": flat(0.2),
    }
    options = {"size": (16, 16), "depth": 3}
    truth, variance = joined(scene, "multijitter", 256, 1024, 1000, options)
    cells = []
    for kind in ("independent", "multijitter", "stratified", "orthogonal", "ldsampler"):
        mean, own = joined(scene, kind, 256, 64, 0, options)
        seen = own > 0
        cells.append(f"`{kind}` {np.mean((mean - truth)[seen] ** 2) / np.mean((own + variance)[seen]):.2f}")
    return ", ".join(cells) + " (1 is right)"


@finding
def few_samples():
    """Pixels of many joined pictures of few paths, against independent ones: mean over pixels of the
    squared difference over what both spreads promise."""
    lamp = {"type": "area", "radiance": {"type": "uniform", "value": 4.0}}
    above = mi.ScalarTransform4f().translate([-1, 5, 1]).rotate([1, 0, 0], 90).scale(1.5)
    mirror = {"type": "conductor", "material": "none"}
    floor = mi.ScalarTransform4f().translate([0, -0.6, 0]).rotate([1, 0, 0], -90).scale(5)
    scene = {
        "ball": {"type": "sphere", "radius": 0.6, "center": [-0.7, 0, 0], "bsdf": {"type": "diffuse"}},
        "mirror": {"type": "sphere", "radius": 0.6, "center": [0.7, 0, 0], "bsdf": mirror},
        "floor": {"type": "rectangle", "to_world": floor, "bsdf": {"type": "diffuse"}},
        "lamp": {"type": "disk", "to_world": above, "emitter": lamp},
        "sky": flat(0.2),
    }
    options = {"size": (32, 32), "depth": 5}
    truth, variance = joined(scene, "independent", 64, 1024, 10_000, options)
    cells = []
    for kind, spp, count in (("independent", 4, 2000), ("multijitter", 4, 2000), ("multijitter", 9, 900)):
        mean, own = joined(scene, kind, count, spp, 0, options)
        seen = own > 0
        ratio = np.mean((mean - truth)[seen] ** 2 / (own + variance)[seen])
        cells.append(f"`{kind}` of {spp} paths {ratio:.2f}")
    return ", ".join(cells) + " (1 is right)"


def joined(scene, sampler, count, spp, first, options):
    """Mean Y of pictures with different seeds, and the variance of that mean."""
    pictures = [picture(scene, spp=spp, seed=first + seed, sampler=sampler, **options)[..., 1] for seed in range(count)]
    return np.mean(pictures, axis=0), np.var(pictures, axis=0, ddof=1) / count


@finding
def seeds_are_independent():
    """Variance of the mean of a picture between seeds, over that which its pixels' variances promise."""
    scene = {"ball": {"type": "sphere", "radius": 0.7, "bsdf": {"type": "diffuse"}}, "sky": flat()}
    cells = []
    for kind in ("independent", "multijitter"):
        pictures = np.array([picture(scene, spp=16, seed=s, sampler=kind, size=(24, 24))[..., 1] for s in range(200)])
        ratio = pictures.mean(axis=(1, 2)).var(ddof=1) / (pictures.var(axis=0, ddof=1).sum() / pictures[0].size ** 2)
        cells.append(f"`{kind}` {ratio:.2f} ± 0.10")
    return ", ".join(cells) + " (1 if pixels are independent)"


@finding
def depth_convention():
    """Between walls of albedo and emission 0.5: 0.5, 0.75, 0.875 for 1, 2, 3 segments."""
    grey = {"type": "diffuse", "reflectance": {"type": "uniform", "value": 0.5}}
    light = {"type": "area", "radiance": {"type": "uniform", "value": 0.5}}
    cube = {
        "type": "cube",
        "flip_normals": True,
        "bsdf": grey,
        "emitter": light,
        "to_world": transform(np.diag([10, 10, 10, 1.0])),
    }
    factor = mitsuba_scene.MITSUBA_Y_INTEGRAL / mitsuba_scene.ETALON_Y_INTEGRAL
    values = [picture({"cube": cube}, spp=1024, depth=depth)[..., 1].mean() * factor for depth in (1, 2, 3)]
    return "max_depth 1, 2, 3: " + ", ".join(f"{value:.4f}" for value in values)


@finding
def conductors():
    """A silver, an aluminium, a gold and a copper ball against Fresnel's formula, mean of the bands."""
    cells = []
    for metal in ("ag", "al", "au", "cu"):
        nm, n, k = spectra.read_csv(spectra.DATA / f"{metal}.csv")
        bsdf = {"type": "conductor", "eta": mitsuba_scene.spectrum((nm, n)), "k": mitsuba_scene.spectrum((nm, k))}
        film = mitsuba_scene.make_film((16, 16), "standard") | {"type": "specfilm", "box": mitsuba_scene.box(500, 600)}
        film.pop("pixel_format")
        ball = {"type": "sphere", "bsdf": bsdf}
        seen = picture({"ball": ball, "sky": flat()}, spp=4096, sampler="multijitter", film=film)[..., 0].mean() / 100
        fine = np.linspace(500, 600, 1001)
        r = ball_albedo(np.interp(fine, nm, n), np.interp(fine, nm, k)).mean()
        true = 1 - np.pi / 4 * (1 - r)
        cells.append(f"{metal.title()} {seen / true - 1:+.1e}")
    return ", ".join(cells) + " relative"


def ball_albedo(n, k):
    """∫ R(θ) 2 cos θ d cos θ of a metal, by Fresnel's formula averaged over polarisations."""
    cos = (np.arange(2000) + 0.5)[:, None] / 2000
    sin2 = 1 - cos**2
    root = np.sqrt((n + 1j * k) ** 2 - sin2)
    s = np.abs((cos - root) / (cos + root)) ** 2
    index2 = (n + 1j * k) ** 2
    p = np.abs((index2 * cos - root) / (index2 * cos + root)) ** 2
    return ((s + p) / 2 * 2 * cos).mean(axis=0)


@finding
def dispersion():
    """Glass with an index that depends on the wavelength."""
    index = mitsuba_scene.spectrum((np.array([400.0, 700.0]), np.array([1.6, 1.5])))
    try:
        mi.load_dict({"type": "dielectric", "int_ior": index})
    except Exception as error:  # whatever its kind, the words are the finding
        return f"refused: {str(error).strip().splitlines()[-1].strip()[:120]}"
    return "accepted"


@finding
def threads_and_filters():
    """Whether the picture is the same with one and two threads."""
    import drjit

    scene = {"ball": {"type": "sphere", "bsdf": {"type": "diffuse"}}, "sky": flat()}
    cells = []
    for kind in ("box", "gaussian"):
        film = mitsuba_scene.make_film((256, 256), "standard") | {"rfilter": {"type": kind}}
        pictures = []
        for threads in (1, 2, 2):
            drjit.set_thread_count(threads)
            pictures.append(picture(scene, spp=64, film=film))
        same = all(np.array_equal(pictures[0], other) for other in pictures[1:])
        cells.append(f"`{kind}` {'the same bits' if same else 'other bits'}")
    return ", ".join(cells)


def elsewhere(code, **environment):
    """Exit code and last line of a Python program of its own."""
    result = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | environment,
        timeout=60,
    )
    lines = (result.stderr.strip() or result.stdout.strip()).splitlines()
    return result.returncode, lines[-1][:120] if lines else ""


@finding
def old_llvm():
    """The llvm variants with the library of LLVM 15."""
    library = "/usr/lib/x86_64-linux-gnu/libLLVM-15.so"
    if not os.path.exists(library):
        return "not checked, no LLVM 15 here"
    code = (
        "import mitsuba as mi; mi.set_variant('llvm_ad_spectral'); "
        "print(mi.render(mi.load_dict(mi.cornell_box()), spp=1).shape)"
    )
    return "exit code {}: {}".format(*elsewhere(code, DRJIT_LIBLLVM_PATH=library))


@finding
def exr_with_one_thread():
    """Writing an EXR by `Bitmap.write` with a pool of one thread."""
    code = (
        "import mitsuba as mi, numpy as np, drjit; mi.set_variant('llvm_ad_rgb'); drjit.set_thread_count(1); "
        "import os, tempfile; name = os.path.join(tempfile.mkdtemp(), 'x.exr'); "
        "mi.Bitmap(np.zeros((64, 64, 3), np.float32)).write(name); print('written')"
    )
    try:
        return "exit code {}: {}".format(*elsewhere(code))
    except subprocess.TimeoutExpired:
        return "does not end within a minute"


@finding
def irregular_spectra_in_rgb():
    """A spectrum of unequal steps in an RGB variant."""
    code = (
        "import mitsuba as mi, numpy as np; mi.set_variant('scalar_rgb'); "
        "s = {'type': 'irregular', 'wavelengths': '400,500,700', 'values': '1,1,1'}; "
        "d = {'type': 'scene', 'integrator': {'type': 'path'}, 'sky': {'type': 'constant', 'radiance': s}, "
        "'sensor': {'type': 'perspective', 'film': {'type': 'hdrfilm', 'width': 4, 'height': 4}}}; "
        "print(np.array(mi.render(mi.load_dict(d), spp=4)).mean())"
    )
    return "exit code {}: {}".format(*elsewhere(code))


def main():
    """Prints the findings asked for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("names", nargs="*", help="parts of names")
    parser.add_argument("--variant", default=mitsuba_scene.DEFAULT_VARIANT)
    parser.add_argument("--threads", type=int, default=0)
    arguments = parser.parse_args()
    mitsuba_scene.set_variant(arguments.variant, arguments.threads)
    mi.set_log_level(mi.LogLevel.Error)
    print(f"Mitsuba {mi.__version__}, {arguments.variant}\n\n| experiment | result |\n|---|---|")
    for name, function in FINDINGS.items():
        if not arguments.names or any(part in name for part in arguments.names):
            question = " ".join(function.__doc__.split())
            print(f"| `{name}`: {question} | {function()} |", flush=True)


if __name__ == "__main__":
    main()
