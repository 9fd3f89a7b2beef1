"""The transmissibility of a frequency response against a limit above a frequency."""

import math

import numpy as np
import numpy.typing as npt

from wirerope_mj.assessment.criteria.criterion import Criterion
from wirerope_mj.assessment.criteria.points import check_points, check_rows, curve_at
from wirerope_mj.assessment.criteria.verdict import Verdict
from wirerope_mj.foundation.arguments import positive


def transmissibility_verdict(
    frequency: npt.ArrayLike,
    amplitude: npt.ArrayLike,
    *,
    base: float,
    limit: float | None,
    above: float = 0.0,
    subject: str,
) -> Verdict:
    """Return the verdict on the largest transmissibility from a frequency on.

    Args:
        frequency: [Hz], in any order; a branch that folds has several amplitudes at one of them, and all count.
        amplitude: of the payload's acceleration [m/s^2].
        base: amplitude of the base's acceleration [m/s^2].
        limit: largest transmissibility allowed; None is not judged.
        above: frequency from which it is judged [Hz]; without it, everywhere.
        subject: what is judged.

    Raises:
        ValueError: an argument is not positive, or the response ends below `above`.
    """
    f, a = check_rows("amplitude", frequency, amplitude)
    positive("base", base, unit="m/s^2")
    if not (math.isfinite(above) and 0.0 <= above <= f.max()):
        raise ValueError(f"`above` must be between 0 and {f.max():.6g} Hz, where the response ends, got {above!r}.")
    frequencies, values = f[f >= above], a[f >= above]
    # Where the curve passes `above` between two of its points it has a value too.
    for i in np.flatnonzero((f[:-1] < above) != (f[1:] < above)):
        if a[i] > 0.0 and a[i + 1] > 0.0:
            pair = [i, i + 1] if f[i] < f[i + 1] else [i + 1, i]
            between = curve_at(check_points("response", f[pair], a[pair]), np.array([above]))
            frequencies, values = np.append(frequencies, above), np.append(values, between)
    worst = int(values.argmax())
    judged = "everywhere" if above <= f.min() else f"from {above:.4g} Hz on"
    note = (
        f"at {frequencies[worst]:.4g} Hz, judged {judged}"
        if limit is not None
        else f"at {frequencies[worst]:.4g} Hz; no limit is stated"
    )
    return Verdict(
        criterion=Criterion("transmissibility"),
        subject=subject,
        value=float(values[worst] / base),
        limit=limit,
        unit="",
        note=note,
    )
