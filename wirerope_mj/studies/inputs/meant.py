"""Whether values, shifts and factors of a study can be what was meant: each is held against what the model says."""

from collections.abc import Sequence

import numpy as np
import pyarrow as pa

from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.centres import body_axes, is_aligned
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.studies.inputs.distributions import Choice, Distribution, Normal, Uniform
from wirerope_mj.studies.inputs.nominal import SHIFTS, model_unit, nominal, nominal_text
from wirerope_mj.studies.inputs.quantities import Column, Quantity

FAR = 10.0
"""How far, as a factor, all values of a parameter lie from the model's if they were meant as factors on it, perhaps."""

NEAR = 1e-6
"""Distance from 0 below which a position is 0 [m]: there a value and a shift are the same."""


def check_centres(quantities: Sequence[Quantity], system: System) -> None:
    """Raise ValueError if centres of mass are said in two ways, or positions of them look like shifts.

    A value whose middle is nearer to 0 than to the model's is refused: it is what a shift looks like, and taken as a position
    it would move the centre of mass to the body's origin unnoticed. All that is refused can be said as a shift.
    """
    columns = [column for quantity in quantities for column in quantity.columns]
    absolute = {target: column.name for column in columns if column.kind == "centre" for target in column.targets}
    for column in columns:
        for body in column.targets if column.kind == "centre_shift" else ():
            if body in absolute:
                raise ValueError(
                    f"`vary`: {absolute[body]!r} is a position and {column.name!r} a shift of the same body {body!r}; say all "
                    "of them in one of these ways."
                )
    for quantity in quantities:
        for column in quantity.columns if quantity.columns[0].kind == "centre" else ():
            _check_centre(quantity, column, system)


def _check_centre(quantity: Quantity, column: Column, system: System) -> None:
    shift = _named(column, system, "centre_shift")
    for body in column.targets:
        if is_aligned(system, body):
            raise ValueError(
                f"`vary`: {column.name!r}: MuJoCo has moved the origin of body {body!r} into its centre of mass (`align` of "
                f"its free joint), so that positions in its axes are not those of the model; say shifts: {shift!r}."
            )
    values = nominal(column, system, ())
    there = nominal_text(values, "m")
    if max(values) - min(values) > NEAR:
        raise ValueError(
            f"`vary`: {column.name!r} is one position for bodies whose centres of mass stand at {there} in the model; name "
            f"one body, or say shifts: {shift!r}."
        )
    middle, here = _middle(quantity.distribution), values[0]
    if abs(here) > NEAR and abs(middle) < abs(middle - here):
        raise ValueError(
            f"`vary`: {column.name!r} is the position of the centre of mass in the body's axes [m], and stands at {there} in "
            f"the model; values around {middle:g} m are nearer to 0 than to that, as shifts are. If they are shifts, say "
            f"{shift!r}, along the world's axes; if the centre is to stand there, say {shift!r} with shifts that bring it "
            f"there, {middle - here:.4g} m along this axis of the body."
        )


def _named(column: Column, system: System, kind: str) -> str:
    """Return the name of a centre of mass as another kind; without its axis where the body's axes are not the world's."""
    name = column.name.replace(f"/{column.kind}/", f"/{kind}/")
    parallel = all(np.allclose(body_axes(system, body), np.eye(3), atol=1e-9) for body in column.targets)
    return name if parallel else f"{name.rpartition('/')[0]}/AXIS"


def _middle(distribution: Distribution) -> float:
    if isinstance(distribution, Normal):
        return distribution.mean
    ends = [distribution.low, distribution.high] if isinstance(distribution, Uniform) else []
    if isinstance(distribution, Choice):
        ends = [min(distribution.choices), max(distribution.choices)]
    return (ends[0] + ends[1]) / 2.0


def warnings_of(system: System, columns: Sequence[Column], inputs: pa.Table) -> list[str]:
    """Return a message for every column whose sampled values look like another kind than its name says."""
    found = []
    for column in columns:
        values = np.asarray(inputs[column.name])
        if column.kind in SHIFTS:
            found += _like_position(system, column, values)
        elif column.kind in ("law", "mass"):
            found += _like_value(system, column, values) if column.relative else _like_factor(system, column, values)
    return found


def _like_position(system: System, column: Column, shifts: Array) -> list[str]:
    """Return a message if all shifts are nearer to where something stands than to 0."""
    low, high = float(shifts.min()), float(shifts.max())
    middle = (low + high) / 2.0
    values = [here for here in nominal(column, system, ()) if abs(here) > NEAR]
    if low <= 0.0 <= high or not any(abs(middle - here) < abs(middle) for here in values):
        return []
    if column.kind == "centre_shift":
        remedy = f"say {_named(column, system, 'centre')!r}"
    else:
        remedy = "take the model's position off them"
    return [
        f"{column.name} is a shift, from {low:.3g} to {high:.3g} m in the study, of what stands at "
        f"{nominal_text(values, 'm')} in the model; if these are positions, {remedy}."
    ]


def _like_factor(system: System, column: Column, values: Array) -> list[str]:
    """Return a message if all values are far from the model's."""
    numbers = nominal(column, system, ())
    sizes, here = np.abs(values), np.abs(np.array(numbers, dtype=np.float64))
    if not (sizes.max() < here.min() / FAR or sizes.min() > here.max() * FAR > 0.0):
        return []
    return [
        f"{column.name} is from {sizes.min():.3g} to {sizes.max():.3g} in the study and "
        f"{nominal_text(sorted(here), '')} in the model; if these are to be factors on the model's value, say `relative`."
    ]


def _like_value(system: System, column: Column, values: Array) -> list[str]:
    """Return a message if all factors are far from 1."""
    sizes = np.abs(values)
    if sizes.max() >= 1.0 / FAR and sizes.min() <= FAR:
        return []
    here = nominal_text(nominal(column, system, ()), model_unit(column))
    return [
        f"{column.name} is a factor, from {sizes.min():.3g} to {sizes.max():.3g} in the study, on {here} in the model; if "
        "these are values, leave out `relative`."
    ]
