"""The variants of a study: system and motion of each from its row of inputs, and the check whether they are valid."""

import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pyarrow as pa

from wirerope_mj.engine.simulation.simulate import check_direction
from wirerope_mj.engine.system import Changes, System
from wirerope_mj.engine.system.varied import body_axes, centre_of_mass, changed
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.errors import ModelError, StudyWarning, WireRopeError
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import AXES, Isolator, Limits, bottom_in_place
from wirerope_mj.studies.vary.mount_quantities import MOUNT_FACTORS
from wirerope_mj.studies.vary.quantities import MotionSettings
from wirerope_mj.studies.vary.quantity import WHOLE, Draft, InputColumn, without_force

Row = Entries


@dataclass(frozen=True, kw_only=True)
class Work:
    """The inputs that all variants of a study share; can be pickled, and needs no file."""

    system: System
    motions: tuple[BaseMotion, ...]  # base motions among which a variant may choose; most studies have one
    columns: tuple[InputColumn, ...]  # of the inputs
    # duration, timestep, sample_rate, initial: as `simulate` takes them
    duration: float
    timestep: float
    sample_rate: float
    initial: str
    corners: Array  # of all motions [s], (n,): all variants take the same steps


class Maker:
    """Makes variants of one base system; variants with equal inputs share their objects, so that work is done once."""

    def __init__(self, system: System, motions: Sequence[BaseMotion], columns: Sequence[InputColumn]) -> None:
        self._system, self._motions = system, motions
        self._of_motion = [column for column in columns if not column.targets]
        self._of_system = [column for column in columns if column.targets]
        self._isolators: dict[object, Isolator] = {}
        self._made: dict[object, Any] = {}
        self._axes: dict[str, Array] = {}

    def system(self, row: Row) -> System:
        """Return the system of a variant.

        Raises:
            ValueError, ModelError: a value is out of a law's valid range, or the model has no room for the change.
        """
        key = tuple(row[column.name] for column in self._of_system)
        if key not in self._made:
            changes = self.changes(row)
            self._made[key] = changed(self._system, changes) if any(vars(changes).values()) else self._system
        return self._made[key]

    def motion(self, row: Row) -> BaseMotion:
        settings = MotionSettings.of(self._of_motion, row)
        if settings not in self._made:
            self._made[settings] = settings.motion(self._motions)
        return self._made[settings]

    def changes(self, row: Row) -> Changes:
        """Return the changes of the base system that make the system of a variant."""
        draft = self.draft(row)
        return self.moves(draft, self.isolators(draft, [*draft.isolators, *draft.parameters, *draft.gone]))

    def isolators(self, draft: Draft, mounts: Iterable[str]) -> dict[str, Isolator]:
        """Return the isolators of some mounts, by mount, with all that a draft changes of them."""
        return {mount: self._isolator(mount, draft) for mount in mounts}

    def draft(self, row: Row) -> Draft:
        """Gather what a row of inputs changes; the stop at which a mount goes solid moves, changes and vanishes with it."""
        draft = Draft(system=self._system)
        for column in self._of_system:
            column.apply(draft, row[column.name])
        for mount, stop in self._system.bottoms.items():  # where it goes solid, unless that varies by itself
            for moves in (draft.position_shifts, draft.turns):
                if mount in moves:
                    moves.setdefault(stop, moves[mount])
            if mount in draft.isolators and stop not in draft.parameters:
                draft.isolators.setdefault(stop, bottom_in_place(self._system.mounts[stop].written, draft.isolators[mount]))
            if mount in draft.absent:
                draft.absent.add(stop)
        return draft

    def moves(self, draft: Draft, isolators: Mapping[str, Isolator]) -> Changes:
        """Turn a draft into changes of the base system, with `isolators` by mount as those of the mounts that change.

        Where the draft replaces an isolator by one of another height, the foundation of its mount moves, so that the equipment
        stays where it was. New centres of mass become shifts along the world's axes.
        """
        positions = dict(draft.position_shifts)
        for mount, isolator in draft.isolators.items():
            if any(rise := self._system.mounts[mount].shift_for(isolator) or ()):
                positions[mount] = np.add(rise, positions.get(mount, 0.0)).tolist()
        moved = dict(draft.centre_shifts)
        for body, centre in draft.centres.items():
            if body not in self._axes:
                self._axes[body] = body_axes(self._system, body)
            moved[body] = (self._axes[body] @ (centre - centre_of_mass(self._system, body))).tolist()
        return Changes(
            isolators=isolators, masses=draft.masses, centres=moved, positions=positions,  # type: ignore[arg-type]
            turns={mount: np.radians(turn) for mount, turn in draft.turns.items()},  # type: ignore[misc]
            tunings=draft.tunings,
        )  # fmt: skip

    def forget(self) -> None:
        """Discard the objects that were made so far, for their memory."""
        self._made.clear()
        self._isolators.clear()

    def _isolator(self, mount: str, draft: Draft) -> Isolator:
        """Return a mount's isolator with the parameters of a draft, or without force if it is absent or has failed."""
        base = draft.isolators.get(mount) or self._system.mounts[mount].written
        absent, failed = mount in draft.absent, mount in draft.failed
        parameters = {} if absent or failed else draft.parameters.get(mount, {})
        key = (id(base), absent, failed, tuple(sorted(parameters.items())))
        if key not in self._isolators:
            try:
                if absent or failed:
                    bare = without_force(base)
                    self._isolators[key] = replace(bare, limits=Limits()) if absent else bare  # nothing there to judge
                else:
                    if mount in draft.isolators and any(part != WHOLE for part, _ in parameters):
                        raise ValueError("its isolator varies, and so do parameters of it; vary one or the other.")
                    self._isolators[key] = _edited(base, parameters)
            except ValueError as error:
                raise ValueError(f"mount {mount!r}: {error}") from None
        return self._isolators[key]


