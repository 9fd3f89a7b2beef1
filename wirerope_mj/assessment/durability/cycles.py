"""Cycles of a history, counted by the rainflow method, and the damage that they do."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.summary import Brief

# Exponent at the most: with a larger one amplitudes of micrometres do a damage that is no number any more.
STEEPEST = 50.0


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Cycles(Brief):
    """Cycles of a history.

    Attributes:
        ranges: of each cycle from its lowest to its highest value, (n,).
        means: between them, (n,).
        counts: 1 for a closed cycle, 0.5 for what is left open, (n,).
    """

    ranges: Array
    means: Array
    counts: Array

    @property
    def total(self) -> float:
        """Number of cycles, open ones as halves."""
        return float(self.counts.sum())

    def damage(self, exponent: float, constant: float = 1.0) -> float:
        """Return Miner's sum of n/N with N = C / A^b, A being half the range.

        Args:
            exponent: b.
            constant: C, in the unit of the history to the power b; 1: a damage to be compared with others of that unit only.

        Raises:
            ValueError: one of them is not positive, or the exponent is that of no fatigue curve.
        """
        b, c = positive("exponent", exponent), positive("constant", constant)
        if b > STEEPEST:
            raise ValueError(
                f"`exponent` of a fatigue curve must be at most {STEEPEST:g}, got {b:g}: those of metals are 3 to 15."
            )
        return float(np.sum(self.counts * (0.5 * self.ranges) ** b) / c)

    def equivalent_amplitude(self, exponent: float) -> float:
        """Return the amplitude of as many equal cycles that do the same damage; 0 without a cycle."""
        return (self.damage(exponent) / self.total) ** (1.0 / exponent) if self.total else 0.0

    def histogram(self, bins: int = 20) -> tuple[Array, Array]:
        """Return the edges of equal classes of ranges, (bins + 1,), and the number of cycles in each, (bins,)."""
        counts, edges = np.histogram(self.ranges, bins=bins, weights=self.counts)
        return edges, counts


def rainflow_cycles(history: npt.ArrayLike) -> Cycles:
    """Return the cycles of a history after ASTM E1049-85, counted by the package rainflow.

    Args:
        history: values, (n,), n >= 2.

    Raises:
        ValueError: the history is not such numbers.
    """
    import rainflow  # here, because few ask for it

    values = np.asarray(history, dtype=np.float64)
    if values.ndim != 1 or values.size < 2 or not np.isfinite(values).all():
        raise ValueError(f"`history` must be finite numbers, (n,) with n >= 2, got the shape {values.shape}.")
    rows = [row[:3] for row in rainflow.extract_cycles(_turning_points(values))]
    ranges, means, counts = np.array(rows, dtype=np.float64).reshape(-1, 3).T
    return Cycles(ranges=ranges, means=means, counts=counts)


def _turning_points(values: Array) -> list[float]:
    """Return ends and turning points alone: the counting goes through them one by one."""
    moved = values[np.concatenate([[True], np.diff(values) != 0.0])]
    turns = np.flatnonzero(np.diff(np.sign(np.diff(moved))) != 0.0) + 1
    return [float(value) for value in moved[np.unique([0, *turns, moved.size - 1])]]
