#!/usr/bin/env python3
"""Invents scenes, renders each with etalon and with Mitsuba, and has `etalon compare` judge.

    tools/invented.py --scenes 100 --folder invented      scenes 1 to 100; exit code 1 if one differs
    tools/invented.py --first 42 --scenes 1 --folder invented

What is called inconsistent is drawn afresh with 16 times the samples on both sides, and reported where that
stays so; honest pictures get there with a probability of 1e-6, rare paths apart. Scenes and pictures
stay in the folder.
"""

import argparse
import json
import math
import random
import subprocess
import sys
import warnings
from dataclasses import replace
from pathlib import Path

import mitsuba as mi

import etalon
import mitsuba_scene
import reference_file
import replicates
from reference_file import Reference
from scene_file import SceneError

SIZE = [32, 24]
# Factor by which a second look has more samples.
CLOSER = 16
CLOSED = ["sphere", "cube", "cylinder"]
FLAT = ["disk", "rectangle"]


class Inventor:
    """Draws the parts of a scene, as values of its file."""

    def __init__(self, seed):
        self.random = random.Random(seed)

    def number(self, low, high):
        """A number with three digits after the point."""
        return round(self.random.uniform(low, high), 3)

    def vector(self, low, high):
        """Three numbers."""
        return [self.number(low, high) for _ in range(3)]

    def often(self, probability):
        """Whether something happens."""
        return self.random.random() < probability

    def reflectance(self):
        """A spectrum between 0 and 0.85."""
        nm = [360, self.number(420, 560), self.number(600, 700), 830]
        table = [[x, self.number(0, 0.85)] for x in nm]
        return self.random.choice([self.number(0.1, 0.85), {"rgb": self.vector(0.05, 0.85)}, {"table": table}])

    def emission(self, low, high):
        """A spectrum of about this size at 560 nm."""
        size = self.number(low, high)
        kelvin = self.random.randint(2500, 9000)
        planck = 1.191042972e-16 / 560e-9**5 / math.expm1(1.438776877e-2 / 560e-9 / kelvin) * 1e-9
        black = {"blackbody": kelvin, "scale": float(f"{size / planck:.4g}")}
        rgb = {"rgb": [round(size * x, 3) for x in self.vector(0.2, 1)]}
        return self.random.choice([size, {"name": "D65", "scale": size}, black, rgb])

    def material(self, kind):
        """What something does with light, of what Mitsuba can do on the kind of shape."""
        choices = [{"diffuse": self.reflectance()}] * 5 + [{"black": True}]
        choices.append({"mirror": self.random.choice(["Ag", "Al", "Au", "Cu", {"n": 1.2, "k": 2.5}])})
        choices.append({"mirror": {"ideal": self.reflectance()}})
        if kind in CLOSED or kind == "implicit":
            choices.append({"glass": {"ior": self.number(1.05, 2.2)}})
        if kind in ("cube", "rectangle"):
            board = [self.reflectance(), self.reflectance()]
            choices.append({"checkerboard": board, "cell": self.number(0.15, 0.6)})
        return self.random.choice(choices)

    def shape(self, kind):
        """A shape of a kind, about 1 in size."""
        match kind:
            case "sphere":
                return {"sphere": {"radius": self.number(0.3, 1)}}
            case "cube":
                return {"cube": {"size": self.vector(0.3, 1.6)}}
            case "cylinder":
                return {"cylinder": {"radius": self.number(0.2, 0.8), "height": self.number(0.4, 2)}}
            case "disk":
                return {"disk": {"radius": self.number(0.3, 1.2)}}
            case "rectangle":
                return {"rectangle": {"size": self.vector(0.4, 2.5)[:2]}}
        return {"implicit": self.random.choice(["torus", "goursat", "heart", "mitchell"])}

    def place(self, first=()):
        """Transforms to somewhere near the origin: half of all are scaled by axis, a third sheared."""
        steps = list(first)
        if self.often(0.5):
            steps.append({"scale": [x * self.random.choice([1, 1, 1, -1]) for x in self.vector(0.4, 1.3)]})
        if self.often(0.35):
            steps.append({"shear": {self.random.choice(["xy", "xz", "yx", "yz", "zx", "zy"]): self.number(-0.8, 0.8)}})
        if self.often(0.4):
            steps.append({"rotate": {"axis": self.vector(-1, 1), "angle": self.number(0, 360)}})
        elif self.often(0.5):
            axis = self.random.choice("xyz")
            steps.append({f"rotate_{axis}": self.random.choice([90, 180, 45, 30])})
        return [*steps, {"translate": self.vector(-1.6, 1.6)}]

    def camera(self):
        """A camera that looks at the origin from 4 to 7 away."""
        away, height, turn = self.number(4, 7), self.random.uniform(-0.2, 0.95), self.random.uniform(0, math.tau)
        beside = away * math.sqrt(1 - height * height)
        place = [beside * math.cos(turn), away * height, beside * math.sin(turn)]
        camera = {"from": [round(x, 3) for x in place], "to": self.vector(-0.4, 0.4)}
        if self.often(0.2):
            return camera | {"orthographic": self.number(2, 5)}
        if self.often(0.3):
            camera["lens"] = {"radius": self.number(0.05, 0.6), "focus": self.number(2, 9)}
        return camera | {"fov": self.number(25, 70)}

    def objects(self):
        """Pairs of an [[object]] table, its material apart, and that material."""
        result = []
        if self.often(0.3):
            kind = self.random.choice(CLOSED)
            room = {"diffuse": self.reflectance()}
            if self.often(0.6):
                room |= {"emit": self.emission(0.1, 0.8), "sides": "back"}
            result.append((kind, [{"scale": self.vector(8, 14)}], room))
        elif self.often(0.8):
            kind = self.random.choice(["plane", {"rectangle": {"size": [8, 8]}}])
            board = {"checkerboard": [self.reflectance(), self.reflectance()], "cell": self.number(0.3, 1.2)}
            floor = self.random.choice([{"diffuse": self.reflectance()}, board])
            place = [{"rotate_x": -90}, {"rotate_y": self.number(0, 360)}, {"translate": [0, -1.7, 0]}]
            result.append((kind, place, floor))
        if self.often(0.2):
            small = [{"scale": self.number(0.3, 0.7)}]
            result.append((self.shape("implicit"), self.place(small), self.material("implicit")))
        for _ in range(self.random.randint(2, 6)):
            kind = self.random.choice(CLOSED + FLAT)
            result.append((self.shape(kind), self.place(), self.material(kind)))
        for _ in range(self.random.randint(0, 3)):
            # Light from inside a closed shape leaks out of it in Mitsuba (`closed_lights`).
            kind = self.random.choice(CLOSED + FLAT)
            sides = ["front", "both"] + (["back"] if kind in FLAT else [])
            lamp = {"emit": self.emission(1, 4), "sides": self.random.choice(sides)}
            if self.often(0.4):
                lamp |= self.random.choice([{"diffuse": self.reflectance()}, {"mirror": "Cu"}])
            result.append((self.shape(kind), self.place(), lamp))
        return result

    def light(self):
        """A light without a surface."""
        if self.often(0.5):
            return {"point": self.vector(-3, 3), "intensity": self.emission(2, 8)}
        return {"direction": self.vector(-1, 1), "irradiance": self.emission(0.5, 3)}

    def scene(self):
        """The text of a scene file."""
        image = {"size": SIZE, "spp": 1}
        depth = self.random.choice([None, 2, 3, 4, 6, 8])
        image |= {"max_depth": depth} if depth else {}
        objects = self.objects()
        lit = any("emit" in material for _, _, material in objects)
        tables = {"camera": self.camera(), "image": image}
        tables["materials"] = {f"material{i}": material for i, (_, _, material) in enumerate(objects)}
        lines = []
        if self.often(0.5) or not lit:
            lines.append(f"environment = {toml(self.emission(0.2, 1))}")
        for name, table in tables.items():
            lines += [f"[{name}]", *(f"{key} = {toml(value)}" for key, value in table.items())]
        for index, (shape, place, _) in enumerate(objects):
            table = {"shape": shape, "material": f"material{index}", "transform": place}
            lines += ["[[object]]", *(f"{key} = {toml(value)}" for key, value in table.items())]
        for light in [self.light() for _ in range(self.random.randint(0, 2))]:
            lines += ["[[light]]", *(f"{key} = {toml(value)}" for key, value in light.items())]
        return "\n".join(lines) + "\n"


