"""Measured responses: what sensors on base, bodies, points and mounts recorded, by channel, in SI on one clock.

A phrase says what a column of the file is: "point/rack_top z g" is an acceleration in g along z at the point rack_top.
"""

import shlex
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Literal

import numpy as np

from wirerope_mj.foundation.arguments import between, finite, one_of
from wirerope_mj.foundation.arrays import Array, Booleans
from wirerope_mj.foundation.directions import Direction
from wirerope_mj.foundation.errors import RecordError, RecordWarning
from wirerope_mj.foundation.summary import Summarised, quantity
from wirerope_mj.foundation.units import ACCELERATION_UNITS, FORCE_UNITS, LENGTH_UNITS, VELOCITY_UNITS, find_unit, range_of
from wirerope_mj.motions.records.checks import clipped_text, flat_tops
from wirerope_mj.motions.records.reading import level_at_rest, offset_of
from wirerope_mj.motions.records.record import Record, load_record
from wirerope_mj.motions.records.sampling import evenly_sampled
from wirerope_mj.motions.records.signals import level_warnings, resolution_warnings
from wirerope_mj.motions.records.table import read_columns, require_within_range
from wirerope_mj.motions.records.uff import is_uff, read_uff_columns
from wirerope_mj.motions.records.written import code_text, lost_code

Quantity = Literal["acceleration", "velocity", "displacement", "deflection", "force"]
Axis = Literal["x", "y", "z"]
UNITS: Mapping[Quantity, Mapping[str, float]] = {
    "acceleration": ACCELERATION_UNITS, "velocity": VELOCITY_UNITS, "displacement": LENGTH_UNITS, "deflection": LENGTH_UNITS,
    "force": FORCE_UNITS,
}  # fmt: skip
"""Units of each quantity, and what one of each is in SI."""

SI: Mapping[Quantity, str] = {"acceleration": "m/s^2", "velocity": "m/s", "displacement": "m", "deflection": "m", "force": "N"}
_OF_MOUNT: Mapping[str, Axis] = {"roll": "x", "shear": "y", "axial": "z"}
_KINDS = ("body", "point", "mount")
_EXAMPLES = '"base z g", "point/rack_top -x g", "body/floor displacement z mm" or "mount/m1 axial force kN"'


@dataclass(frozen=True, kw_only=True)
class ChannelPhrase:
    """Measurement that a file's column holds, as far as its phrase states it."""

    subject: str  # "base", "body/NAME", "point/NAME" or "mount/NAME"
    quantity: Quantity | None  # None where only the unit in the file's header can say
    axis: Axis  # of the world; of a mount x is roll, y shear, z axial
    sign: float  # -1.0 for a sensor that points the other way
    unit: str | None  # None where the file's header says it
    # whether a displacement of a body or a point is that in space, not that relative to the base
    absolute: bool

    def quantity_of(self, unit: str) -> Quantity | None:
        """Return the quantity that the phrase states, or else the unit's; None if the unit does not fit."""
        if self.quantity is not None:
            return self.quantity if find_unit(unit, UNITS[self.quantity]) else None
        return quantity_of(unit, mount=self.subject.startswith("mount/"))


def quantity_of(unit: str, *, mount: bool) -> Quantity | None:
    """Return the quantity of a unit, None for an unknown unit: lengths are displacements, of a mount deflections."""
    for known, units in UNITS.items():
        if find_unit(unit, units) and mount == (known in ("deflection", "force")):
            return known
    return None


