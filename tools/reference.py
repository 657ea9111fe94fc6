#!/usr/bin/env python3
"""Renders reference pictures with Mitsuba 3: mean, variance of the mean, and provenance.

    tools/reference.py                          all that are missing or stale
    tools/reference.py cornell_box prism        these, if missing or stale
    tools/reference.py --check                  says what is stale; exit code 1 if something is
    tools/reference.py --verify furnace_closed  renders it again with other seeds and compares
    tools/reference.py --agreement              renders all with etalon and compares
    tools/reference.py my.toml --set image.size=[96,64] -o my_reference.exr

What is known by name is listed in reference/references.toml, what a file holds is said in
reference/README.md. A picture is up to date if scene, data files, panel, overrides, samples,
replicates, sampler, bands and Mitsuba's version are those it was made with.
"""

import argparse
import datetime
import json
import shlex
import sys
import time
import tomllib
import warnings
import zlib
from dataclasses import replace
from pathlib import Path

import mitsuba as mi

import etalon
import meshes
import mitsuba_scene
import reference_agreement
import reference_file
import replicates
import scene_file
from reference_file import Reference
from scene_file import SceneError

# More than the pictures of one reference are, one for each replicate and wavelength.
SEEDS_EACH = 8192


def first_seed(reference):
    """Of the seeds that only this reference has."""
    return SEEDS_EACH * (1 + zlib.crc32(reference.name.encode()) % 2**17)


def make(reference, path, arguments):
    """Renders a reference and writes it."""
    start = time.perf_counter()
    mean, variance, whole, error = replicates.mean_and_variance(replicates.pictures(reference, first_seed(reference)))
    attributes = reference_file.scene_attributes(reference) | provenance(reference, arguments)
    names = reference_file.channel_names()
    attributes["channelMeans"] = json.dumps(dict(zip(names, whole.tolist(), strict=True)))
    attributes["channelStandardErrors"] = json.dumps(dict(zip(names, error.tolist(), strict=True)))
    seconds = time.perf_counter() - start
    reference_file.write(path, mean, variance, attributes | {"seconds": round(seconds, 1)})
    relative = " ".join(f"{name} {1e2 * e / m:.4f} %" for name, m, e in zip("RGB", whole, error, strict=False) if m)
    print(f"{reference.name}: {seconds:.0f} s, standard error of the mean: {relative}", flush=True)


def provenance(reference, arguments):
    """How the picture was made."""
    tables = reference.tables()
    attributes = settings(tables) | {
        "integrator": "path",
        "variant": mi.variant(),
        "maxDepth": tables["image"].get("max_depth", "unlimited"),
        "sampler": reference.sampler,
        "spp": real_spp(reference),
        "sppAsked": reference.spp,
        "replicates": reference.replicates,
        "seeds": f"{first_seed(reference)} and following",
        "date": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        "command": shlex.join(["tools/reference.py", *arguments.command]),
    }
    note = stand_ins(tables)
    return attributes | ({"standIn": note} if note else {})


def settings(tables):
    """What a picture must have been made with besides what its entry in the list says."""
    result = {"mitsubaVersion": mi.__version__}
    if any(scene_file.placed(entry).kind == "plane" for entry in tables.get("object", [])):
        result["planeExtent"] = mitsuba_scene.PLANE_EXTENTS[-1]
    if mitsuba_scene.needs_double(tables):
        result["variant"] = "scalar_spectral"
    return result


def real_spp(reference):
    """Paths per pixel that Mitsuba's sampler really takes; some round up."""
    return mi.load_dict({"type": reference.sampler, "sample_count": reference.spp}).sample_count()


def stand_ins(tables):
    """What stands in for something that Mitsuba lacks, with its measured error."""
    notes = meshes.notes(tables)
    if replicates.has_dispersion(tables):
        notes.append(
            f"glass: one wavelength at a time with the constant index there, in strata of {replicates.STRATUM} nm; "
            "spp is per wavelength"
        )
    return "; ".join(notes)


def own_scene(path, arguments):
    """A scene file that is not in the list."""
    scene = str(path.resolve())
    if path.resolve().is_relative_to(reference_file.ROOT):
        scene = str(path.resolve().relative_to(reference_file.ROOT))
    return Reference(
        path.stem, scene, arguments.panel, arguments.set, arguments.spp, arguments.replicates, arguments.sampler
    )


def chosen(arguments):
    """The references asked for, each with the file to write."""
    known = reference_file.known()
    asked = arguments.names or list(known)
    result = []
    for name in asked:
        if name.endswith(".toml"):
            path = Path(name)
            reference = own_scene(path, arguments)
            result.append((reference, arguments.output or Path(f"{path.stem}_reference.exr")))
        elif name in known:
            result.append((known[name], known[name].file))
        else:
            sys.exit(f"error: there is no reference {name!r}; there are: {', '.join(known)}")
    if arguments.output and len(result) != 1:
        sys.exit("error: -o is for one picture")
    return result


