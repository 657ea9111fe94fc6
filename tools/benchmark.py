#!/usr/bin/env python3
"""Compares etalon with Mitsuba 3 on the same scene files, side by side on the same machine.

    tools/benchmark.py                       camera paths per second, as a Markdown table
    tools/benchmark.py --convergence         error of the picture over paths per pixel
    tools/benchmark.py --agreement           means of the picture with their standard errors

Same size, paths per pixel, depth, box filter and number of threads on both sides. Speed: both are
timed warm at the paths per pixel asked for and at 1, alternating, and the times subtracted, so that
start-up, compilation and the writing of files count on neither side. The ratio of rates by processor
time is there because other work on the machine disturbs it less.
"""

import argparse
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np

import agreement
import convergence
import etalon
import mitsuba_scene
import scene_file

SCENES = ["cornell_box", "fig1_cube", "fig2_cylinder", "fig7_mirrors", "fig8_lens"]
SAMPLERS = [("independent", "independent"), ("sobol", "multijitter")]
CORNELL_DEPTH = 8


def scaled_size(size, pixels):
    """A size of about this many pixels in the same proportions."""
    factor = (pixels / (size[0] * size[1])) ** 0.5
    return [max(1, round(length * factor)) for length in size]


def etalon_seconds(path, image, arguments, folder):
    """Seconds of a render without its start-up: by the clock, and of the processors together."""

    def seconds(spp):
        return etalon.render(path, folder / "speed.exr", arguments, **image | {"spp": spp})

    return seconds(image["spp"]) - seconds(1)


class MitsubaTimer:
    """Two warm Mitsuba scenes, one with 1 path per pixel."""

    def __init__(self, path, image):
        self.scenes = [
            mitsuba_scene.load(path, image=image | {"spp": spp}, sampler=image["sampler"], fast=True)
            for spp in (image["spp"], 1)
        ]
        for scene in self.scenes:
            mitsuba_scene.render(scene)

    def seconds(self, seed):
        """As [`etalon_seconds`]."""
        times = []
        for scene in self.scenes:
            start = np.array([time.perf_counter(), time.process_time()])
            mitsuba_scene.render(scene, seed)
            times.append([time.perf_counter(), time.process_time()] - start)
        return times[0] - times[1]

    def spp(self):
        """Paths per pixel that Mitsuba really takes; some samplers round up."""
        return self.scenes[0].sensors()[0].sampler().sample_count()


def speed_row(path, samplers, arguments, folder):
    """One line of the table: alternating runs of one scene with a pair of samplers."""
    scene = scene_file.load(path)["image"]
    image = {"size": scaled_size(scene["size"], arguments.pixels), "spp": arguments.spp}
    depth = CORNELL_DEPTH if path.stem == "cornell_box" else scene.get("max_depth")
    image |= {"max_depth": depth} if depth else {}
    timer = MitsubaTimer(path, image | {"sampler": samplers[1]})
    pixels = image["size"][0] * image["size"][1]
    ours, theirs = [], []
    for seed in range(1, arguments.rounds + 1):
        paths = pixels * (arguments.spp - 1)
        ours.append(paths / etalon_seconds(path, image | {"sampler": samplers[0], "seed": seed}, arguments, folder))
        theirs.append(pixels * (timer.spp() - 1) / timer.seconds(seed))
    ours, theirs = np.array(ours), np.array(theirs)
    width, height = image["size"]
    rates = [f"{rate / 1e6:.2f}" for rate in (np.median(ours[:, 0]), np.median(theirs[:, 0]))]
    spreads = [f"{np.min(r):.2f} / {np.median(r):.2f} / {np.max(r):.2f}" for r in (ours / theirs).T]
    cells = [path.stem, f"{width}×{height}", str(depth or "∞"), " / ".join(samplers), *rates, *spreads]
    return "| " + " | ".join(cells) + " |"


def speed(paths, arguments, folder):
    """Prints the table of speeds."""
    print(f"Camera paths per second; {arguments.spp} paths a pixel, box filter, {arguments.threads} threads each,")
    wavelengths = arguments.wavelengths or "as planned (`etalon info`)"
    print(f"{arguments.rounds} alternating rounds. Wavelengths a path: etalon {wavelengths}, Mitsuba 4.")
    print(f"Mitsuba {mitsuba_scene.mi.__version__} {arguments.variant}, Russian roulette at its own default depth.\n")
    columns = ["scene", "size", "depth", "samplers (etalon / Mitsuba)", "etalon, 10⁶/s", "Mitsuba, 10⁶/s"]
    columns += ["ratio min / median / max", "the same by processor time"]
    print("| " + " | ".join(columns) + " |\n|" + "---|" * len(columns))
    for path in paths:
        for samplers in SAMPLERS:
            try:
                print(speed_row(path, samplers, arguments, folder), flush=True)
            except scene_file.SceneError as error:
                print(f"{path}: skipped, {error}", file=sys.stderr)
                break


def parse_arguments():
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("scenes", nargs="*", type=Path, help="scene files (default: those of the report that exist)")
    mode = parser.add_mutually_exclusive_group()
    mode.add_argument("--convergence", action="store_true", help="error of the picture over paths per pixel")
    mode.add_argument("--agreement", action="store_true", help="means of the picture with their standard errors")
    parser.add_argument("--pixels", type=int, help="size of the picture (default: 65536, for the other two 4096)")
    parser.add_argument("--spp", type=int, help="paths per pixel (default: 256; reference and agreement: 4096)")
    parser.add_argument("--rounds", type=int, default=5, help="alternating rounds (default: %(default)s)")
    parser.add_argument("--replicates", type=int, default=8, help="pictures of a reference (default: %(default)s)")
    parser.add_argument("--wavelengths", type=int, choices=[4, 8], help="per path, for etalon")
    parser.add_argument("--threads", type=int, default=2, help="for each side (default: %(default)s)")
    parser.add_argument("--binary", type=Path, default=etalon.BINARY)
    parser.add_argument("--variant", default=mitsuba_scene.DEFAULT_VARIANT)
    arguments = parser.parse_args()
    is_speed = not (arguments.convergence or arguments.agreement)
    arguments.pixels = arguments.pixels or (65536 if is_speed else 4096)
    arguments.spp = arguments.spp or (256 if is_speed else 4096)
    if not arguments.scenes:
        known = [etalon.ROOT / "scenes" / f"{name}.toml" for name in SCENES]
        arguments.scenes = [path for path in known if path.exists()]
    return arguments


def main():
    """Runs the comparison that was asked for."""
    arguments = parse_arguments()
    mitsuba_scene.set_variant(arguments.variant, arguments.threads)
    warnings.simplefilter("once")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            if not (arguments.convergence or arguments.agreement):
                return speed(arguments.scenes, arguments, folder)
            for path in arguments.scenes:
                image = {"size": scaled_size(scene_file.load(path)["image"]["size"], arguments.pixels)}
                table = convergence.table if arguments.convergence else agreement.table
                table(path, image, arguments, folder)
        except (etalon.EtalonError, scene_file.SceneError) as error:
            sys.exit(f"error: {error}")


if __name__ == "__main__":
    main()
