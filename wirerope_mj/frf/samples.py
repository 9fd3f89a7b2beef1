"""Which motions of a branch are shown: some along its resonance, and many from its one end to the other."""

import numpy as np
import numpy.typing as npt

from wirerope_mj.frf.curve import Curve
from wirerope_mj.periodic import Branch

Points = npt.NDArray[np.int64]

SHARES = (0.35, 0.7)
"""Shares of the highest amplitude at which motions are shown on either side of it."""


def along_resonance(branch: Branch) -> list[int]:
    """Return points of a branch: on the way up to its highest amplitude, there, and on the way down again.

    The way is that along the branch, so that behind a fold the motions which no sweep reaches are among them.
    """
    amplitude, top = branch.amplitude, branch.peak
    before, after = [], []
    for share in SHARES:
        lower = np.flatnonzero(amplitude <= share * amplitude[top])
        before += [int(lower[lower < top][-1])] if (lower < top).any() else []
        after += [int(lower[lower > top][0])] if (lower > top).any() else []
    return sorted({*before, top, *after})


def along_branch(branch: Branch, curve: Curve, count: int) -> Points:
    """Return `count` points of a branch in its order, equally far from each other along the curve, the highest among them.

    The length is that in a picture on logarithmic axes whose height is its width: most of it lies in the resonance. A branch
    with fewer points has some of them several times.
    """
    f, a = np.log(curve.frequency), np.log(curve.amplitude)
    steps = np.hypot(np.diff(f) / (np.ptp(f) or 1.0), np.diff(a) / (np.ptp(a) or 1.0))
    along = np.concatenate([[0.0], np.cumsum(steps)])
    places = np.interp(np.linspace(0.0, along[-1], count), along, curve.point)
    points = np.round(places).astype(np.int64)
    points[np.abs(points - branch.peak).argmin()] = branch.peak
    return points
