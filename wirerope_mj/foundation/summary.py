"""Results in a few lines: as text in a terminal, as a small table in a notebook, as values that JSON knows."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from html import escape
from typing import Any, TypeVar

import numpy as np

from wirerope_mj.foundation.plain_text import plain, short
from wirerope_mj.foundation.units import shown_in

Item = TypeVar("Item")

# Letters of a value in a summary.
_LONGEST = 90
# Letters of a call that is shown as it is.
_LONGEST_CALL = 1000
# Lines of a summary: what is longer is looked up by name rather than read.
MOST_LINES = 12


class Summarised:
    """Base of results that summarise themselves in a few lines; dataclasses need `repr=False`."""

    def _summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and values with their units as texts by name."""
        raise NotImplementedError

    def _lines(self) -> tuple[str, list[tuple[str, str]]]:
        heading, values = self._summary()
        rows = [(plain(name), plain(value)) for name, value in values.items()]
        if len(rows) >= MOST_LINES:
            rows = [*rows[: MOST_LINES - 2], ("...", f"and {len(rows) - MOST_LINES + 2} more")]
        return plain(heading), rows

    def __repr__(self) -> str:
        heading, rows = self._lines()
        width = max((len(name) for name, _ in rows), default=0)
        return "\n".join([heading, *(f"  {name:{width}}  {value}".rstrip() for name, value in rows)])

    def _repr_html_(self) -> str:
        heading, rows = self._lines()
        cells = "".join(
            f'<tr><td style="text-align:left">{escape(name)}</td><td style="text-align:left">{escape(value)}</td></tr>'
            for name, value in rows
        )
        return f"<table><caption>{escape(heading)}</caption>{cells}</table>"


class Brief(Summarised):
    """Base of dataclasses that summarise each field in a few words: arrays by shape, names by number."""

    def _summary(self) -> tuple[str, dict[str, str]]:
        values = {item.name: getattr(self, item.name) for item in fields(self) if item.repr}  # type: ignore[arg-type]
        name = values.pop("name", "")
        return f"{type(self).__name__} {name}".rstrip(), {key: in_brief(value) for key, value in values.items()}


class AsCall:
    """Base of dataclasses whose text is the call that makes them, with long values cut; they need `repr=False`."""

    def __repr__(self) -> str:
        values = {item.name: repr(getattr(self, item.name)) for item in fields(self) if item.repr}  # type: ignore[arg-type]
        whole = sum(map(len, values.values())) <= _LONGEST_CALL
        parts = [f"{name}={value if whole else short(value, _LONGEST)}" for name, value in values.items()]
        return f"{type(self).__name__}({', '.join(parts)})"


class ByName(dict[str, Item]):
    """A dictionary whose text lists its names alone."""

    def __repr__(self) -> str:
        return f"{len(self)} by name: {_listed(self)}"


def in_brief(value: object) -> str:
    """Format a value in a few words."""
    if isinstance(value, np.ndarray):
        return f"array of shape {value.shape}"
    if isinstance(value, Summarised):
        return value._lines()[0]
    if isinstance(value, Mapping):
        return f"{len(value)}: {_listed(value)}" if value else "none"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, tuple) and value and is_dataclass(value[0]):
        return f"{len(value)} of {type(value[0]).__name__}"
    text = value if isinstance(value, str) else repr(value)
    return short(text, _LONGEST) if len(text) <= 10 * _LONGEST or isinstance(value, str) else f"{type(value).__name__}"


def _listed(names: Iterable[object]) -> str:
    return short(", ".join(map(str, names)), _LONGEST)


def quantity(value: float, unit: str) -> str:
    """Format a value in SI with the unit in which an engineer reads it: "31.2 mm"."""
    shown, factor = shown_in(unit)
    return f"{value * factor:.4g} {shown}".strip() if math.isfinite(value) else "not known"


def span(values: tuple[float, float], unit: str) -> str:
    """Format a range in SI with the unit in which an engineer reads it: "5 to 80 Hz"."""
    shown, factor = shown_in(unit)
    return f"{values[0] * factor:.4g} to {values[1] * factor:.4g} {shown}".strip()


def json_values(value: Any) -> Any:
    """Convert a value, or those in dictionaries and lists, to JSON's: floats that are NaN or infinite become None."""
    if isinstance(value, dict):
        return {name: json_values(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [json_values(item) for item in value]
    if isinstance(value, float):  # NumPy's double is one of them
        return float(value) if math.isfinite(value) else None
    return value
