"""Random vibration: rms and 3-sigma values with their statistical error, and the largest value beside them."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wirerope_mj.assessment.criteria.payload import UNIT, UNLIMITED
from wirerope_mj.assessment.criteria.sampled import (
    elements,
    read_columns,
    sample_rate,
    sampled_peak,
    sampled_text,
    steady_interval,
)
from wirerope_mj.assessment.criteria.verdict import LARGEST, RMS, SIGMA, Criterion, Verdict, limits_by_name, payload_bodies
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import ArrayLike
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.motions.spectra import power_spectral_density

SIGMAS = 3.0  # standard deviations of the 3-sigma value


def random_verdicts(
    time: ArrayLike, acceleration: ArrayLike, *, subject: str, discard: float, end: float | None = None,
    limit: float | None = None, rms_limit: float | None = None, resolution: float | None = None, along: str = "",
    fixed_over: float | None = None,
) -> tuple[Verdict, ...]:  # fmt: skip
    """Judge the rms, the 3-sigma value and the largest value of a stationary acceleration.

    Only the stationary part may count: neither the settling at the beginning nor the fall of the vibration and the decay
    after it. The error of the rms stands in the notes: with statistical bandwidth B and length t its relative standard error
    is 1 / (2 sqrt(B t)) in Gaussian vibration. Where the amplitudes of all sines of a vibration of length T are fixed, as a
    controlled shaker has them, it is sqrt(1 - t / T) of that: only the phases differ from seed to seed.

    Args:
        time: uniform instants [s], (n,).
        acceleration: [m/s^2], (n,).
        subject: what is judged.
        discard: length at the beginning that is left out [s]: until the response has settled.
        end: instant after which nothing counts [s]: where the vibration begins to fall, `steady[1]` of a RandomVibration;
            without it, everything to the last instant.
        limit: largest acceleration allowed [m/s^2], which 3 sigma and the largest value are judged by; None is not judged.
        rms_limit: largest rms allowed [m/s^2]; None is not judged.
        resolution: of the density the bandwidth comes from [Hz]; see `power_spectral_density`.
        along: "x", "y" or "z", if the acceleration is a component.
        fixed_over: length T of a vibration with fixed amplitudes [s]; None of Gaussian vibration.

    Raises:
        ValueError: the samples are not as they must be, or too short.
    """
    instants, values = np.asarray(time, dtype=np.float64), np.asarray(acceleration, dtype=np.float64)
    if end is not None and instants.ndim == 1 and instants.shape == values.shape:
        kept = int(np.searchsorted(instants, end, side="right"))
        if kept < 2:
            raise ValueError(f"`end` must lie after the first instants, got {end!r}.")
        instants, values = instants[:kept], values[:kept]
    density = power_spectral_density(instants, values, discard=discard, resolution=resolution)
    if values.ndim != 1:
        raise ValueError(f"`acceleration` must be one history, (n,), got the shape {values.shape}.")
    kept = round(density.duration * (instants.size - 1) / float(instants[-1] - instants[0]))
    instants, values = instants[-kept:], values[-kept:]
    rms = float(np.std(values))
    largest, when = sampled_peak(instants, np.abs(values - values.mean()))
    uncertainty, expected = "", ""
    if rms > 0.0:
        gaussian = f"{100.0 * float(density.rms_error):.2g} %"
        length = f"({density.duration:.4g} s of a bandwidth of {float(density.bandwidth):.3g} Hz)"
        uncertainty = f"standard error {gaussian} {length}"
        if fixed_over is not None:
            # A record of the whole length has one rms for all seeds; the bandwidth is known within some 10 %, and so no less
            # than a tenth is stated.
            part = max(math.sqrt(max(1.0 - density.duration / fixed_over, 0.0)), 0.1)
            error = f"standard error {100.0 * float(density.rms_error) * part:.2g} %"
            uncertainty = f"{error} from seed to seed, amplitudes being fixed; {gaussian} in Gaussian vibration {length}"
        # The zeros of a Gaussian process are crossed upward sqrt(int f^2 G df / int G df) times a second (Rice 1944), and the
        # largest size of N = twice as many half waves has the mean c + 0.577 / c in sigma, c = sqrt(2 ln N) (Davenport 1964).
        rate = math.sqrt(float(np.sum(density.frequency**2 * density.density) / np.sum(density.density)))
        c = math.sqrt(2.0 * math.log(max(2.0 * rate * density.duration, math.e)))
        expected = f"{largest / rms:.3g} sigma; a Gaussian of this length is expected to reach {c + 0.5772 / c:.3g}"
    rows = (
        (RMS, rms, rms_limit, None, uncertainty),
        (SIGMA, SIGMAS * rms, limit, None, uncertainty),
        (LARGEST, largest, limit, when, expected),
    )
    return tuple(
        Verdict(
            criterion=Criterion(kind, axis=along), subject=subject, value=value, limit=allowed, unit=UNIT, time=instant,
            note="; ".join(part for part in (note, UNLIMITED if allowed is None else "") if part),
        )
        for kind, value, allowed, instant, note in rows
    )  # fmt: skip


def judge_random(
    response: Response, *, discard: float | None = None, end: float | None = None, limits: Sequence[PayloadLimit] | None = None,
    resolution: float | None = None,
) -> tuple[Verdict, ...]:  # fmt: skip
    """Judge the accelerations of all payload bodies and points along x, y and z by `random_verdicts`, where they move.

    Without `discard` and `end`, the interval in which the base is stationary counts, from the settling of the response on:
    three decay times of the dominant resonance, from the width of its peak (`settling` of the density).

    Args:
        response: of a run with random vibration.
        discard: length at the beginning that is left out [s]: until the response has settled. It must be given where the
            base does more than vibrate at random.
        end: instant after which nothing counts [s]; without it, where the random vibration begins to fall.
        limits: of kind "acceleration"; without them the model's own. One of a single value, for the norm of the vector,
            applies to every component.
        resolution: of the densities [Hz]; see `power_spectral_density`.

    Raises:
        ValueError: a limit names neither a body nor a point, the run is too short, or `discard` is missing.
    """
    only_random, first, falls = steady_interval(response.motion)
    if discard is None and not only_random:
        raise ValueError("`discard` must be given: the base of this run does not vibrate at random alone.")
    last = falls if end is None else end
    bodies = payload_bodies(response)
    stated = limits_by_name(response, limits, "acceleration", [*bodies, *response.points])
    kinds = {name: "bodies" for name in bodies} | {name: "points" for name in response.points}
    random = [part for part in elements(response.motion) if "psd" in part]
    fixed = all(part.get("amplitudes", "fixed") == "fixed" for part in random) and only_random
    steady = slice(*np.searchsorted(response.time, [first, last]))
    lead = max(first - float(response.time[0]), 0.0)
    verdicts: list[Verdict] = []
    for name, kind in kinds.items():
        acceleration = read_columns(response, f"{kind}/{name}/acceleration/x", 3)
        values = stated[name].values if name in stated else (0.0,)
        for axis in np.flatnonzero(np.ptp(acceleration, axis=0) > 1e-9 * np.ptp(acceleration)):
            history = acceleration[:, axis]
            settled = discard
            if settled is None:  # a response to what is steady from `first` on
                settled = lead + float(power_spectral_density(response.time[steady], history[steady]).settling)
            verdicts += random_verdicts(
                response.time, history, subject=name, discard=settled, end=last,
                limit=values[axis % len(values)] or None, resolution=resolution, along="xyz"[axis],
                fixed_over=min(float(part["duration"]) for part in random) if fixed else None,
            )  # fmt: skip
    highest = max((float(part["psd"][-1][0]) for part in random), default=0.0)
    if sample_rate(response.time) >= 2.0 * highest:
        return tuple(verdicts)
    note = f"{sampled_text(response.time)}, and the vibration reaches up to {highest:.4g} Hz"
    return tuple(replace(row, limit=None, note=f"{note}; {row.note}" if row.note else note) for row in verdicts)


def stationary_verdicts(response: Response) -> tuple[Verdict, ...]:
    """Judge rms and 3-sigma accelerations by the model's limits; empty unless the base vibrates at random alone.

    ValueError if the run is too short.
    """
    alone, first, _ = steady_interval(response.motion)
    if not alone or first == -math.inf:
        return ()
    return tuple(row for row in judge_random(response) if row.criterion.kind != LARGEST)
