"""Warnings about a signal: a shift of its zero, AC coupling, and a sampling rate too low for its pulses or vibration."""

import math
from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.motions.records.reading import is_pulse, offset_of, peak_from

# parts of what stands before a change and behind it, and the least samples of each: their medians must agree
_PARTS, _FEWEST = 4, 16
_STEADY = 0.25  # of the change, by which the medians of these parts may differ from the level
_WITHOUT_PULSE = (0.1, 0.9)  # quantiles of a signal between which a short pulse does not rule
_ERRORS = 7.4  # four standard errors of a median of noise, in median deviations over the root of the number of samples
_LEVEL = 0.5  # of the range, beyond which a change is the top of a pulse that the record ends in
_SLOW, _GAIN = 0.1, 0.1  # velocity that does not matter [m/s]; fraction of that of the motion from which it does
_FOOT = 0.1  # fraction of the peak above which samples belong to a pulse; of its velocity, below which it has come back
# of the length of a pulse above its foot, that its flank takes to an undershoot: one that brakes the base takes longer
_FLANK = 0.8
_BLOCKS = 64  # means of what follows a pulse, which take the noise off
# largest residual, over the signal behind its pulse, of a fit with one stage of AC coupling, or with two
_RESIDUAL, _RESIDUAL_OF_RETURN = {1: 0.25, 2: 0.12}, 0.06  # and behind an undershoot, where no flank disturbs
_LEAST_LOSS = 0.1  # fraction of the pulse's velocity that must be lost
_RINGS = 0.015  # of the peak, rms, from which what smoothing takes away behind a pulse is ringing
_PULSES = 16  # lengths of its pulse that a record has at least, for what follows it to be smoothed by them
_DAMPED = 0.65  # damping ratio from which two stages of coupling are told from a base that swings; of a Butterworth filter 0.71
_NOISE = 1.2  # times the noise of these means that may be left


def level_shift(a: Array) -> tuple[float, float, int] | None:
    """Find a change of a signal's level (n,): the levels before and after, and its sample; None if there is no change.

    The change is where the sum of the samples less their mean is farthest from zero. Both levels are steady: a slow swing or
    what dies away is no level.
    """
    return _shift_at(a, a) or _shift_at(a, np.clip(a, *np.quantile(a, _WITHOUT_PULSE)))


def _shift_at(a: Array, looked_at: Array) -> tuple[float, float, int] | None:
    """Find a lasting step in the level of a signal `a` (n,): its medians before and after, and the sample of the step.

    The step is sought in `looked_at`, (n,), the same signal, as a rule without its pulse. None if it is small against the
    scatter, or large as what the signal shows, or if the level on either side is not steady.
    """
    at = int(np.abs(np.cumsum(looked_at - looked_at.mean())).argmax()) + 1
    parts = a[:at], a[at:]
    if min(map(len, parts)) < _PARTS * _FEWEST:
        return None
    levels = [float(np.median(part)) for part in parts]
    change = abs(levels[1] - levels[0])
    pairs = list(zip(parts, levels, strict=True))
    spreads = [float(np.median(np.abs(part - level))) / math.sqrt(part.size) for part, level in pairs]
    if not _ERRORS * math.hypot(*spreads) < change < _LEVEL * float(np.ptp(a)):
        return None
    for part, level in pairs:
        # of noise alone: what swings has smaller steps than deviations
        error = float(np.median(np.abs(np.diff(part)))) / math.sqrt(2.0 * part.size / _PARTS)
        medians = [abs(float(np.median(block)) - level) for block in np.array_split(part, _PARTS)]
        if max(medians) > max(_STEADY * change, _ERRORS * error):
            return None
    return levels[0], levels[1], at


