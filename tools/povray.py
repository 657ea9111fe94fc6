#!/usr/bin/env python3
"""Primary rays of the heart and of Mitchell's surface: POV-Ray's `poly` and `isosurface` beside etalon.

    tools/povray.py [--size 700] [--distances 1 10 100 1000]

Both get the same rays through the same pixels, one thread each. POV-Ray's time is that of its process less
that of an empty scene; it shades its hits with a constant colour that is the depth. etalon's time is that of
`cargo bench -p etalon-method -- view`: finding hits, coefficients formed anew for each ray. Printed are
microseconds a ray, and on how many pixels POV-Ray's picture differs from the certified one: in whether there
is a hit, and by more than 1e-3 of the box in its depth.
"""

import argparse
import itertools
import resource
import subprocess
import tempfile
from fractions import Fraction
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
HALVES = {"heart": 1.5, "mitchell": 3.0}


def product(a, b):
    """Product of polynomials as {exponents: coefficient}."""
    result = {}
    for (e, c), (f, d) in itertools.product(a.items(), b.items()):
        key = tuple(i + j for i, j in zip(e, f))
        result[key] = result.get(key, 0) + c * d
    return result


def total(*parts):
    """Sum of factor × polynomial."""
    result = {}
    for factor, polynomial in parts:
        for e, c in polynomial.items():
            result[e] = result.get(e, 0) + factor * c
    return result


def power(a, n):
    """a to the n."""
    return {(0, 0, 0): 1} if n == 0 else product(power(a, n - 1), a)


X, Y, Z = ({tuple(int(i == j) for j in range(3)): 1} for i in range(3))
ONE = {(0, 0, 0): 1}


def field(name):
    """The field's polynomial and its text for POV-Ray."""
    if name == "heart":
        s = total((1, power(X, 2)), (Fraction(9, 4), power(Y, 2)), (1, power(Z, 2)), (-1, ONE))
        zzz = power(Z, 3)
        polynomial = total(
            (1, power(s, 3)), (-1, product(power(X, 2), zzz)), (-Fraction(9, 80), product(power(Y, 2), zzz))
        )
        return polynomial, "pow(x*x + 2.25*y*y + z*z - 1, 3) - x*x*z*z*z - 0.1125*y*y*z*z*z"
    w = total((1, power(Y, 2)), (1, power(Z, 2)))
    polynomial = total(
        (4, power(X, 4)),
        (4, power(w, 2)),
        (17, product(power(X, 2), w)),
        (-20, total((1, power(X, 2)), (1, w))),
        (17, ONE),
    )
    text = "4*(pow(x,4) + pow(y*y + z*z, 2)) + 17*x*x*(y*y + z*z) - 20*(x*x + y*y + z*z) + 17"
    return polynomial, text


def coefficients(polynomial, degree):
    """In the order of POV-Ray's `poly`: exponents of x, then y, then z, falling."""
    return [
        float(polynomial.get((i, j, k), 0))
        for i in range(degree, -1, -1)
        for j in range(degree - i, -1, -1)
        for k in range(degree - i - j, -1, -1)
    ]


def largest_gradient(polynomial, half):
    """Largest length of the gradient on a grid of the box."""
    grid = np.linspace(-half, half, 41)
    x, y, z = np.meshgrid(grid, grid, grid, indexing="ij")
    square = 0
    for axis in range(3):
        part = 0
        for exponents, c in polynomial.items():
            if exponents[axis]:
                e = [n - (i == axis) for i, n in enumerate(exponents)]
                part = part + float(c) * exponents[axis] * x ** e[0] * y ** e[1] * z ** e[2]
        square = square + part**2
    return float(np.sqrt(square.max()))


def scene(name, kind, distance):
    """POV-Ray's scene: depth along +y as a grey from 0 to 1 over the box; the background is blue."""
    half = HALVES[name]
    far = 4 * half * distance
    polynomial, text = field(name)
    degree = max(sum(e) for e in polynomial)
    box = f"box {{ <{-half},{-half},{-half}>, <{half},{half},{half}> }}"
    if kind == "poly":
        numbers = ", ".join(repr(c) for c in coefficients(polynomial, degree))
        shape = f"poly {{ {degree}, <{numbers}> bounded_by {{ {box} }} "
    elif kind == "isosurface":
        shape = (
            f"isosurface {{ function {{ {text} }} contained_by {{ {box} }} accuracy 1e-3 "
            f"max_gradient {largest_gradient(polynomial, half)} "
        )
    else:
        shape = "sphere { <0, -1e9, 0>, 1 "
    return f"""#version 3.7;
global_settings {{ assumed_gamma 1 }}
camera {{ perspective location <0, {-far}, 0> direction <0, {far}, 0>
  right <{2 * half}, 0, 0> up <0, 0, {2 * half}> }}
background {{ rgb <0, 0, 1> }}
{shape} pigment {{ gradient y color_map {{ [0 rgb 0] [1 rgb <1, 1, 0>] }} scale {2.002 * half}
  translate {-1.001 * half}*y }} finish {{ ambient 1 diffuse 0 }} }}
"""


