"""Whether etalon and Mitsuba compute the same picture: independent replicates of both."""

import math

import numpy as np

import etalon
import mitsuba_scene

# Seeds of replicates; pictures that are measured against a reference have others.
FIRST_SEED = 1000


def etalon_pictures(path, image, arguments, folder):
    """Independent pictures (replicate×height×width×3), linear XYZ."""
    pictures = []
    for seed in range(FIRST_SEED, FIRST_SEED + arguments.replicates):
        output = folder / "replicate.exr"
        etalon.render(path, output, arguments, **image | {"spp": arguments.spp, "seed": seed})
        pictures.append(etalon.read_xyz(output))
    return np.array(pictures)


def mitsuba_pictures(path, image, arguments):
    """Independent pictures (replicate×height×width×3), linear XYZ by the published observer."""
    options = image | {"spp": arguments.spp}
    scene = mitsuba_scene.load(path, image=options, sampler="multijitter", film="observer")
    seeds = range(FIRST_SEED, FIRST_SEED + arguments.replicates)
    return np.array([mitsuba_scene.render(scene, seed) for seed in seeds])


def mean_and_error(pictures):
    """Mean over replicates and its standard error."""
    return pictures.mean(axis=0), pictures.std(axis=0, ddof=1) / math.sqrt(len(pictures))


def table(path, image, arguments, folder):
    """Prints means of the picture, and how far its pixels are apart in standard errors."""
    ours = etalon_pictures(path, image, arguments, folder)
    theirs = mitsuba_pictures(path, image, arguments)
    print(f"{path.stem}: {image['size']}, {arguments.replicates} replicates × {arguments.spp} paths a pixel")
    print("| mean | etalon | standard error | Mitsuba | standard error | difference / Mitsuba | in standard errors |")
    print("|---|---|---|---|---|---|---|")
    for axis, name in enumerate("XYZ"):
        (a, error_a), (b, error_b) = (
            mean_and_error(pictures[..., axis].mean(axis=(1, 2))) for pictures in (ours, theirs)
        )
        z = (a - b) / math.hypot(error_a, error_b)
        print(f"| {name} | {a:.7f} | {error_a:.1e} | {b:.7f} | {error_b:.1e} | {(a - b) / b:+.2e} | {z:+.2f} |")
    print(f"\nPixels of Y: mean square of difference / standard error {pixel_statistic(ours, theirs)}\n")


def pixel_statistic(ours, theirs):
    """Mean of t² over pixels, and what it is for equal pictures: n/(n − 2) of Student's t with the
    2 (K − 1) degrees of freedom of two times K replicates of the same variance."""
    (a, error_a), (b, error_b) = (mean_and_error(pictures[..., 1]) for pictures in (ours, theirs))
    seen = np.hypot(error_a, error_b) > 0
    squares = (a - b)[seen] ** 2 / (error_a**2 + error_b**2)[seen]
    freedom = 2 * (len(ours) - 1)
    return f"{squares.mean():.3f} over {seen.sum()} pixels (about {freedom / (freedom - 2):.3f} if equal)"
