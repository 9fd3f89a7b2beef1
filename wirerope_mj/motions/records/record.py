"""Measured acceleration of a base, played back exactly as it was sampled."""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arguments import finite, nonzero, one_of, positive
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.directions import ROTATIONS, Direction, checked_direction, direction_text, plain_direction
from wirerope_mj.foundation.errors import RecordError, RecordWarning
from wirerope_mj.foundation.parquet_files import read_content
from wirerope_mj.foundation.table_files import LARGEST
from wirerope_mj.foundation.units import ACCELERATION_UNITS, STANDARD_GRAVITY, find_unit
from wirerope_mj.motions.motion import BaseMotion, Said
from wirerope_mj.motions.piecewise import PiecewiseLinear
from wirerope_mj.motions.records.checks import motion_warnings, reading_warnings
from wirerope_mj.motions.records.reading import axes_of
from wirerope_mj.motions.records.sampling import BASELINES, evenly_sampled, resample_record, without_baseline
from wirerope_mj.motions.records.table import acceleration_channels, read_record_table, table_channels
from wirerope_mj.motions.records.turning import AXES_OF_SENSORS, Turning, fade_factor, turned, turning_warnings
from wirerope_mj.motions.records.uff import is_uff, read_uff, uff_channels

# A sampled signal is taken to hold nothing shorter than four samples, twice the shortest period it could.
_SAMPLES_PER_PERIOD = 4
_EVEN = 1e-3  # fraction of an interval by which an instant's last digit may shift it: as much as in a file that counts as even
_MEASURED = frozenset(
    [".csv", ".txt", ".tsv", ".dat", ".asc", ".mat", ".xlsx", ".xlsm", ".uff", ".unv", ".lvm", ".tdms", ".at2", ".v2"]
)
# factors by which units of acceleration are taken for each other, and their relative error
_GRAVITY, _OF_GRAVITY = (STANDARD_GRAVITY, 1.0 / STANDARD_GRAVITY), 5e-3
_BLOCK = 100_000  # samples that are searched for the peak together, so that a long record is not copied


