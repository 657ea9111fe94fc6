"""Spectra of scene files, and the observer, as numbers.

A spectrum is a float (the same value at every wavelength) or a pair of arrays (wavelengths in nm,
values), linear in between and zero outside. Smooth spectra are tabulated at whole nm, where linear
interpolation is within 1e-5 of Planck's law at 1500 K and more.
"""

from functools import cache
from pathlib import Path

import numpy as np

NM_MIN, NM_MAX = 360, 830
WHOLE_NM = np.arange(NM_MIN, NM_MAX + 1.0)
DATA = Path(__file__).resolve().parent.parent / "src" / "lanes" / "spectrum" / "data"
# XYZ to linear sRGB, D65 white: IEC 61966-2-1:1999/Amd 1:2003, as in src/lanes/spectrum/observer.rs.
XYZ_TO_RGB = np.array(
    [[3.2406255, -1.537208, -0.4986286], [-0.9689307, 1.8757561, 0.0415175], [0.0557101, -0.2040211, 1.0569959]]
)
PLANCK, LIGHT_SPEED, BOLTZMANN = 6.62607015e-34, 299792458.0, 1.380649e-23


def read_csv(path):
    """Columns of a CSV file with `#` comments and at most one heading, one array each."""
    lines = [line.strip() for line in Path(path).read_text(encoding="utf-8").splitlines()]
    rows = [line.split(",") for line in lines if line and not line.startswith("#")]
    try:
        float(rows[0][0])
    except ValueError:
        rows = rows[1:]
    return np.array(rows, float).T


@cache
def observer():
    """CIE 1931 x̄, ȳ, z̄ at whole nm (3×471), and ∫ ȳ dλ in nm by which XYZ is divided."""
    table = read_csv(DATA / "cie_1931_2deg.csv")[1:]
    return table, np.trapezoid(table[1], WHOLE_NM)


@cache
def d65():
    """CIE D65 with Y = 1: wavelengths in nm, values. Simpson's rule is exact for both tables."""
    nm, values = read_csv(DATA / "cie_d65.csv")
    bars, integral = observer()
    power = np.interp(WHOLE_NM, nm, values)
    y_nodes, y_middle = power * bars[1], middle(power) * middle(bars[1])
    luminance = (y_nodes[:-1] + 4 * y_middle + y_nodes[1:]).sum() / 6 / integral
    return nm, values / luminance


def middle(values):
    """Means of neighbours."""
    return (values[1:] + values[:-1]) / 2


def blackbody(kelvin):
    """Planck's law at whole nm, W·m⁻²·sr⁻¹·nm⁻¹."""
    metres = WHOLE_NM * 1e-9
    exponent = PLANCK * LIGHT_SPEED / (metres * BOLTZMANN * kelvin)
    return WHOLE_NM, 2e-9 * PLANCK * LIGHT_SPEED**2 / metres**5 / np.expm1(exponent)


def sigmoid_fit(target, white):
    """The sigmoid of a quadratic polynomial (Jakob, Hanika 2019, eq. 5, 6) at whole nm whose linear
    sRGB under D65 is `target` times `white`, by damped Newton along the line from grey."""
    nm, power = d65()
    bars, integral = observer()
    weights = XYZ_TO_RGB @ (bars * np.interp(WHOLE_NM, nm, power)) / integral
    weights *= (np.ones(3) if white is None else 1 / weights.sum(axis=1))[:, None]
    powers = np.vander((WHOLE_NM - 595) / 235, 3, increasing=True)
    grey = float(np.clip(np.mean(target), 0.01, 0.99))
    c = np.array([(grey - 0.5) / np.sqrt(grey * (1 - grey)), 0, 0])
    for part in np.linspace(1 / 16, 1, 16):
        c = newton(c, weights, powers, grey + part * (np.asarray(target) - grey))
    return squash(powers @ c)


def squash(z):
    """½ + z/(2√(1 + z²))."""
    return 0.5 + z / (2 * np.sqrt(1 + z * z))


def newton(c, weights, powers, target):
    """Coefficients whose colour is `target`, from `c`; steps that do not help are halved."""

    def residual(c):
        return weights @ squash(powers @ c) - target

    for _ in range(100):
        error = residual(c)
        slope = 0.5 * (1 + (powers @ c) ** 2) ** -1.5
        move = np.linalg.lstsq((weights * slope) @ powers, error, rcond=None)[0]
        length = 1.0
        while length > 1e-6 and np.linalg.norm(residual(c - length * move)) > np.linalg.norm(error):
            length /= 2
        if length <= 1e-6 or np.abs(error).max() < 1e-13:
            return c
        c = c - length * move
    return c


def rgb(colour, emission):
    """The smooth spectrum of a linear sRGB colour, see src/lanes/spectrum/rgb.rs."""
    colour = np.array(colour, float)
    if not emission:
        if np.ptp(colour) == 0:
            return float(colour[0])
        return WHOLE_NM, sigmoid_fit(colour, "reflectance")
    if colour.max() == 0:
        return 0.0
    scale = 2 * colour.max()
    nm, power = d65()
    return WHOLE_NM, scale * sigmoid_fit(colour / scale, None) * np.interp(WHOLE_NM, nm, power)


def scaled(spectrum, factor):
    """The spectrum times a factor."""
    if isinstance(spectrum, float):
        return spectrum * factor
    return spectrum[0], spectrum[1] * factor


class Spectra:
    """Reads the spectra of a scene: `named` is its [spectra] table, `folder` where its files are."""

    def __init__(self, named, folder):
        self.named, self.folder = named, Path(folder)

    def read(self, form, emission):
        """The spectrum that `form` describes; colours depend on whether it is an emission."""
        if isinstance(form, int | float):
            return float(form)
        if isinstance(form, str):
            form = {"name": form}
        return scaled(self.unscaled(form, emission), form.get("scale", 1.0))

    def unscaled(self, form, emission):
        """The spectrum of a table of the file, without its factor."""
        ((kind, value),) = ((key, value) for key, value in form.items() if key != "scale")
        match kind:
            case "constant":
                return float(value)
            case "table":
                return tuple(np.array(value, float).T)
            case "csv":
                return tuple(read_csv(self.folder / value))
            case "blackbody":
                return blackbody(value)
            case "rgb":
                return rgb(value, emission)
        if value.upper() == "D65":
            return d65()
        return 1.0 if value.upper() == "E" else self.read(self.named[value], emission)
