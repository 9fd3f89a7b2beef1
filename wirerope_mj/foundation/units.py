"""Unit conversions that more than one room needs; the library itself speaks SI."""

STANDARD_GRAVITY = 9.80665
"""Standard acceleration of free fall [m/s^2] (ISO 80000-3), the g of shock levels."""

LENGTH_UNITS = {"m": 1.0, "mm": 1e-3, "in": 0.0254}
"""Units of deflections that data sheets use, and what one of them is in metres."""

FORCE_UNITS = {"N": 1.0, "daN": 10.0, "kN": 1e3, "lbf": 4.4482216152605}
"""Units of forces that data sheets use, and what one of them is in newtons."""

_SHOWN = {"m": ("mm", 1e3), "N": ("kN", 1e-3), "m/s^2": ("g", 1.0 / STANDARD_GRAVITY)}


def shown_in(unit: str) -> tuple[str, float]:
    """Return the unit in which an engineer reads values of an SI unit, and the factor into it; else the unit itself and 1."""
    return _SHOWN.get(unit, (unit, 1.0))