def _edited(isolator: Isolator, parameters: Mapping[tuple[str, ...], Any]) -> Isolator:
    """Return an isolator with other parameters of its laws and its stiffening."""
    values: dict[str, Entries] = {}
    factors = {name: value for (part, name), value in parameters.items() if part == WHOLE}
    for (part, name), value in parameters.items():
        if part != WHOLE:
            values.setdefault(part, {})[name] = value
    edited: Entries = {}
    for part, by_law in values.items():
        law = isolator.axes.get(part)
        try:
            edited[part] = replace(law, **law.completed(by_law)) if law else replace(getattr(isolator, part), **by_law)
        except ValueError as error:
            raise ValueError(f"[{part}] {error}") from None
    isolator = replace(isolator, **edited)
    for name, (change, _) in MOUNT_FACTORS.items():
        isolator = change(isolator, factors[name]) if name in factors else isolator
    return isolator


BLOCK = 1024  # Variants that are checked at once, and, one by one, before what was made of them is forgotten
# Parameters in which the two laws of a rope loop must suit each other; they may differ in all others.
_SHARED_IN_A_LOOP = {"beta", "gamma", "n"}
Check = Callable[[Row], object]  # Raises an error if one variant is not valid


def check_variants(
    name: str, system: System, motions: Sequence[BaseMotion], columns: Sequence[InputColumn], blocks: Iterable[pa.Table]
) -> None:
    """Raise ModelError for the first invalid variant of the study `name`, whose inputs come in `blocks`, with the reason.

    A StudyWarning says which values of the first block look like factors on the model's, or factors and shifts like values.
    """
    maker = Maker(system, motions, columns)
    first_moved = dict[str, Row]()  # of what one layout has no room for, none has: the first in which each position is another

    def check_motion(row: Row) -> None:
        check_direction(system, maker.motion(row))

    for number, inputs in enumerate(blocks):
        values = {column.name: np.asarray(inputs[column.name]) for column in columns}
        for column in columns if number == 0 else ():
            for message in column.warnings(system, values[column.name]):
                warnings.warn(message, StudyWarning, stacklevel=2)
        for first in range(0, inputs.num_rows, BLOCK):
            block = inputs.slice(first, BLOCK)
            checks: list[Check] = [] if systems_valid(system, columns, block) else [maker.changes]
            checks += [] if _motions_valid(system, columns, block, check_motion) else [check_motion]
            for row in block.to_pylist() if checks else []:
                try:
                    for check in checks:
                        check(row)
                except (ValueError, WireRopeError) as error:
                    numbers = [field.name for field in columns if field.type == pa.float64()]
                    below = [number for number in numbers if row[number] <= 0.0 < np.mean(values[number])]
                    cut = f" `low=` cuts the distribution of {below[0]} off." if below else ""
                    raise ModelError(f"variant {row['variant']} of study {name!r} cannot be: {error}{cut}") from None
            maker.forget()
        if number == 0:
            first_moved[""] = inputs.slice(0, 1).to_pylist()[0]
        for column in columns:
            if column.name not in first_moved and (moved := column.moved(system, values[column.name])).any():
                first_moved[column.name] = inputs.slice(int(np.argmax(moved)), 1).to_pylist()[0]
    for row in first_moved.values():
        maker.system(row)


def systems_valid(system: System, columns: Sequence[InputColumn], block: pa.Table) -> bool:
    """Tell whether the systems of all rows of a block of inputs are certainly valid; False means unknown."""
    draft = Draft(system=system)
    if not all(column.certainly_valid(draft, block[column.name].to_numpy()) for column in columns if column.targets):
        return False
    laws: dict[tuple[str, str], Entries] = {}
    for mount, parameters in draft.parameters.items():
        for (axis, parameter), numbers in parameters.items():
            laws.setdefault((mount, axis), {})[parameter] = numbers
    for (mount, axis), values in laws.items():
        isolator = system.mounts[mount].written
        law, shared = isolator.axes[axis], {name.rpartition(".")[2] for name in values} & _SHARED_IN_A_LOOP
        if AXES.index(axis) in isolator.coupled_axes and (isolator.coupling != "loop" or shared):
            return False  # the two must then suit each other, too
        # several laws complete what each of them has
        if law is None or not law.certainly_valid(values if law.factors else law.completed(values)):
            return False
    return True


def _motions_valid(system: System, columns: Sequence[InputColumn], block: pa.Table, check: Check) -> bool:
    """Tell whether all base motions are certainly valid, by checking one of each record; False means unknown."""
    values, draft = {column.name: block[column.name].to_numpy() for column in columns}, Draft(system=system)
    if not all(column.certainly_valid(draft, values[column.name]) for column in columns if not column.targets):
        return False
    records = np.broadcast_to(MotionSettings.of(columns, values).record, block.num_rows)
    _, firsts = np.unique(records, return_index=True)
    try:
        for index in firsts.tolist():
            check(block.slice(index, 1).to_pylist()[0])
    except (ValueError, WireRopeError):
        return False
    return True
