"""What of a run is judged: sampled histories and their extremes, and the segment over which a base is steady."""

import math
from collections.abc import Iterator

import numpy as np

from wirerope_mj.assessment.between_samples import sample_rate
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import RandomVibration, motion_from_dict

SAMPLED = "sampled at"  # How the notes begin on what is not judged because samples are too few


def read_columns(response: Response, first: str, count: int) -> Array:
    """Return `count` columns from the one named `first` on, (n_t, count).

    They are not kept in the response: of a long one in a file only what is looked at is in memory.
    """
    column = response.samples.names.index(first)
    return response.samples.columns(column, column + count)


def read_start(response: Response, first: str, count: int) -> Array:
    """Return the first sample of `count` columns from the one named `first` on, (count,)."""
    column = response.samples.names.index(first)
    return next(iter(response.samples.blocks(column, column + count)))[0]


def sampled_text(time: Array) -> str:
    """Return at what rate something is sampled, as a note of what is not judged for it."""
    return f"{SAMPLED} {sample_rate(time):.4g} Hz"


def samples_hold(response: Response) -> str:
    """Return what the samples of a run can tell, as a sentence: up to which frequency, and how much of the peaks they reach."""
    rate, worst, of_what = sample_rate(response.time), 0.0, ""
    for kind, peaks in (("bodies", response.peaks.bodies), ("points", response.peaks.points)):
        for name, peak in peaks.items():
            acceleration = read_columns(response, f"{kind}/{name}/acceleration/x", 3)
            reached = sampled_peak(response.time, np.linalg.norm(acceleration, axis=1))[0]
            missed = 1.0 - reached / peak.acceleration.value if peak.acceleration.value > AT_REST else 0.0
            worst, of_what = max((worst, of_what), (missed, name))
    text = f"{rate:.4g} samples a second tell nothing above {0.5 * rate:.4g} Hz, and shapes up to a tenth of their rate"
    return text + (f"; they miss {100.0 * worst:.2g} % of the peak acceleration of {of_what}" if worst > _MISSED else "")


AT_REST = 1e-3 * STANDARD_GRAVITY  # Acceleration below which something rests [m/s^2]
_MISSED = 0.01


def sampled_peak(time: Array, values: Array) -> tuple[float, float]:
    """Return the largest of `values` (n,) and its instant [s], refined by the parabola through the samples beside it."""
    k = int(values.argmax())
    if 0 < k < values.size - 1:
        before, here, after = values[k - 1 : k + 2].tolist()
        bend = before - 2.0 * here + after
        if bend < 0.0:
            shift = 0.5 * (before - after) / bend
            return here - 0.25 * (before - after) * shift, float(time[k] + shift * (time[k + 1] - time[k]))
    return float(values[k]), float(time[k])


# Kinds of motions that go on steadily.
STEADY = frozenset({"sweep", "sine", "vibration-lines", "harmonic-force", "unbalance"})


def steady_interval(motion: Entries) -> tuple[bool, float, float]:
    """Return whether a motion is random vibration alone, and the instants [s] between which all of that is stationary.

    Without any random vibration these are minus and plus infinity. Files of records are not read.
    """
    parts = list(elements(motion))
    random = [motion_from_dict(part) for part in parts if part.get("kind") == RandomVibration.kind]
    intervals = [motion.steady for motion in random if isinstance(motion, RandomVibration)]
    first = max((interval[0] for interval in intervals), default=-math.inf)
    last = min((interval[1] for interval in intervals), default=math.inf)
    return bool(parts) and len(intervals) == len(parts), first, last


def elements(stored: Entries) -> Iterator[Entries]:
    """Yield the elementary motions of which one is made by adding, scaling and turning."""
    inner = [*stored.get("terms", ()), *([stored["motion"]] if "motion" in stored else ())]
    if not inner:
        yield stored
    for part in inner:
        yield from elements(part)
