"""Peak accelerations of bodies and points against what they can bear, and shock response spectra against test spectra."""

import math
from collections.abc import Sequence

import numpy as np
import scipy

from wirerope_mj.assessment.criteria.sampled import has_peak, read_columns, sampled_peak
from wirerope_mj.assessment.criteria.verdict import (
    ACCELERATION,
    Amplification,
    Criterion,
    Verdict,
    largest_each,
    limits_by_name,
    payload_bodies,
)
from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.motions.spectra import ShockResponseSpectrum

UNIT = "m/s^2"
UNLIMITED = "no limit is stated"


def acceleration_verdicts(
    response: Response, limits: Sequence[PayloadLimit] | None = None, *, cutoff: float | None = None
) -> tuple[Verdict, ...]:
    """Judge the largest absolute acceleration of every payload body and every point.

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
    driven = response.peaks.bodies.get(response.scene.base)
    base = driven.acceleration.value if driven is not None and cutoff is None and has_peak(response.motion) else 0.0
    stated = limits_by_name(response, limits, "acceleration", [*bodies, *points])
    verdicts: list[Verdict] = []
    for kind, names, peaks in (("bodies", bodies, response.peaks.bodies), ("points", points, response.peaks.points)):
        for name in names:
            peak, amplified, note = peaks[name].acceleration, None, ""
            if base > 0.0:
                amplified = Amplification(measure="peak", value=peak.value, base=base)
            if cutoff is not None:
                peak = _filtered(response.time, read_columns(response, f"{kind}/{name}/acceleration/x", 3), cutoff)
                note = f"below {cutoff:.6g} Hz (Butterworth, second order, forward and backward)"
            allowed = stated[name].values if name in stated else (0.0,)
            rows = [("", peak.value, peak.time, allowed[0])]
            if len(allowed) > 1:
                lows, highs = (peak.minimum, peak.minimum_time), (peak.maximum, peak.maximum_time)
                ends = [lows if -peak.minimum[i] > peak.maximum[i] else highs for i in range(3)]
                rows = [
                    (axis, float(abs(value[i])), float(when[i]), allowed[i])
                    for i, (axis, (value, when)) in enumerate(zip("xyz", ends, strict=True))
                ]
            verdicts += [
                Verdict(
                    criterion=Criterion(ACCELERATION, axis=axis), subject=name, value=value, limit=limit or None, unit=UNIT,
                    time=when, note="; ".join(part for part in (note, "" if limit else UNLIMITED) if part),
                    amplification=amplified,
                )
                for axis, value, when, limit in rows
            ]  # fmt: skip
    return tuple(largest_each(verdicts))


def _filtered(time: Array, acceleration: Array, cutoff: float) -> Peak:
    """Find the peak of a history without what lies above `cutoff` [Hz]."""
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


def spectrum_verdict(
    spectrum: ShockResponseSpectrum, frequency: ArrayLike, acceleration: ArrayLike, *, subject: str,
    criterion: str = "shock response spectrum",
) -> Verdict:  # fmt: skip
    """Judge a maximax spectrum against a test spectrum, at the frequency of the highest utilisation.

    Not part of `judge`: call it with a measured test spectrum.

    Equipment that stood a test bears every shock whose spectrum lies below the test's, at the same Q. Only frequencies are
    judged that both have.

    Args:
        spectrum: of the acceleration where the equipment stands; of several directions, the largest counts.
        frequency: of the test spectrum's points [Hz], increasing.
        acceleration: of the test spectrum's points [m/s^2]; straight between them on logarithmic axes.
        subject: what is judged.
        criterion: what the verdict is called.

    Raises:
        ValueError: the points do not make a curve, or have no frequency in common with the spectrum.
    """
    f, v = (np.atleast_1d(np.asarray(values, dtype=np.float64)) for values in (frequency, acceleration))
    if f.ndim != 1 or f.shape != v.shape or not f.size:
        raise ValueError(f"`test spectrum` must be as many frequencies as values, got the shapes {f.shape} and {v.shape}.")
    if not (np.isfinite(f).all() and np.isfinite(v).all() and f.min() > 0.0 and v.min() > 0.0):
        raise ValueError("`test spectrum` must hold finite frequencies and values > 0.")
    if not (np.diff(f) > 0.0).all():
        raise ValueError(f"`test spectrum` must have increasing frequencies, got {', '.join(f'{x:.6g}' for x in f[:8])}.")
    values = spectrum.maximax if spectrum.maximax.ndim == 1 else spectrum.maximax.max(axis=1)
    inside = (spectrum.frequencies >= f[0] * (1.0 - 1e-9)) & (spectrum.frequencies <= f[-1] * (1.0 + 1e-9))
    allowed = np.exp(np.interp(np.log(spectrum.frequencies), np.log(f), np.log(v)))
    ratio = np.where(inside, values / allowed, -np.inf)
    worst = int(ratio.argmax())
    if not np.isfinite(ratio[worst]):
        low, high = spectrum.frequencies[[0, -1]]
        raise ValueError(
            f"`frequency` of the test spectrum, {f[0]:.6g} to {f[-1]:.6g} Hz, does not overlap the "
            f"spectrum's {low:.6g} to {high:.6g} Hz."
        )
    judged = spectrum.frequencies[np.isfinite(ratio)]
    note = f"at {spectrum.frequencies[worst]:.4g} Hz, Q = {spectrum.q:g}; judged from {judged[0]:.4g} to {judged[-1]:.4g} Hz"
    if judged[0] > f[0] * 1.06 or judged[-1] < f[-1] / 1.06:  # a twelfth of an octave
        note += f" of {f[0]:.4g} to {f[-1]:.4g} Hz"
    return Verdict(
        criterion=Criterion(criterion), subject=subject, value=float(values[worst]), limit=float(allowed[worst]),
        unit="m/s^2", note=note,
    )  # fmt: skip
