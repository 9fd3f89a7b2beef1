"""Ticks of axes: round numbers inside a range, linear or logarithmic."""

import math

import numpy as np

from wirerope_mj.foundation.arrays import Array

# First digits of the numbers on a logarithmic axis; 10, 100, .. are always among them.
_DIGITS = ((1.0, 2.0, 3.0, 5.0, 7.0), (1.0, 2.0, 5.0), (1.0, 2.0, 4.0), (1.0, 3.0), (1.0,))
_CLOSER = 0.9  # of what each of the numbers would have: by so much two of them may stand closer


def log_ticks(low: float, high: float, *, most: int = 12) -> Array:
    """Choose round numbers for a logarithmic axis from `low` to `high`: as many as fit, every power of ten among them.

    Of an axis on which `most` numbers fit, none stand closer than that. Where not even the powers of ten fit, every second,
    third .. of them stands there; where there are none, numbers are in equal steps.
    """
    powers = _powers(low, high)
    equal = [linear_ticks(low, high, most=count) for count in range(min(most, 6), 1, -1)]
    whole = _inside(powers, low, high)
    chosen = [(powers[:, None] * np.array(digits)).ravel() for digits in _DIGITS]
    chosen += [ticks for ticks in equal if all(np.isclose(ticks, power, rtol=1e-9).any() for power in whole)]
    chosen += [whole[::step] for step in range(2, whole.size)]
    room = _CLOSER * math.log(high / low) / most
    fitting = [
        ticks for choice in chosen if (ticks := _inside(choice, low, high)).size > 1 and np.diff(np.log(ticks)).min() >= room
    ]
    fitting += [thinned for ticks in equal if not fitting and (thinned := _thin_out(ticks, whole, room)).size > 1]
    if fitting:
        return max(fitting, key=len)
    return next((ticks for ticks in equal[::-1] if ticks.size > 1), linear_ticks(low, high, most=6))


def log_lines(low: float, high: float) -> Array:
    """Return the numbers of one significant digit from `low` to `high`, for grid lines of a logarithmic axis."""
    return _inside((_powers(low, high)[:, np.newaxis] * np.arange(1, 10)).ravel(), low, high)


def _powers(low: float, high: float) -> Array:
    return np.asarray(10.0 ** np.arange(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1), dtype=np.float64)


def _inside(ticks: Array, low: float, high: float) -> Array:
    return ticks[(ticks >= low * (1.0 - 1e-9)) & (ticks <= high * (1.0 + 1e-9))]


def _thin_out(ticks: Array, whole: Array, room: float) -> Array:
    """Return the powers of ten, and the other ticks that keep a distance from these and from each other."""
    kept = list(whole)
    for tick in ticks:
        if all(abs(math.log(tick / neighbour)) >= room for neighbour in kept):
            kept.append(tick)
    return np.sort(kept)


def linear_ticks(low: float, high: float, *, most: int = 6) -> Array:
    """Return equally spaced round numbers inside a range, about `most` of them."""
    rough = (high - low) / most
    power = 10.0 ** math.floor(math.log10(rough))
    step = power * min((1.0, 2.0, 5.0, 10.0), key=lambda digit: abs(math.log(digit * power / rough)))
    return np.asarray(np.arange(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1) * step)
