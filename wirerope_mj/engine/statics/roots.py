"""Newton's method for a series of neighbouring roots: the Jacobian of one serves the next."""

from collections.abc import Callable

import numpy as np

from wirerope_mj.foundation.arrays import Array

ITERATIONS = 60  # iterations for one root: ten times what a smooth one takes

# halvings of a step before it counts as leading nowhere: 1/4096 of it is rounding where Newton's method works at all
HALVINGS = 12
LONGEST = 0.1  # longest step [m or rad]: more than any mount travels

# fraction of the residual that a step may leave; beyond it a new Jacobian is cheaper than the iterations that it saves
SLOW = 0.2

# step of the differences [m or rad]: small against any travel, and they stand eight digits above the rounding of forces
DIFFERENCE = 1e-7

# fraction of the largest singular value below which a direction has no stiffness: differences are rounded at 1e-11 of it
INDIFFERENT = 1e-10


class Roots:
    """Finds roots one after another, each from the last.

    Broyden's updates (1965, his first) carry the inverse Jacobian along; a new one is taken from differences only where
    convergence slows. Directions without any stiffness are left as they are.
    """

    def __init__(self, residual: Callable[[Array], Array], moved: Callable[[Array, Array], Array], size: int) -> None:
        """Prepare for the roots of `residual(position)` over positions `moved(position, step)` with steps (size,)."""
        self.residual, self.moved, self.size = residual, moved, size
        self.inverse: Array | None = None

    def forget(self) -> None:
        """Take a new Jacobian for the next root."""
        self.inverse = None

    def find(self, position: Array, tolerance: float) -> tuple[Array, float]:
        """Return the root next to `position` and the largest residual left; larger than `tolerance` where it ended earlier."""
        value = self.residual(position)
        for _ in range(ITERATIONS):
            if not largest(value) > tolerance or not np.isfinite(value).all():
                break
            fresh = self.inverse is None
            inverse = self._inverse(position) if self.inverse is None else self.inverse
            step = -inverse @ value
            step *= min(1.0, LONGEST / max(largest(step), 1e-12))
            for _halving in range(HALVINGS if fresh else 1):
                trial = self.moved(position, step)
                trial_value = self.residual(trial)
                if largest(trial_value) < largest(value):
                    break
                step *= 0.5
            else:
                self.inverse = None
                if fresh:
                    break
                continue
            self.inverse = _updated(inverse, step, value, trial_value)
            position, value = trial, trial_value
        return position, largest(value)

    def _inverse(self, position: Array) -> Array:
        # To both sides: where a load step begins a law is stiffer one way than the other, and one-sided columns of two bodies
        # that deflect the same mount against each other would take a slope each.
        columns = []
        for unit in DIFFERENCE * np.eye(self.size):
            above, below = (self.residual(self.moved(position, side)) for side in (unit, -unit))
            columns.append((above - below) / (2.0 * DIFFERENCE))
        jacobian = np.stack(columns, axis=1)
        if not np.isfinite(jacobian).all():
            return np.zeros_like(jacobian)  # leads nowhere: the root is not found
        return np.asarray(np.linalg.pinv(jacobian, rcond=INDIFFERENT))


def largest(values: Array) -> float:
    """Return the largest magnitude, 0 of nothing."""
    return float(np.abs(values).max(initial=0.0))


def _updated(inverse: Array, step: Array, before: Array, after: Array) -> Array | None:
    """Return the inverse Jacobian that maps the last change of the residual to the step; None where it no longer serves."""
    expected = inverse @ (after - before)
    agreement = float(step @ expected)
    if largest(after) > SLOW * largest(before) or agreement < SLOW * float(step @ step):
        return None
    return np.asarray(inverse + np.outer(step - expected, step @ inverse) / agreement)
