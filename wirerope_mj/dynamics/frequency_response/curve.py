"""The amplitude over frequency between the points of a branch, also where it folds, and selected motions of it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from wirerope_mj.dynamics.periodic import Branch
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array, Booleans, Integers

BETWEEN = 16  # intervals between two neighbouring points: at steps of 2 % in frequency, an eighth of a percent apart
FRACTIONS = (0.35, 0.7)  # fractions of the highest amplitude at which motions are shown on either side of it


@dataclass(frozen=True, kw_only=True)
class BranchCurve:
    """A branch as a fine line, in its own order."""

    frequency: Array  # [Hz], (n,)
    amplitude: Array  # of the payload [m/s^2], (n,)
    stable: Booleans  # whether the motions on either side are, (n,)
    point: Array  # position in the branch, an integer at its points, (n,)

    @cached_property
    def runs(self) -> list[slice]:
        """Segments over which the frequency rises or falls throughout."""
        turned = np.flatnonzero(np.diff(np.sign(np.diff(self.frequency))) != 0.0) + 1
        ends = [0, *turned.tolist(), self.frequency.size - 1]
        return [slice(a, b + 1) for a, b in zip(ends[:-1], ends[1:], strict=True) if b > a]

    def amplitudes_at(self, frequency: Array) -> list[tuple[Array, Booleans]]:
        """Interpolate amplitude and stability at frequencies [Hz], (m,), on every run; NaN where a run does not reach."""
        branches = []
        for run in self.runs:
            f, a, s = self.frequency[run], self.amplitude[run], self.stable[run]
            order = slice(None, None, 1 if f[-1] > f[0] else -1)
            f, a, s = f[order], a[order], s[order]
            values = np.interp(frequency, f, a, left=np.nan, right=np.nan)
            branches.append((values, s[np.clip(np.searchsorted(f, frequency), 0, f.size - 1)]))
        return branches


def curve_of(branch: Branch) -> BranchCurve:
    """Draw the curve through the points of a branch.

    Akima's spline in the length along the branch, of frequency and amplitude in logarithms: it does not ring at the kinks
    that the payload's largest acceleration has where another crest becomes the highest.
    """
    f, a = np.log(branch.frequency), np.log(branch.amplitude)
    steps = relative_steps(f, a)
    kept = np.concatenate([[True], steps > 1e-9])  # a point that was located may coincide with the next
    f, a, point = f[kept], a[kept], np.flatnonzero(kept).astype(np.float64)
    if f.size < 3:
        return BranchCurve(frequency=np.exp(f), amplitude=np.exp(a), stable=branch.stable[kept], point=point)
    along = np.concatenate([[0.0], np.cumsum(relative_steps(f, a))])
    fraction = np.arange(BETWEEN) / BETWEEN
    fine = np.append((along[:-1, None] + np.diff(along)[:, None] * fraction).ravel(), along[-1])
    position = np.interp(fine, along, point)
    stable = branch.stable[np.floor(position).astype(int)] & branch.stable[np.ceil(position).astype(int)]
    frequency, amplitude = (np.exp(scipy.interpolate.Akima1DInterpolator(along, values)(fine)) for values in (f, a))
    return BranchCurve(frequency=frequency, amplitude=amplitude, stable=stable, point=position)


def relative_steps(f: Array, a: Array) -> Array:
    """Distances between successive points, both coordinates relative to their ranges, (n - 1,)."""
    return np.hypot(np.diff(f) / (float(np.ptp(f)) or 1.0), np.diff(a) / (float(np.ptp(a)) or 1.0))


def along_resonance(branch: Branch) -> list[int]:
    """Choose points of a branch: below its highest amplitude on either side, and at it.

    The order is that along the branch, so that behind a fold the motions which no sweep reaches are among them.
    """
    amplitude, top = branch.amplitude, branch.peak
    before, after = [], []
    for fraction in FRACTIONS:
        lower = np.flatnonzero(amplitude <= fraction * amplitude[top])
        before += [int(lower[lower < top][-1])] if (lower < top).any() else []
        after += [int(lower[lower > top][0])] if (lower > top).any() else []
    return sorted({*before, top, *after})


def along_branch(branch: Branch, curve: BranchCurve, count: int) -> Integers:
    """Choose `count` points of a branch in its order, equally far from each other along the curve, the highest among them.

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
    """Rank mount and axis (0 roll, 1 shear, 2 axial) of all loops of a periodic motion, most work per repetition first.

    In vibration this says which mounts move: the utilisation of the rated travel is mostly that of the sag.
    """
    work = {}
    for name, mount in response.mounts.items():
        for axis in range(3):
            force, steps = mount.force[:, axis], np.diff(mount.deflection[:, axis])
            if force.any():
                work[name, axis] = abs(float(np.sum(0.5 * (force[1:] + force[:-1]) * steps)))
    return sorted(work, key=lambda loop: work[loop], reverse=True)
