"""How well etalon agrees with a reference: means of the picture, colour and bands."""

import json
import math
import tempfile
from pathlib import Path

import numpy as np
from scipy import stats

import etalon
import reference_file


def welch(a, b, level):
    """Difference of two (mean, standard error, replicates) in combined standard errors, and what it
    exceeds by chance with probability `level`: Student's t with the degrees of freedom of Welch
    (1947)."""
    (mean_a, error_a, count_a), (mean_b, error_b, count_b) = a, b
    error = math.hypot(error_a, error_b)
    if error == 0:
        return (0.0 if mean_a == mean_b else math.inf), 0.0
    freedom = error**4 / (error_a**4 / (count_a - 1) + error_b**4 / (count_b - 1))
    return (mean_a - mean_b) / error, float(stats.t.isf(level / 2, freedom))


def heading():
    """Prints the head of the table."""
    print("| reference | channel | etalon | reference | difference | combined standard error | in standard errors |")
    print("|---|---|---|---|---|---|---|")


def etalon_means(reference, folder, arguments):
    """Means over the picture (seed×channel) of pictures by etalon."""
    output = Path(folder) / "picture.exr"
    options = ["--layers", reference_file.BAND_LAYER, "--spp", str(arguments.etalon_spp)]
    options += ["--panel", reference.panel] if reference.panel else []
    for override in reference.set:
        options += ["--set", override]
    result = []
    for seed in range(1, arguments.seeds + 1):
        etalon.run(arguments.binary, reference.path, output, [*options, "--seed", str(seed)], arguments.threads or 2)
        _, channels = reference_file.read(output)
        result.append([channels[name].mean() for name in reference_file.channel_names()])
    return np.array(result)


def compare(reference, path, arguments):
    """Prints a line for each channel."""
    header = reference_file.read_header(path)
    means, errors = (json.loads(header[key]) for key in ("channelMeans", "channelStandardErrors"))
    with tempfile.TemporaryDirectory() as folder:
        ours = etalon_means(reference, folder, arguments)
    for index, name in enumerate(reference_file.channel_names()):
        a, b = ours[:, index].mean(), means[name]
        if b == 0:
            print(f"| {reference.name} | {name} | {a:.6g} | 0 | | | |")
            continue
        own = ours[:, index].std(ddof=1) / math.sqrt(len(ours))
        error = math.hypot(own, errors[name])
        z, limit = welch((a, own, len(ours)), (b, errors[name], header["replicates"]), 1e-3)
        print(
            f"| {reference.name} | {name} | {a:.6g} | {b:.6g} | {1e2 * (a / b - 1):+.3f} % "
            f"| {1e2 * error / b:.3f} % | {z:+.2f}{' (!)' if abs(z) > limit else ''} |",
            flush=True,
        )
