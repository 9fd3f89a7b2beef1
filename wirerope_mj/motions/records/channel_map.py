"""Phrases that say what a measured column is: "point/rack_top z g" is an acceleration in g along z at the point rack_top."""

import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from wirerope_mj.foundation.units import ACCELERATION_UNITS, FORCE_UNITS, LENGTH_UNITS, VELOCITY_UNITS, find_unit

Quantity = Literal["acceleration", "velocity", "displacement", "deflection", "force"]
Axis = Literal["x", "y", "z"]
UNITS: Mapping[Quantity, Mapping[str, float]] = {
    "acceleration": ACCELERATION_UNITS, "velocity": VELOCITY_UNITS, "displacement": LENGTH_UNITS, "deflection": LENGTH_UNITS,
    "force": FORCE_UNITS,
}  # fmt: skip
"""Units of each quantity, and what one of each is in SI."""

SI: Mapping[Quantity, str] = {"acceleration": "m/s^2", "velocity": "m/s", "displacement": "m", "deflection": "m", "force": "N"}
_OF_MOUNT: Mapping[str, Axis] = {"roll": "x", "shear": "y", "axial": "z"}
_KINDS = ("body", "point", "mount")
_EXAMPLES = '"base z g", "point/rack_top -x g", "body/floor displacement z mm" or "mount/m1 axial force kN"'


@dataclass(frozen=True, kw_only=True)
class ChannelPhrase:
    """What a column of a file is, as far as its phrase says."""

    subject: str  # "base", "body/NAME", "point/NAME" or "mount/NAME"
    quantity: Quantity | None  # None where only the unit in the file's header can say
    axis: Axis  # of the world; of a mount x is roll, y shear, z axial
    sign: float  # -1.0 for a sensor that points the other way
    unit: str | None  # None where the file's header says it
    # of a displacement of a body or a point: whether it is that in space and not that relative to the base
    absolute: bool

    def quantity_of(self, unit: str) -> Quantity | None:
        """Return the quantity that the phrase states, or that of a unit; None if the unit is not one of it."""
        if self.quantity is not None:
            return self.quantity if find_unit(unit, UNITS[self.quantity]) else None
        return quantity_of(unit, mount=self.subject.startswith("mount/"))


def quantity_of(unit: str, *, mount: bool) -> Quantity | None:
    """Return the quantity that a unit is of, None if it is not known: lengths are displacements, of a mount deflections."""
    for quantity, units in UNITS.items():
        if find_unit(unit, units) and mount == (quantity in ("deflection", "force")):
            return quantity
    return None


def parse_channel(column: str, phrase: str) -> ChannelPhrase:
    """Parse what a column is: a subject, then in any order an axis with its sign, a quantity, a unit, "absolute".

    A name with spaces stands in quotation marks. ValueError says what is missing, said twice or unknown.
    """
    try:
        subject, *words = shlex.split(phrase)
    except ValueError:
        raise _refused(column, phrase, "does not say what the column is") from None
    kind, _, name = subject.partition("/")
    if subject != "base" and not (kind in _KINDS and name):
        raise _refused(column, phrase, f"begins with {subject!r}, which is neither base nor body/, point/ or mount/NAME")
    is_mount = kind == "mount"
    found: dict[str, str] = {}
    for word in words:
        bare = word.strip("[]()")
        axis = bare.lstrip("+-")
        if axis in ("x", "y", "z", *_OF_MOUNT):
            if (axis in _OF_MOUNT) != is_mount:
                axes = "roll, shear or axial" if is_mount else "x, y or z"
                raise _refused(column, phrase, f"has the axis {axis}: the axis of {_called(subject)} is {axes}")
            role = "axis"
        elif bare in UNITS:
            role = "quantity"
        elif any(find_unit(bare, units) for units in UNITS.values()):
            role = "unit"
        elif bare in ("absolute", "relative"):
            role = "reference"
        else:
            raise _refused(column, phrase, f"has the word {word!r}, which is no axis, quantity or unit")
        if role in found:
            raise _refused(column, phrase, f"states two of {role}: {found[role]} and {bare}")
        found[role] = bare
    if "axis" not in found:
        raise _refused(column, phrase, "does not say the axis")
    quantity, unit, word = found.get("quantity"), found.get("unit"), found["axis"]
    axis = word.lstrip("+-")
    parsed = ChannelPhrase(
        subject=subject, quantity=next((one for one in UNITS if one == quantity), None),
        axis=_OF_MOUNT.get(axis) or ("x" if axis == "x" else "y" if axis == "y" else "z"),
        sign=-1.0 if word.startswith("-") else 1.0, unit=unit, absolute=found.get("reference") == "absolute",
    )  # fmt: skip
    if unit is not None and parsed.quantity_of(unit) is None:
        stated = quantity or f"anything measured at {_called(subject)}"
        raise _refused(column, phrase, f"has the unit {unit}, which is none of {stated}")
    if is_mount != (quantity in ("deflection", "force")) and quantity is not None:
        has = "deflection and force" if is_mount else "acceleration, velocity and displacement"
        raise _refused(column, phrase, f"asks for the {quantity} of {_called(subject)}, which has {has}")
    return parsed


def _called(subject: str) -> str:
    return "the base" if subject == "base" else f"a {subject.partition('/')[0]}"


def _refused(column: str, phrase: str, fault: str) -> ValueError:
    return ValueError(f"`channels` must say what column {column!r} is, such as {_EXAMPLES}; {phrase!r} {fault}.")
