"""Resonances of branches: their peaks, and the backbone through the peaks of several levels."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.dynamics.periodic.branch import Branch
from wirerope_mj.foundation.arrays import Array

PROMINENT = 1.02
"""Ratio of a peak to the higher of its two adjacent valleys from which on it is one."""


@dataclass(frozen=True, kw_only=True)
class Resonance:
    """A peak of a branch over the frequency.

    Attributes:
        index: of the point with the largest amplitude.
        frequency: of the peak [Hz], by the parabola through three points.
        amplitude: of the payload [m/s^2].
        ratio: frequency of the highest peak over this one's: near n for the superharmonic resonance of order n.
    """

    index: int
    frequency: float
    amplitude: float
    ratio: float


@dataclass(frozen=True, kw_only=True)
class Backbone:
    """Highest peaks of branches at several levels: acceleration of the base, frequency [Hz] and amplitude, (n,) each."""

    acceleration: Array
    frequency: Array
    amplitude: Array


def resonances(branch: Branch) -> tuple[Resonance, ...]:
    """Return the peaks of a branch that was followed in frequency, in its order; superharmonic ones included.

    Raises:
        ValueError: the branch was followed in acceleration.
    """
    if branch.parameter != "frequency":
        raise ValueError("`branch` must be followed in frequency to have resonances.")
    a = branch.amplitude
    indices = [i for i in range(1, a.size - 1) if a[i - 1] < a[i] >= a[i + 1] and _is_prominent(a, i)]
    peaks = [(i, *_top(branch, i)) for i in indices]
    highest = max(peaks, key=lambda peak: peak[2], default=(0, np.nan, np.nan))
    return tuple(
        Resonance(index=i, frequency=frequency, amplitude=amplitude, ratio=highest[1] / frequency)
        for i, frequency, amplitude in peaks
    )


def backbone(branches: Sequence[Branch]) -> Backbone:
    """Return the highest peaks of branches that were followed in frequency at several levels, by rising level.

    Raises:
        ValueError: a branch has no peak between its ends, or was followed in acceleration.
    """
    if not branches:
        raise ValueError("`branches` must hold at least one branch, got none.")
    rows = []
    for branch in branches:
        peaks = resonances(branch)
        if not peaks:
            raise ValueError(
                f"the branch at {branch.acceleration[0]:.4g} m/s^2 has no peak between {branch.frequency[0]:.4g} and "
                f"{branch.frequency[-1]:.4g} Hz; follow it further."
            )
        peak = max(peaks, key=lambda p: p.amplitude)
        rows.append((float(branch.acceleration[0]), peak.frequency, peak.amplitude))
    acceleration, frequency, amplitude = np.array(sorted(rows)).T
    return Backbone(acceleration=acceleration, frequency=frequency, amplitude=amplitude)


def _is_prominent(a: Array, i: int) -> bool:
    """Return whether the curve falls by 2 % on both sides before it rises above this point again."""
    sides = []
    for side in (a[i::-1], a[i:]):
        higher = np.flatnonzero(side > a[i])
        sides.append(float(side[: higher[0] if higher.size else side.size].min()))
    return bool(a[i] > PROMINENT * max(sides))


def _top(branch: Branch, i: int) -> tuple[float, float]:
    """Return frequency and amplitude of the parabola's vertex through three points; the point itself at a fold."""
    f, a = np.log(branch.frequency[i - 1 : i + 2]), branch.amplitude[i - 1 : i + 2]
    if not f[0] < f[1] < f[2] and not f[0] > f[1] > f[2]:
        return float(branch.frequency[i]), float(a[1])
    left, right = (a[1] - a[0]) / (f[1] - f[0]), (a[2] - a[1]) / (f[2] - f[1])
    curvature = (right - left) / (f[2] - f[0])
    if curvature == 0.0:
        return float(branch.frequency[i]), float(a[1])
    top = float(np.clip(0.5 * (f[0] + f[1] - left / curvature), min(f[0], f[2]), max(f[0], f[2])))
    return float(np.exp(top)), float(a[0] + (top - f[0]) * (left + curvature * (top - f[1])))
