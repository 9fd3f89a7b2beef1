"""Whether every variant of a study can be: asked of whole columns of inputs, and one by one where these cannot say."""

import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from wirerope_mj.engine.simulation.simulate import check_direction
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.errors import ModelError, StudyWarning, WireRopeError
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import AXES, Isolator
from wirerope_mj.studies.inputs.meant import warnings_of
from wirerope_mj.studies.inputs.nominal import SHIFTS, nominal
from wirerope_mj.studies.inputs.quantities import STIFFENING, Column
from wirerope_mj.studies.inputs.variants import Maker, Row, without_force

BLOCK = 1024
"""Variants that are checked at once, and, one by one, before what was made of them is forgotten."""

_MOVED = ("centre", *SHIFTS)
"""Kinds of columns that move something."""

_SHARED_IN_A_LOOP = {"beta", "gamma", "n"}
"""Parameters in which the two laws of a rope loop must suit each other; they may differ in all others."""

Values = Mapping[str, npt.NDArray[Any]]
"""Inputs of a block of variants by column."""

Check = Callable[[Row], object]
"""Raises an error if one variant cannot be."""


def check_variants(
    name: str, system: System, motions: Sequence[BaseMotion], columns: Sequence[Column], inputs: pa.Table
) -> None:
    """Raise ModelError for the first variant of the study `name` that cannot be; says why.

    A StudyWarning says which values look like factors on the model's, or factors and shifts like values.
    """
    for message in warnings_of(system, columns, inputs):
        warnings.warn(message, StudyWarning, stacklevel=2)
    maker = Maker(system, motions, columns)

    def check_motion(row: Row) -> None:
        check_direction(system, maker.motion(row))

    for first in range(0, inputs.num_rows, BLOCK):
        block = inputs.slice(first, BLOCK)
        values = {column.name: block[column.name].to_numpy() for column in columns}
        checks: list[Check] = [] if _systems_can_be(system, columns, values) else [maker.changes]
        checks += [] if _motions_can_be(system, columns, values, block, check_motion) else [check_motion]
        for row in block.to_pylist() if checks else []:
            try:
                for check in checks:
                    check(row)
            except (ValueError, WireRopeError) as error:
                raise ModelError(f"variant {row['variant']} of study {name!r} cannot be: {error}") from None
        maker.forget()
    for place in _layouts(system, columns, inputs):
        maker.system(inputs.slice(place, 1).to_pylist()[0])


def _layouts(system: System, columns: Sequence[Column], inputs: pa.Table) -> list[int]:
    """Return the places of variants whose layouts stand for all: what one has no room for, none has.

    They are the first one, and the first in which each position is another one: what is not moved asks for no room.
    """
    moved = [
        np.asarray(inputs[column.name]) != (0.0 if column.kind in SHIFTS else nominal(column, system, ())[0])
        for column in columns
        if column.kind in _MOVED
    ]
    return list(dict.fromkeys([0, *(int(np.argmax(one)) for one in moved)]))


def _systems_can_be(system: System, columns: Sequence[Column], values: Values) -> bool:
    """Return whether all systems surely can be; False says nothing."""
    laws: dict[tuple[str, str], dict[str, Any]] = {}  # columns of parameters by mount and axis
    for column in columns:
        if column.kind in ("mass", *_MOVED):
            if not np.isfinite(values[column.name]).all() or (
                column.kind == "mass" and values[column.name].min() <= 0.0
            ):
                return False
        elif column.kind in ("failed", "fitted"):
            if not all(_can_fail(system.mounts[mount].written) for mount in column.targets):
                return False
        elif column.kind == STIFFENING:
            return False  # the factor acts on whole laws: each variant is made
        elif column.kind == "law":
            axis, key = column.key
            for mount, here in zip(column.targets, nominal(column, system, ()), strict=True):
                edited = _edited(here, values[column.name], column.relative)
                laws.setdefault((mount, axis), {})[key] = edited
    return all(_law_holds(system, mount, axis, parameters) for (mount, axis), parameters in laws.items())


def _can_fail(isolator: Isolator) -> bool:
    try:
        without_force(isolator)
    except ValueError:
        return False
    return True


def _edited(nominal: Any, column: npt.NDArray[Any], relative: bool) -> Any:
    if not relative:
        return column
    return tuple(column * one for one in nominal) if isinstance(nominal, tuple) else column * nominal


def _law_holds(system: System, mount: str, axis: str, parameters: Mapping[str, Any]) -> bool:
    isolator = system.mounts[mount].written
    law = isolator.axes[axis]
    coupled = AXES.index(axis) in isolator.coupled_axes  # the two must then suit each other, too
    if coupled and (isolator.coupling != "loop" or parameters.keys() & _SHARED_IN_A_LOOP):
        return False
    return law is not None and law.certainly_valid(law.completed(parameters))


def _motions_can_be(system: System, columns: Sequence[Column], values: Values, block: pa.Table, check: Check) -> bool:
    """Return whether all base motions surely can be, one of each record among them checked; False says nothing."""
    varied = {column.kind: values[column.name] for column in columns if not column.targets}
    if (
        not all(np.isfinite(column).all() for column in varied.values())
        or (varied.get("level", np.ones(1)) == 0.0).any()
    ):
        return False
    if {"azimuth", "elevation"} & set(varied) and len(system.assembly.tables.drive) < 3:
        return False  # the base cannot go everywhere
    _, places = np.unique(varied.get("record", np.zeros(1)), return_index=True)
    try:
        for place in places.tolist():
            check(block.slice(place, 1).to_pylist()[0])
    except (ValueError, WireRopeError):
        return False
    return True
