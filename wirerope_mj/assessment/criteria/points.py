"""The shock response spectrum of a point against a test spectrum."""

import numpy as np

from wirerope_mj.assessment.criteria.verdict import Criterion, Verdict
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.motions.spectra import ShockResponseSpectrum


def check_points(name: str, frequency: ArrayLike, value: ArrayLike) -> tuple[Array, Array]:
    """Return frequencies [Hz] and values of a curve as arrays.

    ValueError if they are not as many, not positive, or the frequencies do not increase.
    """
    f, v = np.atleast_1d(np.asarray(frequency, dtype=np.float64)), np.atleast_1d(np.asarray(value, dtype=np.float64))
    if f.ndim != 1 or f.shape != v.shape or not f.size:
        raise ValueError(f"`{name}` must be as many frequencies as values, got the shapes {f.shape} and {v.shape}.")
    if not (np.isfinite(f).all() and np.isfinite(v).all() and f.min() > 0.0 and v.min() > 0.0):
        raise ValueError(f"`{name}` must hold finite frequencies and values > 0.")
    if f.size > 1 and not (np.diff(f) > 0.0).all():
        raise ValueError(f"`{name}` must have increasing frequencies, got {', '.join(f'{x:.6g}' for x in f[:8])}.")
    return f, v


def spectrum_verdict(
    spectrum: ShockResponseSpectrum, frequency: ArrayLike, acceleration: ArrayLike, *, subject: str,
    criterion: str = "shock response spectrum",
) -> Verdict:  # fmt: skip
    """Return the verdict on a maximax spectrum against a test spectrum, at the frequency of the highest utilisation.

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
    f, v = check_points("test spectrum", frequency, acceleration)
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