def reason(reference):
    """Why a reference must be rendered (again), or None."""
    return reference_file.stale(reference, settings(reference.tables()))


def check(references):
    """Says what is stale; the exit code."""
    code = 0
    for reference, _ in references:
        why = reason(reference)
        print(f"{reference.name}: {'stale, ' + why if why else 'up to date'}")
        code = code or int(why is not None)
    return code


def verify(reference):
    """Renders a reference again with other seeds and a quarter of the samples, and compares means:
    exit code 1 if a channel is further away than one honest run in a thousand has it."""
    _, channels = reference_file.read(reference.file)
    again = replace(reference, spp=max(reference.spp // 4, 1))
    pictures = replicates.pictures(again, first_seed(reference) + 2**31)
    mean, variance, _, _ = replicates.mean_and_variance(pictures)
    names, wrong = reference_file.channel_names(), 0
    limit = reference_agreement.limit(reference_agreement.LEVEL / len(names))
    for index, name in enumerate(names):
        a = reference_agreement.mean_and_error(mean[..., index], variance[..., index])
        b = reference_agreement.mean_and_error(channels[name], channels[f"variance.{name}"])
        z = reference_agreement.deviation(a, b)
        wrong += abs(z) > limit
        print(f"{reference.name} {name}: {a[0]:.6g} again, {b[0]:.6g} recorded, {z:+.2f} standard errors")
    print(f"{reference.name}: {'NOT consistent' if wrong else 'consistent'} (limit {limit:.2f})", flush=True)
    return int(wrong > 0)


def parse_arguments():
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="names of references, or scene files (.toml)")
    mode = parser.add_mutually_exclusive_group()
    mode.add_argument("--list", action="store_true", help="list the references")
    mode.add_argument("--check", action="store_true", help="say what is stale")
    mode.add_argument("--verify", action="store_true", help="render again with other seeds and compare")
    mode.add_argument("--agreement", action="store_true", help="render with etalon and compare")
    parser.add_argument("--force", action="store_true", help="render what is up to date, too")
    parser.add_argument("--variant", default=mitsuba_scene.DEFAULT_VARIANT, help="default: %(default)s")
    parser.add_argument("--threads", type=int, default=0, help="default: all")
    own = parser.add_argument_group("for scene files")
    own.add_argument("--panel")
    own.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="lay over the scene")
    own.add_argument("--spp", type=int, default=256, help="paths per pixel and replicate (default: %(default)s)")
    own.add_argument("--replicates", type=int, default=16, help="default: %(default)s")
    own.add_argument("--sampler", default="multijitter", help="default: %(default)s")
    own.add_argument("-o", "--output", type=Path)
    compare = parser.add_argument_group("for --agreement")
    compare.add_argument("--etalon-spp", type=int, default=1024, help="paths per pixel and seed (default: %(default)s)")
    compare.add_argument("--seeds", type=int, default=8, help="pictures by etalon (default: %(default)s)")
    compare.add_argument("--binary", type=Path, default=etalon.BINARY)
    arguments = parser.parse_args()
    arguments.command = sys.argv[1:]
    return arguments


def main():
    """Does what the command line asks."""
    arguments = parse_arguments()
    warnings.simplefilter("once")
    references = chosen(arguments)
    if arguments.list:
        for reference, _ in references:
            print(f"{reference.name}: {reference.scene} {reference.panel or ''} {' '.join(reference.set)}")
        return 0
    if arguments.check:
        return check(references)
    code = 0
    if arguments.agreement:
        reference_agreement.heading()
    for reference, path in references:
        try:
            if arguments.agreement:
                reference_agreement.compare(reference, path, arguments)
            elif arguments.verify:
                replicates.choose_variant(reference.tables(), arguments.variant, arguments.threads)
                code = verify(reference) or code
            elif arguments.force or path != reference.file or reason(reference):
                replicates.choose_variant(reference.tables(), arguments.variant, arguments.threads)
                make(reference, path, arguments)
        except (SceneError, etalon.EtalonError, OSError) as error:
            print(f"error: {reference.name}: {error}", file=sys.stderr)
            code = 2
        except (KeyError, tomllib.TOMLDecodeError) as error:
            print(f"error: {reference.scene}: {error}; `etalon info` says what is wrong with it", file=sys.stderr)
            code = 2
    return code


if __name__ == "__main__":
    sys.exit(main())
