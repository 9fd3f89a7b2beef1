"""Floquet multipliers of a periodic motion, the factors of a small disturbance over it."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from wirerope_mj.dynamics.periodic.flow import Flow
from wirerope_mj.dynamics.periodic.shooting import Shot
from wirerope_mj.foundation.arrays import Array

Multipliers = npt.NDArray[np.complex128]

NEAR_ONE = 1e-3
"""Multipliers so near to 1 may be neutral: a double one splits by the root of the difference quotients' noise of 1e-6."""

SHIFT = 0.05
"""Finite shift along a direction that may be neutral, in units of the scales: a fold's direction is neutral for small
shifts only."""

UNCHANGED = 1e-3
"""Fraction of the shift by which a neutral motion may differ from a repetition."""

MARGIN = 1e-4
"""Excess over 1 that is still the noise of an undamped direction (a mount axis that does not move dissipates nothing)."""


STEPS_MOVED = 10.0
"""The difference quotients for multipliers are central and this many radians wide, over the steps of a period: so wide that the
reversals of the mounts, where the derivative jumps, move over more than a step. Narrow ones see a reversal stand between two
stages and are wrong by a fraction of a step: 3e-3 of a multiplier with 1280 steps, where wide ones are right to 1e-5."""

NARROWEST, WIDEST = 3e-3, 3e-2
"""Bounds of that width in units of the scales: below the first it gains nothing, above the second the map bends."""


@dataclass(frozen=True, kw_only=True)
class FloquetStability:
    """Floquet multipliers by falling modulus without the neutral ones, whose number is `neutral`."""

    multipliers: Multipliers
    neutral: int

    @property
    def stable(self) -> bool:
        """True if no multiplier lies outside the unit circle."""
        return bool((np.abs(self.multipliers) <= 1.0 + MARGIN).all())


def wide_monodromy(flow: Flow, at: Shot) -> Array:
    """Return the scaled monodromy matrix of the motion between the steps, (n_x, n_x): right where one matters for itself."""
    drive = at.track.drive
    width = float(np.clip(STEPS_MOVED * drive.periods / drive.steps, NARROWEST, WIDEST))
    ahead, behind = (flow.ends(at.x + side * width * np.diag(at.scale), drive) for side in (1.0, -1.0))
    return np.asarray(((ahead - behind) / at.scale).T / (2.0 * width))


def stability(flow: Flow, at: Shot, phi: Array) -> FloquetStability:
    """Return the stability of a periodic motion with the scaled monodromy matrix `phi`.

    A law without an elastic part cares for the rate of its deflection only, and the hysteretic state of an axis that does not
    move stays where it is: there are whole families of periodic motions. Their direction has a multiplier of 1 whose computed
    value may stand on either side of it. It is told from a fold, where a multiplier passes 1 too, by a finite shift, after
    which a neutral motion still repeats itself.
    """
    values, neutral = np.linalg.eigvals(phi).astype(np.complex128), []
    if _near_one(values).size:  # only their vectors are needed, which cost more than the values
        values, vectors = (one.astype(np.complex128) for one in np.linalg.eig(phi))
        near = _near_one(values)
        repeats = _repeats(flow, at, vectors[:, near])
        neutral = [int(i) for i, is_neutral in zip(near, repeats, strict=True) if is_neutral]
    kept = np.delete(values, neutral)
    order = np.argsort(-np.abs(kept), kind="stable")
    return FloquetStability(multipliers=kept[order], neutral=len(neutral))


def _near_one(values: Multipliers) -> npt.NDArray[np.int64]:
    return np.flatnonzero((np.abs(values - 1.0) < NEAR_ONE) & (np.abs(values.imag) < NEAR_ONE))


def _repeats(flow: Flow, at: Shot, vectors: npt.NDArray[np.complex128]) -> list[bool]:
    """Return for every direction (columns) whether the motion shifted along it repeats itself."""
    if not vectors.shape[1]:
        return []
    directions = np.real(
        vectors * np.exp(-1j * np.angle(vectors[np.abs(vectors).argmax(axis=0), range(vectors.shape[1])]))
    )
    directions = directions / np.abs(directions).max(axis=0)
    starts = at.x + SHIFT * at.scale * directions.T
    ends = flow.ends(starts, at.track.drive)
    gaps = np.abs((ends - starts) / at.scale - at.gap).max(axis=1)
    return [bool(gap < UNCHANGED * SHIFT) for gap in gaps]
