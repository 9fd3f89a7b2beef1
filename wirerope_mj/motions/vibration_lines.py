"""Several steady sines at once: ship vibration at shaft, blade and engine orders."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arguments import between, finite, integer, positive, the_one_given
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.directions import Direction, checked_direction, direction_text
from wirerope_mj.foundation.quantities import Phrase
from wirerope_mj.foundation.summary import AsCall
from wirerope_mj.motions import ranges
from wirerope_mj.motions.envelope import Envelope, check_room, random_phases, usual_ramp
from wirerope_mj.motions.motion import BaseMotion, Said, StartedMotion, TargetSpectrum
from wirerope_mj.motions.phrases import START, SpokenMotion, file_first
from wirerope_mj.motions.psd_lines import Points, checked_points, table_lines

_ORDER = {"acceleration": 2, "velocity": 1, "displacement": 0}
_UNIT = {"acceleration": "m/s^2", "velocity": "m/s", "displacement": "m"}
# samples in a period of the highest frequency for the peak, and the largest number of sines for it: a second's work
_SAMPLES, _MOST_SINES = 32.0, 2e7
_BLOCK = 2**14  # samples at once: they stay in a processor's cache


MOST_DWELLS = 100  # frequencies of an amplitude table's dwells


def _dwells(
    shape: Callable[..., BaseMotion], phrase: Phrase, direction: Direction, _: int, table: tuple[str, Points]
) -> BaseMotion:
    """Make the sine of each line of an amplitude table in turn, each starting and ending at rest, then dwells at some lines."""
    quantity, lines = table
    amplitudes, chosen = dict(lines), phrase.quantities.get("frequency", ())
    if ("dwell" in phrase.named) != bool(chosen):
        raise ValueError(
            '"dwell" and its frequencies belong together, as in "dwell 60 s 7 Hz 12 Hz"; `wirerope shock` and a job find them.'
        )
    for frequency in chosen:
        if frequency not in amplitudes:
            known = ", ".join(f"{line:g}" for line in amplitudes)
            raise ValueError(f"a dwell must be at a frequency of the table, {known} Hz, got {frequency:g} Hz.")
    stages = [(line, phrase.one("time")) for line in lines]
    stages += [((frequency, amplitudes[frequency]), phrase.named["dwell"]) for frequency in chosen]
    dwells, start = [], phrase.start
    for line, length in stages:
        amplitude: Entries = {quantity: [line]}
        dwells.append(shape(direction=direction, duration=length, start=start, **amplitude))
        start += length
    return sum(dwells[1:], start=dwells[0])


@dataclass(frozen=True, init=False, repr=False)
class VibrationLines(AsCall, StartedMotion):
    """Sines of fixed frequencies along one direction, endless or between a smooth rise from rest and a fall back to it.

    With the envelope E(t), which is 1 for an endless motion without a rise,

        x = -E sum X_i sin(w_i t + phi_i),   X_i = A_i/w_i^2 = V_i/w_i

    so that each line has the acceleration A sin(w t + phi) where E is 1, as `Sine` has; v and a are its exact derivatives,
    and nothing drifts. Lines whose amplitudes are given in different quantities add as motions with +.

    Args:
        acceleration: lines (frequency [Hz], acceleration amplitude [m/s^2]), in order of frequency.
        velocity: the same with velocity amplitudes [m/s].
        displacement: the same with displacement amplitudes [m].
        direction: `"x"`, `"y"`, `"z"` or a 3-vector.
        phases: phase of every line at time zero [rad].
        seed: instead of the phases: integer that chooses them at random. Without either all are zero.
        duration: length of the vibration with rise and fall [s]; None: it never ends.
        rise: length of the rise [s], at least a period of the lowest frequency; None: no rise in an endless vibration,
            which then already goes on before `start`, else ten such periods, or a tenth of the duration if that is
            shorter.
        fall: length of the fall [s], likewise; only with a duration.
        start: instant at which the vibration begins [s].
        target: points (frequency [Hz], acceleration [m/s^2]) of the response spectrum that the lines were made for.
        damping: damping ratio of that spectrum's oscillators; only with a target.
    """

    kind: ClassVar[str] = "vibration-lines"
    renamed: ClassVar[Mapping[str, str]] = dict.fromkeys(_ORDER, "lines")
    phrases = (
        SpokenMotion(
            name="amplitude-table", example="levels.csv 10 s z",
            summary='steady sines, one frequency after the other, of a file with "from [Hz], to [Hz], displacement [mm]" in '
            'steps of 1 Hz, or "frequency [Hz], displacement [mm]"; with "dwell 60 s" then 60 s at each response prominence of '
            'the model, with "dwell 60 s 7 Hz 12 Hz" at these.',
            needs={"time": 1}, says_more=True, begins=file_first(table_lines), make=_dwells, words=START | {"dwell": "time"},
            may={"frequency": MOST_DWELLS},
        ),
    )  # fmt: skip

    quantity: str
    lines: Points
    direction: Direction
    phases: tuple[float, ...] | None
    seed: int | None
    rise: float
    fall: float
    start: float
    duration: float
    target: Points | None = field(repr=False)
    damping: float | None = field(repr=False)

    def __init__(
        self, *, acceleration: Sequence[Sequence[float]] | None = None, velocity: Sequence[Sequence[float]] | None = None,
        displacement: Sequence[Sequence[float]] | None = None, phases: Sequence[float] | None = None, seed: int | None = None,
        duration: float | None = None, fall: float | None = None, rise: float | None = None,
        direction: str | Sequence[float], start: float = 0.0, target: Sequence[Sequence[float]] | None = None,
        damping: float | None = None,
    ) -> None:  # fmt: skip
        if (target is None) != (damping is None):
            raise ValueError("`target` and `damping` belong together: a response spectrum is that of oscillators of a damping.")
        spectrum = None if target is None else checked_points("target", target, quantity="acceleration [m/s^2]")
        self._set(
            target=spectrum, damping=None if damping is None else between("damping", positive("damping", damping), 0.0, 0.99)
        )
        given = {"acceleration": acceleration, "velocity": velocity, "displacement": displacement}
        quantity, points = the_one_given(given)
        lines = checked_points(quantity, points, quantity=f"amplitude [{_UNIT[quantity]}]", least=1)
        self._set(quantity=quantity, lines=lines, direction=checked_direction(direction))
        if phases is not None and seed is not None:
            raise ValueError("at most one of `phases` and `seed` can be given, got both.")
        if phases is not None and len(phases) != len(lines):
            raise ValueError(f"`phases` must hold one phase for each of the {len(lines)} lines, got {len(phases)}.")
        self._set(phases=None if phases is None else tuple(finite("phases", phase) for phase in phases))
        self._set(seed=None if seed is None else integer("seed", seed, least=0), start=ranges.start("start", start))
        lowest = lines[0][0]
        if duration is None:
            if fall is not None:
                raise ValueError("`fall` needs a `duration`: an endless vibration never falls.")
            ramps = 0.0 if rise is None else usual_ramp("rise", rise, lowest=lowest, duration=math.inf), 0.0
        else:
            length = ranges.length("duration", duration)
            asked = (("rise", rise), ("fall", fall))
            first, last = (usual_ramp(name, value, lowest=lowest, duration=length) for name, value in asked)
            check_room(length, first, last)
            ramps = first, last
        self._set(rise=ramps[0], fall=ramps[1], duration=math.inf if duration is None else float(duration))

    @property
    def targets(self) -> tuple[TargetSpectrum, ...]:
        """Response spectrum that the lines were made for; empty if none was given."""
        if self.target is None or self.damping is None:
            return ()
        return (TargetSpectrum(self.target, self.damping, self.unit),)

    @property
    def frequencies(self) -> Array:
        """Frequencies of the lines [Hz], (n,)."""
        return np.array([frequency for frequency, _ in self.lines])

    @property
    def amplitudes(self) -> Array:
        """Amplitudes of the lines, in the quantity in which they were given, (n,)."""
        return np.array([amplitude for _, amplitude in self.lines])

    @property
    def corners(self) -> Array:
        """Ends of rise and fall [s], (n,): the acceleration's slope jumps there."""
        return self.envelope.corners

    @cached_property
    def envelope(self) -> Envelope:
        """Envelope of rise and fall."""
        return Envelope(start=self.start, stop=self.end, rise=self.rise, fall=self.fall)

    @cached_property
    def _said(self) -> Said:
        """Describe the lines: `3 lines from 5 to 12 Hz, each up to 0.5 m/s^2, peak acceleration 1.3 m/s^2, 8 s along z`.

        The peak is that of samples, low by 0.5 % at most; of an endless or a very long vibration the rms value is given.
        """
        f, unit, length = self.frequencies, _UNIT[self.quantity], ""
        largest = f"{self.amplitudes.max():.4g} {unit}"
        text = f"1 line of {f[0]:.4g} Hz, {self.quantity} {largest}"
        samples = (self.end - self.start) * f[-1] * _SAMPLES
        if math.isfinite(samples):
            length = f", {self.duration:.4g} s"
        if f.size > 1:
            if samples * f.size < _MOST_SINES:
                kind, value, count = "peak", 0.0, math.ceil(samples)
                for first in range(0, count + 1, _BLOCK):
                    steps = np.arange(first, min(first + _BLOCK, count + 1))
                    times = self.start + steps * ((self.end - self.start) / count)
                    value = max(value, float(np.linalg.norm(self.acceleration(times), axis=1).max()))
            else:
                accelerations = self.amplitudes * (2.0 * np.pi * f) ** (2 - _ORDER[self.quantity])
                kind, value = "rms", math.sqrt(0.5 * float(np.sum(accelerations**2)))
            lines = f"{f.size} lines from {f[0]:.4g} to {f[-1]:.4g} Hz"
            text = f"{lines}, each up to {largest}, {kind} acceleration {value:.3g} m/s^2"
        ends = ((self.end, "vibration ends"),) if math.isfinite(self.duration) else ()
        return Said(
            f"{text}{length} along {direction_text(self.direction)}",
            ((self.start, "vibration begins"), *ends),
            shortest_time=1 / self.lines[-1][0],
        )

    def _argument(self, name: str) -> object:
        value = super()._argument(name)
        return value or None if name in ("rise", "fall") else value

    @cached_property
    def _terms(self) -> tuple[tuple[float, float, float], ...]:
        """Angular frequency, displacement amplitude and phase of every line."""
        omega = 2 * np.pi * self.frequencies
        phases = np.zeros(omega.size) if self.phases is None else np.array(self.phases)
        if self.seed is not None:
            phases = random_phases(self.seed, omega.size)
        size = self.amplitudes / omega ** _ORDER[self.quantity]
        return tuple(zip(omega.tolist(), size.tolist(), phases.tolist(), strict=True))

    def _oscillation(self, t: Array, order: int) -> Array:
        """Return the sum of all lines without the envelope, -sum X sin(w t + phi), or its derivative of that order, (n_t,)."""
        total = np.zeros_like(t)
        for omega, size, phase in self._terms:
            total -= size * omega**order * np.sin(omega * t + (phase + order * math.pi / 2))
        return total

    def _along(self, t: Array, order: int) -> Array:
        """Evaluate displacement (order 0), velocity (1) or acceleration (2): the sines times the envelope, (n_t,)."""
        factor, first, second = self.envelope.derivatives(t)
        value = factor * self._oscillation(t, order)
        if order == 2 and (np.any(first) or np.any(second)):
            value += 2 * first * self._oscillation(t, 1) + second * self._oscillation(t, 0)
        if order == 1 and np.any(first):
            value += first * self._oscillation(t, 0)
        return value
