"""The base motion's level, direction and record that vary."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import pyarrow as pa

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import AnyArray, Entries
from wirerope_mj.motions import BaseMotion, Scaled, Turned
from wirerope_mj.studies.inputs.column import Draft, Entry, InputColumn
from wirerope_mj.studies.inputs.distributions import Choice, Distribution


@dataclass(frozen=True, kw_only=True)
class MotionSettings:
    """Level, direction [deg] and record of one variant's motion, or of many as arrays; None where the motions say it."""

    level: Any = None
    azimuth: Any = None
    elevation: Any = None
    record: Any = 0

    @classmethod
    def of(cls, columns: Sequence[InputColumn], row: Entries) -> "MotionSettings":
        """Return the settings of a row of inputs, or of columns of them."""
        return cls(**{one.setting: row[one.name] for one in columns if isinstance(one, MotionColumn)})

    @property
    def turns(self) -> bool:
        """True if the direction varies."""
        return self.azimuth is not None or self.elevation is not None

    def motion(self, motions: Sequence[BaseMotion]) -> BaseMotion:
        """Return the base motion of one variant."""
        motion = motions[self.record]
        if self.turns:
            angles = (self.azimuth, self.elevation)
            motion = Turned(motion, direction=direction(*(0.0 if one is None else one for one in angles)))
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

    numbers = "a distribution of numbers"
    bounds = "finite"

    @property
    def setting(self) -> str:
        """Name of the setting of the motion."""
        return self.form.rpartition("/")[2]

    @classmethod
    def resolve(cls, entry: Entry) -> tuple[InputColumn, ...]:
        """Return the columns of the matching setting."""
        if entry.distribution.relative:
            raise ValueError(f"`vary`: {entry.name!r} cannot be relative; a level is a factor by itself.")
        if not cls.suits(entry.distribution):
            raise ValueError(f"`vary`: {entry.name!r} must be {cls.numbers}, got {entry.distribution}.")
        return (cls(name=entry.name),)

    @classmethod
    def suits(cls, distribution: Distribution) -> bool:
        """Return whether the distribution is of numbers that the setting takes."""
        return not isinstance(distribution, Choice) or all(type(one) in (int, float) for one in distribution.choices)


class Level(MotionColumn):
    """Factor on the motion."""

    form = "motion/level"
    pattern = re.compile(form)
    nature = "factor"

    def nominal(self, system: System, motions: Sequence[BaseMotion] = ()) -> list[object]:
        """Return what the model says."""
        return [1.0]

    def certainly_valid(self, draft: Draft, values: AnyArray) -> bool:
        """Return whether all values are valid; False says nothing."""
        return super().certainly_valid(draft, values) and bool((values != 0.0).all())


class Angle(MotionColumn):
    """Angle [deg] of the motion's direction."""

    model_unit = "°"

    def certainly_valid(self, draft: Draft, values: AnyArray) -> bool:
        """Return whether all values are valid; False says nothing."""
        return super().certainly_valid(draft, values) and len(draft.system.assembly.tables.drive) >= 3


class Azimuth(Angle):
    """Direction [deg] of the motion from x towards y."""

    form = "motion/azimuth"
    pattern = re.compile(form)

    def nominal(self, system: System, motions: Sequence[BaseMotion] = ()) -> list[object]:
        """Return the azimuths of the motions' directions [deg]; of a vertical motion there is none."""
        return [math.degrees(math.atan2(y, x)) for x, y, _ in _directions(motions) if math.hypot(x, y) > 0.0]


class Elevation(Angle):
    """Direction [deg] of the motion above the plane of x and y."""

    form = "motion/elevation"
    pattern = re.compile(form)

    def nominal(self, system: System, motions: Sequence[BaseMotion] = ()) -> list[object]:
        """Return what the model says."""
        return [math.degrees(math.atan2(z, math.hypot(x, y))) for x, y, z in _directions(motions)]


class Record(MotionColumn):
    """Index of the motion among several."""

    form = "motion/record"
    pattern = re.compile(form)
    nature = "index"
    type = pa.int64()
    numbers = "a Choice of integers, indices in `motions`"

    @classmethod
    def resolve(cls, entry: Entry) -> tuple[InputColumn, ...]:
        """Return the columns of the matching setting."""
        columns = super().resolve(entry)
        values = entry.distribution.choices if isinstance(entry.distribution, Choice) else ()
        last = len(entry.motions) - 1
        if not set(values) <= set(range(last + 1)):
            there = "is one record, 0" if last == 0 else f"are the records 0 to {last}"
            raise ValueError(f"`vary`: {entry.name!r}: there {there}, got {list(values)}.")
        return columns

    @classmethod
    def suits(cls, distribution: Distribution) -> bool:
        """Return whether the distribution is a Choice of integers."""
        return isinstance(distribution, Choice) and all(type(value) is int for value in distribution.choices)


def _directions(motions: Sequence[BaseMotion]) -> list[list[float]]:
    return [row for motion in motions for row in motion.directions.tolist()]