def moved_level(a: Array, rate: float) -> tuple[float, float, int] | None:
    """Find a change of a signal's level (`level_shift`) that changes a base's velocity notably; None without; `rate` in Hz."""
    found = level_shift(a)
    if found is None:
        return None
    before, after, at = found
    gained = abs(after - before) * min(at, a.size - at) / rate
    deviation = a - np.where(np.arange(a.size) < at, before, after)
    return found if gained > max(_SLOW, _GAIN * float(np.ptp(np.cumsum(deviation))) / rate) else None


def level_warnings(where: str, time: Array, a: Array, unit: tuple[str, float], *, played: bool = True) -> Iterator[str]:
    """Yield warnings about a shifted zero or AC coupling in an acceleration (n,) at instants [s]; `played`: it drives a base.

    `where` is how a sentence about it begins, "along x"; levels are said in a unit, its name and what one of it is in SI.
    """
    rate = (time.size - 1) / float(time[-1] - time[0])
    found = moved_level(a, rate) if played else level_shift(a)
    if found is not None:
        (before, after, at), (name, factor) = found, unit
        remedy = "Check the sensor and its mounting."
        if played:
            added = abs(after - before) * (a.size - at) / rate
            remedy = (
                f"no constant takes both off, and {added:.3g} m/s are added. {remedy} Use what lies before, or "
                'baseline="highpass" (--baseline highpass).'
            )
        yield (
            f"{where} its level changes from {before / factor:.4g} to {after / factor:.4g} {name} at {time[at]:.4g} s: in the "
            f"shock the sensor turned or shifted its zero, or its AC coupling has not come back yet"
            f"{'; ' if played else '. '}{remedy}"
        )
    elif played and (coupling := _coupling(a, rate) or _coupling(_without_ringing(a), rate)):
        limit, velocity, final = coupling
        yield (
            f"{where} the velocity of {velocity:.3g} m/s that its pulse reaches falls back to {final:.2g} m/s as AC coupling "
            f"with a lower limit of about {limit:.2g} Hz makes it, or as that of a base that is braked in proportion to it. If "
            "the sensor is AC-coupled, the pulse's change of velocity is lost, soft isolators travel too little, and that "
            "the record ends at rest proves nothing: measure with a DC-coupled sensor, or with a lower limit."
        )


def _without_ringing(a: Array) -> Array:
    """Smooth a signal over the length of its pulse, twice, so that what rings faster is gone and its velocity stays."""
    rest = offset_of(a)
    above = np.flatnonzero(np.abs(a - rest) > 0.5 * peak_from(a, rest))
    length = int(np.count_nonzero(np.diff(above) > 1) < 4) * above.size
    if not 1 < length < a.size // _PULSES:
        return a
    smooth = scipy.ndimage.uniform_filter1d(scipy.ndimage.uniform_filter1d(a, length), length)
    behind = slice(int(above[-1]) + length, None)  # its flanks are smoothed, too
    ringing = (a - smooth)[behind]
    rings = ringing.size and float(np.sqrt(np.mean(ringing**2))) > _RINGS * peak_from(a, rest)
    return smooth if rings else a


