"""Warnings about a measured record: cut off, clipped, too coarse, in other units than its header says, drifting.

No such fault can be known for sure: each warning states its reason, and nothing is changed.
"""

from collections.abc import Iterator

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import ACCELERATION_UNITS, STANDARD_GRAVITY
from wirerope_mj.motions.records.reading import Reading, is_pulse, offset_of, peak_from, quiet_level
from wirerope_mj.motions.records.signals import few_levels, hum_warnings, level_warnings, moved_level, resolution_warnings
from wirerope_mj.motions.records.written import appended_twice, code_text, counted, lost_code

_FEWEST = 16  # samples below which nothing is judged: a record so short was written by hand
# fraction of the peak from which the first or last sample of a pulse, of a vibration, is too large: a Gaussian vibration is
# above half of its peak in two of a hundred samples
_PULSE_END, _VIBRATION_END = 0.1, 0.5
# least number of equal samples in a flat top; fall of the signal one top's length beside it, as a fraction of the range and
# in steps of the converter: beside a smooth top it falls by nine
_TOP, _FALL, _STEPS = 3, 0.02, 20.0
# runs at the limit that clipped noise has at least, and how many times as many samples it has there as within a fraction of
# the range, or two steps of the converter, below: noise that is not clipped has fewer at its largest value than just below
_RUNS, _CROWDED, _BELOW_TOP = 4, 3.0, 0.002
# fraction of a flat top's height by which a rectangle jumps from one sample to the next on both of its sides; the flanks of
# what a sensor measured take more than a sample
_JUMP = 0.99
# relative error within which a level at rest is what gravity would be in another unit: tilt and calibration are less
_GRAVITY_ERROR = 0.03
_UNITS = ("g", "m/s^2", "mm/s^2", "in/s^2", "ft/s^2", "gal", "mg")  # in which loggers write accelerations
_KNOWN = 0.5  # of a level, within which both ends of a record must stand at it, with what their noise leaves open
_OFFSETS = 0.5  # level at rest [m/s^2] below which it is a sensor's offset, and gravity in another unit by chance
# peaks beyond which units are questioned [m/s^2]: 10 000 g is gunfire on bare steel, 1 mg the noise of most sensors
LARGEST_PEAK, SMALLEST_PEAK = 1e5, 1e-2
LARGEST_RATE, SMALLEST_RATE = 2e6, 20.0  # sampling beyond which the unit of time is questioned [Hz]
# speed [m/s] and travel [m] of a base beyond which a record is questioned: shocks of ships, drops and crashes stay below
LARGEST_SPEED, LARGEST_TRAVEL = 30.0, 10.0
# of a record without a quiet part: final velocity over the range of what is left when a steady drift is taken off, from which
# the drift rules; the velocity that does not matter [m/s]; the fraction of the peak above which a mean is that of a pulse
# that fills its record
_DRIFT, _SLOW, _OFFSET = 3.0, 0.1, 0.2
# velocity that an offset adds up to, over the range of the motion's own velocity, from which a warning is given
_GAIN = 0.1
_ENDS = 0.05  # fraction of what an offset would add up to: smaller final velocity and travel show that there is none
# of a record that may be a velocity: level at its beginning over that behind the shock, and the latter over the largest value
_BEGINS, _STAYS = 0.05, 0.8
# of a motion that is no pulse: speed [m/s], peak [m/s^2] and length [s] that together nothing has which shakes; the ground of
# earthquakes reaches 3 m/s, boats that slam 4, and sleds, which are faster, make one pulse
_SWUNG, _HARD, _LONG = 5.0, 20.0, 2.0
_MEDIAN_STEP = 0.954  # median of the steps from sample to sample of white noise, over its rms
# peak [m/s^2] below which a single pulse given in mm/s^2 is questioned: 0.05 g is no shock, but 50 g in m/s^2 is one
_WEAK = 0.5


