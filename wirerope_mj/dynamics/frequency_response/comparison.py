"""Comparison of a sweep with a branch: their difference away from jumps, and the jumps of the sweep."""

import math
from dataclasses import dataclass

import numpy as np

from wirerope_mj.dynamics.frequency_response.curve import BranchCurve
from wirerope_mj.dynamics.periodic import Branch
from wirerope_mj.dynamics.sweep import FrequencySweep
from wirerope_mj.foundation.arrays import Array

AWAY = 0.05
"""Relative distance from a fold within which a sweep jumps and is not compared."""


@dataclass(frozen=True, kw_only=True)
class SweepJump:
    """A jump of a sweep near a fold.

    Attributes:
        fold: frequency of the fold [Hz].
        frequency: at which the sweep changes most steeply near it [Hz].
        amplitude: of the sweep there [m/s^2].
    """

    fold: float
    frequency: float
    amplitude: float

    @property
    def past_fold(self) -> float:
        """Distance from the fold relative to its frequency, with sign [-]."""
        return self.frequency / self.fold - 1.0


@dataclass(frozen=True, kw_only=True)
class SweepComparison:
    """A sweep's envelope against the stable motions of a branch, away from jumps.

    Attributes:
        largest: largest difference relative to the branch; NaN if nothing can be compared.
        at: frequency of it [Hz].
        peak_frequency, peak: of the envelope [Hz], [m/s^2].
        jumps: of the sweep, one for every fold that it passes in the direction in which it jumps.
    """

    largest: float
    at: float
    median: float
    peak_frequency: float
    peak: float
    jumps: tuple[SweepJump, ...]


def compare(sweep: FrequencySweep, branch: Branch | None, curve: BranchCurve | None) -> SweepComparison:
    """Return the comparison of a sweep with a branch, if there is one."""
    f, a = sweep.frequency, sweep.amplitude
    top = int(np.argmax(a))
    difference = np.full(f.size, np.nan) if branch is None or curve is None else _differences(f, a, branch, curve)
    known = np.flatnonzero(np.isfinite(difference))
    largest = int(known[np.argmax(difference[known])]) if known.size else -1
    return SweepComparison(
        largest=float(difference[largest]) if known.size else math.nan,
        at=float(f[largest]) if known.size else math.nan,
        median=float(np.median(difference[known])) if known.size else math.nan,
        peak_frequency=float(f[top]),
        peak=float(a[top]),
        jumps=() if branch is None else _jumps(sweep, branch),
    )


def _differences(f: Array, a: Array, branch: Branch, curve: BranchCurve) -> Array:
    """Return the relative difference to the nearest stable motion, NaN near folds and where there is none, (n,)."""
    differences = np.full(f.size, np.inf)
    for amplitude, stable in curve.amplitudes_at(f):
        here = np.where(stable, np.abs(a / amplitude - 1.0), np.nan)
        differences = np.fmin(differences, here)
    for fold in branch.folds:
        differences[np.abs(f / fold.frequency - 1.0) < AWAY] = np.nan
    return np.where(np.isfinite(differences), differences, np.nan)


def _jumps(sweep: FrequencySweep, branch: Branch) -> tuple[SweepJump, ...]:
    """Return the jumps of a sweep near the folds of a branch."""
    f, a = sweep.frequency, sweep.amplitude
    rising, jumps = bool(f[-1] > f[0]), []
    for jump in branch.jumps:
        near = np.flatnonzero(np.abs(f[:-1] / jump.parameter - 1.0) < AWAY)
        if jump.rising == rising and near.size:
            steepest = near[np.argmax(np.abs(np.diff(np.log(a)))[near])]
            jumps.append(SweepJump(fold=jump.parameter, frequency=float(f[steepest]), amplitude=float(a[steepest])))
    return tuple(jumps)
