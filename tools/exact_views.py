#!/usr/bin/env python3
"""Masks and depths of the views of tools/povray.py against exact arithmetic.

    tools/exact_views.py [--size 700] [--distances 1 10 100 1000] [--every 10] [--threads 2]

Primary rays of the heart and of Mitchell's surface, hits by `cargo bench -p etalon-method -- view`. For each
pixel on a silhouette (one of its eight neighbours' answers differs) and one of `--every` pixels in both
directions of the rest, the field along the ray is formed in rational numbers from the rays' own f64, and
its roots are isolated by FLINT (Johansson 2017, `python-flint`), which certifies them. Printed are the pixels
that were checked, those whose mask or depth is wrong, and the largest error of a depth relative to the
length of the box. Exit code 1 if anything is wrong. A depth is wrong beyond 1e-12 of that length.
"""

import argparse
import multiprocessing
import subprocess
import sys
import tempfile
from fractions import Fraction
from pathlib import Path

import flint
import numpy as np

from povray import HALVES, ROOT, field

WRONG = 1e-12


def depths(name, size, distance):
    """t of each pixel's hit, infinite for a miss."""
    with tempfile.NamedTemporaryFile(suffix=".f64") as file:
        command = ["cargo", "bench", "-p", "etalon-method", "--", "view", name, str(size), repr(distance), file.name]
        subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
        return np.fromfile(file.name, "<f8").reshape(size, size)


def rational(x):
    """A float or fraction as FLINT's rational."""
    x = Fraction(x)
    return flint.fmpq(x.numerator, x.denominator)


def along(polynomial, origin, direction):
    """The field along a ray as an integer polynomial in t, up to a positive factor."""
    lines = [flint.fmpq_poly([rational(o), rational(d)]) for o, d in zip(origin, direction)]
    powers = []
    for axis, line in enumerate(lines):
        powers.append([flint.fmpq_poly([1])])
        for _ in range(max(e[axis] for e in polynomial)):
            powers[axis].append(powers[axis][-1] * line)
    total = flint.fmpq_poly([0])
    for (i, j, k), c in polynomial.items():
        total += rational(c) * (powers[0][i] * powers[1][j] * powers[2][k])
    return total.numer()


def clip(half, origin, direction):
    """The exact stretch of t ≥ 0 within the closed cube, or None."""
    low, high = Fraction(0), None
    for o, d in zip(map(Fraction, origin), map(Fraction, direction)):
        if d == 0:
            if abs(o) > half:
                return None
            continue
        a, b = sorted(((-half - o) / d, (half - o) / d))
        low, high = max(low, a), b if high is None else min(high, b)
    return (low, high) if low <= high else None


def first_root(polynomial, stretch):
    """The first real root on a stretch as a certified ball, or None."""
    if stretch is None or polynomial.degree() < 1:
        return None
    low, high = (flint.arb(rational(t)) for t in stretch)
    roots = []
    for root, _ in polynomial.complex_roots():
        if root.imag != 0:
            continue
        t = root.real
        inside, outside = low <= t and t <= high, t < low or t > high
        if not inside and not outside:
            raise ArithmeticError("a root on a face of the box")
        if inside:
            roots.append(t)
    return min(roots, key=lambda t: t.mid()) if roots else None


def chosen(hits, every):
    """The pixels to check."""
    mask = np.pad(hits, 1, mode="edge")
    size = hits.shape[0]
    near = np.zeros_like(hits)
    for i in range(3):
        for j in range(3):
            near |= mask[i : i + size, j : j + size] != hits
    near[::every, ::every] = True
    return np.argwhere(near)


def check(job):
    """Wrong masks, wrong depths and the largest error of a depth for some pixels."""
    name, size, distance, pixels = job
    half, polynomial = HALVES[name], field(name)[0]
    far = 4.0 * half * distance
    flint.ctx.prec = 256
    wrong, worst = [0, 0], 0.0
    for row, column, t in pixels:
        place = [(2 * int(i) + 1) / size - 1.0 for i in (column, row)]
        origin = (0.0, -far, 0.0)
        direction = (place[0] * half, far, -place[1] * half)
        root = first_root(along(polynomial, origin, direction), clip(Fraction(half), origin, direction))
        if (root is None) != bool(np.isinf(t)):
            wrong[0] += 1
        elif root is not None:
            # The box is 2 half / far long in t.
            error = float(abs(flint.arb(rational(float(t))) - root).upper()) * far / (2 * half)
            worst = max(worst, error)
            wrong[1] += error > WRONG
    return wrong, worst


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=int, default=700)
    parser.add_argument("--distances", type=float, nargs="+", default=[1.0, 10.0, 100.0, 1000.0])
    parser.add_argument("--every", type=int, default=10)
    parser.add_argument("--threads", type=int, default=2)
    arguments = parser.parse_args()
    print("surface,distance,pixels,hits,checked,wrong masks,wrong depths,largest error of a depth")
    bad = 0
    with multiprocessing.Pool(arguments.threads) as pool:
        for name in HALVES:
            for distance in arguments.distances:
                t = depths(name, arguments.size, distance)
                hits = np.isfinite(t)
                pixels = [(i, j, t[i, j]) for i, j in chosen(hits, arguments.every)]
                pieces = [pixels[i::64] for i in range(64)]
                jobs = [(name, arguments.size, distance, piece) for piece in pieces]
                results = pool.map(check, jobs, chunksize=1)
                wrong = [sum(r[0][k] for r in results) for k in range(2)]
                worst = max(r[1] for r in results)
                bad += sum(wrong)
                row = (name, f"{distance:g}", t.size, hits.sum(), len(pixels), *wrong, f"{worst:.1e}")
                print(*row, sep=",", flush=True)
    sys.exit(bad > 0)


if __name__ == "__main__":
    main()
