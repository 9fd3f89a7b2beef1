"""Quantities of a study's system and motion that can vary: names such as "mount/m*/axial/alpha", resolved to columns.

And the base motion's level, direction and record among them.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pyarrow as pa

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import AnyArray, Array, Booleans, Entries
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.motions import BaseMotion, Scaled, Turned
from wirerope_mj.studies.vary.body_quantities import Centre, CentreShift, Mass, Tuning, check_centres
from wirerope_mj.studies.vary.distributions import Choice, Distribution, Isotropic, Specimens
from wirerope_mj.studies.vary.mount_quantities import (
    Failed,
    Fitted,
    LawParameter,
    MountFactor,
    OtherIsolator,
    PositionShift,
    Spread,
    StiffeningParameter,
    Turn,
)
from wirerope_mj.studies.vary.quantity import Draft, Entry, InputColumn, Quantity

# of a quarter, half or full turn in radians, that the largest of values up to it reaches: of many, of a hundred; distance of
# even values over their number, of a range that has zero in its middle. Three degrees are 0.955 of half a turn.
_NEARLY, _APART = (0.96, 0.985), 2.05
_LOUDER = 20.0  # factor on a motion from which it may be in per cent, if all are beyond


@dataclass(frozen=True, kw_only=True)
class MotionSettings:
    """Level, direction [deg] and record of one variant's motion, or of many as arrays; None where the motions say it."""

    level: Any = None
    azimuth: Any = None
    elevation: Any = None
    record: Any = 0

    @classmethod
    def of(cls, columns: Sequence[InputColumn], row: Entries) -> "MotionSettings":
        """Take the settings from inputs by column: numbers of one variant, or arrays of many."""
        return cls(**{column.into: row[column.name] for column in columns if isinstance(column, MotionColumn)})

    @property
    def turns(self) -> bool:
        """True if the settings state a direction."""
        return self.azimuth is not None or self.elevation is not None

    def motion(self, motions: Sequence[BaseMotion]) -> BaseMotion:
        """Return the base motion of one variant."""
        motion = motions[self.record]
        if self.turns:
            angles = (0.0 if angle is None else angle for angle in (self.azimuth, self.elevation))
            motion = Turned(motion, direction=direction(*angles))
        if self.level is None:
            return motion
        if not math.isfinite(self.level) or self.level == 0.0:
            raise ValueError(f"motion/level must be finite and not zero, got {self.level}.")
        return Scaled(motion, self.level)


def direction(azimuth: float, elevation: float) -> tuple[float, float, float]:
    """Return the unit vector of an azimuth from x towards y and an elevation above that plane [deg]."""
    a, e = math.radians(azimuth), math.radians(elevation)
    return (math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e))


class MotionColumn(InputColumn):
    """Column of the base motion, which acts on no mount or body."""

    numbers: ClassVar[str] = "a distribution of numbers"
    bounds = "finite"

    @classmethod
    def resolve(cls, entry: Entry) -> tuple[InputColumn, ...]:
        if entry.distribution.relative:
            raise ValueError(f"`vary`: {entry.name!r} cannot be relative; a level is a factor by itself.")
        if not cls.suits(entry):
            raise ValueError(f"`vary`: {entry.name!r} must be {cls.numbers}, got {entry.distribution}.")
        return (cls(name=entry.name),)

    @classmethod
    def suits(cls, entry: Entry) -> bool:
        """True if the entry's distribution is one of numbers as this quantity takes them."""
        return not isinstance(entry.distribution, Choice) or entry.chooses_among(int, float)


class Level(MotionColumn):
    """Factor on the motion."""

    form = "motion/level"
    into = "level"
    acts = "factor"

    def nominal(self, system: System, motions: Sequence[BaseMotion] = ()) -> list[Any]:
        return [1.0]

    def certainly_valid(self, draft: Draft, values: AnyArray) -> bool:
        return super().certainly_valid(draft, values) and bool((values != 0.0).all())

    def warnings(self, system: System, values: Array) -> list[str]:
        low, high = float(values.min()), float(values.max())
        if low > _LOUDER:
            return [f"{self.name} is a factor on the motion, from {low:.3g} to {high:.3g} in the study: is it in per cent?"]
        if not low < 0.0 < high:
            return []
        return [
            f"{self.name} is a factor on the motion, from {low:.3g} to {high:.3g} in the study, so that some turn the motion "
            "round: is that meant?"
        ]


