"""How well etalon agrees with a reference: means of the picture, colour and bands.

The standard error of a picture's mean comes from the variances of its pixels, which are drawn
independently. Thousands of pixels give it so many degrees of freedom that the quotient of difference
and standard error is normal.
"""

import math
import tempfile
from pathlib import Path
from statistics import NormalDist

import numpy as np

import etalon
import reference_file

# Probability that a channel is marked although both sides are right.
LEVEL = 1e-3


def limit(level):
    """Standard errors that a normal number exceeds with this probability, both sides."""
    return -NormalDist().inv_cdf(level / 2)


def mean_and_error(values, variance):
    """Mean over pixels and its standard error, from the variance of each pixel."""
    return float(values.mean()), math.sqrt(variance.sum()) / variance.size


def deviation(a, b):
    """Difference of two (mean, standard error) in combined standard errors."""
    error = math.hypot(a[1], b[1])
    if error == 0:
        return 0.0 if a[0] == b[0] else math.copysign(math.inf, a[0] - b[0])
    return (a[0] - b[0]) / error


def heading():
    """Prints the head of the table."""
    print("| reference | channel | etalon | reference | difference | combined standard error | in standard errors |")
    print("|---|---|---|---|---|---|---|")


def etalon_pictures(reference, arguments):
    """Pictures by etalon (seed×height×width×channel)."""
    options = ["--layers", reference_file.BAND_LAYER, "--spp", str(arguments.etalon_spp)]
    options += ["--panel", reference.panel] if reference.panel else []
    for override in reference.set:
        options += ["--set", override]
    result = []
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "picture.exr"
        for seed in range(1, arguments.seeds + 1):
            seeded = [*options, "--seed", str(seed)]
            etalon.run(arguments.binary, reference.path, output, seeded, arguments.threads or 2)
            _, channels = reference_file.read(output)
            result.append(np.stack([channels[name] for name in reference_file.channel_names()], axis=-1))
    return np.array(result)


def compare(reference, path, arguments):
    """Prints a line for each channel; marks what one honest channel in a thousand exceeds."""
    _, channels = reference_file.read(path)
    pictures = etalon_pictures(reference, arguments)
    mean, variance = pictures.mean(axis=0), pictures.var(axis=0, ddof=1) / len(pictures)
    for index, name in enumerate(reference_file.channel_names()):
        a = mean_and_error(mean[..., index], variance[..., index])
        b = mean_and_error(channels[name], channels[f"variance.{name}"])
        if b[0] == 0:
            print(f"| {reference.name} | {name} | {a[0]:.6g} | 0 | | | |")
            continue
        z = deviation(a, b)
        print(
            f"| {reference.name} | {name} | {a[0]:.6g} | {b[0]:.6g} | {1e2 * (a[0] / b[0] - 1):+.3f} % "
            f"| {1e2 * math.hypot(a[1], b[1]) / b[0]:.3f} % | {z:+.2f}{' (!)' if abs(z) > limit(LEVEL) else ''} |",
            flush=True,
        )