def parse_channel(column: str, phrase: str) -> ChannelPhrase:
    """Parse the phrase of a column: a subject, then in any order an axis with its sign, a quantity, a unit, "absolute".

    A name with spaces stands in quotation marks. ValueError says what is missing, said twice or unknown.
    """
    try:
        subject, *words = shlex.split(phrase)
    except ValueError:
        raise _refused(column, phrase, "does not say what the column is") from None
    kind, _, name = subject.partition("/")
    if subject != "base" and not (kind in _KINDS and name):
        raise _refused(column, phrase, f"begins with {subject!r}, which is neither base nor body/, point/ or mount/NAME")
    is_mount = kind == "mount"
    found: dict[str, str] = {}
    for word in words:
        bare = word.strip("[]()")
        axis = bare.lstrip("+-")
        if axis in ("x", "y", "z", *_OF_MOUNT):
            if (axis in _OF_MOUNT) != is_mount:
                axes = "roll, shear or axial" if is_mount else "x, y or z"
                raise _refused(column, phrase, f"has the axis {axis}: the axis of {_called(subject)} is {axes}")
            role = "axis"
        elif bare in UNITS:
            role = "quantity"
        elif any(find_unit(bare, units) for units in UNITS.values()):
            role = "unit"
        elif bare in ("absolute", "relative"):
            role = "reference"
        else:
            raise _refused(column, phrase, f"has the word {word!r}, which is no axis, quantity or unit")
        if role in found:
            raise _refused(column, phrase, f"states two of {role}: {found[role]} and {bare}")
        found[role] = bare
    if "axis" not in found:
        raise _refused(column, phrase, "does not say the axis")
    quantity, unit, word = found.get("quantity"), found.get("unit"), found["axis"]
    axis = word.lstrip("+-")
    parsed = ChannelPhrase(
        subject=subject, quantity=next((known for known in UNITS if known == quantity), None),
        axis=_OF_MOUNT.get(axis) or ("x" if axis == "x" else "y" if axis == "y" else "z"),
        sign=-1.0 if word.startswith("-") else 1.0, unit=unit, absolute=found.get("reference") == "absolute",
    )  # fmt: skip
    if unit is not None and parsed.quantity_of(unit) is None:
        stated = quantity or f"anything measured at {_called(subject)}"
        raise _refused(column, phrase, f"has the unit {unit}, which is none of {stated}")
    if is_mount != (quantity in ("deflection", "force")) and quantity is not None:
        has = "deflection and force" if is_mount else "acceleration, velocity and displacement"
        raise _refused(column, phrase, f"asks for the {quantity} of {_called(subject)}, which has {has}")
    return parsed


def _called(subject: str) -> str:
    return "the base" if subject == "base" else f"a {subject.partition('/')[0]}"


def _refused(column: str, phrase: str, fault: str) -> ValueError:
    return ValueError(f"`channels` must say what column {column!r} is, such as {_EXAMPLES}; {phrase!r} {fault}.")


BASELINES = ("none", "rest", "mean")
_FEWEST = 16  # samples below which nothing can be said of a response
_OFFSET = 0.02  # level at rest, as a fraction of a channel's range, from which it is warned of


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredChannel:
    """Samples of one sensor, and the place, quantity and axis that it measured."""

    subject: str  #: "base", "body/NAME", "point/NAME" or "mount/NAME"
    quantity: Quantity  #: "acceleration", "velocity" or "displacement"; of a mount "deflection" or "force"
    axis: Axis  #: "x", "y" or "z" of the world; of a mount x is roll, y shear, z axial, with the signs of its response
    time: Array = field(repr=False)  #: instants on the run's clock [s], evenly spaced, (n,)
    values: Array = field(repr=False)  #: in SI, with the sign of the axis, (n,)
    #: samples at which the sensor was at the end of its range: the true value lies beyond, (n,)
    saturated: Booleans = field(repr=False)
    absolute: bool = False  #: of a displacement of a body or a point: that in space; else relative to the base
    column: str  #: of the file
    unit: str  #: in which the file gives it

    @property
    def key(self) -> str:
        """Name of the channel, such as "point/rack_top acceleration z"."""
        reference = "absolute " if self.absolute else ""
        return f"{self.subject} {reference}{self.quantity} {self.axis}"

    @property
    def counts_from_start(self) -> bool:
        """Whether values are changes since the start, as relative displacements, deflections and forces are."""
        return self.quantity in ("displacement", "deflection", "force") and not self.absolute

    @property
    def rate(self) -> float:
        """Samples per second [Hz]."""
        return (self.time.size - 1) / float(self.time[-1] - self.time[0])


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Measured(Summarised):
    """Measured channels of a test; made by `load_measured`."""

    name: str  #: of the test: its file's name without the ending, or as it was given
    channels: tuple[MeasuredChannel, ...]  #: in the order of the map
    warnings: tuple[str, ...] = ()  #: what had to be done to the samples, and what looks wrong about them
    path: Path  #: of the file
    phrases: Mapping[str, str]  #: what each column is, by column, as `load_measured` takes them
    #: as `load_measured` takes them
    start: float = 0.0
    clock: float = 1.0
    baseline: str = "none"
    gaps: str = "refuse"

    def __getitem__(self, key: str) -> MeasuredChannel:
        """Return the channel with a key, such as "point/rack_top acceleration z", or of a column."""
        for channel in self.channels:
            if key in (channel.key, channel.column):
                return channel
        raise KeyError(f"{self.name} has no channel {key!r}; it has {', '.join(channel.key for channel in self.channels)}.")

    def _summary(self) -> tuple[str, dict[str, str]]:
        first = self.channels[0]
        return f"Measured {self.name}: {first.time[-1] - first.time[0]:.4g} s at {first.rate:.6g} Hz", {
            c.key: f"peak {quantity(float(np.abs(c.values).max()), SI[c.quantity])}" for c in self.channels
        }

    @cached_property
    def base(self) -> Record:
        """Measured acceleration of the base as a motion, as `load_record` reads it from the same file with the same start.

        RecordError: the map names no acceleration of the base, or the clock is not the file's.
        """
        parts = {c.column: c for c in self.channels if c.subject == "base" and c.quantity == "acceleration"}
        if not parts:
            raise RecordError(
                f"{self.path}: no column is mapped to the base's acceleration. Map one, for instance "
                f'channels={{"A0": "base z g"}} (--map "A0=base z g").'
            )
        units = {channel.unit for channel in parts.values()}
        if self.clock != 1.0 or len(units) > 1:
            fault = f"its units are {', '.join(units)}" if len(units) > 1 else f"its clock is changed by {self.clock!r}"
            raise RecordError(
                f"{self.path}: the base cannot be played from this file, {fault}; a base is played on its file's own clock, "
                "with one unit for all axes."
            )
        directions: dict[str, Direction] = {}
        for column, channel in parts.items():
            sign = parse_channel(column, self.phrases[column]).sign
            x, y, z = (sign * (channel.axis == axis) for axis in ("x", "y", "z"))
            directions[column] = (x, y, z) if sign < 0.0 else channel.axis
        return load_record(
            self.path, channels=directions, baseline=self.baseline, start=self.start, gaps=self.gaps, unit=units.pop()
        )


