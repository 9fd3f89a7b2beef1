"""What a fit is worth: its criterion, and its error at amplitudes that it has not seen."""

import math
from collections.abc import Sequence

import numpy as np

from wirerope_mj.mounts.identification.measured import MeasuredLoop
from wirerope_mj.mounts.identification.result import Identification
from wirerope_mj.mounts.laws import Law

SAME = 0.05  # Relative difference within which two amplitudes are one: a rig does not repeat its stroke closer


def error_of(law: Law, loop: MeasuredLoop) -> float:
    """Return the root mean square of a law's force minus the measured one, without means, over half of the force range."""
    return float(np.std(loop.model_force(law) - loop.force) / (0.5 * np.ptp(loop.force)))


def amplitude_groups(loops: Sequence[MeasuredLoop]) -> list[list[int]]:
    """Return the indices of the loops of each amplitude; the loops are in the order of their amplitudes."""
    groups: list[list[int]] = []
    for index, loop in enumerate(loops):
        if groups and loop.amplitude <= (1.0 + SAME) * loops[groups[-1][0]].amplitude:
            groups[-1].append(index)
        else:
            groups.append([index])
    return groups


def group_error(law: Law, loops: Sequence[MeasuredLoop], group: Sequence[int]) -> float:
    """Return the error of the loops of one amplitude."""
    return float(np.sqrt(np.mean([error_of(law, loops[index]) ** 2 for index in group])))


def criterion(fit: Identification, free: int) -> float:
    """Return N ln(S / N) + p ln N, S the weighted squares that are left; the loops' means are the same for every law."""
    count, squares = 0, 0.0
    for loop, residual in zip(fit.loops, fit.residuals, strict=True):
        newtons = residual * 0.5 * float(np.ptp(loop.force))
        squares += loop.force.size * (newtons / loop.weight) ** 2
        count += loop.force.size
    return count * math.log(max(squares, 1e-300) / count) + free * math.log(count)
