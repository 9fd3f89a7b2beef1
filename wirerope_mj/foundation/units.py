"""Units of files and of what people read, and what one of each is in SI; the library itself speaks SI."""

import math
from collections.abc import Mapping
from typing import overload

from wirerope_mj.foundation.arrays import Array

STANDARD_GRAVITY = 9.80665  # Standard acceleration of free fall [m/s^2] (ISO 80000-3), the g of shock levels
TIME_UNITS = {"s": 1.0, "ms": 1e-3}
LENGTH_UNITS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254}
FORCE_UNITS = {"N": 1.0, "daN": 10.0, "kN": 1e3, "lbf": 4.4482216152605, "kip": 4448.2216152605}
STIFFNESS_UNITS = {"N/mm": 1e3, "lb/in": 175.12683524647636}  # of vendors' tables; 4.4482216152605 N / 0.0254 m
VELOCITY_UNITS = {"m/s": 1.0, "mm/s": 1e-3, "cm/s": 1e-2, "in/s": 0.0254}
ACCELERATION_UNITS = {
    "m/s^2": 1.0, "m/s2": 1.0, "m/s²": 1.0, "g": STANDARD_GRAVITY, "mm/s^2": 1e-3, "mm/s2": 1e-3, "cm/s^2": 1e-2, "cm/s2": 1e-2,
    "gal": 1e-2, "in/s^2": 0.0254, "ft/s^2": 0.3048,
}  # fmt: skip
_POUND = 0.45359237
# units of each kind of quantity in the tables of a model, in SI; an inch is 25.4 mm, a pound 0.45359237 kg (both exact)
UNITS: dict[str, Mapping[str, float]] = {
    "length": {"mm": 1e-3} | LENGTH_UNITS,
    "mass": {"kg": 1.0, "t": 1e3, "g": 1e-3, "lb": _POUND},
    "inertia": {
        "kg m^2": 1.0, "kg m2": 1.0, "kg m²": 1.0, "kg*m^2": 1.0, "kg mm^2": 1e-6, "kg mm2": 1e-6, "kg*mm^2": 1e-6,
        "t m^2": 1e3, "g mm^2": 1e-9, "lb in^2": _POUND * LENGTH_UNITS["in"] ** 2,
    },
    "time": TIME_UNITS,
    "angle": {"deg": math.pi / 180.0, "°": math.pi / 180.0, "rad": 1.0},
    "stiffness": {
        f"{force}/{length}": newtons / metres
        for force, newtons in FORCE_UNITS.items() for length, metres in (("m", 1.0), ("mm", 1e-3))
    } | {"MN/m": 1e6},
    "frequency": {"Hz": 1.0},
    "ratio": {"%": 0.01, "-": 1.0},
    "damping": {"N s/m": 1.0, "kN s/m": 1e3, "N s/mm": 1e3},
}  # fmt: skip
_SHOWN = {"m": ("mm", 1e3), "N": ("kN", 1e-3), "m/s^2": ("g", 1.0 / STANDARD_GRAVITY)}
# Displayed units to one SI unit; the g is a divisor, so that integers of it stay integers.
_PER_SI = {
    "mm": 1e3, "ms": 1e3, "mrad": 1e3, "kN": 1e-3, "kN/m": 1e-3, "mm/s": 1e3, "N/mm": 1e-3, "MB": 1e-6, "%": 100.0,
    "g²/Hz": STANDARD_GRAVITY**-2,
}  # fmt: skip


def shown_in(unit: str) -> tuple[str, float]:
    """Return the unit in which an engineer reads values of an SI unit, and the factor into it; else the unit itself and 1."""
    return _SHOWN.get(unit, (unit, 1.0))


def in_si(value: float, factor: float) -> float:
    """Return a value of a data sheet times its unit, to twelve digits: 6.8 mm are 0.0068 m, not 0.006799999999999999 m."""
    return float(f"{value * factor:.12g}")


@overload
def in_unit(value: float, unit: str) -> float: ...


@overload
def in_unit(value: Array, unit: str) -> Array: ...


def in_unit(value: float | Array, unit: str) -> float | Array:
    """Return SI values in the unit that is displayed: one of `_PER_SI`, such as "mm" or "kN", or "g"; else as they are."""
    if unit == "g":
        return value / STANDARD_GRAVITY
    return _PER_SI[unit] * value if unit in _PER_SI else value


def significant(value: float, digits: int = 3) -> str:
    """Return a number to some significant digits without an exponent, whole digits never cut: 0.00123, 1.23, 123, 12345."""
    if value == 0.0 or abs(value) < 1e-9:  # nothing that is shown in mm, kN or g is that small and not rounding
        return "0"
    rounded = abs(float(f"{value:.{digits - 1}e}"))  # 9.9999 is 10.0, not 10.00
    decimals = max(digits - 1 - math.floor(math.log10(rounded)), 0)
    return f"{value:z.{min(decimals, 6)}f}"


def instant_text(time: float) -> str:
    """Return an instant [s] as sentences say it: "61.2 ms", "1.2345 s"."""
    return f"{1e3 * time:.1f} ms" if time < 1.0 else f"{time:.4f} s"


def duration_text(value: float, digits: int = 3) -> str:
    """Return a duration [s] in ms, from 1 s on in s, to some significant digits without an exponent: 11 ms, 1.59 s, 3600 s."""
    text, unit = significant(1e3 * value, digits), "ms"
    if abs(float(text)) >= 1e3:
        text, unit = significant(value, digits), "s"
    return f"{text.rstrip('0').rstrip('.') if '.' in text else text} {unit}"
