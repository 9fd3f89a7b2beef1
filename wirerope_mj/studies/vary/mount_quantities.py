"""Quantities of mounts that vary in a study: parameters of laws, isolators, positions, absence and failure."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import AnyArray, Array
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.mounts.isolator import AXES, Isolator, Stiffening
from wirerope_mj.mounts.laws.parallel import part_of
from wirerope_mj.mounts.vendor_parts import catalogue, load_isolator
from wirerope_mj.studies.vary.distributions import Choice, Distribution, Specimens
from wirerope_mj.studies.vary.quantity import FAR, WHOLE, WORLD, Draft, Entry, InputColumn, Shift, ValueOrFactor, without_force


class MountColumn(InputColumn):
    """Column of a study's inputs that acts on mounts."""

    noun = "mount"

    @classmethod
    def existing(cls, system: System) -> dict[str, bool]:
        return {name: mount.isolator.is_stop for name, mount in system.mounts.items()}


class LawParameter(MountColumn, ValueOrFactor):
    """Parameter of a law; its key is the axis and the parameter.

    Of several laws in parallel it is "laws[0].alpha", or a factor on all of them: "stiffness", "friction" or "yield".
    """

    form = "mount/NAME/AXIS/PARAMETER"
    pattern = re.compile(rf"mount/(.*)/({'|'.join(AXES)})/([^/]*)")
    model_unit = "SI"

    @classmethod
    def resolve(cls, entry: Entry) -> tuple[InputColumn, ...]:
        mounts, name = cls.matching(entry, entry.pattern), entry.name
        nominal = [cls.checked(name, entry.system.mounts[mount].written, mount, *entry.key) for mount in mounts]
        if not entry.distribution.relative and any(isinstance(value, tuple) for value in nominal):
            raise ValueError(f"`vary`: {name!r} is several numbers; give it factors, `relative=True`.")
        if entry.distribution.relative and all(value == 0.0 for value in nominal):
            raise ValueError(f"`vary`: {name!r} is 0 in the model, and 0 times anything is 0; give absolute values.")
        return cls.split(entry, mounts)

    @classmethod
    def checked(cls, name: str, isolator: Isolator, mount: str, axis: str, parameter: str) -> object:
        """Return the value of a law's parameter in the model; ModelError lists the parameters if there is no such one."""
        law = isolator.axes[axis]
        if law is None:
            present = [axis for axis, law in isolator.axes.items() if law is not None]
            raise ModelError(f"`vary`: {name!r}: mount {mount!r} has no law on axis {axis!r}; it has {', '.join(present)}.")
        if (whole := law).factors:
            if parameter in whole.factors:
                return 1.0
            try:
                number, parameter = part_of(parameter)
                law = whole.components[number]
            except (ValueError, IndexError):
                count = len(whole.components)
                raise ModelError(
                    f"`vary`: {name!r}: mount {mount!r} has {count} laws on its {axis} axis; name a parameter of one, "
                    f"laws[0].alpha to laws[{count - 1}].alpha, or a factor on all: {', '.join(whole.factors)}."
                ) from None
        names = [key for key, value in law.to_dict().items() if not isinstance(value, str | bool)]
        lists = {key: value for key in names if isinstance(value := getattr(law, key), tuple)}
        if parameter not in names + [f"{key}[{n}]" for key, value in lists.items() for n in range(len(value))]:
            raise ModelError(
                f"`vary`: {name!r}: law {law.name} of mount {mount!r} has no parameter {parameter!r}; it has "
                f"{', '.join(names)}."
            )
        value = law.parameter(parameter)
        if not isinstance(value, float | int | tuple):
            raise ModelError(f"`vary`: {name!r}: {parameter!r} of mount {mount!r} is not a number.")
        return value

    def nominal_of(self, system: System, target: str) -> Any:
        law = system.mounts[target].written.axes[self.key[0]]
        assert law is not None  # `checked` has seen to it
        return law.parameter(self.key[1])

    def apply(self, draft: Draft, value: Any) -> None:
        for mount in self.targets:
            if self.relative and isinstance(nominal := self.nominal_of(draft.system, mount), tuple):
                changed: Any = tuple(value * number for number in nominal)
            else:
                changed = value * nominal if self.relative else value
            draft.parameters.setdefault(mount, {})[self.key] = changed

    def certainly_valid(self, draft: Draft, values: AnyArray) -> bool:
        self.apply(draft, values)  # columns in place of numbers: all parameters of a law are checked together
        return True


