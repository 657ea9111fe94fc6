#!/usr/bin/env python3
"""Measures what building and testing take, in processor seconds and by the clock.

    tools/build_time.py                                        the last commit
    tools/build_time.py --base e571ce1 --cores 2 --rounds 3    beside another, alternating, with ratios
    tools/build_time.py --base e571ce1 --steps scene cli       some steps only

Commits are cloned into a temporary folder, each with a target folder of its own; changes that are not committed do
not count. Dependencies are fetched beforehand, and nothing is loaded while the clock runs. Processor seconds are those
of cargo and all that it starts, user and system; other work on the machine disturbs them little, the clock much.
Printed are medians over the rounds. Needs git, cargo and Python's standard library.
"""

import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from statistics import median

ROOT = Path(__file__).resolve().parent.parent
BUILD = ["build", "--release"]
BUILD_TESTS = ["test", "--release", "--no-run"]
TEST = ["test", "--release"]


class BuildError(Exception):
    """A command gave up."""


@dataclass
class Seconds:
    """What a command took: on all processors together, and by the clock."""

    processor: float
    clock: float

    def __add__(self, other):
        return Seconds(self.processor + other.processor, self.clock + other.clock)


class Checkout:
    """A commit in a folder, with its target folder."""

    def __init__(self, repository, revision, folder):
        self.revision = revision
        self.folder = folder
        self.target = folder / "target"
        self.changes = 0
        run(["git", "clone", "--quiet", "--shared", "--no-checkout", repository, folder])
        # A clone knows the names of its origin's branches only; the commit itself is in it by any name.
        commit = run(["git", "rev-parse", "--verify", f"{revision}^{{commit}}"], cwd=repository).strip()
        run(["git", "checkout", "--quiet", "--detach", commit], cwd=folder)
        run(["cargo", "fetch", "--locked"], cwd=folder)

    def clean(self):
        """Removes all that was built."""
        shutil.rmtree(self.target, ignore_errors=True)

    def cargo(self, arguments):
        """Seconds of a cargo command."""
        environment = os.environ | {"CARGO_TARGET_DIR": str(self.target), "CARGO_NET_OFFLINE": "true"}
        before, start = children_seconds(), time.perf_counter()
        run(["cargo", *arguments, "--locked"], cwd=self.folder, env=environment)
        return Seconds(children_seconds() - before, time.perf_counter() - start)

    def change(self, name):
        """Adds a line to a source file."""
        path = self.folder / name
        if not path.is_file():
            raise BuildError(f"{self.revision} has no file {name}")
        self.changes += 1
        with path.open("a", encoding="utf-8") as file:
            file.write(f"// Change {self.changes}.\n")


def run(command, **options):
    """Standard output of a command that succeeds."""
    result = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False, **options)
    if result.returncode:
        last = (result.stdout + result.stderr).strip()[-2000:]
        raise BuildError(f"{' '.join(map(str, command))}: exit code {result.returncode}\n{last}")
    return result.stdout


def children_seconds():
    """Processor seconds of all processes that this one started and that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def clean_build(checkout):
    """From nothing to the binary."""
    checkout.clean()
    return {"clean `cargo build --release`": checkout.cargo(BUILD)}


def clean_tests(checkout):
    """From nothing to the tests' answer; the documentation's tests are built while they run."""
    checkout.clean()
    built = checkout.cargo(BUILD_TESTS)
    ran = checkout.cargo(TEST)
    name = "clean `cargo test --release`"
    return {name: built + ran, f"{name}: build": built, f"{name}: run": ran}


def changed(name, command):
    """A step that changes a file where all else is built."""

    def step(checkout):
        checkout.cargo(command)
        checkout.change(name)
        return {f"a line changed in `{name}`, `cargo {' '.join(command)}`": checkout.cargo(command)}

    return step


STEPS = {
    "build": clean_build,
    "tests": clean_tests,
    "test": changed("tests/many_objects.rs", BUILD_TESTS),
    "scene": changed("src/scene/mod.rs", BUILD),
    "cli": changed("src/cli/mod.rs", BUILD),
}


def measure(checkouts, steps, rounds):
    """For each line of the table and each checkout, its seconds in each round."""
    table = {}
    for turn in range(rounds):
        for name in steps:
            # Who is first changes from round to round.
            for place in sorted(range(len(checkouts)), reverse=turn % 2 == 1):
                checkout = checkouts[place]
                print(f"round {turn + 1}: {checkout.revision}: {name}", file=sys.stderr, flush=True)
                for line, seconds in STEPS[name](checkout).items():
                    table.setdefault(line, [[] for _ in checkouts])[place].append(seconds)
    return table


def show(table, checkouts):
    """Prints the table in Markdown, with the ratios of the last checkout to the first."""
    kinds = [("processor", "processor"), ("clock", "clock")]
    columns = ["step"] + [f"{checkout.revision}, {words} s" for checkout in checkouts for _, words in kinds]
    if len(checkouts) > 1:
        columns += [f"ratio, {words}" for _, words in kinds]
    print("| " + " | ".join(columns) + " |\n|" + "---|" * len(columns))
    for line, sides in table.items():
        cells = [f"{median(getattr(s, kind) for s in side):.1f}" for side in sides for kind, _ in kinds]
        if len(checkouts) > 1:
            for kind, _ in kinds:
                pairs = zip(sides[0], sides[-1])
                ratios = sorted(getattr(now, kind) / getattr(before, kind) for before, now in pairs)
                extent = f" ({ratios[0]:.3f} to {ratios[-1]:.3f})" if len(ratios) > 1 else ""
                cells.append(f"{median(ratios):.3f}{extent}")
        print(f"| {line} | " + " | ".join(cells) + " |")


def main():
    """Measures what was asked for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--revision", default="HEAD", help="the commit to measure (default: %(default)s)")
    parser.add_argument("--base", help="another commit, to compare with")
    parser.add_argument("--steps", nargs="+", choices=STEPS, default=list(STEPS), help="which steps (default: all)")
    parser.add_argument("--rounds", type=int, default=1, help="how often (default: %(default)s)")
    parser.add_argument("--cores", type=int, help="processors to use (default: all)")
    parser.add_argument("--repository", type=Path, default=ROOT, help="another repository with the same files")
    arguments = parser.parse_args()
    if arguments.rounds < 1:
        parser.error("--rounds must be at least 1")
    if arguments.cores is not None:
        available = sorted(os.sched_getaffinity(0))
        if not 1 <= arguments.cores <= len(available):
            parser.error(f"--cores: there are {len(available)}")
        os.sched_setaffinity(0, available[: arguments.cores])
    revisions = [arguments.base, arguments.revision] if arguments.base else [arguments.revision]
    with tempfile.TemporaryDirectory() as name:
        try:
            repository = arguments.repository.resolve()
            checkouts = [Checkout(repository, r, Path(name) / str(i)) for i, r in enumerate(revisions)]
            show(measure(checkouts, arguments.steps, arguments.rounds), checkouts)
        except (BuildError, OSError) as error:
            sys.exit(f"error: {error}")


if __name__ == "__main__":
    main()
