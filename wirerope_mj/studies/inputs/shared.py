"""One draw that several quantities share, as the stiffness of all mounts and the mass that was weighed with them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions import BaseMotion
from wirerope_mj.studies.inputs.column import Draft, InputColumn

TOGETHER = " & "
"""Stands between names that share a draw."""


@dataclass(frozen=True, kw_only=True)
class SharedDraw(InputColumn):
    """One number that several columns take.

    Attributes:
        shared: these columns.
    """

    form = f"NAME{TOGETHER}NAME"

    shared: tuple[InputColumn, ...]

    @property
    def parts(self) -> tuple[InputColumn, ...]:
        """The columns that share the draw."""
        return self.shared

    @property
    def nature_of_numbers(self) -> str:
        """Nature of the numbers, which is one for all."""
        return self.shared[0].nature_of_numbers

    @property
    def unit(self) -> str:
        """Unit of the numbers."""
        return self.shared[0].unit

    def nominal(self, system: System, motions: Sequence[BaseMotion] = ()) -> list[Any]:
        """Return nothing: the quantities have values of their own."""
        return []

    def apply(self, draft: Draft, value: Any) -> None:
        """Put the value into all of them."""
        for column in self.shared:
            column.apply(draft, value)

    def certainly_valid(self, draft: Draft, values: npt.NDArray[Any]) -> bool:
        """Return whether all values are valid in all of them."""
        return all(column.certainly_valid(draft, values) for column in self.shared)

    def moved(self, system: System, values: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
        """Return in which variants something stands elsewhere than in the model."""
        return np.any([column.moved(system, values) for column in self.shared], axis=0)

    def warnings(self, system: System, values: Array) -> list[str]:
        """Return the messages of all of them."""
        return [message for column in self.shared for message in column.warnings(system, values)]


def share(name: str, columns: Sequence[tuple[InputColumn, ...]]) -> tuple[SharedDraw, ...]:
    """Return the columns of names that share a draw: one, or with `each` as many as every name has targets.

    Raises:
        ValueError: they cannot share one.
    """
    every = [column for own in columns for column in own]
    if any(not column.targets or column.type != pa.float64() for column in every):
        raise ValueError(f"`vary`: {name!r}: only numbers of mounts and bodies can share a draw.")
    if len({len(own) for own in columns}) > 1:
        counts = " and ".join(str(len(own)) for own in columns)
        raise ValueError(f"`vary`: {name!r}: with `each` the names must match as many mounts, got {counts}.")
    if len({(column.nature_of_numbers, column.unit) for column in every}) > 1:
        kinds = ", ".join(dict.fromkeys(f"{one.nature_of_numbers} {one.unit}".strip() for one in every))
        raise ValueError(
            f"`vary`: {name!r}: the numbers must be of one kind, got {kinds}; factors are, with `relative`."
        )
    return tuple(
        SharedDraw(
            name=TOGETHER.join(column.name for column in together),
            targets=tuple(dict.fromkeys(target for column in together for target in column.targets)),
            shared=together,
        )
        for together in zip(*columns, strict=True)
    )