class Azimuth(MotionColumn):
    """Direction [deg] of the motion from x towards y."""

    form = "motion/azimuth"
    into = "azimuth"
    model_unit = "°"

    def nominal(self, system: System, motions: Sequence[BaseMotion] = ()) -> list[Any]:
        """Return the azimuths of the motions' directions [deg]; of a vertical motion there is none."""
        directions = (row for motion in motions for row in motion.directions.tolist())
        return [math.degrees(math.atan2(y, x)) for x, y, _ in directions if math.hypot(x, y) > 0.0]

    def certainly_valid(self, draft: Draft, values: AnyArray) -> bool:
        return super().certainly_valid(draft, values) and len(draft.system.assembly.tables.drive) >= 3

    def warnings(self, system: System, values: Array) -> list[str]:
        low, high = float(values.min()), float(values.max())
        turns = [high / (part * math.pi) for part in (0.5, 1.0, 2.0)]
        from_none = abs(low) < 0.02 * high or abs(low + high) < 0.04 * high
        nearly = max(_NEARLY[0], min(_NEARLY[1], 1.0 - _APART / values.size))
        if not (from_none and any(nearly < turn < 1.0005 for turn in turns)):
            return []
        return [f"{self.name} is in degrees, and its values, from {low:.4g} to {high:.4g}, look like radians."]


class Elevation(Azimuth):
    """Direction [deg] of the motion above the plane of x and y."""

    form = "motion/elevation"
    into = "elevation"

    def nominal(self, system: System, motions: Sequence[BaseMotion] = ()) -> list[Any]:
        directions = (row for motion in motions for row in motion.directions.tolist())
        return [math.degrees(math.atan2(z, math.hypot(x, y))) for x, y, z in directions]


class Record(MotionColumn):
    """Index of the motion among several."""

    form = "motion/record"
    into = "record"
    acts = "index"
    type = pa.int64()
    numbers = "a Choice of integers, indices in `motions`"

    @classmethod
    def resolve(cls, entry: Entry) -> tuple[InputColumn, ...]:
        columns = super().resolve(entry)
        values = entry.distribution.choices if isinstance(entry.distribution, Choice) else ()
        last = len(entry.motions) - 1
        if not set(values) <= set(range(last + 1)):
            records = "is one record, 0" if last == 0 else f"are the records 0 to {last}"
            raise ValueError(f"`vary`: {entry.name!r}: there {records}, got {list(values)}.")
        return columns

    @classmethod
    def suits(cls, entry: Entry) -> bool:
        return entry.chooses_among(int)


# Kinds of quantities, in the order in which a name is compared with their patterns.
KINDS: tuple[type[InputColumn], ...] = (
    Spread, Fitted, Failed, PositionShift, Turn, StiffeningParameter, LawParameter, MountFactor, OtherIsolator, Mass, Tuning,
    Centre, CentreShift, Level, Azimuth, Elevation, Record,
)  # fmt: skip
# Names of quantities; NAME may hold * and ?, and be several, as in m01,m04,-m13; names joined by " & " share a draw.
FORMS = ", ".join(kind.form for kind in KINDS)
TOGETHER = " & "  # Stands between names that share a draw


@dataclass(frozen=True, kw_only=True)
class SharedDraw(InputColumn):
    """One number that several columns take."""

    form = f"NAME{TOGETHER}NAME"

    shared: tuple[InputColumn, ...]  # these columns

    @property
    def parts(self) -> tuple[InputColumn, ...]:
        return self.shared

    @property
    def nature(self) -> str:
        return self.shared[0].nature  # one for all, as the unit is

    @property
    def unit(self) -> str:
        return self.shared[0].unit

    def apply(self, draft: Draft, value: object) -> None:
        for column in self.shared:
            column.apply(draft, value)

    def certainly_valid(self, draft: Draft, values: AnyArray) -> bool:
        return all(column.certainly_valid(draft, values) for column in self.shared)

    def moved(self, system: System, values: AnyArray) -> Booleans:
        return np.any([column.moved(system, values) for column in self.shared], axis=0)

    def warnings(self, system: System, values: Array) -> list[str]:
        return [message for column in self.shared for message in column.warnings(system, values)]