@dataclass(frozen=True, kw_only=True, eq=False)
class Record(BaseMotion):
    """Measured acceleration, linear between evenly spaced samples and zero before and after; made by `load_record`.

    Velocity and displacement are its exact integrals from rest. After the record the base coasts at the velocity that
    is left; `baseline` says what was done about it.
    """

    kind: ClassVar[str] = "record"

    path: Path  # file that the record was read from
    # sample instants [s], (n,); the first is `start`. The baseline "highpass" adds some at either end.
    time: Array = field(repr=False)
    samples: Array = field(repr=False)  # acceleration [m/s^2], scaled and baseline-corrected, (n, 3)
    channels: Mapping[str, Direction] | None = None  # as `load_record` takes them
    scale: float = 1.0
    baseline: str = "none"
    start: float = 0.0
    highpass: float | None = None
    resample: float | None = None
    gaps: str = "refuse"
    unit: str | None = None
    rotation: str | None = None
    fade: float | None = None
    sensors_at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turning: Turning | None = field(default=None, repr=False)  # how the base turns; None where nothing does
    columns: str | None = None
    interval: float | None = None
    # what had to be done to the samples, and what looks wrong about them; each begins with the file's name
    warnings: tuple[str, ...] = field(default=(), repr=False)
    duration: float = field(init=False)

    def __post_init__(self) -> None:
        self._set(duration=float(self.time[-1] - self.time[0]))

    @property
    def directions(self) -> Array:
        """Axes of the world along which a sample is not zero; all three if the base turns about another point, (n, 3)."""
        if self.rotates and any(self.sensors_at):
            return np.eye(3)
        return np.eye(3)[[bool(column.any()) for column in self.samples.T]]

    def _derivative(self, t: Array, order: int) -> Array:
        return self._piecewise.derivative(t, order)

    def _angles(self, t: Array, order: int) -> Array:
        return super()._angles(t, order) if self.turning is None else self.turning.derivative(t, order)

    @property
    def rotates(self) -> bool:
        return self.turning is not None

    @property
    def centre(self) -> tuple[float, float, float]:
        return self.sensors_at

    @property
    def end(self) -> float:
        return float(self.time[-1])

    @property
    def corners(self) -> Array:
        """Every sample instant [s], (n,): the slope of the acceleration may change at each."""
        return self.time

    @cached_property
    def _said(self) -> Said:
        """Describe the record in a line, such as `record deck.csv, 2.5 s, peak 14.2 g`."""
        blocks = np.array_split(self.samples, -(-len(self.samples) // _BLOCK))
        peak = max(float(np.linalg.norm(block, axis=1).max()) for block in blocks) / STANDARD_GRAVITY
        record = f"record {self.path.name}"
        events = (self.start, f"{record} begins"), (self.end, f"{record} ends")
        shortest = _SAMPLES_PER_PERIOD * self.duration / (self.time.size - 1)
        text = f"{record}, {self.duration:.4g} s, peak {peak:.4g} g"
        if self.turning is not None:
            largest = np.degrees(np.abs(self.turning.angles).max(axis=0))
            text += "".join(f", {name} to {angle:.3g} deg" for name, angle in zip(ROTATIONS, largest, strict=True) if angle)
        return Said(text, events, shortest_time=shortest)

    @property
    def files(self) -> tuple[Path, ...]:
        return (self.path,)

    @classmethod
    def maker(cls) -> "Callable[..., Record]":
        return load_record

    def _parameters(self, files: Mapping[Path, str]) -> Entries:
        """Return the arguments of `load_record` that make this record as plain values, optional ones only where given."""
        values: Entries = {"path": files.get(self.path, str(self.path))}
        if self.channels is not None:
            values["channels"] = {name: plain_direction(direction) for name, direction in self.channels.items()}
        values |= {"scale": self.scale, "baseline": self.baseline, "start": self.start}
        if self.gaps != "refuse":
            values["gaps"] = self.gaps
        names = "highpass", "resample", "unit", "rotation", "fade", "columns", "interval"
        optional = {name: getattr(self, name) for name in names}
        optional["sensors_at"] = list(self.sensors_at) if any(self.sensors_at) else None
        return values | {name: value for name, value in optional.items() if value is not None}

    @cached_property
    def as_measured(self) -> "Record":
        """The same record without its baseline correction, read from the file, at the instants of its samples here."""
        if self.baseline == "none":
            return self
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RecordWarning)  # they were given
            measured = load_record(**self._parameters({}) | {"baseline": "none", "highpass": None})
        start = float(self.time[(self.time.size - measured.time.size) // 2])
        later = start - measured.start
        turning = measured.turning and replace(measured.turning, time=measured.turning.time + later)
        return replace(measured, start=start, time=measured.time + later, turning=turning)

    @cached_property
    def _piecewise(self) -> PiecewiseLinear:
        return PiecewiseLinear(self.time, self.samples)


def load_record(
    path: str | Path, *, channels: Mapping[str, str | Sequence[float]] | None = None, scale: float = 1.0,
    baseline: str = "none", start: float = 0.0, highpass: float | None = None, resample: float | None = None,
    gaps: str = "refuse", unit: str | None = None, rotation: str | None = None, fade: float | None = None,
    sensors_at: Sequence[float] = (0.0, 0.0, 0.0), columns: str | None = None, interval: float | None = None,
) -> Record:  # fmt: skip
    """Return the base motion that a table or a universal file (dataset 58) holds, on up to three axes at once.

    The header of a CSV file names its columns with their units, for instance `time [s], x [g], z [m/s^2]`; time is the first;
    cells are separated by commas, semicolons or tabs; lines before the header may begin with #. MATLAB, TDMS, HDF5, XLSX and
    Parquet files have columns so named, too, and the time in any of them. A universal file names a channel by its response node
    and direction, `12:z` or `12:-x`; its unit is the ordinate's label or that of dataset 164.

    The base moves in straight lines between evenly spaced samples. A record that is sampled unevenly is resampled at its usual
    interval, on curves through its samples. What had to be done, and what looks wrong (a pulse that is cut off, a saturated
    sensor, a spike, too few samples, values in another unit, a drift), is a `RecordWarning` with its reason, and one of the
    record's `warnings`.

    Args:
        path: of the file.
        channels: which channel moves the base in which direction, for instance `{"ch3": "z"}`, or turns it, `{"gx": "roll"}`,
            `"pitch"` or `"yaw"`, about x, y, z, with `"-roll"` the other way; others are not used. None: the columns named x,
            y, z (or ax, acc_x, acceleration_x, ...), or all directions of a universal file of one node.
        scale: factor on the acceleration, and on roll, pitch and yaw.
        baseline: `"none"`: as measured. `"rest"`: the level of the quiet part that the record begins or ends with is subtracted
            from each direction: gravity, or an offset; nothing from a pulse that fills its record, the mean from a vibration.
            `"mean"`: the mean of the samples, which holds a pulse too. `"velocity"`: the constant that makes the final
            velocity zero, also where a pulse leaves one. `"highpass"`: what is
            slower than `highpass` is filtered out, without phase. Such a filter answers before a shock as well as after it:
            the record is lengthened by two periods of the cutoff at either end, at rest or, if the signal stands off zero,
            at that offset, and is played with them; 1e-4 of a shock's velocity change is left. A record that begins or ends
            amid its motion is played with the jump that it has there.
        start: instant at which the first sample is played [s], whatever the file's own clock says; with `"highpass"`, the
            first of those before the file's.
        highpass: cutoff of the baseline `"highpass"` [Hz], where the filter's gain is one half.
        resample: samples per second to play [Hz], through an anti-alias filter; None: those of the file.
        gaps: `"refuse"`: a record in which rows are missing, cells are empty or hold NaN is an error. `"fill"`: they are filled
            with straight lines.
        unit: of the accelerations, in place of what the file says; for a file that does not say it, or says it wrong.
        rotation: of a table, whose columns of angular rates [deg/s, rad/s] or angular accelerations [deg/s^2, rad/s^2] turn the
            base: `"base"`: sensors were fixed to the base and turn with it, accelerometers too, so that gravity in their
            signals is a constant along z of the world, which a baseline takes off; `"world"`: all axes are the world's. None:
            as `"base"` if `channels` names a rotation, else without.
        fade: length of a smooth rise at the beginning and fall at the end [s], for a record that was cut out of a longer one.
        sensors_at: place of the accelerometers from the base's own origin, along its axes as modelled [m]; it matters where the
            base turns.
        columns: those of a text of numbers alone, such as "time [s], z [g]".
        interval: time from row to row of a text of numbers alone that holds no time [s]; its first line may say it in place of
            this, behind the number of samples, as "4000 0.005".

    Raises:
        RecordError: the file does not hold a usable record; the message names the line.
        ValueError: an argument is out of its range.
    """
    scale, start = nonzero("scale", scale), finite("start", start)
    highpass = _checked_cutoff(baseline, highpass)
    rate = None if resample is None else positive("resample", resample)
    one_of("gaps", gaps, ("refuse", "fill"))
    interval = None if interval is None else positive("interval", interval)
    stated = None if columns is None and interval is None else (columns, interval)
    if unit is not None:
        unit = find_unit(unit, ACCELERATION_UNITS) or one_of("unit", unit, ACCELERATION_UNITS)
    directions = None if channels is None else _checked_channels(channels)
    rotation = _checked_rotation(rotation, directions)
    if fade is not None and highpass is not None:
        raise ValueError('`fade` and the baseline "highpass" exclude each other: the filter lengthens the record by rest.')
    place = tuple(finite("sensors_at", value) for value in sensors_at)
    if len(place) != 3:
        raise ValueError(f"`sensors_at` must be three lengths, got {place!r}.")
    if rotation is None and any(place):
        raise ValueError(
            '`sensors_at` matters where the base turns, and no channel turns it: rotation="base" (--rotation base).'
        )
    file = Path(path).absolute()

    fill = gaps == "fill"
    if is_uff(file) and stated is None:
        if rotation is not None:
            raise RecordError(f"{file}: rotation is read from tables alone: export this universal file as one.")
        reading = read_uff(file, directions, unit)
    else:
        reading = read_record_table(file, directions, unit, fill=fill, turns=rotation is not None, stated=stated)
    reading = evenly_sampled(file, reading, gaps=gaps)
    if rotation is None:  # records that turn the base are judged along the world's axes, below
        reading = reading.warned(*reading_warnings(reading, corrected=baseline != "none"))
    if rate is not None:
        reading = resample_record(reading, rate)
    time, samples = reading.time, reading.samples
    time -= time[0]
    step, digit = float(time[-1]) / (time.size - 1), float(np.spacing(abs(start)))
    if digit > _EVEN * step:
        raise ValueError(
            f"`start` is so far from 0 that its last digit, {digit:.2g} s, is large beside the {step:.6g} s between samples, "
            f"got {start!r}."
        )
    time += start  # in a second step, so that the first instant is `start` to the last digit
    turning = None
    if rotation is not None:
        samples, turning = turned(
            file, time, samples, kind=reading.turned_by, axes=rotation, baseline=baseline, highpass=highpass, fade=fade
        )
        moved = replace(reading, samples=samples)
        reading = reading.warned(*reading_warnings(moved, corrected=baseline != "none"), *turning_warnings(turning))
    peak = max(float(samples.max()), -float(samples.min()))
    if peak * abs(scale) > LARGEST * STANDARD_GRAVITY:
        raise ValueError(f"`scale` makes {abs(scale):.3g} times a peak of {peak:.4g} m/s^2, got {scale!r}.")
    reading = reading.warned(*_scale_warnings(file, scale))
    samples *= scale
    time, samples = without_baseline(time, samples, baseline, highpass)
    if fade is not None:
        samples *= fade_factor(time, fade)[:, np.newaxis]
    messages = (*reading.warnings, *motion_warnings(reading, time, samples, baseline))
    if turning is not None:
        turning = Turning(turning.time, scale * turning.angles, scale * turning.rates)
    for message in messages:
        warnings.warn(f"{file}: {message}", RecordWarning, stacklevel=2)
    for array in (time, samples):
        array.flags.writeable = False
    return Record(
        path=file, time=time, samples=samples, channels=directions, scale=scale, baseline=baseline, start=start,
        highpass=highpass, resample=rate, gaps=gaps, unit=unit, rotation=rotation, fade=fade, turning=turning,
        sensors_at=(place[0], place[1], place[2]),
        columns=columns, interval=interval,
        warnings=tuple(f"{file.name}: {message}" for message in messages),
    )  # fmt: skip


def records_in(motion: BaseMotion) -> list[Record]:
    return [part for part in motion.parts if isinstance(part, Record)]


def record_warnings(motion: BaseMotion) -> tuple[str, ...]:
    return tuple(dict.fromkeys(message for record in records_in(motion) for message in record.warnings))


def is_measurement(path: Path) -> bool:
    """True if a file is of a kind that measured channels are read from, and not a result of this package."""
    if path.suffix.lower() == ".parquet":
        try:
            read_content(path, kind="", remedy="")
        except RecordError:  # it has no metadata of ours
            return True
        return False
    return path.suffix.lower() in _MEASURED or is_uff(path)


def record_channels(
    path: str | Path, *, accelerations: bool = False, columns: str | None = None, interval: float | None = None
) -> tuple[str, ...]:
    """Return the names of a record's channels, as `load_record` takes them; only those of `accelerations` if asked.

    `columns` and `interval` are those of a text without a header, as for `load_record`.

    RecordError: the file is no record.
    """
    file = Path(path).absolute()
    if is_uff(file):
        return uff_channels(file)
    stated = None if columns is None and interval is None else (columns, interval)
    return acceleration_channels(file, stated) if accelerations else table_channels(file, stated)


def _scale_warnings(file: Path, scale: float) -> list[str]:
    """Warn of a scale that turns a unit of acceleration into another, unless nothing says the unit, as in a WAV file."""
    if file.suffix.lower() == ".wav" or not any(abs(abs(scale) / size - 1.0) < _OF_GRAVITY for size in _GRAVITY):
        return []
    return [
        f"`scale` of {scale:g} makes g of m/s^2, or m/s^2 of g, which is done already for the unit that the file or `unit` "
        "says: leave it out, or say the right unit."
    ]


def _checked_cutoff(baseline: str, highpass: float | None) -> float | None:
    """Return the cutoff [Hz] of the baseline "highpass", else None; ValueError if it is missing or has no use."""
    one_of("baseline", baseline, BASELINES)
    if baseline != "highpass":
        if highpass is not None:
            raise ValueError(
                f'`highpass` is the cutoff of baseline="highpass" (--baseline highpass); the baseline is {baseline!r}.'
            )
        return None
    if highpass is None:
        raise ValueError('baseline="highpass" needs its cutoff [Hz], for instance highpass=1.0 (--highpass 1).')
    return positive("highpass", highpass)


def _checked_rotation(rotation: str | None, directions: Mapping[str, Direction] | None) -> str | None:
    """Return "base" or "world", the axes of the channels that turn the base: as given, else "base"; None if none turns it."""
    if rotation is None:
        turns = any(str(direction).lstrip("+-") in ROTATIONS for direction in (directions or {}).values())
        return AXES_OF_SENSORS[0] if turns else None
    return one_of("rotation", rotation, AXES_OF_SENSORS)


def _checked_channels(channels: Mapping[str, str | Sequence[float]]) -> dict[str, Direction]:
    """Return the directions of the channels; ValueError if there are none, or two have one direction."""
    if not channels:
        raise ValueError('`channels` must name at least one column, for instance {"ch3": "z"}, got none.')
    directions = {
        name: str(direction) if str(direction).lstrip("+-") in ROTATIONS else checked_direction(direction)
        for name, direction in channels.items()
    }
    vectors = dict(zip(directions, axes_of(directions.values()), strict=True))
    for name, direction in directions.items():
        alike = [other for other in directions if np.array_equal(vectors[other], vectors[name])]
        if len(alike) > 1:
            raise ValueError(f"`channels` gives {name} and {alike[1]} the same direction {direction_text(direction)}.")
    return directions
