"""Quality of a fit: its information criterion, its error at amplitudes left out, and the number of scales they support."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from wirerope_mj.mounts.identification.measured import MeasuredLoop, prepare
from wirerope_mj.mounts.identification.result import Identification, ScaleRow
from wirerope_mj.mounts.identification.scales import SCALES
from wirerope_mj.mounts.laws import Law, Loop

SAME = 0.05  # Relative difference within which two amplitudes are one: a rig does not repeat its stroke closer


def amplitude_groups(loops: Sequence[MeasuredLoop]) -> list[list[int]]:
    """Group the indices of the loops by amplitude; the loops are in the order of their amplitudes."""
    groups: list[list[int]] = []
    for index, loop in enumerate(loops):
        if groups and loop.amplitude <= (1.0 + SAME) * loops[groups[-1][0]].amplitude:
            groups[-1].append(index)
        else:
            groups.append([index])
    return groups


def group_error(law: Law, loops: Sequence[MeasuredLoop], group: Sequence[int]) -> float:
    """Compute the root mean square of a law's force minus that of the loops of one amplitude, over half of the force range.

    Both are without their means.
    """
    members = [loops[index] for index in group]
    errors = [float(np.std(loop.model_force(law) - loop.force) / (0.5 * np.ptp(loop.force))) for loop in members]
    return float(np.sqrt(np.mean(np.square(errors))))


def criterion(fit: Identification, free: int) -> float:
    """Compute the Bayesian criterion N ln(S / N) + p ln N, S the weighted sum of squares, p the number of free values."""
    count, squares = 0, 0.0
    for loop, residual in zip(fit.loops, fit.residuals, strict=True):
        newtons = residual * 0.5 * float(np.ptp(loop.force))
        squares += loop.force.size * (newtons / loop.weight) ** 2
        count += loop.force.size
    return count * math.log(max(squares, 1e-300) / count) + free * math.log(count)


# Fit of a number of scales to loops, from the grid, or from a fit to more loops.
Fit = Callable[[Sequence[Loop], int, Identification | None], Identification]


def supported_scales(loops: Sequence[Loop], fit: Fit, *, weights: str) -> tuple[int, tuple[ScaleRow, ...]]:
    """Fit one scale, two and three, and return the largest number that the loops support, and all trials.

    One more scale is taken if the criterion falls and the error at amplitudes left out falls, too: its mean over the
    amplitudes in logarithms, for that of the largest, into which a spring is extrapolated, is ten times that of the others.
    ValueError: one scale cannot be fitted, or there is only one amplitude, so that none can be left out.
    """
    order = sorted(loops, key=lambda loop: float(np.ptp(loop.deflection)))
    measured = prepare(order, weights=weights)
    groups = amplitude_groups(measured)
    if len(groups) < 2:
        raise ValueError("`scales='auto'` leaves out every amplitude once, and there is only one; say how many scales.")
    rows: list[ScaleRow] = []
    for count in SCALES:
        least = min((row.criterion for row in rows), default=math.inf)
        try:
            whole, errors = fit(order, count, None), [math.inf]
            free = len(whole.uncertainty.free)
            size = criterion(whole, free)
            if size < least:
                rest = [[loop for index, loop in enumerate(order) if index not in group] for group in groups]
                laws = [fit(part, count, whole).law for part in rest]
                errors = [group_error(law, measured, group) for law, group in zip(laws, groups, strict=True)]
            left_out = float(np.exp(np.mean(np.log(errors))))
            rows.append(ScaleRow(count=count, free=free, criterion=size, left_out=left_out))
        except ValueError as failure:
            if not rows:
                raise
            rows.append(ScaleRow(count=count, free=0, criterion=math.inf, left_out=math.inf, why_not=str(failure)))
        if len(rows) > 1 and not (rows[-1].criterion < least and rows[-1].left_out < rows[-2].left_out):
            return rows[-2].count, tuple(rows)
    return rows[-1].count, tuple(rows)
