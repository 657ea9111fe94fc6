#!/usr/bin/env python3
"""Renders a referenced scene in Mitsuba 3 at several sample counts, as a table for `etalon chart`.

    tools/mitsuba_study.py cornell_box --spp 16 64 256 -o mitsuba.csv

One row is one render (columns: scenes/README.md, "Tables of renders"). Seconds are those of a warm
render: the kernel is compiled and the scene loaded before, nothing is written. The errors are against
reference/NAME.exr, whose seeds are others; its variance is taken off the squares.
"""

import argparse
import csv
import sys
import time
from pathlib import Path

import numpy as np

import mitsuba_scene
import reference_file
from scene_file import SceneError

EPSILON = 1e-4
COLUMNS = ["renderer", "scene", "panel", "settings", "sampler", "wavelengths", "max_depth", "spp", "replicate", "seed"]
COLUMNS += ["threads", "seconds", "samples", "rmse", "relmse", "bias", "bias_standard_error"]
COLUMNS += ["reference", "reference_rmse", "reference_relmse"]
# Wavelengths of a path in the spectral variants.
WAVELENGTHS = 4


def errors(picture, mean, variance):
    """Columns of the errors of R, G, B (height×width×3) against a mean with its variance."""
    pixels = mean.shape[0] * mean.shape[1]
    whole = mean.mean(axis=(0, 1))
    scale = mean**2 + EPSILON * whole**2
    difference = picture - mean
    mse = np.mean(difference**2 - variance)
    spread = difference.std(axis=(0, 1), ddof=1) / np.sqrt(pixels) / whole
    return {
        "rmse": np.copysign(np.sqrt(abs(mse)), mse),
        "relmse": np.mean((difference**2 - variance) / scale),
        "bias": np.mean(difference.mean(axis=(0, 1)) / whole),
        "bias_standard_error": np.sqrt(np.sum(spread**2)) / 3,
        "reference_rmse": np.sqrt(variance.mean()),
        "reference_relmse": np.mean(variance / scale),
    }


def rows(reference, arguments):
    """A row for each sampler, sample count and seed."""
    _, channels = reference_file.read(reference.file)
    mean, variance = (np.stack([channels[prefix + name] for name in "RGB"], axis=-1) for prefix in ("", "variance."))
    tables = reference.tables()
    film = mitsuba_scene.make_film(tables["image"]["size"], "observer")
    for sampler in arguments.samplers:
        for spp in arguments.spp:
            tables["image"]["spp"] = spp
            scene = mitsuba_scene.load_tables(tables, reference.path.parent, sampler, 0, film)
            taken = scene.sensors()[0].sampler().sample_count()
            mitsuba_scene.render(scene)
            for replicate in range(arguments.replicates):
                start = time.perf_counter()
                xyz = mitsuba_scene.render(scene, replicate + 1)
                seconds = time.perf_counter() - start
                yield {
                    "renderer": f"mitsuba {arguments.variant}",
                    "scene": reference.path.stem,
                    "panel": reference.panel or "",
                    "settings": " ".join(reference.set),
                    "sampler": sampler,
                    "wavelengths": WAVELENGTHS,
                    "max_depth": tables["image"].get("max_depth", ""),
                    "spp": taken,
                    "replicate": replicate,
                    "seed": replicate + 1,
                    "threads": arguments.threads,
                    "seconds": f"{seconds:.6f}",
                    "samples": taken * mean[..., 0].size,
                    "reference": f"reference/{reference.name}.exr",
                } | {key: f"{value:.6e}" for key, value in errors(mitsuba_scene.to_rgb(xyz), mean, variance).items()}


def main():
    """Writes the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("name", help="a reference that is there (tools/reference.py --list)")
    parser.add_argument("--samplers", nargs="+", default=["independent", "multijitter"])
    parser.add_argument("--spp", type=int, nargs="+", default=[16, 64, 256, 1024])
    parser.add_argument("--replicates", type=int, default=4, help="renders at each point (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--variant", default=mitsuba_scene.DEFAULT_VARIANT)
    parser.add_argument("-o", "--output", type=Path, help="default: standard output")
    arguments = parser.parse_args()
    mitsuba_scene.set_variant(arguments.variant, arguments.threads)
    known = reference_file.known()
    if arguments.name not in known or not known[arguments.name].file.exists():
        sys.exit(f"error: there is no reference {arguments.name!r}; there are: {', '.join(known)}")
    try:
        output = arguments.output.open("w", newline="") if arguments.output else sys.stdout
        writer = csv.DictWriter(output, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for row in rows(known[arguments.name], arguments):
            writer.writerow(row)
            output.flush()
    except (SceneError, OSError) as error:
        sys.exit(f"error: {arguments.name}: {error}")


if __name__ == "__main__":
    main()
