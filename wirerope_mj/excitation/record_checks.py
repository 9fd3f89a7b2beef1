"""What is suspicious about a measured record: cut off, clipped, in other units than its header says, drifting.

None of these can be known for sure, so that each is said with its reason, and nothing is changed.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from wirerope_mj.excitation.record_reading import Reading
from wirerope_mj.excitation.record_rest import is_pulse, peak_from, resting_value, standing_value
from wirerope_mj.units import STANDARD_GRAVITY

Array = NDArray[np.float64]

_FEWEST = 16
"""Samples below which nothing is judged: a record so short was written by hand."""

_PULSE_END, _RIDE_END = 0.1, 0.5
"""Share of the peak from which the first or last sample of a pulse, of a vibration, is too large: a Gaussian ride is above half
of its peak in two of a hundred samples."""

_TOP, _FALL, _STEPS = 3, 0.02, 20.0
"""A flat top has three equal samples or more; one top's length beside it a smooth one fell by nine steps."""

_NEAR = 0.03
"""Share by which a resting value may miss what gravity would be in another unit: tilt and calibration are less."""

LARGEST_PEAK, SMALLEST_PEAK = 1e5, 1e-2
"""Peaks beyond which units are doubted [m/s^2]: 10 000 g is gunfire on bare steel, 1 mg the noise of most sensors."""

LARGEST_RATE, SMALLEST_RATE = 2e6, 20.0
"""Sampling beyond which the unit of time is doubted [Hz]."""

LARGEST_SPEED, LARGEST_TRAVEL = 30.0, 10.0
"""Speed [m/s] and travel [m] of a base beyond which a record is doubted: shocks of ships, drops and crashes stay below."""

_DRIFT, _SLOW, _OFFSET = 3.0, 0.1, 0.2
"""Final velocity over the range of what is left when a steady drift is taken off, from which the drift rules; the velocity
below which nobody minds [m/s]; the share of the peak above which a mean is that of a pulse that fills its record."""


def doubts_about_reading(reading: Reading, *, corrected: bool) -> Iterator[str]:
    """Yields what is suspicious about accelerations as they were measured; `corrected`: a baseline is taken off later."""
    if reading.time.size < _FEWEST:
        return
    yield from _implausible(reading)
    for axis, a in zip("xyz", reading.samples.T, strict=True):
        low, high = float(a.min()), float(a.max())
        if high > low:
            yield from _wrong_unit(axis, resting_value(a), reading.units, corrected)
            yield from _cut_off(axis, a, standing_value(a))
            yield from _clipped(axis, a, low, high)


def doubts_about_motion(time: Array, samples: Array) -> Iterator[str]:
    """Yields what is suspicious about where the acceleration [m/s^2], (n, 3), takes the base."""
    if time.size < _FEWEST:
        return
    step, length = float(time[1] - time[0]), float(time[-1] - time[0])
    for axis, a in zip("xyz", samples.T, strict=True):
        if not a.any():
            continue
        velocity = a[:-1] + a[1:]
        velocity *= step / 2.0
        np.cumsum(velocity, out=velocity)
        end, speed = float(velocity[-1]), max(float(velocity.max()), -float(velocity.min()))
        travel = float(velocity.sum()) * step
        velocity -= np.linspace(0.0, end, velocity.size)
        small = abs(end) / length < _OFFSET * float(np.abs(a).max())
        drifts = small and abs(end) > max(_SLOW, _DRIFT * float(np.ptp(velocity)))
        if drifts or speed > LARGEST_SPEED or abs(travel) > LARGEST_TRAVEL:
            why = (
                f"the acceleration stands off zero by {end / length:.3g} m/s^2 all along"
                if drifts
                else "a small offset adds up, or its unit is another one, by a factor of 9.81 or 1000"
                if speed > LARGEST_SPEED
                else "a small offset adds up"
            )
            yield (
                f"along {axis} the base would reach {speed:.3g} m/s, and end {travel:.3g} m away at {end:.3g} m/s: {why}. "
                'Correct it with baseline="velocity", "mean" or "highpass" (--baseline).'
            )