def toml(value):
    """A value as TOML."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(part)}" for key, part in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value)


def mitsuba_picture(reference, seed, path):
    """Renders a reference."""
    replicates.choose_variant(reference.tables(), mitsuba_scene.DEFAULT_VARIANT)
    mi.set_log_level(mi.LogLevel.Error)
    mean, variance, _, _ = replicates.mean_and_variance(replicates.pictures(reference, seed))
    attributes = reference_file.scene_attributes(reference) | {"replicates": reference.replicates}
    reference_file.write(path, mean, variance, attributes)


def judged(reference, spp, seed, arguments):
    """What `etalon compare` says of two fresh pictures: its exit code and text."""
    own, others = reference.path.with_suffix(".exr"), reference.path.with_name(f"{reference.name}_reference.exr")
    mitsuba_picture(reference, seed, others)
    options = ["--spp", str(spp), "--replicates", "16", "--seed", str(seed), "--layers", reference_file.BAND_LAYER]
    etalon.run(arguments.binary, reference.path, own, options, 2)
    command = [str(arguments.binary), "compare", str(own), str(others)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    return result.returncode, result.stdout + result.stderr


def different(number, arguments):
    """Renders a scene with both, twice if need be; says whether they differ."""
    path = arguments.folder / f"scene{number}.toml"
    path.write_text(Inventor(number).scene())
    reference = Reference(path.stem, str(path.resolve()), None, [], arguments.spp, 16, "multijitter")
    try:
        code, text = judged(reference, arguments.etalon_spp, 2 * number, arguments)
        again = ""
        if code == 1:
            closer = replace(reference, spp=CLOSER * reference.spp)
            code, text = judged(closer, CLOSER * arguments.etalon_spp, 2**20 + 2 * number, arguments)
            again = f", with {CLOSER} times the samples"
    except (SceneError, etalon.EtalonError) as error:
        code, text, again = 2, str(error), ""
    if code:
        print(text)
    print(f"{path}: {['consistent', 'NOT consistent', 'not compared'][code]}{again}", flush=True)
    return code != 0


def main():
    """Invents and compares as many scenes as asked for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--scenes", type=int, default=100, help="default: %(default)s")
    parser.add_argument("--first", type=int, default=1, help="number of the first scene (default: %(default)s)")
    parser.add_argument("--folder", type=Path, required=True)
    parser.add_argument("--spp", type=int, default=64, help="of Mitsuba, of each of 16 replicates")
    parser.add_argument("--etalon-spp", type=int, default=4096)
    parser.add_argument("--binary", type=Path, default=etalon.BINARY)
    arguments = parser.parse_args()
    warnings.simplefilter("once")
    arguments.folder.mkdir(parents=True, exist_ok=True)
    numbers = range(arguments.first, arguments.first + arguments.scenes)
    count = sum(different(number, arguments) for number in numbers)
    print(f"{count} of {arguments.scenes} scenes differ")
    return int(count > 0)


if __name__ == "__main__":
    sys.exit(main())
