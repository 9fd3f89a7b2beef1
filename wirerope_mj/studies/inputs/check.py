"""Validity of the variants of a study: of whole columns of inputs, and one by one where these cannot say."""

import warnings
from collections.abc import Callable, Sequence

import numpy as np
import pyarrow as pa

from wirerope_mj.engine.simulation.simulate import check_direction
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError, StudyWarning, WireRopeError
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.laws import Parallel
from wirerope_mj.studies.inputs.column import Draft, InputColumn
from wirerope_mj.studies.inputs.motion_columns import MotionSettings
from wirerope_mj.studies.inputs.variants import Maker, Row

BLOCK = 1024  # Variants that are checked at once, and, one by one, before what was made of them is forgotten
# Parameters in which the two laws of a rope loop must suit each other; they may differ in all others.
_SHARED_IN_A_LOOP = {"beta", "gamma", "n"}
Check = Callable[[Row], object]  # Raises an error if one variant is not valid


def check_variants(
    name: str, system: System, motions: Sequence[BaseMotion], columns: Sequence[InputColumn], inputs: pa.Table
) -> None:
    """Raise ModelError for the first variant of the study `name` that is not valid; says why.

    A StudyWarning says which values look like factors on the model's, or factors and shifts like values.
    """
    for column in columns:
        for message in column.warnings(system, np.asarray(inputs[column.name])):
            warnings.warn(message, StudyWarning, stacklevel=2)
    maker = Maker(system, motions, columns)

    def check_motion(row: Row) -> None:
        check_direction(system, maker.motion(row))

    for first in range(0, inputs.num_rows, BLOCK):
        block = inputs.slice(first, BLOCK)
        checks: list[Check] = [] if systems_valid(system, columns, block) else [maker.changes]
        checks += [] if _motions_valid(system, columns, block, check_motion) else [check_motion]
        for row in block.to_pylist() if checks else []:
            try:
                for check in checks:
                    check(row)
            except (ValueError, WireRopeError) as error:
                raise ModelError(f"variant {row['variant']} of study {name!r} cannot be: {error}") from None
        maker.forget()
    # What one layout has no room for, none has: the first, and the first in which each position is another one.
    moved = (np.argmax(column.moved(system, np.asarray(inputs[column.name]))) for column in columns)
    for index in dict.fromkeys([0, *map(int, moved)]):
        maker.system(inputs.slice(index, 1).to_pylist()[0])


def _certainly_valid(draft: Draft, columns: Sequence[InputColumn], block: pa.Table) -> bool:
    return all(column.certainly_valid(draft, block[column.name].to_numpy()) for column in columns)


def systems_valid(system: System, columns: Sequence[InputColumn], block: pa.Table) -> bool:
    """Return whether all systems are certainly valid; False says nothing."""
    draft = Draft(system=system)
    if not _certainly_valid(draft, [column for column in columns if column.targets], block):
        return False
    laws: dict[tuple[str, str], Entries] = {}
    for mount, parameters in draft.parameters.items():
        for (axis, parameter), values in parameters.items():
            laws.setdefault((mount, axis), {})[parameter] = values
    return all(_law_valid(system, mount, axis, parameters) for (mount, axis), parameters in laws.items())


def _law_valid(system: System, mount: str, axis: str, parameters: Entries) -> bool:
    isolator = system.mounts[mount].written
    law = isolator.axes[axis]
    coupled = AXES.index(axis) in isolator.coupled_axes  # the two must then suit each other, too
    if coupled and (isolator.coupling != "loop" or {name.rpartition(".")[2] for name in parameters} & _SHARED_IN_A_LOOP):
        return False
    if isinstance(law, Parallel):
        return law.certainly_valid(parameters)
    return law is not None and law.certainly_valid(law.completed(parameters))


def _motions_valid(system: System, columns: Sequence[InputColumn], block: pa.Table, check: Check) -> bool:
    """Return whether all base motions are certainly valid, one of each record among them checked; False says nothing."""
    if not _certainly_valid(Draft(system=system), [column for column in columns if not column.targets], block):
        return False
    values = {column.name: block[column.name].to_numpy() for column in columns}
    records = np.broadcast_to(MotionSettings.of(columns, values).record, block.num_rows)
    _, firsts = np.unique(records, return_index=True)
    try:
        for index in firsts.tolist():
            check(block.slice(index, 1).to_pylist()[0])
    except (ValueError, WireRopeError):
        return False
    return True
