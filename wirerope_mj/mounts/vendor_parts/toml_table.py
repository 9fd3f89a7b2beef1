"""A table of a vendor's data sheet in the vendor's own units, read with messages that name file, table and key."""

from collections.abc import Callable
from typing import Any

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.units import FORCE_UNITS, LENGTH_UNITS, STIFFNESS_UNITS, in_si

_UNITS = {**LENGTH_UNITS, **FORCE_UNITS, **{unit.replace("/", "_per_"): n for unit, n in STIFFNESS_UNITS.items()}, "Hz": 1.0}
LENGTH, FORCE, STIFFNESS, FREQUENCY = ("mm", "in"), ("N", "daN", "kN"), ("N_per_mm", "lb_per_in"), ("Hz",)
_LARGEST = 1e9  # number that no data sheet states, in any of these units; nor does any state one over it
Pairs = list[tuple[float, float]]


class TomlTable:
    """Entries of one table; each method takes one out of it in SI units, or raises ModelError."""

    def __init__(self, content: object, location: str) -> None:
        if not isinstance(content, dict):
            raise ModelError(f"{location} must be a table, got {content!r}.")
        self.location = location  # file and table, for messages
        self.entries: Entries = dict(content)  # what was not taken yet

    def quantity(self, name: str, units: tuple[str, ...]) -> float:
        """Take a quantity > 0 whose key ends with its unit."""
        value = self.optional_quantity(name, units)
        if value is None:
            raise ModelError(f"{self.location} {' or '.join(f'`{name}_{unit}`' for unit in units)} is missing.")
        return value

    def optional_quantity(self, name: str, units: tuple[str, ...]) -> float | None:
        """Take a quantity > 0 whose key ends with its unit; None where there is none."""
        for unit in units:
            if (value := self.optional_number(f"{name}_{unit}")) is not None:
                return in_si(value, _UNITS[unit])
        return None

    def optional_number(self, key: str) -> float | None:
        """Take a number > 0; None where there is none."""
        value = self._optional(key, None, _is_positive, f"a finite number > 0, from {1.0 / _LARGEST:g} to {_LARGEST:g}")
        return None if value is None else float(value)

    def optional_integer(self, key: str) -> int | None:
        """Take an integer > 0; None where there is none."""
        return self._optional(key, None, lambda value: isinstance(value, int) and _is_positive(value), "an integer > 0")

    def flag(self, key: str) -> bool:
        """Take true or false; False where there is none."""
        return self._optional(key, False, lambda value: isinstance(value, bool), "true or false")

    def text(self, key: str) -> str:
        """Take a string."""
        self.entries.setdefault(key, None)
        return self._optional(key, "", lambda value: isinstance(value, str), "a string")

    def texts(self, key: str) -> tuple[str, ...]:
        """Take a list of strings, empty where there is none."""
        return tuple(self._optional(key, [], lambda value: _is_list(value, str), "a list of strings"))

    def pairs(self, key: str) -> Pairs:
        """Take pairs of numbers > 0 as they are, none where there are none."""
        rows = self._optional(key, [], _are_pairs, "pairs of numbers > 0")
        return [(float(x), float(y)) for x, y in rows]

    def require_empty(self) -> None:
        """Raise ModelError if an entry was not taken."""
        for key in self.entries:
            advice = " Tension follows from the rope loop: leave it out." if key == "tension_ratio" else ""
            raise ModelError(f"{self.location} `{key}` is not known.{advice}")

    def _optional(self, key: str, default: object, valid: Callable[[Any], bool], rule: str) -> Any:
        if key not in self.entries:
            return default
        value = self.entries.pop(key)
        if not valid(value):
            raise ModelError(f"{self.location} `{key}` must be {rule}, got {value!r}.")
        return value


def _is_positive(value: object) -> bool:
    return not isinstance(value, bool) and isinstance(value, int | float) and 1.0 / _LARGEST <= value <= _LARGEST


def _is_list(value: object, kind: type) -> bool:
    return isinstance(value, list) and all(isinstance(item, kind) for item in value)


def _are_pairs(value: list[list[object]]) -> bool:
    return _is_list(value, list) and all(len(row) == 2 and all(map(_is_positive, row)) for row in value)