class StiffeningParameter(LawParameter):
    """Parameter of the stiffening by loading cycles; its key is "stiffening" and the parameter."""

    form = "mount/NAME/stiffening/cycles, mount/NAME/stiffening/after_50"
    pattern = re.compile(r"mount/(.*)/(stiffening)/([^/]*)")
    model_unit = ""

    @classmethod
    def checked(cls, name: str, isolator: Isolator, mount: str, axis: str, parameter: str) -> object:
        if isolator.stiffening is None:
            raise ModelError(f"`vary`: {name!r}: isolator {isolator.name!r} of mount {mount!r} has no [stiffening].")
        if parameter not in (known := [item.name for item in fields(Stiffening)]):
            raise ModelError(f"`vary`: {name!r}: stiffening has no {parameter!r}; it has {', '.join(known)}.")
        return float(getattr(isolator.stiffening, parameter))

    def nominal_of(self, system: System, target: str) -> float:
        return float(getattr(system.mounts[target].written.stiffening, self.key[1]))

    def certainly_valid(self, draft: Draft, values: AnyArray) -> bool:
        return False  # the factor acts on whole laws: each variant is made

    def warnings(self, system: System, values: Array) -> list[str]:
        return []  # any number of cycles may be meant


# Factors on whole mounts: the function that applies each to an isolator, and words for what it acts on.
MOUNT_FACTORS: dict[str, tuple[Callable[[Isolator, float], Isolator], str]] = {
    "stiffness": (Isolator.scaled, "all its forces"),
    "damping": (Isolator.with_damping, "what dissipates"),
    "friction": (Isolator.with_friction, "what dissipates whatever the rate"),
}


class MountFactor(MountColumn):
    """Factor on a whole mount; its key is one of `MOUNT_FACTORS`."""

    form = ", ".join(f"mount/NAME/{name}" for name in MOUNT_FACTORS)
    pattern = re.compile(rf"mount/(.*)/({'|'.join(MOUNT_FACTORS)})")
    acts = "factor"

    @classmethod
    def resolve(cls, entry: Entry) -> tuple[InputColumn, ...]:
        mounts = cls.matching(entry, entry.pattern)
        change, acts_on = MOUNT_FACTORS[entry.key[0]]
        isolators = [entry.system.mounts[mount].written for mount in mounts]
        if all(
            change(isolator, 2.0).axes == isolator.axes for isolator in isolators
        ):  # of a pattern, stops may stay as they are
            raise ModelError(
                f"`vary`: {entry.name!r} is a factor on {acts_on}, and no law of isolator {isolators[0].name!r} of mount "
                f"{mounts[0]!r} has such a part that stands by itself; mount/NAME/stiffness is a factor on all of its forces."
            )
        return cls.split(entry, mounts)

    def nominal_of(self, system: System, target: str) -> float:
        return 1.0

    def warnings(self, system: System, values: Array) -> list[str]:
        if 1.0 / FAR < (middle := float(np.median(np.abs(values)))) < FAR:
            return []
        return [f"{self.name} is a factor, about {middle:.3g} in the study: 1 is the isolator as it is. Is it in per cent?"]

    def apply(self, draft: Draft, value: float) -> None:
        for mount in self.targets:
            draft.parameters.setdefault(mount, {})[WHOLE, self.key[0]] = float(value)


class Spread(LawParameter):
    """Parameters that scatter together from specimen to specimen; each is a column of `LawParameter`."""

    form = "mount/NAME/spread"

    @classmethod
    def resolve(cls, entry: Entry) -> tuple[InputColumn, ...]:
        """Return a column for each parameter in an isolator's [spread], of each mount or of all that share a specimen."""
        name, each = entry.name, entry.distribution.each
        if not isinstance(entry.distribution, Specimens):
            raise ValueError(f"`vary`: {name!r} must be Specimens, got {entry.distribution!r}.")
        mounts = cls.matching(entry, entry.pattern)
        isolators = [entry.system.mounts[mount].written for mount in mounts]
        for mount, isolator in zip(mounts, isolators, strict=True):
            if isolator.spread is None:
                raise ModelError(f"`vary`: {name!r}: isolator {isolator.name!r} of mount {mount!r} has no [spread].")
            for parameter in isolator.spread.parameters:
                axis, _, key = parameter.partition(".")
                if axis not in AXES:
                    raise ModelError(f"`vary`: {name!r}: {parameter!r} in the [spread] of {isolator.name!r} is no parameter.")
                cls.checked(name, isolator, mount, axis, key)
        if not each and any(isolator != isolators[0] for isolator in isolators):
            raise ValueError(f"`vary`: {name!r}: the mounts have different isolators and cannot share one specimen.")
        groups = [(mount, (mount,)) for mount in mounts] if each else [(entry.pattern, tuple(mounts))]
        return tuple(
            LawParameter(name=f"mount/{group}/{'/'.join(key)}", targets=targets, key=key)
            for (group, targets), isolator in zip(groups, isolators, strict=False)
            for key in (tuple(name.split(".", 1)) for name in (isolator.spread.parameters if isolator.spread else ()))
        )