def povray(text, size, folder):
    """Renders; processor seconds and the picture as floats."""
    (folder / "scene.pov").write_text(text)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        ["povray", "+Iscene.pov", "+Oout.png", f"+W{size}", f"+H{size}", "+WT1", "+FN16", "-D", "-A", "-GA",
         "File_Gamma=1.0"],
        cwd=folder, check=True, capture_output=True,
    )  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime, sixteen_bits(folder / "out.png", folder)


def sixteen_bits(path, folder):
    """Red and blue of a 16-bit PNG in [0, 1]; Pillow alone would keep eight bits of them."""
    del folder
    import zlib

    data = path.read_bytes()
    place, width, height, packed = 8, 0, 0, b""
    while place < len(data):
        length = int.from_bytes(data[place : place + 4], "big")
        kind, body = data[place + 4 : place + 8], data[place + 8 : place + 8 + length]
        if kind == b"IHDR":
            width, height = (int.from_bytes(body[i : i + 4], "big") for i in (0, 4))
        if kind == b"IDAT":
            packed += body
        place += length + 12
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + 6 * width)
    out = np.zeros((height, 6 * width), np.int64)
    for i, row in enumerate(rows):
        filtered, above = row[1:].astype(np.int64), out[i - 1] if i else np.zeros(6 * width, np.int64)
        if row[0] == 2:
            out[i] = (filtered + above) & 255
            continue
        if row[0] == 0:
            out[i] = filtered
            continue
        line = out[i]
        for k in range(6 * width):
            left, corner = (line[k - 6], above[k - 6]) if k >= 6 else (0, 0)
            if row[0] == 1:
                guess = left
            elif row[0] == 3:
                guess = (left + above[k]) // 2
            else:
                p = left + above[k] - corner
                guess = min((left, above[k], corner), key=lambda v: abs(p - v))
            line[k] = (filtered[k] + guess) & 255
    values = out.reshape(height, width, 3, 2)
    return (values[..., 0] * 256 + values[..., 1]) / 65535


def etalon(name, size, distance, folder):
    """Microseconds a ray and depths over the box, infinite where nothing is hit."""
    file = folder / "depths.f64"
    command = ["cargo", "bench", "--quiet", "-p", "etalon-method", "--", "view", name, str(size), repr(distance)]
    printed = subprocess.run(
        [*command, str(file)], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout
    t = np.frombuffer(file.read_bytes(), "<f8").reshape(size, size)
    half = HALVES[name]
    far = 4 * half * distance
    # Rays reach the plane y = 0 at t = 1.
    depth = (far * (t - 1) + 1.001 * half) / (2.002 * half)
    return float(printed.split()[-1]) / 1000, depth


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, default=700)
    parser.add_argument("--distances", type=float, nargs="+", default=[1.0, 10.0, 100.0, 1000.0])
    arguments = parser.parse_args()
    size = arguments.size
    print("surface   distance  by          us/ray  wrong mask  wrong depth  ratio")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for surface, distance in itertools.product(HALVES, arguments.distances):
            mine, depth = etalon(surface, size, distance, folder)
            print(f"{surface:9} {distance:8g}  {'etalon':10} {mine:7.3f}")
            empty, _ = povray(scene(surface, "empty", distance), size, folder)
            for kind in ("poly", "isosurface"):
                seconds, picture = povray(scene(surface, kind, distance), size, folder)
                each = (seconds - empty) / size**2 * 1e6
                hit = picture[..., 2] < 0.5
                mask = int((hit != np.isfinite(depth)).sum())
                both = hit & np.isfinite(depth)
                # A step of the depth's 16 bits is 1.5e-5 of the box.
                wrong = int((np.abs(picture[..., 0] - depth)[both] > 1e-3).sum())
                print(
                    f"{surface:9} {distance:8g}  {kind:10} {each:7.3f} {mask:11d} {wrong:12d} "
                    f"{each / mine:6.1f}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
