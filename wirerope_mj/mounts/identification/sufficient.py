"""Conditions for a search: loops the right way round, enough amplitudes, and every free parameter felt."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from wirerope_mj.mounts.identification.measured import MeasuredLoop
from wirerope_mj.mounts.identification.residuals import THIN, Data, Residual
from wirerope_mj.mounts.identification.search import Unknowns
from wirerope_mj.mounts.laws import Law

PER_LOOP = 3  # Quantities that one loop fixes well: its secant stiffness, its area, and how its branches bend
DEAD = 1e-9  # Change of the residual, for a change of 100 % of a parameter, that is rounding


def require_amplitudes(loops: Sequence[MeasuredLoop], unknowns: Unknowns, data: Data) -> None:
    """Raise ValueError if there are too few different amplitudes for the free parameters."""
    amplitudes = {round(loop.amplitude / loops[-1].amplitude, 2) for loop in loops}
    bent = [c for c in unknowns.free if not c.name.startswith("gap")]  # a gap is a knee that the loop has besides
    needed = max(math.ceil(len(bent) / PER_LOOP), 1)
    if data == "loops" and len(amplitudes) < needed:
        raise ValueError(
            f"{len(unknowns.free)} parameters are free ({', '.join(c.name for c in unknowns.free)}), and a loop fixes about "
            f"{PER_LOOP}: {needed} different amplitudes are needed, {len(amplitudes)} given. Test more amplitudes, fix "
            "parameters, or take a law with fewer."
        )


def require_dissipation(loops: Sequence[MeasuredLoop]) -> None:
    """Raise ValueError if a loop is run through the wrong way round; one as thin as its noise is an elastic one."""
    for loop in loops:
        area, rectangle = loop.area(loop.force), float(np.ptp(loop.deflection) * np.ptp(loop.force))
        if area < -THIN * rectangle:
            raise ValueError(
                f"the loop of +-{1e3 * loop.amplitude:.4g} mm encloses {area:.4g} J: it would give energy. Force and "
                "deflection must have the same sign in tension, and samples must be in the order of time."
            )


def require_movement(unknowns: Unknowns, residual: Residual, values: Mapping[str, float]) -> None:
    """Raise ValueError if a free parameter does not move the residual at the start."""
    numbers = unknowns.numbers(values)
    before = residual(unknowns.law(numbers))
    _, high = unknowns.bounds
    for index, c in enumerate(unknowns.free):
        moved = numbers.copy()
        moved[index] += 0.01 if numbers[index] + 0.01 < high[index] else -0.01
        change = np.abs(residual(unknowns.law(moved)) - before).max(initial=0.0) / 0.01
        if not change > DEAD:
            raise ValueError(
                f"`{c.name}` does not move the residual at the start ({c.name} = {c.value(numbers[index]):.6g} {c.unit}): no "
                "search can find it. Fix it, begin elsewhere, or test larger amplitudes."
            )


def require_finite(extra_residuals: Sequence[Residual], law: Law) -> None:
    """Raise ValueError if one of the extra residuals is not finite for a law."""
    for index, residual in enumerate(extra_residuals):
        if not np.isfinite(np.asarray(residual(law), dtype=np.float64)).all():
            raise ValueError(f"`extra_residuals[{index}]` gives numbers that are not finite, at the start {law!r}.")
