"""Shifts along an axis of the world, which are added to a position of the model."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import AnyArray, Array, Booleans
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.studies.inputs.column import Draft, Entry, InputColumn, matching, parts_of

WORLD = ("x", "y", "z")
NEAR = 1e-6  # Distance from 0 below which a position is 0 [m]: there a value and a shift are the same


@dataclass(frozen=True, kw_only=True)
class Shift(InputColumn):
    """Shift [m] of what stands somewhere; its key is the axis."""

    nature = "shift"
    model_unit = "m"
    bounds = "finite"

    mirrored: tuple[str, ...] = ()  # targets that move the other way

    @classmethod
    def shifted(cls, entry: Entry, existing: Sequence[str], noun: str, stops: Sequence[str] = ()) -> tuple[Self, ...]:
        """Return the columns of a shift; what stands behind a minus moves the other way: "m01,m04,-m13,-m16"."""
        check_axis(entry, "a shift")

        def match(parts: list[str]) -> list[str]:
            return matching(replace(entry, pattern=",".join(parts)), existing, noun, stops) if parts else []

        parts = parts_of(entry.pattern, existing)
        every = match([part.removeprefix("-") for part in parts])
        mirrored = match([part[1:] for part in parts if part.startswith("-")])
        straight = match([part for part in parts if not part.startswith("-")])
        if both := set(mirrored) & set(straight):
            raise ValueError(f"`vary`: {entry.name!r}: {min(both)!r} cannot move both ways.")
        columns = cls.split(entry, every)
        return tuple(replace(one, mirrored=tuple(t for t in one.targets if t in mirrored)) for one in columns)

    def shifts_of(self, draft: Draft) -> dict[str, list[float]]:
        """Return the shifts of a variant to which this one belongs."""
        raise NotImplementedError

    def apply(self, draft: Draft, value: Any) -> None:
        """Add the shift to those of the targets."""
        check_finite(self.name, value)
        for target in self.targets:
            shift = self.shifts_of(draft).setdefault(target, [0.0, 0.0, 0.0])
            shift[WORLD.index(self.key[0])] = -value if target in self.mirrored else value

    def moved(self, system: System, values: AnyArray) -> Booleans:
        """Return in which variants something is shifted."""
        return np.asarray(values != 0.0)

    def warnings(self, system: System, values: Array) -> list[str]:
        """Return a message if all shifts are nearer to a position of the model than to 0."""
        low, high = float(values.min()), float(values.max())
        middle = (low + high) / 2.0
        positions = [position for position in self.nominal(system) if abs(position) > NEAR]
        if low <= 0.0 <= high or not any(abs(middle - position) < abs(middle) for position in positions):
            return []
        return [
            f"{self.name} is a shift, from {low:.3g} to {high:.3g} m in the study, of what stands at "
            f"{self.nominal_text(system)} in the model; if these are positions, {self.remedy(system)}."
        ]

    def remedy(self, system: System) -> str:
        """Return how positions are given."""
        return "take the model's position off them"


def check_axis(entry: Entry, noun: str) -> None:
    """Raise an error unless there is such an axis, and the distribution is of lengths."""
    (axis,) = entry.key
    if axis not in WORLD:
        raise ModelError(f"`vary`: {entry.name!r}: there is no axis {axis!r}; there are {', '.join(WORLD)}.")
    if entry.distribution.relative:
        raise ValueError(f"`vary`: {entry.name!r} is {noun} [m] and cannot be relative.")


def check_finite(name: str, value: float) -> None:
    """Raise ValueError unless a sampled value is finite."""
    if not np.isfinite(value):
        raise ValueError(f"{name} must be finite, got {value}.")