def reading_warnings(reading: Reading, *, corrected: bool) -> Iterator[str]:
    """Yield warnings about accelerations as they were measured; `corrected`: a baseline is taken off later."""
    if reading.time.size < _FEWEST:
        return
    rate, (unit, factor) = (reading.time.size - 1) / float(reading.time[-1] - reading.time[0]), reading.unit
    if reading.samples.any() or not reading.turned_by:
        yield from _implausible(reading, rate)
        yield from appended_twice(reading.samples, reading.time)
    for axis, a in zip("xyz", reading.samples.T, strict=True):
        low, high = float(a.min()), float(a.max())
        if high > low:
            quiet, rest = quiet_level(a), offset_of(a)
            if quiet is None and abs(abs(rest) - STANDARD_GRAVITY) <= _GRAVITY_ERROR * STANDARD_GRAVITY:
                quiet = rest  # of a vibration
            yield from _wrong_unit(axis, a, quiet, reading, corrected)
            peak, pulse = peak_from(a, rest), is_pulse(a, rest)
            limit = _PULSE_END if pulse else _VIBRATION_END  # of what is left at an end
            for verb, index, side in (("begins", 0, "before"), ("ends", -1, "after")):
                ratio = min(abs(float(a[index]) - rest), abs(float(a[index]))) / peak
                if ratio > limit:
                    reason = "it is shorter than its pulse" if pulse else "it was cut out of a longer one"
                    yield (
                        f"along {axis} it {verb} at {100.0 * ratio:.0f} % of its peak: {reason}, and {side} it the base's "
                        "acceleration is zero."
                    )
            if (code := lost_code(a / factor)) is not None:
                yield code_text(f"along {axis}", code, a / factor)
                continue
            if levels := few_levels(a):
                yield (
                    f"along {axis} its samples stand at {levels} levels alone, "
                    f"{reading.text((high - low) / (levels - 1), 3)} apart "
                    "or so: the range of the recorder was far too wide for it, and peaks are known to such a step."
                )
                continue
            yield from hum_warnings(f"along {axis}", a, rest, rate)
            yield from (clipped_text(f"along {axis}", reading.text(top, 5), n) for top, n in flat_tops(a))
            yield from resolution_warnings(f"along {axis}", a / factor, rest / factor, rate, unit=unit)
            yield from level_warnings(f"along {axis}", reading.time, a, (unit, factor))


def motion_warnings(reading: Reading, time: Array, samples: Array, baseline: str = "none") -> Iterator[str]:
    """Yield warnings about the velocity and displacement that corrected accelerations [m/s^2], (n, 3), add up to."""
    if time.size < _FEWEST:
        return
    step, length = float(time[1] - time[0]), float(time[-1] - time[0])
    for axis, a in zip("xyz", samples.T, strict=True):
        if not a.any() or moved_level(a, 1.0 / step):  # `reading_warnings` has warned of it
            continue
        rest = quiet_level(a)
        velocity = a[:-1] + a[1:]
        velocity *= step / 2.0
        np.cumsum(velocity, out=velocity)
        end, speed = float(velocity[-1]), max(float(velocity.max()), -float(velocity.min()))
        travel = float(velocity.sum()) * step
        gained = end if rest is None else rest * length  # velocity that a steady offset adds up to
        swing, peak = _swing(velocity), float(np.abs(a - offset_of(a)).max())
        if swing > _SWUNG and peak > _HARD and length > _LONG and not is_pulse(a, offset_of(a)):
            smaller, meant = ("m/s^2 or mg", "mg") if reading.unit[0] == "g" else ("cm/s^2 (gal) or mm/s^2", "gal")
            yield (
                f"along {axis} the base would swing at {swing:.3g} m/s and {reading.text(peak, 3)} for {length:.3g} s, as no "
                f"ground, deck, vehicle or shaker does: is it in {smaller}? Say the right unit, as in --unit {meant}."
            )
            continue
        velocity -= np.linspace(0.0, gained, velocity.size)
        velocity_range = float(np.ptp(velocity))
        course = f"along {axis} the base would reach {speed:.3g} m/s, and end {travel:.3g} m away at {end:.3g} m/s: "
        if rest is None:
            large = abs(gained) / length >= _OFFSET * float(np.abs(a).max())
            drifts = abs(gained) > max(_SLOW, _DRIFT * velocity_range) and not large
            yield from _runaway(course, reading.text(gained / length, 3) if drifts else "", speed, travel)
            continue
        rms = float(np.median(np.abs(np.diff(a[:100_000])))) / _MEDIAN_STEP  # four deviations of what white noise adds up to
        # a level that adds up is seen at the end, or on the way there; the coda of an earthquake has a mean, and ends at rest
        ends_at_rest = abs(end) < _ENDS * abs(gained) and abs(travel) < _ENDS * abs(gained) * length
        if not ends_at_rest and abs(gained) > max(_SLOW, _GAIN * velocity_range, 4.0 * rms * step * float(np.sqrt(a.size))):
            if baseline in ("mean", "velocity"):
                constant = "mean" if baseline == "mean" else "final velocity"
                yield (
                    f'along {axis} the quiet part stands at {reading.text(rest)} after baseline="{baseline}": the {constant} '
                    f"holds the pulse too, and {-gained:.3g} m/s of its velocity are spread over the record. "
                    'baseline="rest" (--baseline rest) takes off the level at rest alone.'
                )
            elif abs(float(np.median(a[:_FEWEST]))) < _BEGINS * abs(rest) and abs(rest) > _STAYS * float(np.abs(a).max()):
                yield (
                    f"{course}it goes from zero to {reading.text(rest, 3)} and stays there, as a velocity does after a "
                    "shock: is it "
                    "one, in m/s? Export the acceleration."
                )
            else:
                yield (
                    f"{course}it stands off zero by {reading.text(rest)} where it rests, which makes {gained:.3g} m/s of it. "
                    'Correct it with baseline="rest" or "highpass" (--baseline).'
                )
        elif speed > LARGEST_SPEED:  # it coasts after its pulse, wherever that takes it
            yield (
                f"{course}its unit may be another one, by a factor of 9.81 or 1000 (say the right one with `unit`, --unit), or "
                "its zero moves."
            )


