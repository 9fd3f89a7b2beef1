"""Warnings about what a record's sampling cannot hold: samples that stand alone, pulses of few samples, fast vibration."""

import math
from collections.abc import Iterator

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions.records.reading import is_pulse, peak_from

# a sample stands alone if it leaves both neighbours to one side by a tenth of the record's range and by ten times what all
# but three others do, and its neighbours agree with theirs to a tenth of that. A step leaves one neighbour alone, and of a
# vibration many samples stand out alike.
_TALL, _ALONE, _LEVEL, _SEVERAL = 0.1, 10.0, 0.1, 3
_FOOT, _HIGH = 0.1, 0.5  # fraction of the peak above which samples belong to a half wave; from which a half wave counts
_FEW = 4  # samples across a half-sine up to which its peak may be 13 % higher or more; of five it may be 7 %
_WIDE = 1.0 - 2.0 * math.asin(_FOOT) / math.pi  # part of a half-sine's length in which it is above its foot
# mean square of the steps from sample to sample over that of the samples: 2 for white noise and for a sine of four samples a
# period, 4 at the Nyquist frequency. Above it most of the energy is faster than 3.6 samples a period. Standard errors of that
# of white noise, 2 over the root of the samples that count, which it must be above 2, too.
_FAST, _ERRORS = 2.4, 4.0


def resolution_warnings(where: str, a: Array, rest: float, rate: float, *, unit: str, played: bool = True) -> Iterator[str]:
    """Yield warnings about a signal (n,) at a rate [Hz] that rests at a value and, if `played`, drives a base.

    `where` is how a sentence about it begins, "along x"; a base is driven in straight lines between the samples.
    """
    alone = _lone_samples(a)
    if alone:
        yield _spike(where, a, alone, rate, unit)
    elif is_pulse(a, rest):
        yield from _coarse(where, a, rest, rate, unit)
    else:
        yield from _fast(where, a - rest, rate, played)


def _lone_samples(a: Array) -> list[int]:
    """Return the samples that stand alone out of their neighbours, most of all first."""
    before, after = a[1:-1] - a[:-2], a[1:-1] - a[2:]
    out = np.where(before * after > 0.0, np.minimum(np.abs(before), np.abs(after)), 0.0)
    several = min(_SEVERAL + 1, out.size)
    tallest = np.argpartition(out, -several)[-several:]
    usual = float(out[tallest].min())
    found = []
    for number in sorted(tallest[out[tallest] > usual], key=lambda one: -out[one]):
        i, height = int(number) + 1, float(out[number])
        beside = np.diff(a[max(i - 2, 0) : i]).tolist() + np.diff(a[i + 1 : i + 3]).tolist()
        level = max([*map(abs, beside), abs(float(a[i + 1] - a[i - 1]))])
        flat = level <= _LEVEL * height
        if flat and height > _ALONE * usual and height >= _TALL * float(np.ptp(np.delete(a, i))):
            found.append(i)
    return found


def _spike(where: str, a: Array, alone: list[int], rate: float, unit: str) -> str:
    first = alone[0]
    rest = np.delete(a, alone)
    others = max(float(rest.max()), -float(rest.min()))
    more = f", and {len(alone) - 1} more like it" if len(alone) > 1 else ""
    return (
        f"{where} one sample of {a[first]:.4g} {unit}, {first / rate:.6g} s after the first, stands alone{more}: its "
        f"neighbours are {a[first - 1]:.4g} and {a[first + 1]:.4g} {unit}, and nothing else is beyond {others:.4g}. That is a "
        f"spike of the measuring chain, or a pulse that {rate:.4g} samples a second cannot hold, and its peak is not known. "
        "Take a spike out of the file; measure a pulse at a higher rate."
    )


def _coarse(where: str, a: Array, rest: float, rate: float, unit: str) -> Iterator[str]:
    """Yield a warning about a pulse of so few samples that its peak may lie between them."""
    first, last = _shortest(a - rest, peak_from(a, rest))
    samples = last - first
    if samples > _FEW:
        return
    values = np.abs(a[max(first - 1, 0) : last + 1] - rest)
    off = "its peak is not known"
    if samples > 2:
        length = (samples - 1) / _WIDE  # at least, of a half-sine whose foot has just so many samples, in intervals
        most = 1.0 / math.cos(math.pi / (2.0 * length))  # its peak lies in the middle of two samples
        off = f"if it is a half-sine, its true peak may be up to {100.0 * (most - 1.0):.0f} % higher"
    elif samples == 2:
        about = 0.5 * math.pi * float(values.sum()) * _WIDE / samples  # velocity change: 2/pi peak x length
        off += f", and of a half-sine with its velocity change would be about {about:.4g} {unit}"
    count = "one sample" if samples == 1 else f"{samples} samples"
    yield (
        f"{where} its shortest pulse, of {values.max():.4g} {unit}, has {count} at {rate:.4g} samples a second: {off}. "
        "Measure at a higher rate, ten samples across the shortest pulse or more."
    )


def _shortest(a: Array, peak: float) -> tuple[int, int]:
    """Return where the shortest half wave of at least half the peak begins and ends; a rests at zero."""
    sign = np.where(np.abs(a) > _FOOT * peak, np.sign(a), 0.0)
    starts = np.flatnonzero(np.diff(np.concatenate([[0.0], sign, [0.0]]))).tolist()
    above = [pair for pair in zip(starts[:-1], starts[1:], strict=True) if sign[pair[0]]]
    waves = [pair for pair in above if float(np.abs(a[slice(*pair)]).max()) >= _HIGH * peak]
    return min(waves, key=lambda wave: wave[1] - wave[0])


def _fast(where: str, a: Array, rate: float, played: bool) -> Iterator[str]:
    """Yield a warning about a vibration faster than what straight lines between samples play."""
    squares = a**2
    ratio = float(np.mean(np.diff(a) ** 2) / squares.mean())
    count = float(squares.sum() ** 2 / (squares**2).sum())  # samples that count: a burst has fewer than its record
    if ratio <= max(_FAST, 2.0 + _ERRORS * 2.0 / math.sqrt(count)):
        return
    part = math.acos(max(1.0 - 0.5 * ratio, -1.0)) / (2.0 * math.pi)  # of the sampling rate, if it were a sine
    shown = (math.sin(math.pi * part) / (math.pi * part)) ** 2
    lines = f"straight lines between samples play {100.0 * shown:.0f} % of such a vibration, and " if played else ""
    remedy = ", or resample it (--resample)" if played else ""
    yield (
        f"{where} its energy lies about {part * rate:.4g} Hz, near the {0.5 * rate:.4g} Hz that {rate:.4g} samples a "
        f"second can hold: {lines}its peaks lie between the samples. Measure at a higher rate{remedy}."
    )
