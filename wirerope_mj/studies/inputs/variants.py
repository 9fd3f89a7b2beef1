"""One variant of a study: its system and its base motion, from the base system and its row of inputs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from wirerope_mj.engine.system import Changes, System
from wirerope_mj.engine.system.varied import body_axes, centre_of_mass, changed
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import Isolator, Limits
from wirerope_mj.studies.inputs.column import WHOLE, Draft, InputColumn
from wirerope_mj.studies.inputs.failure import without_force
from wirerope_mj.studies.inputs.motion_columns import MotionSettings

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
        """Return the base motion of a variant."""
        settings = MotionSettings.of(self._of_motion, row)
        if settings not in self._made:
            self._made[settings] = settings.motion(self._motions)
        return self._made[settings]

    def changes(self, row: Row) -> Changes:
        """Return the changes that make a variant's system of the base system."""
        draft = self.draft(row)
        edited = dict.fromkeys([*draft.isolators, *draft.parameters, *sorted(draft.failed | draft.absent)])
        return self.moves(draft, {mount: self._isolator(mount, draft) for mount in edited})

    def draft(self, row: Row) -> Draft:
        """Return what the columns say of a variant's system."""
        draft = Draft(system=self._system)
        for column in self._of_system:
            column.apply(draft, row[column.name])
        return draft

    def moves(self, draft: Draft, isolators: Mapping[str, Isolator]) -> Changes:
        """Return the changes of masses, centres of mass, positions and inclinations, and isolators.

        Where another isolator is higher or lower, the foundation follows it.
        """
        positions = dict(draft.position_shifts)
        for mount, other in draft.isolators.items():
            if any(rise := self._system.mounts[mount].shift_for(other) or ()):
                positions[mount] = np.add(rise, positions.get(mount, 0.0)).tolist()
        moved = draft.centre_shifts | {body: self._shift_to(body, centre) for body, centre in draft.centres.items()}
        return Changes(
            isolators=isolators, masses=draft.masses, centres=moved, positions=positions,  # type: ignore[arg-type]
            turns={mount: np.radians(turn) for mount, turn in draft.turns.items()},  # type: ignore[misc]
            tunings=draft.tunings,
        )  # fmt: skip

    def forget(self) -> None:
        """Forget the variants that were made, so that memory is bounded."""
        self._made.clear()
        self._isolators.clear()

    def _shift_to(self, body: str, centre: Array) -> list[float]:
        """Return the shift along the world's axes that brings a centre of mass to `centre` in the body's [m]."""
        if body not in self._axes:
            self._axes[body] = body_axes(self._system, body)
        return [float(one) for one in self._axes[body] @ (centre - centre_of_mass(self._system, body))]

    def _isolator(self, mount: str, draft: Draft) -> Isolator:
        base = draft.isolators.get(mount) or self._system.mounts[mount].written
        parameters = draft.parameters.get(mount, {})
        absent, failed = mount in draft.absent, mount in draft.failed
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
    for part, own in values.items():
        law = isolator.axes.get(part)
        try:
            edited[part] = replace(law, **law.completed(own)) if law else replace(getattr(isolator, part), **own)
        except ValueError as error:
            raise ValueError(f"[{part}] {error}") from None
    isolator = replace(isolator, **edited)
    isolator = isolator.scaled(factors["stiffness"]) if "stiffness" in factors else isolator
    return isolator.with_damping(factors["damping"]) if "damping" in factors else isolator
