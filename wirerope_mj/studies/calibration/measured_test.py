"""Measured tests: motion of the base, channels as series for comparison, and the same series of simulated responses."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from wirerope_mj.engine.simulation.stepper import initial_state
from wirerope_mj.engine.simulation.timestep import choose_timestep
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.motions import BaseMotion
from wirerope_mj.motions.records.measured import SI, Measured, MeasuredChannel
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.studies.calibration.noise import Domain, Series, Spectral
from wirerope_mj.studies.engines.together import histories
from wirerope_mj.studies.vary.quantity import InputColumn
from wirerope_mj.studies.vary.variants import Work

SAMPLES = 250  # Samples of a channel that a fit compares at most: the covariance of their errors is a matrix
SMOOTH = 0.6  # Standard deviation of the smoothing before samples are thinned, in intervals of the thinned ones
QUIET = 0.01  # Part of a channel's largest value below which what comes before and after it is left out
FEWEST = 30  # Samples of a channel that a test must have
ACCURACY = 1e-3  # Error of the peaks for which steps are chosen: a tenth of what a good channel measures
SAMPLED = 3.0  # Samples of a simulation in one width of the smoothing of the samples that are compared
# Instants at which a base is sampled, and fractions of the largest motion from which it and a channel count as moving
_INSTANTS, _STILL, _MOVES = 4000, 0.02, 0.2
_XYZ = ("x", "y", "z")


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredTest:
    """Measured test of a system: motion of its base, and channels."""

    name: str  #: in tables and in names of quantities
    motion: BaseMotion  #: of the base
    channels: Sequence[MeasuredChannel]  #: that were measured
    initial: str = "settled"  #: the state in which it began, as `simulate` takes it

    @classmethod
    def of(cls, measured: Measured, motion: BaseMotion | None = None, *, initial: str = "settled") -> "MeasuredTest":
        """Make a test of measured channels under `motion`, or under the motion measured at the base.

        Raises:
            RecordError: there is no motion, or nothing but the base was measured.
        """
        moved = measured.base if motion is None else motion
        channels = [channel for channel in measured.channels if channel.subject != "base"]
        if not channels:
            raise RecordError(
                f"{measured.path}: nothing but the base was measured; map a column to a body, a point or a mount."
            )
        return cls(name=measured.name, motion=moved, channels=channels, initial=initial)


@dataclass(frozen=True, kw_only=True, eq=False)
class Comparable:
    """Channel smoothed and thinned for comparison, and the same treatment of a simulated response."""

    channel: MeasuredChannel  # as measured
    name: str  # "TEST/body/rack/acceleration/z"
    series: Series  # the measured samples that are compared
    width: float  # standard deviation of the smoothing [s]

    @classmethod
    def of(cls, test: str, channel: MeasuredChannel) -> "Comparable":
        """Smooth and thin a measured channel, without saturated samples and without its ends at rest.

        Raises:
            RecordError: it is too short, or does not move.
        """
        name = f"{test}/{channel.subject}/{channel.quantity}/{channel.axis}"
        time, values, bad = channel.time, channel.values, channel.saturated
        moved = np.abs(values - np.median(values))
        largest = float(moved[~bad].max(initial=0.0))
        if largest == 0.0:
            raise RecordError(f"{name}: all samples are the same; a dead channel says nothing. Leave it out.")
        loud = np.flatnonzero(moved > QUIET * largest)
        first, last = max(int(loud[0]) - 2, 0), min(int(loud[-1]) + 2, time.size - 1)
        step = max((time[last] - time[first]) / SAMPLES, float(np.median(np.diff(time))))
        at = np.arange(time[first], time[last] + 0.5 * step, step)
        weights = _smoothing(time, at, SMOOTH * step)
        at, weights = at[weights @ bad < 1e-3], weights[weights @ bad < 1e-3]
        if at.size < FEWEST:
            raise RecordError(
                f"{name}: {at.size} samples are left of it without what was saturated and what stands still; a calibration "
                f"needs {FEWEST}. Measure longer, or leave the channel out."
            )
        smooth = weights @ np.where(bad, 0.0, values)
        even = np.linspace(at[0], at[-1], at.size)
        swing = np.interp(even, at, smooth)
        lines = np.abs(np.fft.rfft((swing - swing.mean()) * np.hanning(at.size))) ** 2
        frequencies = np.fft.rfftfreq(at.size, float(np.mean(np.diff(even))))
        frequency = max(float(frequencies[np.argmax(lines)]), 1.0 / float(np.ptp(at)))  # about which it swings
        power = _smoothing(at, at, 0.5 / frequency) @ (smooth - np.median(values)) ** 2  # over about a period
        size = np.sqrt(2.0 * np.maximum(power, math.ulp(1.0)))
        series = Series(
            name=name, at=at, values=smooth, size=size, frequency=frequency, unit=SI[channel.quantity], across="time",
            smoothed=SMOOTH * step, averaged=float(np.sqrt(np.mean(np.sum(weights**2, axis=1)))),
        )  # fmt: skip
        return cls(channel=channel, name=name, series=series, width=SMOOTH * step)

    def of_response(self, time: Array, values: Array, delay: float) -> Array:
        """Smooth and thin a simulated history (n_t,), delayed by `delay` [s], as the measured channel was."""
        key = (time[0], time[-1], time.size)
        if key not in self._weights:
            # beyond the response's ends the smoothing sees its last value
            self._weights[key] = _smoothing(time, self.series.at, self.width)
        return self._weights[key] @ (np.interp(time - delay, time, values) if delay else values)

    @cached_property
    def _weights(self) -> dict[tuple[float, float, int], Array]:
        return {}

    @property
    def column(self) -> str:
        """The column of a response that the channel measures."""
        kind, _, name = self.channel.subject.partition("/")
        axes, quantity = (AXES, self.channel.quantity) if kind == "mount" else (_XYZ, self.channel.quantity)
        part = "position" if quantity == "displacement" else quantity
        groups = {"body": "bodies", "point": "points", "mount": "mounts"}
        return f"{groups[kind]}/{name}/{part}/{axes[_XYZ.index(self.channel.axis)]}"

    def of_column(self, values: Array, base: Array) -> Array:
        """Convert `column` of a response (n_t,) to the channel's quantity; `base` is the base's displacement [m], (n_t, 3)."""
        moved = values - values[0] if self.channel.counts_from_start or self.channel.quantity == "displacement" else values
        if self.channel.quantity != "displacement" or self.channel.absolute:
            return moved
        return moved - base[:, _XYZ.index(self.channel.axis)]


def work_of(
    system: System, columns: tuple[InputColumn, ...], motion: BaseMotion, *, duration: float, sample_rate: float, initial: str
) -> Work:  # fmt: skip
    """Return the inputs that all runs under one motion share, with a time step chosen for `ACCURACY`."""
    start = initial_state(system, motion, initial)
    chosen = choose_timestep(system, motion, start, duration=duration, sample_rate=sample_rate, accuracy=ACCURACY)
    return Work(
        system=system, motions=(motion,), columns=columns, duration=duration, timestep=chosen.timestep,
        sample_rate=sample_rate, initial=initial, corners=motion.corners,
    )  # fmt: skip


class TransientRuns:
    """Simulated responses of variants to the motion of a test, as the series of its channels."""

    def __init__(self, system: System, test: MeasuredTest, columns: tuple[InputColumn, ...], domain: Domain) -> None:
        for channel in test.channels:
            check_channel(system, test.name, channel)
        self.test, self._time = test, np.zeros(0)
        self.channels = [Comparable.of(test.name, _from_start(test, channel)) for channel in test.channels]
        self._spectra = [] if domain == "time" else [Spectral.of(channel.series, domain) for channel in self.channels]
        self.series = [item.series for item in self._spectra or self.channels]
        rate = SAMPLED / min(channel.width for channel in self.channels)
        end = max(channel.series.at[-1] + 6.0 * channel.width for channel in self.channels)
        self._work = work_of(
            system, columns, test.motion, duration=math.ceil(rate * end) / rate, sample_rate=rate, initial=test.initial
        )
        self.works = (self._work,)

    def __call__(self, rows: Sequence[Entries]) -> list[list[Array] | None]:
        """Return the histories of every channel, (n_t,) each, for the inputs of each row; None for a row whose run failed."""
        self._time, done = histories(self._work, rows, [channel.column for channel in self.channels])
        base = self.test.motion.displacement(self._time)
        return [
            None
            if response is None
            else [channel.of_column(values, base) for channel, values in zip(self.channels, response.T, strict=True)]
            for response in done
        ]

    def recorded(self, number: int, raw: Array, gain: float, delay: float, offset: float) -> Array:
        """Return the series that channel `number` with gain [-], delay [s] and offset [SI] records of history `raw` (n_t,)."""
        samples = gain * self.channels[number].of_response(self._time, raw, delay) + offset
        return self._spectra[number].of_samples(samples) if self._spectra else samples


def check_channel(system: System, name: str, channel: MeasuredChannel) -> None:
    """Raise RecordError unless a system has the body, point or mount that a channel measures."""
    kind, _, subject = channel.subject.partition("/")
    subjects = system.assembly.subjects
    known = {"body": subjects.body_names, "point": subjects.point_names, "mount": list(system.mounts)}
    if kind not in known or subject not in known[kind]:
        names = ", ".join(f"{kind}/{subject_name}" for kind, names in known.items() for subject_name in names)
        raise RecordError(
            f"{name}: this model has no {channel.subject!r}, so that the channel is another model's or misnamed. It "
            f"has: {names}."
        )


def _from_start(test: MeasuredTest, channel: MeasuredChannel) -> MeasuredChannel:
    """Subtract the level before the base moves from a channel of displacements, deflections or forces.

    Raises:
        RecordError: it moves before the base does: it is on another clock.
    """
    instants = np.linspace(0.0, channel.time[-1], _INSTANTS)
    base = np.linalg.norm(test.motion.acceleration(instants), axis=1)
    moved = np.abs(channel.values - channel.values[0])
    if test.initial == "unloaded" or not base.any() or not moved.any():
        return channel  # it moves by itself, or not at all
    began = float(instants[np.argmax(base > _STILL * base.max())])
    first = float(channel.time[np.argmax(moved > _MOVES * moved.max())])
    if first < began - instants[1]:
        raise RecordError(
            f'{test.name}: column "{channel.column}" moves at {first:.4g} s and the base only at {began:.4g} s: they are on '
            "two clocks. Say when its first sample was taken, start (--start), or map the base that was measured with it."
        )
    before = channel.time < began
    if not channel.counts_from_start or not before.any():
        return channel
    return replace(channel, values=channel.values - channel.values[before].mean())


def _smoothing(time: Array, at: Array, width: float) -> Array:
    """Return the weights by which samples at `time` are smoothed to `at`, (n_at, n_t)."""
    weights = np.exp(-0.5 * ((at[:, np.newaxis] - time) / width) ** 2) * np.gradient(time)
    total = weights.sum(axis=1)
    alone = total <= 1e-12 * width  # outside the samples: the nearest one
    weights[alone, np.abs(at[alone, np.newaxis] - time).argmin(axis=1)] = 1.0
    return np.asarray(weights / np.where(alone, 1.0, total)[:, np.newaxis])