def load_measured(
    path: str | Path, *, channels: Mapping[str, str], name: str | None = None, start: float = 0.0, clock: float = 1.0,
    baseline: str = "none", gaps: str = "refuse",
) -> Measured:  # fmt: skip
    """Read measured responses from a CSV, MATLAB, XLSX or Parquet file, or a universal file (dataset 58).

    A phrase says what each column is: what it was measured at ("base", "body/floor", "point/rack_top", "mount/m1"), its axis
    and sign ("z", "-x"; of a mount "roll", "shear", "axial"), and its unit where the file's header does not state it. The unit
    says the quantity: an acceleration, velocity, displacement; of a mount a deflection or a force. A displacement of a body or
    a point is relative to the base unless its phrase says "absolute". Signs are those of a run: a mount's axial deflection and
    force are positive in tension.

    What had to be done, and what looks wrong (a saturated sensor, an offset, a spike, too few samples, a dead channel), is a
    `RecordWarning`, and one of `warnings`.

    Args:
        path: of the file; its first column, or the one called time or t, is the time.
        channels: what each column is, for instance `{"A1": "point/rack_top z g"}`; other columns are not used. Of a universal
            file `{"12:z": ..}`, `{"12:z displacement": ..}`.
        name: of the test; None: the file's.
        start: instant of the run at which the first sample was taken [s], whatever the file's own clock says.
        clock: seconds of the run in a second of the file's clock.
        baseline: `"none"`: as measured. `"rest"`: the level of the quiet part that a channel begins or ends with is taken
            off, or what stands before it first moves; `"mean"`: the mean.
        gaps: `"refuse"`: missing samples are an error. `"fill"`: they are filled with straight lines.

    Raises:
        RecordError: the file does not hold the columns, a unit is not stated, or there are too few samples.
        ValueError: a phrase cannot be understood, or an argument is out of its range.
    """
    start, clock = finite("start", start), between("clock", clock, 1e-6, 1e6)
    one_of("baseline", baseline, BASELINES)
    one_of("gaps", gaps, ("refuse", "fill"))
    if not channels:
        raise ValueError('`channels` must say what at least one column is, such as {"A1": "point/rack_top z g"}, got none.')
    phrases = {column: parse_channel(column, phrase) for column, phrase in channels.items()}
    file = Path(path).absolute()
    names = list(channels)
    reading, units = read_uff_columns(file, names) if is_uff(file) else read_columns(file, names, fill=gaps == "fill")
    if reading.time.size < _FEWEST:
        raise RecordError(f"{file}: a measured response needs at least {_FEWEST} samples, this one has {reading.time.size}.")
    reading = evenly_sampled(file, reading, gaps=gaps)
    time = (reading.time - reading.time[0]) * clock + start
    if not (np.diff(time) > 0.0).all():
        raise ValueError(f"`start` must leave the samples apart, got {start:.6g} s.")
    time.flags.writeable = False
    found, messages = [], list(reading.warnings)
    for (column, phrase), unit, samples in zip(phrases.items(), units, reading.samples.T, strict=True):
        stated = None if phrase.unit else range_of(unit)
        known, unit = _quantity_of(file, column, phrase, unit)
        values = samples * (phrase.sign * UNITS[known][unit])
        if stated is not None:
            require_within_range(f'{file}, column "{column}"', values, stated)
        tops = list(flat_tops(values)) if np.ptp(values) else []
        rest = level_at_rest(values)
        where, rate = f'in column "{column}"', 1.0 / float(time[1] - time[0])
        messages += _warnings(where, values, tops, rate, (known, unit), baseline, rest)
        saturated = np.isin(values, [extreme for extreme, _ in tops])
        level = offset_of(values) if rest is None else rest
        values -= {"none": 0.0, "rest": level, "mean": float(values.mean())}[baseline]
        for array in (values, saturated):
            array.flags.writeable = False
        found.append(
            MeasuredChannel(
                subject=phrase.subject, quantity=known, axis=phrase.axis, time=time, values=values, saturated=saturated,
                absolute=phrase.absolute, column=column, unit=unit,
            )  # fmt: skip
        )  # fmt: skip
    for channel in found:
        if len(alike := [other.column for other in found if other.key == channel.key]) > 1:
            raise ValueError(f"`channels` must be different measurements, got {channel.key!r} for {' and '.join(alike)}.")
    for message in messages:
        warnings.warn(f"{file}: {message}", RecordWarning, stacklevel=2)
    return Measured(
        name=name or file.stem, channels=tuple(found), warnings=tuple(f"{file.name}: {text}" for text in messages), path=file,
        phrases=dict(channels), start=start, clock=clock, baseline=baseline, gaps=gaps,
    )  # fmt: skip


