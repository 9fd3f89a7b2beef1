"""Shooting: Newton's method on the period map, and the Floquet multipliers, factors of a small disturbance over a period."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.dynamics.arclength import ALONG_NEUTRAL, NEUTRAL, SLOWEST, least_solution, without_neutral
from wirerope_mj.dynamics.periodic.flow import Flow
from wirerope_mj.dynamics.periodic.motion import Drive, Track, ranges, scales
from wirerope_mj.foundation.arrays import Array, ComplexArray, Integers

# Step of the difference quotients in units of the scales: far above the rounding of positions of metres (1e-16 m against 1e-5
# of 1e-5 m), far below what bends the map.
DIFFERENCE = 1e-5
TRIALS = 4  # halvings of a Newton step that are tried at once: 1/2, 1/4, 1/8 and 1/16
LONGEST = 2.0  # longest step in units of the scales: beyond it the linear map is no guide
# Residual accepted where rounding or a contact's own iteration stops Newton's method before the tolerance.
ACCEPTED = 1e-6
# Multipliers so near to 1 may be neutral: a double one splits by the root of the difference quotients' noise of 1e-6.
NEAR_ONE = 1e-3
# Finite shift along a direction that may be neutral, in units of the scales: a fold's direction is neutral for small shifts
# only.
SHIFT = 0.05
UNCHANGED = 1e-3  # fraction of the shift by which a neutral motion may differ from a repetition
# Excess over 1 that is still the noise of an undamped direction (a mount axis that does not move dissipates nothing).
MARGIN = 1e-4
# The difference quotients for multipliers are central and this many radians wide, over the steps of a period: so wide that the
# reversals of the mounts, where the derivative jumps, move over more than a step. With narrow ones a reversal stays between two
# stages, which is wrong by a fraction of a step: 3e-3 of a multiplier with 1280 steps, where wide ones are right to 1e-5.
STEPS_MOVED = 10.0
# Bounds of that width in units of the scales: below the first the error no longer falls, above the second the map bends.
NARROWEST, WIDEST = 3e-3, 3e-2


@dataclass(frozen=True, kw_only=True)
class Shot:
    """A motion over one shooting interval and its residuals, the difference of its end and its start."""

    x: Array  # unknowns at its start, (n_x,)
    track: Track  # the motion from the start on
    scale: Array  # unit of every unknown, (n_x,)
    iterations: int = 0  # of Newton's method
    drifts: bool = False  # whether its residuals above the tolerance lie along neutral directions

    @property
    def residuals(self) -> Array:
        """Difference of end and start in units of the scales, (n_x,)."""
        with np.errstate(divide="ignore", invalid="ignore"):  # a motion at rest, or one that diverged: `residual` is infinite
            return (self.track.end - self.x) / self.scale

    @property
    def residual(self) -> float:
        """Largest of the residuals in size; infinite where the motion diverged."""
        largest = float(np.abs(self.residuals).max())
        return largest if np.isfinite(largest) else np.inf

    def closes(self, tolerance: float) -> bool:
        """Check whether the motion repeats itself within the tolerance, but for a drift along neutral directions."""
        return self.residual <= tolerance or self.drifts


def shot(flow: Flow, x: Array, drive: Drive, scale: Array | None = None) -> Shot:
    """Integrate the motion from the unknowns `x`, (n_x,); its own ranges are the scales unless they are given."""
    track = flow.follow(x, drive)
    return Shot(x=x, track=track, scale=scales(flow.coordinates, ranges(flow.system, track)) if scale is None else scale)


def monodromy(flow: Flow, at: Shot) -> Array:
    """Differentiate the scaled end of a motion by its scaled start, (n_x, n_x), all columns integrated in parallel.

    It is the derivative of the map as it is stepped, on which Newton's method and the folds of a branch depend; not valid where
    a law's slope has no derivative at zero, see `wirerope_mj.dynamics.periodic.laws`.
    """
    starts = at.x + DIFFERENCE * np.diag(at.scale)
    ends = flow.ends(starts, at.track.drive)
    return np.asarray(((ends - at.track.end) / at.scale).T / DIFFERENCE)


def close(
    flow: Flow, first: Shot, *, tolerance: float, iterations: int, derivative: Callable[[Flow, Shot], Array] = monodromy
) -> Shot:
    """Solve for the periodic motion near `first` by Newton's method; returns the motion with the smallest residual.

    Where no step reduces the residual, slow directions are taken as neutral, as in `corrected`.
    """
    motion, neutral = first, NEUTRAL
    for iteration in range(iterations):
        if motion.residual <= tolerance or not np.isfinite(motion.residual):
            break
        phi = derivative(flow, motion)
        if not np.isfinite(phi).all():
            break
        slope, residuals = np.eye(motion.residuals.size) - phi, motion.residuals
        nearly = motion.residual <= ALONG_NEUTRAL * tolerance
        if nearly and np.abs(without_neutral(slope, residuals, neutral)).max() <= tolerance:
            return replace(motion, drifts=True)
        step = least_solution(slope, residuals, neutral)
        step *= min(1.0, LONGEST / max(float(np.abs(step).max()), 1e-300))
        better = _line_search(flow, motion, step)
        if better is not None:
            motion = replace(better, iterations=iteration + 1)
        elif neutral == SLOWEST:
            break
        else:
            neutral = SLOWEST
    return motion


def _line_search(flow: Flow, last: Shot, step: Array) -> Shot | None:
    """Find the first motion with a smaller residual after the whole step, then after its halvings; None without one."""
    whole = shot(flow, last.x + last.scale * step, last.track.drive)
    # The scales of the last motion count for both.
    if float(np.abs((whole.track.end - whole.x) / last.scale).max()) < last.residual:
        return whole
    lengths = 0.5 ** np.arange(1, TRIALS + 1)
    starts = last.x + np.outer(lengths, last.scale * step)
    ends = flow.ends(starts, last.track.drive)
    residuals = np.abs((ends - starts) / last.scale).max(axis=1)
    for start, residual in zip(starts, residuals, strict=True):
        if residual < last.residual:
            return shot(flow, start, last.track.drive)
    return None


@dataclass(frozen=True, kw_only=True)
class FloquetStability:
    """Floquet multipliers by falling modulus without the neutral ones, whose number is `neutral`."""

    multipliers: ComplexArray
    neutral: int

    @property
    def stable(self) -> bool:
        return bool((np.abs(self.multipliers) <= 1.0 + MARGIN).all())


def wide_monodromy(flow: Flow, at: Shot) -> Array:
    """Compute the scaled monodromy matrix by wide central differences, (n_x, n_x); for the width see `STEPS_MOVED`."""
    drive = at.track.drive
    width = float(np.clip(STEPS_MOVED * drive.periods / drive.steps, NARROWEST, WIDEST))
    ahead, behind = (flow.ends(at.x + side * width * np.diag(at.scale), drive) for side in (1.0, -1.0))
    return np.asarray(((ahead - behind) / at.scale).T / (2.0 * width))


def stability(flow: Flow, at: Shot, phi: Array) -> FloquetStability:
    """Judge the stability of a periodic motion with the scaled monodromy matrix `phi`.

    A law without an elastic part depends on the rate of its deflection only, and the hysteretic state of an axis that does not
    move stays where it is: there are whole families of periodic motions. Their direction has a multiplier of 1 whose computed
    value may lie on either side of 1. It is distinguished from a fold, where a multiplier passes 1 too, by a finite shift,
    after which a neutral motion still repeats itself.
    """

    def near_one(values: ComplexArray) -> Integers:
        return np.flatnonzero((np.abs(values - 1.0) < NEAR_ONE) & (np.abs(values.imag) < NEAR_ONE))

    values, neutral = np.linalg.eigvals(phi).astype(np.complex128), np.zeros(0, dtype=np.int64)
    if near_one(values).size:  # only their vectors are needed, which cost more than the values
        values, vectors = (part.astype(np.complex128) for part in np.linalg.eig(phi))
        near = near_one(values)
        if near.size:
            vectors = vectors[:, near]
            phase = np.angle(vectors[np.abs(vectors).argmax(axis=0), range(near.size)])
            directions = np.real(vectors * np.exp(-1j * phase))
            starts = at.x + SHIFT * at.scale * (directions / np.abs(directions).max(axis=0)).T
            changes = (flow.ends(starts, at.track.drive) - starts) / at.scale - at.residuals
            neutral = near[np.abs(changes).max(axis=1) < UNCHANGED * SHIFT]
    kept = np.delete(values, neutral)
    return FloquetStability(multipliers=kept[np.argsort(-np.abs(kept), kind="stable")], neutral=neutral.size)
