"""One variant of a study: its system and its base motion, from the base system and its row of inputs."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from wirerope_mj.engine.system import Changes, System
from wirerope_mj.engine.system.centres import body_axes, centre_of_mass
from wirerope_mj.engine.system.varied import changed
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions import BaseMotion, Scaled, Turned
from wirerope_mj.mounts.isolator import Isolator, Limits, Stiffening
from wirerope_mj.mounts.laws import BoucWenBaberNoori, KelvinVoigt, Law, Masing, Parallel, Zener
from wirerope_mj.studies.inputs.quantities import STIFFENING, WORLD, Column

FAINT = 1e-6
"""Stiffness [N/m], damping [N s/m] and slip force [N] of what has failed: it carries nothing, and keeps its states' places."""

ABSENT = ("fitted",)
"""Key of the columns that say whether a mount is there."""

Row = Mapping[str, Any]


@dataclass(frozen=True, kw_only=True)
class Work:
    """What all variants of a study share; can be pickled, and needs no file.

    Attributes:
        system: the base system.
        motions: base motions among which a variant may choose; most studies have one.
        columns: what varies.
        duration, timestep, sample_rate, initial: as `simulate` takes them.
        corners: of all motions [s], (n,): all variants take the same steps.
    """

    system: System
    motions: tuple[BaseMotion, ...]
    columns: tuple[Column, ...]
    duration: float
    timestep: float
    sample_rate: float
    initial: str
    corners: Array


class Maker:
    """Makes variants of one base system; variants with equal inputs share their objects, so that work is done once."""

    def __init__(self, system: System, motions: Sequence[BaseMotion], columns: Sequence[Column]) -> None:
        self._system, self._motions = system, motions
        self._of_motion = [column for column in columns if not column.targets]
        self._of_system = [column for column in columns if column.targets]
        self._isolators: dict[Any, Isolator] = {}
        self._made: dict[Any, Any] = {}
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
        values = {column.kind: row[column.name] for column in self._of_motion}
        key = ("motion", *values.items())
        if key not in self._made:
            motion = self._motions[values.get("record", 0)]
            if {"azimuth", "elevation"} & set(values):
                motion = Turned(motion, direction=direction(values.get("azimuth", 0.0), values.get("elevation", 0.0)))
            if not math.isfinite(level := values.get("level", 1.0)) or level == 0.0:
                raise ValueError(f"motion/level must be finite and not zero, got {level}.")
            self._made[key] = Scaled(motion, level) if "level" in values else motion
        return self._made[key]

    def changes(self, row: Row) -> Changes:
        """Return what a variant's system differs by from the base system."""
        edits: dict[str, dict[tuple[str, ...], tuple[bool, Any]]] = {}
        masses: dict[str, float] = {}
        shifts: dict[str, dict[str, list[float]]] = {"centre_shift": {}, "position_shift": {}}
        centres: dict[str, Array] = {}
        for column in self._of_system:
            value = row[column.name]
            if column.kind == "mass":
                if not (math.isfinite(value) and value > 0.0):
                    unit = "" if column.relative else " kg"
                    raise ValueError(f"{column.name} must be finite and > 0{unit}, got {value:g}{unit}.")
                masses |= {body: value if column.relative else value / self._mass(body) for body in column.targets}
            elif column.kind == "centre" or column.kind in shifts:
                if not math.isfinite(value):
                    raise ValueError(f"{column.name} must be finite, got {value}.")
                along = WORLD.index(column.key[0])
                for target in column.targets:
                    if column.kind == "centre":
                        centres.setdefault(target, centre_of_mass(self._system, target))[along] = value
                    else:
                        shift = shifts[column.kind].setdefault(target, [0.0, 0.0, 0.0])
                        shift[along] = -value if target in column.mirrored else value
            else:
                acts = value != (column.kind == "fitted") if isinstance(value, bool) else True
                targets = ([value] if value else []) if isinstance(value, str) else column.targets if acts else ()
                for mount in targets:
                    edits.setdefault(mount, {})[column.key] = (column.relative, value)
        isolators = {mount: self._isolator(mount, edit) for mount, edit in edits.items()}
        moved = shifts["centre_shift"] | {body: self._shift_to(body, centre) for body, centre in centres.items()}
        return Changes(
            isolators=isolators, masses=masses, centres=moved, positions=shifts["position_shift"]  # type: ignore[arg-type]
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

    def _mass(self, body: str) -> float:
        return float(self._system.model.body(body).mass[0])

    def _isolator(self, mount: str, edit: Mapping[tuple[str, ...], tuple[bool, Any]]) -> Isolator:
        base = self._system.mounts[mount].written
        key = (id(base), tuple(sorted(edit.items())))
        if key not in self._isolators:
            try:
                self._isolators[key] = _edited(base, edit)
            except ValueError as error:
                raise ValueError(f"mount {mount!r}: {error}") from None
        return self._isolators[key]


def direction(azimuth: float, elevation: float) -> tuple[float, float, float]:
    """Return the unit vector of an azimuth from x towards y and an elevation above that plane [deg]."""
    a, e = math.radians(azimuth), math.radians(elevation)
    return (math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e))


