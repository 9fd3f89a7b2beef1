"""Unit conversions that more than one room needs; the library itself speaks SI."""

STANDARD_GRAVITY = 9.80665
"""Standard acceleration of free fall [m/s^2] (ISO 80000-3), the g of shock levels."""