def _implausible(reading: Reading) -> Iterator[str]:
    rate = (reading.time.size - 1) / float(reading.time[-1] - reading.time[0])
    peak = max(float(reading.samples.max()), -float(reading.samples.min()))
    units = " and ".join(reading.units)
    if peak > LARGEST_PEAK:
        yield (
            f"its peak of {peak:.3g} m/s^2 is beyond any base's: are the values in another unit than {units}, by a factor "
            'of 1000 or 9.81? Say the right one, for instance unit="mm/s^2" (--unit).'
        )
    if peak < SMALLEST_PEAK:
        yield (
            f"its peak is {peak:.3g} m/s^2, less than most sensors' noise: are the values in another unit than {units}, by a "
            'factor of 1000 or 9.81? Say the right one, for instance unit="g" (--unit).'
        )
    if not SMALLEST_RATE <= rate <= LARGEST_RATE:
        yield f"it has {rate:.4g} samples a second: is its time in another unit than the header says, s for ms or ms for s?"


def _wrong_unit(axis: str, rest: float | None, units: tuple[str, ...], corrected: bool) -> Iterator[str]:
    """Yields words for a record that rests at gravity, in its own unit or in another one."""
    if rest is None or len(units) != 1:
        return
    (unit,) = units
    g = STANDARD_GRAVITY
    guesses = [(g, ""), (g * g, "m/s^2")] if unit == "g" else [(g, ""), (1.0, "g"), (1000.0 * g, "mm/s^2")]
    if unit.startswith("mm"):
        guesses = [(g, ""), (g / 1000.0, "m/s^2"), (1e-3, "g")]
    for value, other in guesses:
        if abs(abs(rest) - value) <= _NEAR * value:
            words = f"along {axis} it rests at {rest:.4g} m/s^2, "
            if other:
                yield (
                    f'{words}which is gravity if the values are in {other} and not in {unit}. If so, say unit="{other}" '
                    '(--unit), and baseline="mean".'
                )
            elif not corrected:
                yield f'{words}as if gravity were in it, which the model has already: baseline="mean" takes it off.'


def _cut_off(axis: str, a: Array, rest: float) -> Iterator[str]:
    """Yields words for a record that begins or ends far from rest."""
    peak, pulse = peak_from(a, rest), is_pulse(a, rest)
    limit = _PULSE_END if pulse else _RIDE_END
    for word, place, side in (("begins", 0, "before"), ("ends", -1, "after")):
        share = min(abs(float(a[place]) - rest), abs(float(a[place]))) / peak
        if share > limit:
            what = "it is shorter than its pulse" if pulse else "it was cut out of a longer one"
            yield (
                f"along {axis} it {word} at {100.0 * share:.0f} % of its peak: {what}, and {side} it the base's acceleration "
                "is zero."
            )


def _clipped(axis: str, a: Array, low: float, high: float) -> Iterator[str]:
    """Yields words for flat tops at the extreme values, with flanks that a smooth top does not have."""
    middle = float(np.median(a))
    for extreme in (high, low):
        if abs(extreme - middle) < 0.1 * (high - low):
            continue  # a record that never leaves its rest on this side
        first, length = _longest(a == extreme)
        if length < _TOP or length > a.size // 2:
            continue
        beside = [place for place in (first - length, first + 2 * length - 1) if 0 <= place < a.size]
        fall = min((abs(float(a[place]) - extreme) for place in beside), default=0.0)
        if fall > max(_FALL * (high - low), _STEPS * _converter_step(a)):
            yield (
                f"along {axis} {length} samples in a row stand at exactly {extreme:.5g} m/s^2 with steep flanks beside: the "
                "sensor or its amplifier was saturated, and the true peak is higher."
            )


def _longest(inside: NDArray[np.bool_]) -> tuple[int, int]:
    """Returns first place and length of the longest run."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(np.int8)))
    starts, lengths = edges[::2], edges[1::2] - edges[::2]
    longest = int(lengths.argmax())
    return int(starts[longest]), int(lengths[longest])


def _converter_step(a: Array) -> float:
    """Returns the smallest difference of two values beside each other that is none of rounding, 1 % of the range at most."""
    steps = np.abs(np.diff(a[:100_000]))
    kept = steps[steps > 1e-9 * np.abs(a).max()]
    return min(float(kept.min()), 0.01 * float(np.ptp(a))) if kept.size else 0.0
