"""The shock response spectrum of a response against the spectrum that equipment was tested with."""

import numpy as np
import numpy.typing as npt

from wirerope_mj.assessment.criteria.criterion import Criterion
from wirerope_mj.assessment.criteria.points import check_points, curve_at
from wirerope_mj.assessment.criteria.verdict import Verdict
from wirerope_mj.motions.spectra import ShockResponseSpectrum


def spectrum_verdict(
    spectrum: ShockResponseSpectrum,
    frequency: npt.ArrayLike,
    acceleration: npt.ArrayLike,
    *,
    subject: str,
    criterion: str = "shock response spectrum",
) -> Verdict:
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
    points = check_points("test spectrum", frequency, acceleration)
    values = spectrum.maximax if spectrum.maximax.ndim == 1 else spectrum.maximax.max(axis=1)
    allowed = curve_at(points, spectrum.frequencies)
    ratio = np.where(np.isnan(allowed), -np.inf, values / allowed)
    worst = int(ratio.argmax())
    if not np.isfinite(ratio[worst]):
        low, high = spectrum.frequencies[[0, -1]]
        raise ValueError(
            f"`frequency` of the test spectrum, {points[0][0]:.6g} to {points[0][-1]:.6g} Hz, does not overlap the "
            f"spectrum's {low:.6g} to {high:.6g} Hz."
        )
    judged = spectrum.frequencies[np.isfinite(ratio)]
    note = f"at {spectrum.frequencies[worst]:.4g} Hz, Q = {spectrum.q:g}; judged from {judged[0]:.4g} to {judged[-1]:.4g} Hz"
    if judged[0] > points[0][0] * 1.06 or judged[-1] < points[0][-1] / 1.06:  # a twelfth of an octave
        note += f" of {points[0][0]:.4g} to {points[0][-1]:.4g} Hz"
    return Verdict(
        criterion=Criterion(criterion),
        subject=subject,
        value=float(values[worst]),
        limit=float(allowed[worst]),
        unit="m/s^2",
        note=note,
    )
