"""The mass properties that a CAD program prints as text, as SolidWorks does."""

import re
from pathlib import Path

import numpy as np

from wirerope_mj.engine.from_tables.mass_properties import MassProperties
from wirerope_mj.foundation.errors import RecordError, why_unread
from wirerope_mj.foundation.regular_files import regular
from wirerope_mj.foundation.units import LENGTH_UNITS

_MASS = {"grams": 1e-3, "kilograms": 1.0, "pounds": 0.45359237}
_LENGTH = {"millimeters": 1e-3, "centimeters": 1e-2, "meters": 1.0, "inches": LENGTH_UNITS["in"]}
_NUMBER = r"([-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?)"
_HOW = 'Export the mass properties as text in English, with "Mass = .. kilograms", "Center of mass" and "Moments of inertia".'


def read_cad_text(path: Path, *, sign: float) -> MassProperties:
    """Return the mass properties in a text as SolidWorks writes it, about the centre of mass, in the output coordinate system.

    Args:
        path: of the text.
        sign: 1 if the text's products are elements of the tensor, -1 if they are +sum x y dm.

    Raises:
        RecordError: something is missing, in unknown units, or not said in the way above.
    """
    try:
        text = regular(path).read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        raise RecordError(f"{path}: the mass properties cannot be read: {why_unread(error)}") from None
    mass, unit = _found(path, text, rf"^\s*Mass\s*=\s*{_NUMBER}\s*(\w+)", "the mass")
    centre = _block(path, text, r"Center of mass\s*:?\s*\(\s*(\w+)\s*\)", "the centre of mass")
    place = [
        float(_found(path, centre[1], rf"\b{axis}\s*=\s*{_NUMBER}", f"{axis} of the centre of mass")[0])
        for axis in "XYZ"
    ]
    inertia = _block(
        path, text, r"Moments of inertia\s*:?\s*\(\s*(\w+\s*\*\s*square\s+\w+)\s*\)\s*Taken at the center of mass",
        "the moments of inertia taken at the center of mass",
    )  # fmt: skip
    weight, length = re.split(r"\s*\*\s*square\s+", inertia[0])
    factor = _unit(path, weight, _MASS) * _unit(path, length, _LENGTH) ** 2
    tensor = np.empty((3, 3))
    for i, first in enumerate("xyz"):
        for j, second in enumerate("xyz"):
            value = _found(path, inertia[1], rf"\bL{first}{second}\s*=\s*{_NUMBER}", f"L{first}{second}")[0]
            tensor[i, j] = float(value) * factor * (1.0 if i == j else sign)
    if not np.allclose(tensor, tensor.T, rtol=1e-4, atol=1e-6 * tensor.trace()):  # the digits that are printed
        raise RecordError(f"{path}: the moments of inertia are not symmetric: Lxy and Lyx, for instance, differ.")
    scale = _unit(path, centre[0], _LENGTH)
    return MassProperties(float(mass) * _unit(path, unit, _MASS), scale * np.array(place), 0.5 * (tensor + tensor.T))


def _found(path: Path, text: str, pattern: str, what: str) -> tuple[str, ...]:
    match = re.search(pattern, text, flags=re.MULTILINE)
    if match is None:
        raise RecordError(f"{path}: {what} is not found in this text. {_HOW}")
    return match.groups()


def _block(path: Path, text: str, heading: str, what: str) -> tuple[str, str]:
    """Return the unit in a heading and the text below it."""
    match = re.search(heading, text, flags=re.IGNORECASE)
    if match is None:
        raise RecordError(f"{path}: {what} is not found in this text. {_HOW}")
    return match[1], text[match.end() :]


def _unit(path: Path, name: str, known: dict[str, float]) -> float:
    if name not in known:
        raise RecordError(f'{path}: the unit "{name}" is unknown. Known units: {", ".join(known)}.')
    return known[name]
