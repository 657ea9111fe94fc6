"""Error of the picture over paths per pixel, etalon against Mitsuba.

relMSE is the mean over pixels (and colours) of (x − r)² / (r² + ε) with ε = 1e-4 · mean(r)² of that
colour. The reference r is the mean of independent replicates of both renderers, weighted by their
inverse variances; its own variance, known from the replicates, is subtracted from the squares.
"""

import numpy as np

import agreement
import etalon
import mitsuba_scene

SPP = [64, 256, 1024]
PICTURES = 4
EPSILON = 1e-4


def reference(path, image, arguments, folder):
    """Picture (height×width×3, XYZ) and the replicates it is made of, with their weights."""
    groups = [
        agreement.etalon_pictures(path, image, arguments, folder),
        agreement.mitsuba_pictures(path, image, arguments),
    ]
    weights = np.concatenate([np.full(len(g), 1 / g.var(axis=0, ddof=1).mean()) for g in groups])
    return np.concatenate(groups), weights / weights.sum()


def relmse(picture, replicates, weights):
    """relMSE (see the module) of a picture, without the share of the reference's variance."""
    mean = np.tensordot(weights, replicates, axes=1)
    halves = np.split(replicates, 2)
    spread = [half.var(axis=0, ddof=1) for half in halves]
    shares = [np.sum(part**2) for part in np.split(weights, 2)]
    variance = sum(share * part for share, part in zip(shares, spread, strict=True))
    epsilon = EPSILON * mean.mean(axis=(0, 1)) ** 2
    return np.mean(((picture - mean) ** 2 - variance) / (mean**2 + epsilon))


def pictures(path, image, spp, arguments, folder):
    """Pictures (XYZ) by label and seed, whose seeds the reference does not have."""
    output = folder / "picture.exr"
    for label, undivided in {"etalon sobol": {"replicates": 1}, "etalon sobol, usual replicates": {}}.items():
        for seed in range(1, PICTURES + 1):
            options = image | {"spp": spp, "seed": seed, "sampler": "sobol"} | undivided
            etalon.render(path, output, arguments, **options)
            yield label, etalon.read_xyz(output)
    for sampler in ("multijitter", "independent"):
        scene = mitsuba_scene.load(path, image=image | {"spp": spp}, sampler=sampler)
        for seed in range(1, PICTURES + 1):
            yield f"Mitsuba {sampler}", mitsuba_scene.render(scene, seed)


def table(path, image, arguments, folder):
    """Prints relMSE of Y and of linear RGB by renderer, sampler and paths per pixel."""
    replicates, weights = reference(path, image, arguments, folder)
    views = {"Y": lambda xyz: xyz[..., 1:2], "RGB": mitsuba_scene.to_rgb}
    errors = {}
    for spp in SPP:
        for label, picture in pictures(path, image, spp, arguments, folder):
            for name, view in views.items():
                error = relmse(view(picture), view(replicates), weights)
                errors.setdefault((label, name), {}).setdefault(spp, []).append(error)
    print(f"{path.stem}: relMSE at {image['size']}, mean of {PICTURES} pictures, ε = {EPSILON} mean²")
    columns = [f"{name}, {spp} spp" for name in views for spp in SPP]
    print("| | " + " | ".join(columns) + " |")
    print("|---|" + "---|" * len(columns))
    for label in dict.fromkeys(label for label, _ in errors):
        cells = [f"{np.mean(errors[label, name][spp]):.2e}" for name in views for spp in SPP]
        print(f"| {label} | " + " | ".join(cells) + " |")
    print()
