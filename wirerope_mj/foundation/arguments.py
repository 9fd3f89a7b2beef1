"""Checks of arguments: each returns a plain Python value, or raises a ValueError: what must hold, and what was got."""

import math
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.plain_text import quoted


def finite(name: str, value: object, *, unit: str = "") -> float:
    """Return a finite number as a float; text and booleans are refused. `unit` appears in the message: "m"."""
    try:
        number = math.nan if isinstance(value, str | bool | np.bool_) else float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"`{name}` must be a finite number{_in(unit)}, got {quoted(_plain(value))}.")
    return number


def positive(name: str, value: object, *, unit: str = "") -> float:
    """Return a finite number > 0 as a float."""
    number = finite(name, value, unit=unit)
    if number <= 0.0:
        raise ValueError(f"`{name}` must be > 0{_in(unit)}, got {number!r}.")
    return number


def not_negative(name: str, value: object, *, unit: str = "") -> float:
    """Return a finite number >= 0 as a float."""
    number = finite(name, value, unit=unit)
    if number < 0.0:
        raise ValueError(f"`{name}` must be >= 0{_in(unit)}, got {number!r}.")
    return number


def between(name: str, value: object, low: float, high: float) -> float:
    """Return a number from `low` to `high`, both included, as a float."""
    number = finite(name, value)
    if not low <= number <= high:
        raise ValueError(f"`{name}` must lie between {low:g} and {high:g}, got {number!r}.")
    return number


def nonzero(name: str, value: object) -> float:
    """Return a finite number other than zero as a float."""
    number = finite(name, value)
    if number == 0.0:
        raise ValueError(f"`{name}` must not be zero.")
    return number


def integer(name: str, value: object, *, least: int) -> int:
    """Return an integer >= `least` as an int; 2.0 and booleans are refused."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
        raise ValueError(f"`{name}` must be an integer >= {least}, got {quoted(_plain(value))}.")
    return int(value)


def one_of(name: str, value: object, choices: Collection[str]) -> str:
    """Return a string that is one of the choices."""
    if not isinstance(value, str) or value not in choices:
        raise ValueError(f"`{name}` must be one of {', '.join(map(repr, choices))}, got {quoted(value)}.")
    return value


def the_one_given(arguments: Mapping[str, Any]) -> tuple[str, Any]:
    """Return name and value of the one argument that is not None; ValueError if none or several are given."""
    stated = {name: value for name, value in arguments.items() if value is not None}
    if len(stated) != 1:
        *first_names, last = (f"`{name}`" for name in arguments)
        got = " and ".join(f"`{name}`" for name in stated) or "none"
        raise ValueError(f"exactly one of {', '.join(first_names)} and {last} must be given, got {got}.")
    return next(iter(stated.items()))


def as_times(time: ArrayLike) -> Array:
    """Return the times as an array (n_t,); a single time becomes an array of one."""
    times = np.atleast_1d(np.asarray(time, dtype=float))
    if times.ndim != 1:
        raise ValueError(f"`time` must be a number or one-dimensional, got shape {times.shape}.")
    return times


def _in(unit: str) -> str:
    return f" [{unit}]" if unit else ""


def _plain(value: object) -> object:
    return value.item() if isinstance(value, np.generic) else value