def _swing(velocity: Array) -> float:
    """Return half of the range of a velocity (n,) about the parabola that a steady and a drifting zero add up to."""
    course = velocity[:: max(1, velocity.size // 10_000)]
    place = np.linspace(-1.0, 1.0, course.size)
    return 0.5 * float(np.ptp(course - np.polyval(np.polyfit(place, course, 2), place)))


def _runaway(course: str, steady: str, speed: float, travel: float) -> Iterator[str]:
    """Yield a warning about a motion without a quiet part whose speed or travel is too large, with the likely reason."""
    if steady:
        reason = f"the acceleration stands off zero by {steady} all along"
    elif speed > LARGEST_SPEED:
        reason = "a small offset adds up, or its unit is another one, by a factor of 9.81 or 1000 (--unit)"
    elif abs(travel) > LARGEST_TRAVEL:
        reason = "a small offset adds up"
    else:
        return
    yield f'{course}{reason}. Correct it with baseline="velocity", "mean" or "highpass" (--baseline).'


def _implausible(reading: Reading, rate: float) -> Iterator[str]:
    """Yield warnings about a peak or a sampling rate [Hz] that no base has, as if in another unit."""
    peak = max(float(reading.samples.max()), -float(reading.samples.min()))
    units = " and ".join(reading.units)
    if peak > LARGEST_PEAK and counted(reading.samples / reading.unit[1]):
        yield (
            f"its peak is {reading.text(peak, 6)}, and all of its numbers are whole: are they counts of the converter? Say "
            f"what one of them is in {units} by `scale` (--scale)."
        )
    elif peak > LARGEST_PEAK:
        yield (
            f"its peak of {reading.text(peak, 3)} is beyond any base's: are the values in another unit than {units}, by a "
            'factor of 1000 or 9.81? Say the right one, for instance unit="mm/s^2" (--unit).'
        )
    if peak == 0.0:
        yield "all of its samples are zero: the base does not move."
    elif peak < SMALLEST_PEAK:
        yield (
            f"its peak is {reading.text(peak, 3)}, less than most sensors' noise: are the values in another unit than {units}, "
            'by a factor of 1000 or 9.81? Say the right one, for instance unit="g" (--unit).'
        )
    elif (
        peak < _WEAK
        and all(unit.startswith("mm") for unit in reading.units)
        and all(is_pulse(a, offset_of(a)) for a in reading.samples.T if a.any())
    ):
        yield (
            f"its peak is {reading.text(peak, 3)}, little for a shock: if the values are in m/s^2 and not in {units}, say "
            'unit="m/s^2" (--unit).'
        )
    if not SMALLEST_RATE <= rate <= LARGEST_RATE:
        yield f"it has {rate:.4g} samples a second: is its time in another unit than the header says, s for ms or ms for s?"


def _wrong_unit(axis: str, a: Array, rest: float | None, reading: Reading, corrected: bool) -> Iterator[str]:
    """Yield a warning if the level at rest along an axis is gravity, in the record's unit or if read in another one."""
    if rest is None or len(reading.units) != 1:
        return
    (unit,) = reading.units
    level = f"along {axis} it rests at {reading.text(rest)}, "
    gravity = STANDARD_GRAVITY * reading.unit[1]  # of a value in another unit, read in this one, times that unit's factor

    def near(value: float) -> bool:
        return abs(abs(rest) - value) <= _GRAVITY_ERROR * value

    if near(STANDARD_GRAVITY):
        if axis != "z":
            yield (
                f"{level}which is gravity, and that acts along z: is it the channel of another direction, or the sensor "
                "turned? Say where each channel goes, NAME=z (--channels)."
            )
            return
        if rest < 0.0:
            yield (
                f"{level}where a sensor whose axis points up shows 1 g: it is upside down, or its sense is the other one. "
                "If so, say NAME=-z (--channels)."
            )
        if not corrected:
            yield (
                f'{level}as if gravity were in it, which the model has already: baseline="rest" (--baseline rest) takes it off.'
            )
        return
    values = {other: gravity / ACCELERATION_UNITS[other] for other in _UNITS if ACCELERATION_UNITS[other] != reading.unit[1]}
    found = [
        other
        for other, value in values.items()
        if near(value) and (value >= _OFFSETS or (unit.startswith("mm") and other in ("g", "m/s^2")))
    ]
    if found and _stands_at_both_ends(a, rest):
        yield (
            f"{level}which is gravity if the values are in {' or '.join(found)} and not in {unit}. If so, say "
            f'unit="{found[0]}" (--unit), and baseline="rest" (--baseline rest).'
        )


def _stands_at_both_ends(a: Array, level: float) -> bool:
    """Tell whether a signal (n,) begins and ends at a level, as gravity stands in it, and not on the average alone."""
    few = max(_FEWEST, a.size // 50)
    medians = [float(np.median(part)) for part in (a[:few], a[-few:])]
    errors = [float(np.std(part)) / np.sqrt(few) for part in (a[:few], a[-few:])]
    return all(abs(x - level) + error < _KNOWN * abs(level) for x, error in zip(medians, errors, strict=True))


def flat_tops(a: Array) -> Iterator[tuple[float, int]]:
    """Yield the extremes at which a signal (n,) was clipped, and the number of samples that stand there in a row.

    Either the flanks beside are steeper than those of a smooth top, or noise lifts samples off it again and again, yet hardly
    any stand just below.
    """
    low, high, middle = float(a.min()), float(a.max()), float(np.median(a))
    for extreme in (high, low):
        if abs(extreme - middle) <= 0.1 * (high - low):
            continue  # a record that never leaves its rest on this side
        at_extreme = a == extreme
        edges = np.flatnonzero(np.diff(np.concatenate([[False], at_extreme, [False]]).astype(np.int8)))
        lengths = edges[1::2] - edges[::2]
        first, length = int(edges[2 * lengths.argmax()]), int(lengths.max())  # of the longest run
        if length < _TOP or length > a.size // 2:
            continue
        beside = [abs(float(a[i] - a[first])) for i in (first - 1, first + length) if 0 <= i < a.size]
        if len(beside) == 2 and min(beside) >= _JUMP * abs(float(a[first]) - middle):
            continue  # a rectangle, reached and left in one sample each: it was written so, not measured
        flanks = [i for i in (first - length, first + 2 * length - 1) if 0 <= i < a.size]
        fall = min((abs(float(a[i]) - extreme) for i in flanks), default=0.0)
        near = max(_BELOW_TOP * (high - low), 2.5 * _converter_step(a))
        below = np.count_nonzero(np.abs(a - extreme) <= near) - np.count_nonzero(at_extreme)
        runs = np.count_nonzero(np.diff(at_extreme)) // 2
        noisy = runs >= _RUNS and np.count_nonzero(at_extreme) > _CROWDED * below
        if noisy or fall > max(_FALL * (high - low), _STEPS * _converter_step(a)):
            yield extreme, length


def clipped_text(where: str, extreme: str, length: int) -> str:
    """Word the warning that so many samples in a row stand at an extreme, given with its unit: a saturated sensor."""
    return (
        f"{where} {length} samples in a row stand at exactly {extreme} with steep flanks beside: the "
        "sensor or its amplifier may have been saturated, and the true peak be higher."
    )


def _converter_step(a: Array) -> float:
    """Return the step of the converter: the smallest step of the signal above rounding, 1 % of the range at most."""
    steps = np.abs(np.diff(a[:100_000]))
    kept = steps[steps > 1e-9 * np.abs(a).max()]
    return min(float(kept.min()), 0.01 * float(np.ptp(a))) if kept.size else 0.0
