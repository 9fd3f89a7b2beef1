"""Measured acceleration of a base, played back exactly as it was sampled."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wirerope_mj.errors import RecordError
from wirerope_mj.excitation.checks import (
    Direction,
    as_times,
    checked_direction,
    direction_text,
    finite,
    nonzero,
    plain_direction,
    unit_vector,
)
from wirerope_mj.excitation.motion import BaseMotion, unique_times
from wirerope_mj.excitation.piecewise import PiecewiseLinear
from wirerope_mj.excitation.record_file import ACCELERATION_UNITS, TIME_UNITS, Header, read_header, read_numbers
from wirerope_mj.units import STANDARD_GRAVITY

_AXIS_COLUMN = re.compile(r"(?:(?:a|acc|acceleration)[ _]?)?([xyz])", re.IGNORECASE)

# A sampled signal is taken to hold nothing shorter than four samples, twice the shortest period it could.
_SAMPLES_PER_PERIOD = 4


@dataclass(frozen=True, kw_only=True, eq=False)
class Record(BaseMotion):
    """Measured acceleration, linear between its samples and zero before and after; made by `load_record`.

    Velocity and displacement are its exact integrals from rest. After the record the base coasts at the velocity that
    is left; `baseline` says what was done about it.

    Attributes:
        path: File that the record was read from.
        time: Sample instants [s], shape (n,); the first is `start`.
        samples: Acceleration [m/s^2], scaled and baseline-corrected, shape (n, 3).
        channels: Columns and their directions as asked for; None: the columns named x, y and z.
        scale: Factor on the acceleration.
        baseline: `"none"`, `"mean"` or `"velocity"`.
        start: Instant of the first sample [s].
    """

    kind: ClassVar[str] = "record"

    path: Path
    time: NDArray[np.float64] = field(repr=False)
    samples: NDArray[np.float64] = field(repr=False)
    channels: Mapping[str, Direction] | None = None
    scale: float = 1.0
    baseline: str = "none"
    start: float = 0.0
    duration: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "duration", float(self.time[-1] - self.time[0]))

    @property
    def directions(self) -> NDArray[np.float64]:
        """Axes of the world in which a sample is not zero, shape (n, 3)."""
        return np.eye(3)[np.any(self.samples != 0.0, axis=0)]

    def acceleration(self, time: ArrayLike) -> NDArray[np.float64]:
        """Returns the base's acceleration [m/s^2] at the times [s], shape (n_t, 3)."""
        return self._piecewise.acceleration(as_times(time))

    def velocity(self, time: ArrayLike) -> NDArray[np.float64]:
        """Returns the base's velocity [m/s] at the times [s], shape (n_t, 3)."""
        return self._piecewise.velocity(as_times(time))

    def displacement(self, time: ArrayLike) -> NDArray[np.float64]:
        """Returns the base's displacement [m] at the times [s], shape (n_t, 3)."""
        return self._piecewise.displacement(as_times(time))

    @property
    def end(self) -> float:
        """Instant of the last sample [s]."""
        return float(self.time[-1])

    @cached_property
    def corners(self) -> NDArray[np.float64]:
        """Every sample instant [s], shape (n,): the slope of the acceleration may change at each."""
        return unique_times(self.time)

    @property
    def description(self) -> str:
        """For instance `record deck.csv, 2.5 s, peak 14.2 g`."""
        peak = float(np.max(np.linalg.norm(self.samples, axis=1))) / STANDARD_GRAVITY
        return f"record {self.path.name}, {self.duration:.4g} s, peak {peak:.4g} g"

    @property
    def events(self) -> tuple[tuple[float, str], ...]:
        """First and last sample."""
        return (self.start, f"record {self.path.name} begins"), (self.end, f"record {self.path.name} ends")

    @property
    def shortest_time(self) -> float:
        """Four usual sample intervals [s]."""
        return _SAMPLES_PER_PERIOD * float(np.median(np.diff(self.time)))

    @property
    def files(self) -> tuple[Path, ...]:
        """The file that the record was read from."""
        return (self.path,)

    def _parameters(self, files: Mapping[Path, str]) -> dict[str, Any]:
        values: dict[str, Any] = {"path": files.get(self.path, str(self.path))}
        if self.channels is not None:
            values["channels"] = {name: plain_direction(direction) for name, direction in self.channels.items()}
        return {**values, "scale": self.scale, "baseline": self.baseline, "start": self.start}

    @cached_property
    def _piecewise(self) -> PiecewiseLinear:
        return PiecewiseLinear(self.time, self.samples)


