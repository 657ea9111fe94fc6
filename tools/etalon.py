"""Runs the etalon binary and reads its pictures."""

import resource
import subprocess
import time
from pathlib import Path

import numpy as np
import OpenEXR

import spectra

ROOT = Path(__file__).resolve().parent.parent
BINARY = ROOT / "target" / "release" / "etalon"


class EtalonError(Exception):
    """The binary is missing or gave up."""


def render(scene, output, arguments, **image):
    """Renders to the file `output` with the command line's `binary`, `threads` and `wavelengths`;
    `image` are options that stand for keys of [image], such as spp=64 or size=(64, 48). Returns
    seconds of the whole process, by the clock and of the processors together."""
    options = []
    for key, value in (image | {"wavelengths": arguments.wavelengths}).items():
        if value is not None:
            text = "x".join(map(str, value)) if key == "size" else str(value)
            options += [f"--{key.replace('_', '-')}", text]
    return run(arguments.binary, scene, output, options, arguments.threads)


def run(binary, scene, output, options, threads):
    """Renders with options as on the command line; returns seconds as [`render`]."""
    command = [str(binary), "render", str(scene), "-o", str(output), "--quiet", "--threads", str(threads), *options]
    before = children_seconds()
    start = time.perf_counter()
    try:
        result = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        raise EtalonError(f"{binary}: {error.strerror}; build it with cargo build --release") from error
    seconds = np.array([time.perf_counter() - start, children_seconds() - before])
    if result.returncode != 0:
        raise EtalonError(f"{' '.join(command)}\n{result.stderr.strip()}")
    return seconds


def children_seconds():
    """Processor seconds of the processes that have ended, over all their threads."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def read_xyz(path):
    """Linear XYZ (height×width×3, float64) of a picture with channels R, G, B."""
    channels = OpenEXR.File(str(path), separate_channels=True).channels()
    rgb = np.stack([channels[name].pixels for name in "RGB"], axis=-1).astype(np.float64)
    return rgb @ np.linalg.inv(spectra.XYZ_TO_RGB).T
