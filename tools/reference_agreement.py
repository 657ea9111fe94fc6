"""How well etalon agrees with a reference: means of the picture, colour and bands."""

import json
import math
import tempfile
from pathlib import Path

import numpy as np
from scipy import stats

import etalon
import reference_file


def student_limit(level, freedom):
    """|t| that is exceeded with this probability, both sides."""
    return float(stats.t.isf(level / 2, freedom))


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
        z = (a - b) / error if error else math.copysign(math.inf, a - b) if a != b else 0.0
        print(
            f"| {reference.name} | {name} | {a:.6g} | {b:.6g} | {1e2 * (a / b - 1):+.3f} % "
            f"| {1e2 * error / b:.3f} % | {z:+.2f} |",
            flush=True,
        )
