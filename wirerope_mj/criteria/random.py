"""Random vibration: rms and 3-sigma values with their statistical error, and the largest value beside them."""

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from wirerope_mj.criteria.acceleration import UNIT, UNLIMITED
from wirerope_mj.criteria.limits import limits_by_name, payload_bodies
from wirerope_mj.criteria.sampled import sampled_peak
from wirerope_mj.criteria.verdict import Verdict
from wirerope_mj.limits import PayloadLimit
from wirerope_mj.response import Response
from wirerope_mj.spectra import PowerSpectralDensity, power_spectral_density

Array = npt.NDArray[np.float64]

SIGMAS = 3.0


def random_verdicts(
    time: npt.ArrayLike,
    acceleration: npt.ArrayLike,
    *,
    subject: str,
    discard: float,
    limit: float | None = None,
    rms_limit: float | None = None,
    resolution: float | None = None,
    along: str = "",
) -> tuple[Verdict, ...]:
    """Return verdicts on the rms, the 3-sigma value and the largest value of a stationary acceleration.

    How well the rms is known stands in the notes: with statistical bandwidth B and length T its relative standard error is
    1 / (2 sqrt(B T)).

    Args:
        time: uniform instants [s], (n,).
        acceleration: [m/s^2], (n,).
        subject: what is judged.
        discard: length at the beginning that is left out [s]: until the response has settled.
        limit: largest acceleration allowed [m/s^2], which 3 sigma and the largest value are judged by; None is not judged.
        rms_limit: largest rms allowed [m/s^2]; None is not judged.
        resolution: of the density the bandwidth is found from [Hz]; see `power_spectral_density`.
        along: " along x", if the acceleration is a component.

    Raises:
        ValueError: the samples are not as they must be, or too short.
    """
    density = power_spectral_density(time, acceleration, discard=discard, resolution=resolution)
    instants, values = np.asarray(time, dtype=np.float64), np.asarray(acceleration, dtype=np.float64)
    if values.ndim != 1:
        raise ValueError(f"`acceleration` must be one history, (n,), got the shape {values.shape}.")
    kept = round(density.duration * (instants.size - 1) / float(instants[-1] - instants[0]))
    instants, values = instants[-kept:], values[-kept:]
    rms = float(np.std(values))
    certainty = _certainty(density, rms)
    largest, when = sampled_peak(instants, np.abs(values - values.mean()))
    rows = (
        (f"rms acceleration{along}", rms, rms_limit, None, certainty),
        (f"{SIGMAS:g}-sigma acceleration{along}", SIGMAS * rms, limit, None, certainty),
        (f"largest acceleration{along}", largest, limit, when, _expected(density, rms, largest)),
    )
    return tuple(
        Verdict(
            criterion=criterion,
            subject=subject,
            value=value,
            limit=allowed,
            unit=UNIT,
            time=instant,
            note="; ".join(part for part in (note, UNLIMITED if allowed is None else "") if part),
        )
        for criterion, value, allowed, instant, note in rows
    )


def judge_random(
    response: Response,
    *,
    discard: float,
    limits: Sequence[PayloadLimit] | None = None,
    resolution: float | None = None,
) -> tuple[Verdict, ...]:
    """Return `random_verdicts` on x, y and z of every payload body and every point that move along them.

    Args:
        response: of a run with random vibration.
        discard: length at the beginning that is left out [s]: until the response has settled.
        limits: of kind "acceleration"; without them the model's own. One of a single value, for the size of the vector, is
            asked of every component.
        resolution: of the densities [Hz]; see `power_spectral_density`.

    Raises:
        ValueError: a limit names neither a body nor a point, or the run is too short.
    """
    bodies = payload_bodies(response)
    stated = limits_by_name(response, limits, "acceleration", [*bodies, *response.points])
    moved = {name: response.bodies[name].acceleration for name in bodies}
    moved |= {name: point.acceleration for name, point in response.points.items()}
    found: list[Verdict] = []
    for name, acceleration in moved.items():
        values = stated[name].values if name in stated else (0.0,)
        for axis in np.flatnonzero(np.ptp(acceleration, axis=0) > 1e-9 * np.ptp(acceleration)):
            found += random_verdicts(
                response.time,
                acceleration[:, axis],
                subject=name,
                discard=discard,
                limit=values[axis % len(values)] or None,
                resolution=resolution,
                along=f" along {'xyz'[axis]}",
            )
    return tuple(found)


def _certainty(density: PowerSpectralDensity, rms: float) -> str:
    """Return how well the rms is known, in words."""
    if not rms > 0.0:
        return ""
    return (
        f"standard error {100.0 * float(density.rms_error):.2g} % ({density.duration:.4g} s of a bandwidth of "
        f"{float(density.bandwidth):.3g} Hz)"
    )


def _expected(density: PowerSpectralDensity, rms: float, largest: float) -> str:
    """Return how many sigma the largest value is, and how many a Gaussian process of this length leads to expect.

    Its zeros are crossed upward sqrt(int f^2 G df / int G df) times a second (Rice 1944), and the largest size of N = twice
    as many half waves has the mean c + 0.577 / c in sigma, c = sqrt(2 ln N) (Davenport 1964).
    """
    if not rms > 0.0:
        return ""
    rate = math.sqrt(float(np.sum(density.frequency**2 * density.density) / np.sum(density.density)))
    c = math.sqrt(2.0 * math.log(max(2.0 * rate * density.duration, math.e)))
    return f"{largest / rms:.3g} sigma; a Gaussian of this length is expected to reach {c + 0.5772 / c:.3g}"
