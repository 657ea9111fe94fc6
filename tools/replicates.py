"""Independent pictures of one scene by Mitsuba, each with colour and spectral bands.

Glass with dispersion has no counterpart in Mitsuba, whose index of refraction is one number. Such a
scene is rendered one wavelength at a time, with the index at that wavelength: the spectrum is cut
into strata of `STRATUM` nm, replicate r of K looks at one wavelength in each, and over the replicates
these are the middles of K equal parts of the stratum, in an order drawn for each stratum. The mean is
then a midpoint rule of STRATUM/K nm, and the spread of the replicates holds the spread within strata.
"""

import mitsuba as mi
import numpy as np

import mitsuba_scene
import spectra
from reference_file import BANDS
from scene_file import SceneError

# nm. What crosses the picture with the wavelength differs within a stratum, and the error counts that
# difference as noise: with 5 nm it was the larger part of the prism's error by a factor of ten.
STRATUM = 1.0
# Fewest paths of Mitsuba's `multijitter` that were seen to be right.
LEAST_JITTERED = 9
# Width about a wavelength, nm. Its ends are whole multiples of 1/1024 nm, which single precision holds.
LINE = 1 / 8


def has_dispersion(tables):
    """Whether glass whose index depends on the wavelength is on an object of the scene."""
    used = {entry["material"] for entry in tables.get("object", [])}
    glasses = [tables["materials"][name]["glass"] for name in used if "glass" in tables["materials"][name]]
    return any(mitsuba_scene.has_dispersion(glass) for glass in glasses)


def choose_variant(tables, variant, threads=0):
    """Sets Mitsuba's variant: many small pictures of one wavelength each are faster in the scalar one,
    which compiles nothing, and ellipsoids are right there only."""
    scalar = has_dispersion(tables) or mitsuba_scene.needs_double(tables)
    mitsuba_scene.set_variant("scalar_spectral" if scalar else variant, threads)


def pictures(reference, first_seed):
    """Yields `reference.replicates` pictures (height×width×channel, float64): linear Rec. 709, then
    mean spectral radiance in each band."""
    if reference.sampler == "multijitter" and reference.spp < LEAST_JITTERED:
        raise SceneError(
            f"multijitter is wrong on average with fewer than {LEAST_JITTERED} paths (few_samples in "
            f"reference/README.md): ask for --spp {LEAST_JITTERED}, or for --sampler independent"
        )
    tables = reference.tables()
    tables["image"] |= {"spp": reference.spp}
    each = by_wavelength if has_dispersion(tables) else all_wavelengths
    for xyz, bands in each(reference, tables, first_seed):
        yield np.concatenate([mitsuba_scene.to_rgb(xyz), bands], axis=-1)


def all_wavelengths(reference, tables, first_seed):
    """Pictures with four wavelengths a path."""
    film = mitsuba_scene.make_film(tables["image"]["size"], "observer", BANDS)
    scene = mitsuba_scene.load_tables(tables, reference.path.parent, reference.sampler, 0, film)
    widths = np.array([high - low for low, high in BANDS])
    for seed in range(first_seed, first_seed + reference.replicates):
        values = np.array(mi.render(scene, seed=seed), np.float64)
        yield values[..., :3] / mitsuba_scene.ETALON_Y_INTEGRAL, values[..., 3:] / widths


def by_wavelength(reference, tables, first_seed):
    """Pictures that are sums of pictures of one wavelength each."""
    lows = np.arange(spectra.NM_MIN, spectra.NM_MAX, STRATUM)
    count = reference.replicates
    order = np.argsort(np.random.default_rng(first_seed).random((len(lows), count)), axis=1)
    bars, integral = spectra.observer()
    width, height = tables["image"]["size"]
    for replicate in range(count):
        xyz, bands = np.zeros((height, width, 3)), np.zeros((height, width, len(BANDS)))
        for index, low in enumerate(lows):
            nm = low + (order[index, replicate] + 0.5) / count * STRATUM
            seed = first_seed + replicate * len(lows) + index
            radiance = at_wavelength(reference, tables, nm, seed)[..., None]
            weights = [np.interp(nm, spectra.WHOLE_NM, bar) for bar in bars]
            xyz += radiance * weights * STRATUM / integral
            inside = [(a <= low < b) * STRATUM / (b - a) for a, b in BANDS]
            bands += radiance * inside
        yield xyz, bands


def at_wavelength(reference, tables, nm, seed):
    """Spectral radiance (height×width) within `LINE` about a wavelength, with the indices there."""
    low = np.round((nm - LINE / 2) * 1024) / 1024
    size = tables["image"]["size"]
    sensitivity = {"type": "regular", "wavelength_min": low, "wavelength_max": low + LINE, "values": "1,1,1,1,1"}
    film = mitsuba_scene.make_film(size, "standard") | {"type": "specfilm", "line": sensitivity}
    film.pop("pixel_format")
    scene = mitsuba_scene.load_tables(tables, reference.path.parent, reference.sampler, seed, film, nm)
    return np.array(mi.render(scene, seed=seed), np.float64)[..., 0] / LINE


def mean_and_variance(replicates):
    """Mean over the replicates and variance of that mean, by Welford's method; mean over all pixels
    and its standard error, from the replicates' means alone."""
    count, mean, square, wholes = 0, 0.0, 0.0, []
    for picture in replicates:
        count += 1
        step = picture - mean
        mean = mean + step / count
        square = square + step * (picture - mean)
        wholes.append(picture.mean(axis=(0, 1)))
    wholes = np.array(wholes)
    error = wholes.std(axis=0, ddof=1) / np.sqrt(count)
    return mean, square / (count - 1) / count, wholes.mean(axis=0), error
