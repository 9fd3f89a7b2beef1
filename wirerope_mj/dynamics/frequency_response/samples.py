"""Selected motions of a branch, along its resonance or from end to end, and the loops that dissipate most."""

import numpy as np
import numpy.typing as npt

from wirerope_mj.dynamics.frequency_response.curve import BranchCurve, relative_steps
from wirerope_mj.dynamics.periodic import Branch
from wirerope_mj.engine.response import Response

Points = npt.NDArray[np.int64]

FRACTIONS = (0.35, 0.7)
"""Fractions of the highest amplitude at which motions are shown on either side of it."""


def along_resonance(branch: Branch) -> list[int]:
    """Return points of a branch: below its highest amplitude on either side, and at it.

    The order is that along the branch, so that behind a fold the motions which no sweep reaches are among them.
    """
    amplitude, top = branch.amplitude, branch.peak
    before, after = [], []
    for fraction in FRACTIONS:
        lower = np.flatnonzero(amplitude <= fraction * amplitude[top])
        before += [int(lower[lower < top][-1])] if (lower < top).any() else []
        after += [int(lower[lower > top][0])] if (lower > top).any() else []
    return sorted({*before, top, *after})


def along_branch(branch: Branch, curve: BranchCurve, count: int) -> Points:
    """Return `count` points of a branch in its order, equally far from each other along the curve, the highest among them.

    The length is that in a picture on logarithmic axes whose height is its width: most of it lies in the resonance. A branch
    with fewer points has some of them several times.
    """
    f, a = np.log(curve.frequency), np.log(curve.amplitude)
    along = np.concatenate([[0.0], np.cumsum(relative_steps(f, a))])
    positions = np.interp(np.linspace(0.0, along[-1], count), along, curve.point)
    points = np.round(positions).astype(np.int64)
    points[np.abs(points - branch.peak).argmin()] = branch.peak
    return points


def busiest_loops(response: Response) -> list[tuple[str, int]]:
    """Return mount and axis (0 roll, 1 shear, 2 axial) of all loops of a periodic motion, most work per repetition first.

    In vibration this says which mounts move: the utilisation of the rated travel is mostly that of the sag.
    """
    work = {}
    for name, mount in response.mounts.items():
        for axis in range(3):
            force, steps = mount.force[:, axis], np.diff(mount.deflection[:, axis])
            if force.any():
                work[name, axis] = abs(float(np.sum(0.5 * (force[1:] + force[:-1]) * steps)))
    return sorted(work, key=lambda loop: work[loop], reverse=True)
