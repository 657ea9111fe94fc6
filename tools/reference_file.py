"""Reference pictures: a mean over replicates, its variance and where it comes from, as OpenEXR."""

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenEXR

import scene_file

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "reference"
# Neighbouring bands of 50 nm: `etalon render --layers spectral:405-755:50`.
BANDS = [[380 + 50 * i, 430 + 50 * i] for i in range(8)]
BAND_LAYER = "spectral:405-755:50"
DEFAULTS = {"panel": None, "set": [], "spp": 256, "replicates": 16, "sampler": "multijitter"}


@dataclass
class Reference:
    """What is to be rendered: a scene file (relative to the project), one of its panels or None,
    `key=value` overrides, paths per pixel and replicate, replicates, and Mitsuba's sampler.

    With dispersive glass `spp` is per pixel, replicate and wavelength."""

    name: str
    scene: str
    panel: str | None
    set: list
    spp: int
    replicates: int
    sampler: str

    @property
    def path(self):
        """The scene file."""
        return ROOT / self.scene

    @property
    def file(self):
        """The picture."""
        return FOLDER / f"{self.name}.exr"

    def tables(self):
        """The scene with panel and overrides laid over it."""
        return scene_file.load(self.path, self.panel, self.set)


def known():
    """The references of the project, by name."""
    entries = scene_file.load(FOLDER / "references.toml")["reference"]
    return {entry["name"]: Reference(**DEFAULTS | entry) for entry in entries}


def channel_names(bands=BANDS):
    """Names of the channels of a mean: colour, then bands as etalon's src/film/spectral.rs."""
    middles = [f"{(low + high) / 2:.6f}".replace(".", ",") for low, high in bands]
    return ["R", "G", "B", *(f"S0.{middle}nm" for middle in middles)]


def scene_attributes(reference):
    """What identifies the scene: its text and the files that its spectra come from."""
    text = reference.path.read_bytes()
    attributes = {"sceneFile": reference.scene, "sceneHash": hashlib.sha256(text).hexdigest()}
    files = scene_file.csv_files(scene_file.load(reference.path))
    if files:
        content = b"".join((reference.path.parent / name).read_bytes() for name in files)
        attributes |= {"dataFiles": " ".join(files), "dataHash": hashlib.sha256(content).hexdigest()}
    if reference.panel:
        attributes["panel"] = reference.panel
    if reference.set:
        attributes["overrides"] = " ".join(text.replace(" ", "") for text in reference.set)
    return attributes


def stale(reference, settings):
    """Why the picture must be rendered (again): a sentence, or None if it is up to date.

    `settings`: further attributes that it must have."""
    if not reference.file.exists():
        return "it is missing"
    header = read_header(reference.file)
    expected = scene_attributes(reference) | settings | {"replicates": reference.replicates, "bands": json.dumps(BANDS)}
    expected |= {"sampler": reference.sampler, "sppAsked": reference.spp}
    for key, value in expected.items():
        if header.get(key) != value:
            return f"{key} was {header.get(key)!r} and is now {value!r}"
    for key in ("panel", "overrides", "dataHash"):
        if key in header and key not in expected:
            return f"it was made with {key} {header[key]!r}"
    return None


def read_header(path):
    """Attributes of a picture."""
    return OpenEXR.File(str(path), header_only=True).header()


def read(path):
    """Attributes of a picture, and its channels (height×width, float64) by name."""
    file = OpenEXR.File(str(path), separate_channels=True)
    channels = {name: channel.pixels.astype(np.float64) for name, channel in file.channels().items()}
    return file.header(), channels


def write(path, mean, variance, attributes):
    """Writes means and their variances (height×width×channel) in single precision."""
    channels = {}
    for index, name in enumerate(channel_names()):
        channels[name] = np.ascontiguousarray(mean[..., index], np.float32)
        channels[f"variance.{name}"] = np.ascontiguousarray(variance[..., index], np.float32)
    header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION} | attributes
    header |= {"spectralLayoutVersion": "1.0", "emissiveUnits": "W.m^-2.sr^-1", "bands": json.dumps(BANDS)}
    partial = path.with_suffix(".partial.exr")
    OpenEXR.File(header, channels).write(str(partial))
    partial.replace(path)