def _quantity_of(file: Path, column: str, phrase: ChannelPhrase, header: str | None) -> tuple[Quantity, str]:
    """Return quantity and unit of a column, from its phrase or else the file's header; RecordError if neither states them."""
    unit = phrase.unit or header
    known = None if unit is None else phrase.quantity_of(unit)
    if known is not None and unit is not None:
        return known, find_unit(unit, UNITS[known]) or unit
    wanted = phrase.quantity or ("deflection" if phrase.subject.startswith("mount/") else "acceleration")
    listed = ", ".join(UNITS[wanted])
    fault = "has no unit" if unit is None else f'has the unit "{unit}", which is none of what {phrase.subject} can have'
    raise RecordError(
        f'{file}: column "{column}" {fault}. State it in the header, "{column} [{next(iter(UNITS[wanted]))}]", or in the map, '
        f'"{column}={phrase.subject} {phrase.axis} {next(iter(UNITS[wanted]))}"; units of {wanted}: {listed}.'
    )


def _warnings(
    where: str, values: Array, tops: list[tuple[float, int]], rate: float, known: tuple[Quantity, str], baseline: str,
    rest: float | None,
) -> Iterator[str]:  # fmt: skip
    """Yield warnings about a channel [SI] before its baseline is taken off, in the unit of its column."""
    (quantity, unit), spread = known, float(np.ptp(values))
    factor = UNITS[quantity][unit]
    if spread == 0.0:
        yield f"{where} all samples are {values[0] / factor:.4g} {unit}: the channel is dead, or was not connected."
        return
    if (code := lost_code(values / factor)) is not None:
        yield code_text(where, code, values / factor)
        return
    yield from (clipped_text(where, f"{extreme / factor:.5g} {unit}", length) for extreme, length in tops)
    if rest is None and baseline == "rest":
        yield f"{where} it is at rest nowhere; {offset_of(values) / factor:.4g} {unit} was taken off as its level."
    if rest is not None and abs(rest) > _OFFSET * spread and baseline == "none":
        yield (
            f"{where} it rests at {rest / factor:.4g} {unit} and not at zero. If that is an offset, "
            'baseline="rest" takes it off (--baseline rest).'
        )
    yield from resolution_warnings(where, values / factor, offset_of(values) / factor, rate, unit=unit, played=False)
    if quantity == "acceleration":
        yield from level_warnings(where, np.arange(values.size) / rate, values, (unit, factor), played=False)
