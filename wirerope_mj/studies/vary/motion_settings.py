"""The base motion's level, direction and record that vary."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import pyarrow as pa

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import AnyArray, Entries
from wirerope_mj.motions import BaseMotion, Scaled, Turned
from wirerope_mj.studies.vary.distributions import Choice
from wirerope_mj.studies.vary.quantity import Draft, Entry, InputColumn


@dataclass(frozen=True, kw_only=True)
class MotionSettings:
    """Level, direction [deg] and record of one variant's motion, or of many as arrays; None where the motions say it."""

    level: Any = None
    azimuth: Any = None
    elevation: Any = None
    record: Any = 0

    @classmethod
    def of(cls, columns: Sequence[InputColumn], row: Entries) -> "MotionSettings":
        return cls(**{column.into: row[column.name] for column in columns if isinstance(column, MotionColumn)})

    @property
    def turns(self) -> bool:
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