def quantities(vary: Mapping[str, Distribution], system: System, motions: Sequence[BaseMotion]) -> tuple[Quantity, ...]:
    """Return the quantities that vary, resolved for a system and its motions.

    ModelError if a name stands for nothing that exists; says what does; ValueError if a distribution does not suit its
    quantity, or two names stand for the same.
    """
    if not vary:
        raise ValueError(f"`vary` must name at least one quantity: {FORMS}.")
    resolved = tuple(_quantity(name, distribution, system, motions) for name, distribution in vary.items())
    taken: dict[tuple[str, str, tuple[str, ...]], str] = {}
    for quantity in resolved:
        for part in (part for column in quantity.columns for part in column.parts):
            for target in part.targets or ("",):
                first = taken.setdefault((part.form, target, part.key), quantity.name)
                if first != quantity.name:
                    raise ValueError(f"`vary`: {first!r} and {quantity.name!r} both say {part.name!r}.")
    for (form, target, key), name in taken.items():
        last = key[-1].rpartition("[")[0] if key and key[-1].endswith("]") else ""  # "stiffness" of "stiffness[0]"
        whole = taken.get((form, target, (*key[:-1], last)), name) if last else name
        if whole != name:
            raise ValueError(f"`vary`: {whole!r} is all the numbers of which {name!r} is one.")
    check_centres(resolved, system)
    return resolved


def _quantity(name: str, distribution: Distribution, system: System, motions: Sequence[BaseMotion]) -> Quantity:
    """Resolve one entry of `vary`, whose name may be several that share a draw, to its columns."""
    if len(names := name.split(TOGETHER)) > 1:
        shared = [_quantity(part, distribution, system, motions).columns for part in names]
        every = [column for group in shared for column in group]
        if any(not column.targets or column.type != pa.float64() for column in every):
            raise ValueError(f"`vary`: {name!r}: only numbers of mounts and bodies can share a draw.")
        if len({len(group) for group in shared}) > 1:
            counts = " and ".join(str(len(group)) for group in shared)
            raise ValueError(f"`vary`: {name!r}: with `each` the names must match as many mounts, got {counts}.")
        if len({(column.nature, column.unit) for column in every}) > 1:
            kinds = ", ".join(dict.fromkeys(f"{column.nature} {column.unit}".strip() for column in every))
            raise ValueError(f"`vary`: {name!r}: the numbers must be of one kind, got {kinds}; factors are, with `relative`.")
        draws = tuple(
            SharedDraw(
                name=TOGETHER.join(column.name for column in together),
                targets=tuple(dict.fromkeys(target for column in together for target in column.targets)),
                shared=together,
            )
            for together in zip(*shared, strict=True)
        )
        return Quantity(name=name, distribution=distribution, columns=draws)
    if not isinstance(distribution, Distribution):
        raise ValueError(f"`vary`: {name!r} must be a Normal, Uniform, Isotropic, Choice or Specimens, got {distribution!r}.")
    kind, parts = next(((kind, match.groups()) for kind in KINDS if (match := kind.pattern.fullmatch(name))), (None, ()))
    if isinstance(distribution, Isotropic) and kind is not Elevation:
        raise ValueError(f"`vary`: {name!r} cannot be Isotropic; it is for {Elevation.form}.")
    if isinstance(distribution, Specimens) and kind is not Spread:
        raise ValueError(f"`vary`: {name!r} cannot be Specimens; they are for {Spread.form}.")
    if kind is not None:
        pattern, *key = parts or ("",)
        columns = kind.resolve(
            Entry(name=name, pattern=pattern, key=tuple(key), distribution=distribution, system=system, motions=motions)
        )
        groups = dict.fromkeys(column.targets for column in columns) if kind is Spread else {}
        isolators = tuple(system.mounts[targets[0]].written for targets in groups)
        return Quantity(name=name, distribution=distribution, columns=columns, isolators=isolators)
    start, _, axis = name.rpartition("/")
    if name.startswith("mount/") and start.endswith("/position"):
        raise ModelError(
            f"`vary`: there is no quantity {name!r}: a mount's position varies by shifts [m] of where the model has it, and "
            f"they are called {f'{start}_shift/{axis}'!r}; for a position take the model's off."
        )
    raise ModelError(f"`vary`: there is no quantity {name!r}. What can vary: {FORMS}.")
