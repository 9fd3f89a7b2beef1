"""What a sampled number is, a value, a shift or a factor, in which unit, and what the model says of the same quantity."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.centres import body_axes, centre_of_mass
from wirerope_mj.motions import BaseMotion
from wirerope_mj.studies.inputs.quantities import STIFFENING, WORLD, Column

UNITS = {
    "law": "SI", "mass": "kg", "centre": "m", "centre_shift": "m", "position_shift": "m", "azimuth": "°", "elevation": "°"
}  # fmt: skip
"""Units of values and shifts by the kind of column; parameters of laws have those that their law states."""

SHIFTS = ("centre_shift", "position_shift")
"""Kinds of columns that are added to what the model says."""

_KINDS = {"level": "factor", "record": "index", "fitted": "choice", "failed": "choice"}


def kind_of(column: Column) -> str:
    """Return what the numbers of a column are: "value", "shift", "factor", "index" or "choice"."""
    if column.relative:
        return "factor"
    return "shift" if column.kind in SHIFTS else _KINDS.get(column.kind, "value")


def unit_of(column: Column) -> str:
    """Return the unit of a column's numbers; "" of factors, indices and choices."""
    return "" if column.relative else UNITS.get(column.kind, "")


def column_label(column: Column) -> str:
    """Return the name of a column with the unit of its numbers, as an axis or a heading says it."""
    unit = "factor" if kind_of(column) == "factor" else unit_of(column)
    return column.name if unit in ("", "SI") else f"{column.name} [{unit}]"


def nominal(column: Column, system: System, motions: Sequence[BaseMotion]) -> list[Any]:
    """Return what the model says of a column's quantity, one value for each target; empty where it says nothing.

    Of a shift it is the position that is shifted, of a factor the value that is multiplied: [m], [kg], SI, [deg].
    """
    if column.kind in ("azimuth", "elevation"):
        return _angle(column.kind, motions)
    if column.kind == "level":
        return [1.0]
    if not column.targets or (column.kind == "failed" and column.type == "string"):
        return []
    return [_of_target(column, system, target) for target in column.targets]


def nominal_text(values: Sequence[Any], unit: str) -> str:
    """Return nominal values as a cell: "0.35 m", "0.2 to 0.9 m", "True"; "-" where there are none."""
    numbers = np.concatenate([np.ravel(value) for value in values]) if values else np.empty(0)
    if numbers.size == 0:
        return "-"
    if numbers.dtype == np.bool_:
        return " or ".join(map(str, np.unique(numbers)))
    lowest, highest = f"{numbers.min():.4g}", f"{numbers.max():.4g}"
    text = lowest if lowest == highest else f"{lowest} to {highest}"
    return f"{text} {unit}" if unit not in ("", "SI") else text


def model_unit(column: Column) -> str:
    """Return the unit of a column's nominal values: of a factor that of what it multiplies."""
    return UNITS.get(column.kind, "")


def _of_target(column: Column, system: System, target: str) -> Any:
    if column.kind == "mass":
        return float(system.model.body(target).mass[0])
    if column.kind == "centre":
        return float(centre_of_mass(system, target)[WORLD.index(column.key[0])])
    if column.kind == "centre_shift":
        return float((body_axes(system, target) @ centre_of_mass(system, target))[WORLD.index(column.key[0])])
    if column.kind == "position_shift":
        return float(system.mounts[target].position[WORLD.index(column.key[0])])
    if column.kind in ("fitted", "failed"):
        return column.kind == "fitted"
    if column.kind == STIFFENING:
        return float(getattr(system.mounts[target].written.stiffening, column.key[1]))
    law = system.mounts[target].written.axes[column.key[0]]
    assert law is not None  # `quantities` has seen to it
    return law.parameter(column.key[1])


def _angle(kind: str, motions: Sequence[BaseMotion]) -> list[float]:
    """Return azimuth or elevation of the motions' directions [deg]; of a vertical motion there is no azimuth."""
    angles = []
    for x, y, z in np.concatenate([motion.directions for motion in motions]).tolist():
        level = math.hypot(x, y)
        if kind == "elevation":
            angles.append(math.degrees(math.atan2(z, level)))
        elif level > 0.0:
            angles.append(math.degrees(math.atan2(y, x)))
    return angles
