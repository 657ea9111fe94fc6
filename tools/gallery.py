#!/usr/bin/env python3
"""Renders every panel of every scene into a folder of pictures with an index.

    tools/gallery.py gallery --spp 64

A scene's own picture is rendered too, where it is complete without a panel. Needs the release
binary and Python's standard library.
"""

import argparse
import subprocess
import sys
import time
import tomllib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BINARY = ROOT / "target" / "release" / "etalon"


@dataclass
class Picture:
    """A rendered picture: its panel (or None), seconds it took, and what went wrong, if anything."""

    stem: str
    panel: str | None
    seconds: float
    error: str


def run(command):
    """Exit code and standard error of a command."""
    result = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    return result.returncode, result.stderr.strip()


def variants(binary, scene, tables):
    """The panels of a scene; None stands for the file's own picture."""
    panels = [panel["name"] for panel in tables.get("panel", [])]
    is_complete = not panels or run([binary, "info", scene])[0] == 0
    return [None] * is_complete + panels


def render(binary, scene, panel, folder, options):
    """Renders one picture."""
    stem = scene.stem + (f"-{panel}" if panel else "")
    choice = ["--panel", panel] if panel else []
    start = time.perf_counter()
    code, message = run([binary, "render", scene, "-o", folder / f"{stem}.exr", "--quiet", *choice, *options])
    return Picture(stem, panel, time.perf_counter() - start, message if code else "")


def head(scene):
    """The comment at the head of a scene file."""
    lines = []
    for line in scene.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            break
        lines.append(line.removeprefix("#").strip())
    return "\n".join(lines)


def section(scene, tables, pictures, folder):
    """The index's part about one scene, as Markdown."""
    lines = [f"## {tables.get('title', scene.stem)}", "", head(scene), ""]
    for picture in pictures:
        title = picture.panel or scene.stem
        if picture.error:
            lines += [f"**{title}** failed:", "", "```", picture.error, "```", ""]
            continue
        lines += [f"**{title}** ([EXR]({picture.stem}.exr), {picture.seconds:.1f} s)", ""]
        if (folder / f"{picture.stem}.png").exists():
            lines += [f"![{title}]({picture.stem}.png)", ""]
    return lines


def main():
    """Renders all scenes and writes the index."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("folder", type=Path, nargs="?", default=ROOT / "gallery", help="where to (default: gallery)")
    parser.add_argument("--scenes", type=Path, default=ROOT / "scenes", help="folder of scene files")
    parser.add_argument("--binary", type=Path, default=BINARY)
    parser.add_argument("--only", nargs="*", help="names of scenes")
    arguments, options = parser.parse_known_args()
    if not arguments.binary.is_file():
        sys.exit(f"error: there is no {arguments.binary}; build it with cargo build --release")
    arguments.folder.mkdir(parents=True, exist_ok=True)
    lines, failed = ["# Gallery", "", f"Options: `{' '.join(options) or 'none'}`.", ""], 0
    for scene in sorted(arguments.scenes.glob("*.toml")):
        if arguments.only and scene.stem not in arguments.only:
            continue
        tables = tomllib.loads(scene.read_text(encoding="utf-8"))
        pictures = []
        for panel in variants(arguments.binary, scene, tables):
            picture = render(arguments.binary, scene, panel, arguments.folder, options)
            print(f"{picture.stem}: {picture.error or f'{picture.seconds:.1f} s'}", flush=True)
            pictures.append(picture)
        failed += sum(bool(picture.error) for picture in pictures)
        lines += section(scene, tables, pictures, arguments.folder)
    (arguments.folder / "index.md").write_text("\n".join(lines), encoding="utf-8")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
