"""Peak accelerations of bodies and points against what they can bear."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy

from wirerope_mj.assessment.criteria.sampled import STEADY, elements, read_columns, sampled_peak
from wirerope_mj.assessment.criteria.verdict import (
    ACCELERATION,
    Amplification,
    Criterion,
    Verdict,
    limits_by_name,
    one_each,
    payload_bodies,
)
from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.payload_limits import PayloadLimit

UNIT = "m/s^2"
UNLIMITED = "no limit is stated"


def acceleration_verdicts(
    response: Response, limits: Sequence[PayloadLimit] | None = None, *, cutoff: float | None = None
) -> tuple[Verdict, ...]:
    """Return a verdict on the largest absolute acceleration of every payload body and every point.

    A limit of one value judges the size of the vector, one of three values the components that have one. What has no limit
    is not judged.

    Args:
        response: of a run.
        limits: of kind "acceleration"; without them the model's own.
        cutoff: frequency [Hz] above which the sampled histories are filtered away first, as a fragility that was measured
            with a filter asks for: a Butterworth filter of second order, forward and backward. Without it, the peaks of
            every step.

    Raises:
        ValueError: a limit names neither a body nor a point, or the cutoff is not below half the sampling rate.
    """
    bodies, points = payload_bodies(response), list(response.points)
    steady = any(part.get("kind") in STEADY for part in elements(response.motion))
    driven = response.peaks.bodies.get(response.scene.base)
    base = 0.0 if steady or cutoff is not None or driven is None else driven.acceleration.value
    stated = limits_by_name(response, limits, "acceleration", [*bodies, *points])
    verdicts: list[Verdict] = []
    for kind, names, peaks in (("bodies", bodies, response.peaks.bodies), ("points", points, response.peaks.points)):
        for name in names:
            if cutoff is None:
                peak = peaks[name].acceleration
                amplified = Amplification(measure="peak", value=peak.value, base=base) if base > 0.0 else None
                verdicts += [replace(row, amplification=amplified) for row in _judge(name, peak, stated.get(name), "")]
            else:
                history = read_columns(response, f"{kind}/{name}/acceleration/x", 3)
                peak = _filtered(response.time, history, cutoff)
                note = f"below {cutoff:.6g} Hz (Butterworth, second order, forward and backward)"
                verdicts += _judge(name, peak, stated.get(name), note)
    return tuple(one_each(verdicts))


def _judge(name: str, peak: Peak, limit: PayloadLimit | None, note: str) -> list[Verdict]:
    """Return one verdict on the size of the vector, or one on every component that is limited."""
    if limit is None or len(limit.values) == 1:
        notes = [note, UNLIMITED if limit is None else ""]
        return [
            Verdict(
                criterion=Criterion(ACCELERATION), subject=name, value=peak.value,
                limit=None if limit is None else limit.values[0], unit=UNIT, time=peak.time,
                note="; ".join(part for part in notes if part),
            )
        ]  # fmt: skip
    verdicts = []
    for axis, allowed in enumerate(limit.values):
        low = -peak.minimum[axis] > peak.maximum[axis]
        when = peak.minimum_time[axis] if low else peak.maximum_time[axis]
        verdicts.append(Verdict(
            criterion=Criterion(ACCELERATION, axis="xyz"[axis]), subject=name,
            value=float(max(-peak.minimum[axis], peak.maximum[axis])), limit=allowed or None, unit=UNIT, time=float(when),
            note="; ".join(part for part in (note, "" if allowed else UNLIMITED) if part),
        ))  # fmt: skip
    return verdicts


def _filtered(time: Array, acceleration: Array, cutoff: float) -> Peak:
    """Return the peak of a history without what lies above `cutoff` [Hz]."""
    half = 0.5 * (time.size - 1) / float(time[-1] - time[0])
    if not (math.isfinite(cutoff) and 0.0 < cutoff < half):
        raise ValueError(f"`cutoff` must be between 0 and half the sampling rate, {half:.6g} Hz, got {cutoff!r}.")
    smooth = scipy.signal.sosfiltfilt(scipy.signal.butter(2, cutoff / half, output="sos"), acceleration, axis=0)
    value, when = sampled_peak(time, np.linalg.norm(smooth, axis=1))
    highest = [sampled_peak(time, smooth[:, axis]) for axis in range(3)]
    lowest = [sampled_peak(time, -smooth[:, axis]) for axis in range(3)]
    return Peak(
        value=value, time=when, vector=smooth[int(np.searchsorted(time, when)) - 1],
        minimum=-np.array([value for value, _ in lowest]), minimum_time=np.array([when for _, when in lowest]),
        maximum=np.array([value for value, _ in highest]), maximum_time=np.array([when for _, when in highest]),
    )  # fmt: skip