def _coupling(a: Array, rate: float) -> tuple[float, float, float] | None:
    """Identify AC coupling: its lower limit [Hz], and the velocities [m/s] at the ends of the pulse and of the record.

    Behind its pulse such a signal is -v/tau, v being its own integral; of two stages in a row a sum of v and its integral,
    whose poles are real or nearly: a base that swings is damped less. None where the signal after its pulse is different.
    """
    rest = offset_of(a)
    peak = peak_from(a, rest)
    before = a[: int(np.argmax(np.abs(a - rest) > _FOOT * peak))]
    rest = float(np.median(before)) if before.size >= _FEWEST else 0.0  # such a sensor has no other
    side = float(np.sign(a[int(np.argmax(np.abs(a - rest) > 0.5 * peak))] - rest))  # what comes first: an undershoot follows
    above = np.flatnonzero(side * (a - rest) > _FOOT * peak)
    if not above.size or not is_pulse(a, rest):
        return None
    velocity = np.cumsum(a - rest) / rate
    first = int(above[-1]) + 1
    lowest = first + int((side * a[first:]).argmin()) if first < a.size else first
    if lowest - above[-1] < _FLANK * (above[-1] - above[0]):  # it goes on to an undershoot, from which the return begins
        first = lowest
    reached, final = float(velocity[first - 1]), float(velocity[-1])
    if abs(reached) < _SLOW or abs(final) > (1.0 - _LEAST_LOSS) * abs(reached):
        return None
    last = int(np.flatnonzero(np.abs(velocity) > _FOOT * abs(reached))[-1]) + 1
    last = min(max(last, first + 2 * _FEWEST), a.size)
    if last - first < 2 * _FEWEST:
        return None
    blocks = np.array_split(np.arange(first, last), min(_BLOCKS, (last - first) // 2))
    course = np.column_stack([velocity, np.cumsum(velocity) / rate])
    level = np.array([float(a[block].mean()) - rest for block in blocks])
    means = np.array([course[block].mean(axis=0) for block in blocks])
    size = float(np.linalg.norm(level))
    noise = float(np.median(np.abs(np.diff(a[first:last])))) / 0.954 * len(blocks) / math.sqrt(last - first)
    for order in (1, 2):
        factors = -np.linalg.lstsq(means[:, :order], level, rcond=None)[0]
        residual = float(np.linalg.norm(level + means[:, :order] @ factors))
        damped = factors[0] > 0.0 and (order == 1 or 0.0 < factors[1] < (factors[0] / (2.0 * _DAMPED)) ** 2)
        limit = _RESIDUAL[order] if first != lowest else _RESIDUAL_OF_RETURN
        if damped and residual <= max(limit * size, _NOISE * noise) and size > 2.0 * noise:
            return (float(factors[0]) if order == 1 else math.sqrt(factors[1])) / (2.0 * math.pi), reached, final
    return None


# a sample stands alone if it leaves both neighbours to one side by a tenth of the record's range and by ten times what all
# but three others do, and its neighbours agree with theirs to a tenth of that. A step leaves one neighbour alone, and of a
# vibration many samples stand out alike.
_TALL, _ALONE, _BESIDE, _SEVERAL = 0.1, 10.0, 0.1, 3
_HIGH = 0.5  # fraction of the peak from which a half wave counts
_COARSE_SAMPLES = 4  # samples across a half-sine up to which its peak may be 13 % higher or more; of five it may be 7 %
_WIDE = 1.0 - 2.0 * math.asin(_FOOT) / math.pi  # part of a half-sine's length in which it is above its foot
# mean square of the steps from sample to sample over that of the samples: 2 for white noise and for a sine of four samples a
# period, 4 at the Nyquist frequency. Above it most of the energy is faster than 3.6 samples a period. Standard errors of that
# of white noise, 2 over the root of the samples that count, which it must be above 2, too.
_FAST, _SCATTER = 2.4, 4.0


def resolution_warnings(where: str, a: Array, rest: float, rate: float, *, unit: str, played: bool = True) -> Iterator[str]:
    """Yield warnings about spikes and coarse sampling of a signal (n,) with a level at rest; `played`: it drives a base.

    `where` is how a sentence about it begins, "along x"; a base is driven in straight lines between the samples.
    """
    if alone := _lone_samples(a):
        first, others = alone[0], np.delete(a, alone)
        more = f", and {len(alone) - 1} more like it" if len(alone) > 1 else ""
        yield (
            f"{where} one sample of {a[first]:.4g} {unit}, {first / rate:.6g} s after the first, stands alone{more}: its "
            f"neighbours are {a[first - 1]:.4g} and {a[first + 1]:.4g} {unit}, and nothing else is beyond "
            f"{max(float(others.max()), -float(others.min())):.4g}. That is a spike of the measuring chain, or a pulse that "
            f"{rate:.4g} samples a second cannot hold, and its peak is not known. Take a spike out of the file; measure a "
            "pulse at a higher rate."
        )
    elif is_pulse(a, rest):
        yield from _coarse(where, a, rest, rate, unit)
    else:
        yield from _fast(where, a - rest, rate, played)


def _lone_samples(a: Array) -> list[int]:
    """Return the indices of the samples that stand out alone of their neighbours, as spikes do, the highest first."""
    before, after = a[1:-1] - a[:-2], a[1:-1] - a[2:]
    out = np.where(before * after > 0.0, np.minimum(np.abs(before), np.abs(after)), 0.0)
    several = min(_SEVERAL + 1, out.size)
    tallest = np.argpartition(out, -several)[-several:]
    usual = float(out[tallest].min())
    found = []
    for number in sorted(tallest[out[tallest] > usual], key=lambda place: -out[place]):
        i, height = int(number) + 1, float(out[number])
        beside = np.diff(a[max(i - 2, 0) : i]).tolist() + np.diff(a[i + 1 : i + 3]).tolist()
        level = max([*map(abs, beside), abs(float(a[i + 1] - a[i - 1]))])
        flat = level <= _BESIDE * height
        if flat and height > _ALONE * usual and height >= _TALL * float(np.ptp(np.delete(a, i))):
            found.append(i)
    return found


def _coarse(where: str, a: Array, rest: float, rate: float, unit: str) -> Iterator[str]:
    """Yield a warning about a pulse of so few samples that its peak may lie between them."""
    sign = np.where(np.abs(a - rest) > _FOOT * peak_from(a, rest), np.sign(a - rest), 0.0)
    starts = np.flatnonzero(np.diff(np.concatenate([[0.0], sign, [0.0]]))).tolist()
    above = [pair for pair in zip(starts[:-1], starts[1:], strict=True) if sign[pair[0]]]
    waves = [pair for pair in above if float(np.abs(a[slice(*pair)] - rest).max()) >= _HIGH * peak_from(a, rest)]
    first, last = min(waves, key=lambda wave: wave[1] - wave[0])  # of the shortest half wave of at least half the peak
    samples = last - first
    if samples > _COARSE_SAMPLES:
        return
    values = np.abs(a[max(first - 1, 0) : last + 1] - rest)
    peak = "its peak is not known"
    if samples > 2:
        length = (samples - 1) / _WIDE  # at least, of a half-sine whose foot has just so many samples, in intervals
        most = 1.0 / math.cos(math.pi / (2.0 * length))  # its peak lies in the middle of two samples
        peak = f"if it is a half-sine, its true peak may be up to {100.0 * (most - 1.0):.0f} % higher"
    elif samples == 2:
        about = 0.5 * math.pi * float(values.sum()) * _WIDE / samples  # velocity change: 2/pi peak x length
        peak += f", and of a half-sine with its velocity change would be about {about:.4g} {unit}"
    count = "one sample" if samples == 1 else f"{samples} samples"
    yield (
        f"{where} its shortest pulse, of {values.max():.4g} {unit}, has {count} at {rate:.4g} samples a second: {peak}. "
        "Measure at a higher rate, ten samples across the shortest pulse or more."
    )


def _fast(where: str, a: Array, rate: float, played: bool) -> Iterator[str]:
    """Yield a warning about a vibration (n,) that is too fast for its samples, joined by straight lines, at a rate [Hz]."""
    squares = a**2
    ratio = float(np.mean(np.diff(a) ** 2) / squares.mean())
    count = float(squares.sum() ** 2 / (squares**2).sum())  # samples that count: a burst has fewer than its record
    if ratio <= max(_FAST, 2.0 + _SCATTER * 2.0 / math.sqrt(count)):
        return
    part = math.acos(max(1.0 - 0.5 * ratio, -1.0)) / (2.0 * math.pi)  # of the sampling rate, if it were a sine
    shown = (math.sin(math.pi * part) / (math.pi * part)) ** 2
    lines = f"straight lines between samples play {100.0 * shown:.0f} % of such a vibration, and " if played else ""
    remedy = ", or resample it (--resample)" if played else ""
    yield (
        f"{where} its energy lies about {part * rate:.4g} Hz, near the {0.5 * rate:.4g} Hz that {rate:.4g} samples a "
        f"second can hold: {lines}its peaks lie between the samples. Measure at a higher rate{remedy}."
    )


# samples from which a channel is looked at; fraction of them that is not zero in what a sensor measured; distances between the
# levels of a converter over the peak, below which it was set too wide; crossings of each level, which no ramp has
_MEASURED, _LIVE, _LEVELS, _CROSSED = 64, 0.9, 12.0, 3
_MAINS, _PERIODS, _HUMS, _PURE = (
    (50.0, 60.0),
    4.5,
    0.01,
    0.7,
)  # Hz; least of them; fraction of the peak, of the quiet part's power
_LOUD = 0.2  # fraction of the peak with which a shock begins, in a record that hums


def channel_warnings(names: Sequence[str], axes: Array, samples: Array) -> Iterator[str]:
    """Yield warnings of channels that are dead beside live ones, or equal: axes (n_channels, k), samples along them (n, k)."""
    if samples.shape[0] < _MEASURED:
        return
    used = {int(np.flatnonzero(row)[0]): name for name, row in zip(names, axes, strict=True) if np.count_nonzero(row) == 1}
    alone = {axis: name for axis, name in used.items() if np.count_nonzero(axes[:, axis]) == 1}
    filled = {axis: np.count_nonzero(samples[:, axis]) / samples.shape[0] for axis in alone}
    for axis, name in alone.items():
        if not filled[axis] and max(filled.values()) > _LIVE:
            yield f"channel {short(name)} is zero throughout, and others have noise: is its sensor dead, or not connected?"
    for one, other in combinations(alone, 2):
        if filled[one] > _LIVE and np.array_equal(np.abs(samples[:, one]), np.abs(samples[:, other])):
            yield (
                f"channels {short(alone[one])} and {short(alone[other])} are equal from sample to sample, as no two "
                "sensors are: was "
                "a column copied?"
            )


def few_levels(a: Array) -> int:
    """Count the levels at which all samples (n,) of a coarse converter stand, at equal distances; 0 for any other signal."""
    levels = np.unique(a)
    if a.size < _MEASURED or not 3 <= levels.size <= 2.0 * _LEVELS:
        return 0
    gaps = np.diff(levels)
    even = np.abs(gaps / gaps.min() - np.round(gaps / gaps.min())).max() < 1e-2
    crossed = np.count_nonzero(np.diff(a)) > _CROSSED * levels.size
    return levels.size if even and crossed and float(np.abs(a).max()) < _LEVELS * float(gaps.min()) else 0


def hum_warnings(where: str, a: Array, rest: float, rate: float) -> Iterator[str]:
    """Yield a warning if the quiet part before a shock is a sine of the mains' frequency."""
    peak = peak_from(a, rest)
    before = a[: int(np.argmax(np.abs(a - rest) > _LOUD * peak))]
    if before.size < _MEASURED:
        return
    before = (before - before.mean()) * np.hanning(before.size)
    power = np.abs(np.fft.rfft(before)) ** 2
    lines = np.fft.rfftfreq(before.size, 1.0 / rate)
    for mains in _MAINS:
        if before.size < _PERIODS * rate / mains or 2.5 * mains > rate:
            continue
        near = np.abs(lines - mains) <= 2.0 * rate / before.size
        size = float(np.sqrt(2.0 * np.mean(before**2) / np.mean(np.hanning(before.size) ** 2)))
        pure = lines[power.argmax()] == lines[near][power[near].argmax()] and power[near].sum() > _PURE * power.sum()
        if pure and size > _HUMS * peak:
            yield (
                f"{where} its quiet part is a sine of {mains:.0f} Hz with {100.0 * size / peak:.2g} % of the peak: the hum of "
                "the mains, from a ground loop or an unshielded cable? It stays in the record."
            )
            return
