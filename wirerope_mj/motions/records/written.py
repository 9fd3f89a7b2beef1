"""Slips of whoever wrote a record: a channel copied with a factor, a record appended twice, codes for lost samples."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.said_above import rates_above
from wirerope_mj.foundation.table_header import Header

_MEASURED, _LIVE = 64, 0.9  # samples from which a channel is looked at; fraction of them that is not zero in what was measured
# rounding by which a copied channel may differ: of each number, and in steps of the smallest difference of two. Ratios that
# are chosen (two thirds, 0.65, ..) or those of an angle in degrees are those of courses that were made, and not of two sensors
_DIGITS, _ROUNDED = 1e-3, 2.0
_CHOSEN, _ANGLE, _CLOSE = (0.05, 1.0 / 3.0), 5.0, 1e-3
_FILLED = 0.9  # of a code for lost samples, which all others stay below
_SAME_RATE = 0.05  # relative


def copied_channels(channels: Mapping[str, Array]) -> Iterator[str]:
    """Yield a warning of each two channels (n,), of which one is the other times a factor that no one chooses."""
    live = {name: a for name, a in channels.items() if a.size >= _MEASURED and np.count_nonzero(a) > _LIVE * a.size}
    for (one, a), (second, b) in combinations(live.items(), 2):
        factor = float(a @ b) / float(a @ a)
        turn = math.degrees(math.atan(abs(factor))) / _ANGLE
        chosen = [abs(factor) / step for step in _CHOSEN]
        if not factor or abs(turn - round(turn)) < _CLOSE or any(abs(x - round(x)) < _CLOSE / _CHOSEN[0] for x in chosen):
            continue
        steps = [float(np.diff(np.unique(values)).min(initial=np.inf)) for values in (a, b)]
        step = _ROUNDED * max(steps[0] * abs(factor), steps[1])
        if step < _CLOSE * float(np.ptp(b)) and (np.abs(b - factor * a) <= step + _DIGITS * np.abs(b)).all():
            yield (
                f"channel {short(second)} is {factor:.4g} times channel {short(one)} from sample to sample, as no two sensors "
                "are: was one sensor recorded twice, with two sensitivities, or a column copied?"
            )


def appended_twice(a: Array, time: Array) -> Iterator[str]:
    """Yield a warning if the second half of samples (n, k) at instants [s] is the first to the last digit.

    A course that repeats within its half is periodic, and as it was made.
    """
    half = len(a) // 2
    if (
        half < _MEASURED
        or len(a) % 2
        or np.count_nonzero(a[:half]) <= _LIVE * a[:half].size
        or not np.array_equal(a[:half], a[half:])
    ):
        return
    parts = (half // n for n in range(2, 9) if half % n == 0)
    if not any(np.array_equal(a[:part], a[part : 2 * part]) for part in parts):
        yield (
            f"from {time[half]:.6g} s on it is what it was from its beginning, to the last digit: was the record appended "
            "twice? Leave one half out."
        )


def lost_code(written: Array) -> float | None:
    """Return the number, all nines, that stands for lost samples among the numbers (n,) of a file; None if there is none."""
    extreme = float(written[np.abs(written).argmax()])
    digits = f"{abs(extreme):.6g}".replace(".", "")
    others = np.abs(written[np.abs(written - extreme) > 1e-9 * abs(extreme)])
    if len(digits) < 2 or set(digits) != {"9"} or written.size - others.size < 2 or not others.size:
        return None
    return extreme if others.max() < _FILLED * abs(extreme) else None


def code_text(where: str, code: float, written: Array) -> str:
    """Return the warning of a code for lost samples."""
    count = np.count_nonzero(np.abs(written - code) <= 1e-9 * abs(code))
    return (
        f"{where} {count} samples are {code:.6g}, and all others are smaller: that is a logger's code for samples that "
        'it lost. Leave these cells empty, and have them filled by gaps="fill" (--gaps fill).'
    )


def counted(written: Array) -> bool:
    """Tell whether all numbers (n, k) of a file are whole, as counts of a converter are."""
    return bool(written.size and (np.abs(written - np.round(written)) < 1e-6).all())


def rate_warnings(header: Header, time: Array) -> list[str]:
    """Warn of a sampling rate that is said above a header and is not that of the instants [s], (n,)."""
    said = rates_above(header)
    rate = (time.size - 1) / float(time[-1] - time[0])
    if not said or any(abs(each / rate - 1.0) < _SAME_RATE for each in said):
        return []
    return [
        f"above its header stand {said[0]:.6g} samples a second, and its time has {rate:.6g}: is the time in another unit, or "
        "was it made with another interval than the recorder's?"
    ]


def channels_alone(names: Sequence[str], axes: Array, samples: Array) -> dict[str, Array]:
    """Return the samples (n,) of each channel that alone moves one axis: axes (n_channels, k), samples along them (n, k)."""
    used = {int(np.flatnonzero(row)[0]): name for name, row in zip(names, axes, strict=True) if np.count_nonzero(row) == 1}
    return {name: samples[:, axis] for axis, name in used.items() if np.count_nonzero(axes[:, axis]) == 1}