def _edited(isolator: Isolator, edit: Mapping[tuple[str, ...], tuple[bool, Any]]) -> Isolator:
    """Return an isolator with other parameters, by axis and name; the key () makes it fail, `ABSENT` takes it away."""
    if ABSENT in edit:
        return replace(without_force(isolator), limits=Limits())  # nothing is there that could be judged
    if () in edit:
        return without_force(isolator)
    laws: dict[str, dict[str, Any]] = {}
    stiffening: dict[str, float] = {}
    for (axis, name), (relative, value) in edit.items():
        if axis == STIFFENING:
            stiffening[name] = value * getattr(isolator.stiffening, name) if relative else value
            continue
        law = isolator.axes[axis]
        assert law is not None  # `quantities` has seen to it
        if relative:
            nominal = law.parameter(name)
            value = tuple(value * one for one in nominal) if isinstance(nominal, tuple) else value * nominal
        laws.setdefault(axis, {})[name] = value
    changed: dict[str, Law | Stiffening] = {}
    for axis, values in laws.items():
        law = isolator.axes[axis]
        assert law is not None
        try:
            changed[axis] = replace(law, **law.completed(values))
        except ValueError as error:
            raise ValueError(f"[{axis}] {error}") from None
    if stiffening:
        assert isolator.stiffening is not None  # `quantities` has seen to it
        try:
            changed[STIFFENING] = replace(isolator.stiffening, **stiffening)
        except ValueError as error:
            raise ValueError(f"[{STIFFENING}] {error}") from None
    return replace(isolator, **changed)  # type: ignore[arg-type]


def acts(isolator: Isolator) -> bool:
    """Return whether an isolator makes forces: it is there, and has not failed."""
    return any(law is not None and law != _faint(law) for law in isolator.axes.values())


def without_force(isolator: Isolator) -> Isolator:
    """Return the isolator after its failure: laws with as many states and hardly any force."""
    laws = {axis: _faint(law) for axis, law in isolator.axes.items() if law is not None}
    return replace(isolator, coupling=None, loop=None, rotation=None, stiffening=None, **laws)  # type: ignore[arg-type]


def _faint(law: Law) -> Law:
    if isinstance(law, Masing):
        faint = (FAINT,) * len(law.stiffness)
        return replace(law, stiffness=faint, slip_force=faint, k=0.0)
    if isinstance(law, BoucWenBaberNoori):
        return replace(law, alpha=FAINT, k=0.0)
    if isinstance(law, Parallel):
        return Parallel(laws=tuple(_faint(part) for part in law.laws))
    if law.n_states > 1:
        return law.scaled(FAINT / law.initial_stiffness)
    return _FAINT_WITH_STATE if law.n_states == 1 else _FAINT_WITHOUT_STATE


_FAINT_WITH_STATE, _FAINT_WITHOUT_STATE = Zener(k0=0.0, k1=FAINT, c=FAINT), KelvinVoigt(k=0.0, c=FAINT)
