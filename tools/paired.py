#!/usr/bin/env python3
"""Measures whether one build of etalon renders as fast as another, scene by scene.

    tools/paired.py OLD                                  target/release/etalon beside another binary
    tools/paired.py OLD --rounds 20 --threads 2          more alternations, more threads
    tools/paired.py OLD --instructions                   instructions under valgrind instead of seconds

Seconds are those of the processor, user and system, of whole renders that alternate: old, new, new, old, … Printed are
the mean ratio new/old of the pairs, with its 95 % interval (Student's t on logarithms). Instructions are those of one
pass of 4 paths a pixel, on AVX2; they hardly differ from run to run. Needs Python's standard library, and valgrind for
instructions.
"""

import argparse
import math
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import mean, stdev

ROOT = Path(__file__).resolve().parent.parent
SCENES = [
    ("cornell_box", []),
    ("fig1_cube", ["--panel", "large"]),
    ("fig2_cylinder", ["--panel", "large-128"]),
    ("fig7_mirrors", ["--panel", "depth-64"]),
    ("fig8_lens", ["--panel", "radius-0.8-focus-10"]),
]


class RunError(Exception):
    """A program gave up."""


def run(command):
    """What a program says on stderr, if it succeeds."""
    result = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if result.returncode:
        raise RunError(f"{' '.join(map(str, command))}: exit code {result.returncode}\n{result.stderr[-2000:]}")
    return result.stderr


def render(binary, scene, options, size, samples, output):
    """The command that renders a scene."""
    command = [binary, "render", ROOT / "scenes" / f"{scene}.toml", "-q", "-o", output, "--spp", samples]
    return command + ["--size", f"{size}x{size}", "--set", 'image.sampler="independent"', *options]


def seconds(command):
    """Processor seconds of a program."""

    def spent():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime

    before = spent()
    run(command)
    return spent() - before


def instructions(command):
    """Instructions of a program on one thread."""
    said = run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", *command, "--instructions", "avx2"])
    return int(re.search(r"Collected : (\d+)", said)[1])


def student(freedom):
    """The two-sided 95 % quantile of Student's t, by Hill's expansion (Algorithm 396, CACM 13, 1970), to 1e-3."""
    z = 1.959964
    terms = [
        (z**3 + z) / 4,
        (5 * z**5 + 16 * z**3 + 3 * z) / 96,
        (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384,
    ]
    return z + sum(term / freedom ** (i + 1) for i, term in enumerate(terms))


def interval(ratios):
    """Mean ratio, and the ends of its 95 % interval."""
    logarithms = [math.log(ratio) for ratio in ratios]
    centre = mean(logarithms)
    half = student(len(ratios) - 1) * stdev(logarithms) / math.sqrt(len(ratios))
    return [math.exp(centre + shift) for shift in (0, -half, half)]


def main():
    """Prints a table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("old", type=Path, help="the binary to compare with")
    parser.add_argument("new", type=Path, nargs="?", default=ROOT / "target" / "release" / "etalon")
    parser.add_argument("--rounds", type=int, default=10, help="pairs of renders (default: %(default)s, at least 5)")
    parser.add_argument("--threads", type=int, default=1, help="of each render (default: %(default)s)")
    parser.add_argument("--spp", type=int, default=64, help="paths a pixel (default: %(default)s)")
    parser.add_argument("--pixels", type=int, default=512, help="along each edge (default: %(default)s)")
    parser.add_argument("--instructions", action="store_true", help="count instructions under valgrind")
    arguments = parser.parse_args()
    if arguments.rounds < 5:
        parser.error("--rounds must be at least 5")
    binaries = [arguments.old, arguments.new]
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "picture.exr"
        if arguments.instructions:
            print("| scene | old, 10⁶ | new, 10⁶ | ratio |\n|---|---|---|---|")
        else:
            print("| scene | ratio of seconds | 95 % interval |\n|---|---|---|")
        for scene, options in SCENES:
            if arguments.instructions:
                options = [*options, "--threads", 1]
                old, new = (instructions(render(b, scene, options, 160, 4, output)) for b in binaries)
                print(f"| {scene} | {old / 1e6:.1f} | {new / 1e6:.1f} | {new / old:.4f} |", flush=True)
                continue
            options = [*options, "--threads", arguments.threads]
            commands = [render(b, scene, options, arguments.pixels, arguments.spp, output) for b in binaries]
            ratios = []
            for turn in range(arguments.rounds):
                took = {i: seconds(commands[i]) for i in ((0, 1) if turn % 2 == 0 else (1, 0))}
                ratios.append(took[1] / took[0])
            centre, low, high = interval(ratios)
            print(f"| {scene} | {centre:.4f} | {low:.4f} to {high:.4f} |", flush=True)


if __name__ == "__main__":
    try:
        main()
    except (RunError, OSError) as error:
        sys.exit(f"error: {error}")
