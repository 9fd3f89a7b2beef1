"""Unit conversions that more than one room needs; the library itself speaks SI."""

STANDARD_GRAVITY = 9.80665
"""Standard acceleration of free fall [m/s^2] (ISO 80000-3), the g of shock levels."""

_SHOWN = {"m": ("mm", 1e3), "N": ("kN", 1e-3), "m/s^2": ("g", 1.0 / STANDARD_GRAVITY)}


def shown_in(unit: str) -> tuple[str, float]:
    """Return the unit in which an engineer reads values of an SI unit, and the factor into it; else the unit itself and 1."""
    return _SHOWN.get(unit, (unit, 1.0))