def load_record(
    path: str | Path,
    *,
    channels: Mapping[str, str | Sequence[float]] | None = None,
    scale: float = 1.0,
    baseline: str = "none",
    start: float = 0.0,
) -> Record:
    """Returns the base motion that a CSV file holds: time in the first column, accelerations in others.

    The header names the columns with their units, for instance `time [s], x [g], z [m/s^2]`; cells are separated by
    commas, semicolons or tabs; lines before the header may begin with #. Sampling need not be uniform.

    Args:
        path: The file.
        channels: Which column moves the base in which direction, for instance `{"ch3": "z"}`; other columns are not
            used. None: the columns named x, y, z (or ax, acc_x, acceleration_x, ...).
        scale: Factor on the acceleration.
        baseline: `"none"`: as measured. `"mean"`: the mean of the samples is subtracted from each direction.
            `"velocity"`: the constant acceleration is subtracted that makes the final velocity zero.
        start: Instant at which the first sample is played [s], whatever the file's own clock says.

    Raises:
        RecordError: The file does not hold a usable record; the message names the line.
        ValueError: An argument is out of its range.
    """
    if baseline not in ("none", "mean", "velocity"):
        raise ValueError(f'`baseline` must be "none", "mean" or "velocity", got {baseline!r}.')
    scale, start = nonzero("scale", scale), finite("start", start)
    wanted = None if channels is None else _checked_channels(channels)
    file = Path(path).absolute()

    header = read_header(file)
    directions = _axis_columns(header) if wanted is None else _named_columns(header, wanted)
    columns = [0, *directions]
    factors = [header.factor(0, TIME_UNITS), *(header.factor(column, ACCELERATION_UNITS) for column in directions)]
    numbers = read_numbers(header, columns) * factors

    time = start + (numbers[:, 0] - numbers[0, 0])
    axes = np.array([unit_vector(direction) for direction in directions.values()])
    samples = _corrected(time, scale * (numbers[:, 1:] @ axes), baseline)
    for array in (time, samples):
        array.flags.writeable = False
    return Record(path=file, time=time, samples=samples, channels=wanted, scale=scale, baseline=baseline, start=start)


def _corrected(time: NDArray[np.float64], samples: NDArray[np.float64], baseline: str) -> NDArray[np.float64]:
    """Returns the samples with the baseline taken off that was asked for."""
    if baseline == "mean":
        return samples - samples.mean(axis=0)
    if baseline == "velocity":
        return samples - np.trapezoid(samples, time, axis=0) / (time[-1] - time[0])
    return samples


def _checked_channels(channels: Mapping[str, str | Sequence[float]]) -> dict[str, Direction]:
    if not channels:
        raise ValueError('`channels` must name at least one column, for instance {"ch3": "z"}, got none.')
    wanted = {name: checked_direction(direction) for name, direction in channels.items()}
    for name, direction in wanted.items():
        twins = [other for other in wanted if np.array_equal(unit_vector(wanted[other]), unit_vector(direction))]
        if len(twins) > 1:
            raise ValueError(f"`channels` gives {name} and {twins[1]} the same direction {direction_text(direction)}.")
    return wanted


def _named_columns(header: Header, wanted: Mapping[str, Direction]) -> dict[int, Direction]:
    """Returns the column numbers of the channels asked for, with their directions."""
    for name in wanted:
        found = header.names[1:].count(name)
        if found != 1:
            fault = f'there is no column "{name}"' if found == 0 else f'there are {found} columns "{name}"'
            raise RecordError(
                f"{header.path}, line {header.line}: {fault}; the columns are {', '.join(header.names[1:])}."
            )
    return {header.names.index(name, 1): direction for name, direction in wanted.items()}


def _axis_columns(header: Header) -> dict[int, Direction]:
    """Returns the numbers of the columns that are named after an axis, with their directions."""
    found: dict[int, Direction] = {}
    for column, name in enumerate(header.names[1:], start=1):
        match = _AXIS_COLUMN.fullmatch(name)
        if not match:
            continue
        if match[1].lower() in found.values():
            raise RecordError(
                f'{header.path}, line {header.line}: "{name}" is a second column for direction {match[1].lower()}. '
                "Choose with `channels`."
            )
        found[column] = match[1].lower()
    if not found:
        raise RecordError(
            f"{header.path}, line {header.line}: no column is named x, y or z; the columns are "
            f"{', '.join(header.names)}. Name one with `channels`, for instance "
            f'{{"{header.names[-1] if len(header.names) > 1 else "ch1"}": "z"}}.'
        )
    return found
