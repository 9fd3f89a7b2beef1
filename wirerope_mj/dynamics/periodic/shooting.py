"""Shooting: the start of a motion that repeats itself, by Newton's method on the period map."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.dynamics.arclength import least_solution
from wirerope_mj.dynamics.periodic.coordinates import scales
from wirerope_mj.dynamics.periodic.flow import Flow
from wirerope_mj.dynamics.periodic.observe import ranges
from wirerope_mj.dynamics.periodic.track import Drive, Track
from wirerope_mj.foundation.arrays import Array

DIFFERENCE = 1e-5
"""Step of the difference quotients in units of the scales: far above the rounding of positions of metres (1e-16 m against
1e-5 of 1e-5 m), far below what bends the map."""

TRIALS = 4
"""Step lengths 1, 1/2, 1/4, 1/8 of Newton's method that are tried at once."""

LONGEST = 2.0
"""Longest step in units of the scales: beyond it the linear map is no guide."""

ACCEPTED = 1e-6
"""Residual accepted where rounding or a contact's own iteration stops Newton's method before the tolerance."""


@dataclass(frozen=True, kw_only=True)
class Shot:
    """A motion over one shooting interval and how far it is from repeating itself.

    Attributes:
        x: unknowns at its start, (n_x,).
        track: from there on.
        scale: unit of every unknown, (n_x,).
        residual: largest difference of end and start in these units.
        iterations: of Newton's method.
    """

    x: Array
    track: Track
    scale: Array
    iterations: int = 0

    @property
    def gap(self) -> Array:
        """Difference of end and start in units of the scales, (n_x,)."""
        with np.errstate(divide="ignore", invalid="ignore"):  # nothing moves, or it went astray: `residual` is infinite
            return (self.track.end - self.x) / self.scale

    @property
    def residual(self) -> float:
        """Largest component of the gap; infinite where the motion went astray."""
        largest = float(np.abs(self.gap).max())
        return largest if np.isfinite(largest) else np.inf


def shot(flow: Flow, x: Array, drive: Drive, scale: Array | None = None) -> Shot:
    """Return the motion from `x`; its own ranges are the scales unless they are given."""
    track = flow.follow(x, drive)
    if scale is None:
        scale = scales(flow.coordinates, ranges(flow.system, track))
    return Shot(x=x, track=track, scale=scale)


def monodromy(flow: Flow, at: Shot) -> Array:
    """Return the derivative of the scaled end by the scaled start, (n_x, n_x), its columns integrated in parallel.

    It is that of the map as it is stepped, on which Newton's method and the folds of a branch depend; of no use where a law's
    slope has no derivative at zero, see `wirerope_mj.dynamics.periodic.scaled_states`.
    """
    starts = at.x + DIFFERENCE * np.diag(at.scale)
    ends = flow.ends(starts, at.track.drive)
    return np.asarray(((ends - at.track.end) / at.scale).T / DIFFERENCE)


def close(
    flow: Flow,
    first: Shot,
    *,
    tolerance: float,
    iterations: int,
    derivative: Callable[[Flow, Shot], Array] = monodromy,
) -> Shot:
    """Return the periodic motion near `first`, or the best that was found."""
    now = first
    for iteration in range(iterations):
        if now.residual <= tolerance or not np.isfinite(now.residual):
            break
        phi = derivative(flow, now)
        if not np.isfinite(phi).all():
            break
        step = least_solution(np.eye(now.gap.size) - phi, now.gap)
        step *= min(1.0, LONGEST / max(float(np.abs(step).max()), 1e-300))
        better = _trial(flow, now, step)
        if better is None:
            break
        now = replace(better, iterations=iteration + 1)
    return now


def _trial(flow: Flow, now: Shot, step: Array) -> Shot | None:
    """Return the first motion with a smaller residual among the step and its halves; the whole step is tried alone."""
    whole = shot(flow, now.x + now.scale * step, now.track.drive)
    # Both are judged by the scales of the one before.
    if float(np.abs((whole.track.end - whole.x) / now.scale).max()) < now.residual:
        return whole
    lengths = 0.5 ** np.arange(1, TRIALS + 1)
    starts = now.x + np.outer(lengths, now.scale * step)
    ends = flow.ends(starts, now.track.drive)
    residuals = np.abs((ends - starts) / now.scale).max(axis=1)
    for start, residual in zip(starts, residuals, strict=True):
        if residual < now.residual:
            return shot(flow, start, now.track.drive)
    return None