@dataclass(frozen=True, kw_only=True)
class OtherIsolator(MountColumn):
    """Isolators in place of the model's, by the names of their files."""

    form = "mount/NAME/isolator"
    acts = "choice"
    type = pa.string()

    devices: Mapping[str, Isolator] = field(default_factory=dict, repr=False)  # isolators by name

    @classmethod
    def listed(cls, name: str, distribution: Distribution) -> Distribution:
        """Replace patterns among isolators' names, as "CB1400-*", by the vendors' parts with laws on all axes."""
        if not (cls.pattern.fullmatch(name) and isinstance(distribution, Choice) and isinstance(distribution.choices[0], str)):
            return distribution
        names: list[str] = []
        for choice in distribution.choices:
            parts = catalogue(choice) if any(mark in choice for mark in "*?[") else {}
            whole = [part for part, device in parts.items() if isinstance(device, Isolator) and all(device.axes.values())]
            if parts and not whole:
                raise ValueError(f"`vary`: {name!r}: none of {', '.join(parts)} has laws on all axes.")
            names += whole or [choice]
        return Choice(*dict.fromkeys(names), each=distribution.each, group=distribution.group)

    @classmethod
    def resolve(cls, entry: Entry) -> tuple[InputColumn, ...]:
        """Return the columns of the matching mounts, every isolator loaded from beside the model or from the catalogue."""
        mounts = cls.matching(entry, entry.pattern)
        if not (isinstance(entry.distribution, Choice) and entry.chooses_among(str)):
            raise ValueError(f"`vary`: {entry.name!r} must be a Choice of isolators' names, got {entry.distribution!r}.")
        folder = entry.system.path.parent if entry.system.path else Path()
        devices = {name: load_isolator(name, beside=folder) for name in entry.distribution.choices}
        return tuple(replace(column, devices=devices) for column in cls.split(entry, mounts))

    def apply(self, draft: Draft, value: str) -> None:
        draft.isolators |= dict.fromkeys(self.targets, self.devices[value])


class PositionShift(MountColumn, Shift):
    """Shift [m] of a mount along an axis of the world."""

    form = "mount/NAME/position_shift/x"
    places_mounts = True
    into = "position_shifts"

    def nominal_of(self, system: System, target: str) -> float | None:
        return float(system.mounts[target].position[WORLD.index(self.key[0])])


class Turn(MountColumn, Shift):
    """Angle [°] by which a mount's axes turn about an axis of the world; turned axes of the model have no single angle."""

    form = "mount/NAME/turn/x"
    model_unit = "°"
    places_mounts = True
    into = "turns"


class Fitted(MountColumn):
    """Presence of mounts."""

    form = "mount/NAME/fitted"
    acts = "choice"
    type = pa.bool_()
    places_mounts = True

    @classmethod
    def resolve(cls, entry: Entry) -> tuple[InputColumn, ...]:
        mounts = cls.matching(entry, entry.pattern)
        if not entry.chooses_among(bool):
            raise ValueError(f"`vary`: {entry.name!r} must be a Choice of True and False, got {entry.distribution!r}.")
        return cls.split(entry, mounts)

    def nominal_of(self, system: System, target: str) -> bool | None:
        return True

    def apply(self, draft: Draft, value: Any) -> None:
        draft.absent |= set() if value else set(self.targets)

    def certainly_valid(self, draft: Draft, values: AnyArray) -> bool:
        try:
            for mount in self.targets:
                without_force(draft.system.mounts[mount].written)
        except ValueError:
            return False
        return True


class Failed(Fitted):
    """Failure of mounts: each may fail, or one of several does."""

    form = "mount/NAME/failed"
    places_mounts = False

    @classmethod
    def resolve(cls, entry: Entry) -> tuple[InputColumn, ...]:
        """Return columns of True and False, or one of the name of the mount that has failed."""
        mounts, distribution = cls.matching(entry, entry.pattern), entry.distribution
        if isinstance(distribution, Choice) and entry.chooses_among(str) and not distribution.each:
            if unknown := [value for value in distribution.choices if value not in ("", *mounts)]:
                raise ModelError(
                    f'`vary`: {entry.name!r}: there is no mount {unknown[0]!r} there; choose from "" (none), '
                    f"{', '.join(mounts)}."
                )
            return (FailedMount(name=entry.name, targets=tuple(mounts)),)
        if not entry.chooses_among(bool):
            raise ValueError(
                f"`vary`: {entry.name!r} must be a Choice of True and False, or of the mount's name that has failed "
                '("" = none).'
            )
        return cls.split(entry, mounts)

    def nominal_of(self, system: System, target: str) -> bool | None:
        return False

    def apply(self, draft: Draft, value: Any) -> None:
        draft.failed |= set(self.targets) if value else set()


class FailedMount(Failed):
    """Name of the one mount that has failed, "" if none has."""

    type = pa.string()

    def nominal_of(self, system: System, target: str) -> None:
        return None

    def apply(self, draft: Draft, value: str) -> None:
        draft.failed |= {value} if value else set()
