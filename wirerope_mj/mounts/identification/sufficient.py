"""Checks before a search: options, sense of the loops, number of amplitudes, contact of a stop, effect of parameters."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal, get_args

import numpy as np
import scipy

from wirerope_mj.foundation.arguments import finite, one_of, positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.families import Coordinate, Family
from wirerope_mj.mounts.identification.measured import MeasuredLoop
from wirerope_mj.mounts.identification.search import THIN, Data, Method, Residual, Unknowns
from wirerope_mj.mounts.laws import Law

Constraint = Literal["beta>gamma", "beta=gamma", "beta<gamma"]


def require_options(
    method: object, data: object, constraint: object, noise: object, grid: bool, start: object, fixed: object,
    extra_residuals: object,
) -> None:  # fmt: skip
    """Raise ValueError unless the options of `identify` are known and agree with each other."""
    one_of("method", method, get_args(Method))
    one_of("data", data, get_args(Data))
    if constraint is not None:
        one_of("constraint", constraint, get_args(Constraint))
    if noise is not None:
        positive("noise", noise)
    if start is None and not grid:
        raise ValueError("`grid` is False and there is no `start`: a search has nowhere to begin.")
    if method == "frequency" and (start is None or data != "loops"):
        raise ValueError(
            "`method='frequency'` needs a law to `start` at and `data='loops'`: from the grid searches go by forces."
        )
    if not isinstance(fixed, Mapping):
        raise ValueError(f"`fixed` must be a mapping of names to values, got {fixed!r}.")
    for name, value in fixed.items():
        finite(f"fixed[{name!r}]", value)
    if not isinstance(extra_residuals, Sequence) or not all(map(callable, extra_residuals)):
        raise ValueError(f"`extra_residuals` must be a sequence of functions of a law, got {extra_residuals!r}.")


def unknowns_of(
    law: type[Law], family: Family, coordinates: list[Coordinate], fixed: dict[str, float], free: Sequence[str],
    constraint: Constraint | None, start: Law | None,
) -> Unknowns:  # fmt: skip
    """Choose the parameters that are searched for and those that are fixed; ValueError where options contradict each other."""
    if start is not None and type(start) is not law:
        raise ValueError(f"`start` must be a {law.name} law, got {start!r}.")
    if fixed.get("loss") == 0.0:  # an elastic stop has none
        coordinates = [c for c in coordinates if c.name != "reversal"]
    names = [c.name for c in coordinates]
    for option, named in (("fixed", fixed), ("free", free)):
        for name in named:
            if name not in names:
                raise ValueError(f"`{option}` names {name!r}, which {law.name} does not have; it has {', '.join(names)}.")
    if both := [name for name in free if name in fixed]:
        raise ValueError(f"`fixed` and `free` both name {', '.join(both)}.")
    start_values = family.read(start) if start is not None else {}
    kept = [(name, value) for name, value in family.usual.items() if start_values.get(name, value) == value]
    usual = {name: value for name, value in kept if name not in free}
    fixed = {**usual, **fixed}
    if start is not None and (missing := [n for n in names if n not in fixed and n not in start_values]):
        raise ValueError(f"`start` must give {', '.join(missing)}, which the loops show and the search moves, got {start!r}.")
    if set(names) <= set(fixed):
        raise ValueError(f"`fixed` names all parameters, {', '.join(names)}: nothing is left to search for.")
    if constraint is not None:
        if "sigma" not in names:
            raise ValueError(f"`constraint` is between beta and gamma, and {law.name} does not have both.")
        if "sigma" in fixed:
            raise ValueError("`constraint` and `fixed` both say what sigma = beta / (beta + gamma) may be; give one of them.")
        ends = {"beta>gamma": (0.5, math.inf), "beta<gamma": (0.0, 0.5)}.get(constraint, (0.0, math.inf))
        coordinates = [
            replace(c, lower=max(c.lower, ends[0]), upper=min(c.upper, ends[1])) if c.name == "sigma" else c
            for c in coordinates
        ]
        if constraint == "beta=gamma":
            fixed["sigma"] = 0.5
    return Unknowns(family=family, coordinates=coordinates, fixed=fixed)


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
    """Raise ValueError if a loop gives energy; a loop as thin as its noise counts as elastic."""
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


HINGES = 12  # Gaps of the springs that make up any stop, evenly over the reach of a side
SURE = 30.0  # Variances by which a side has to lessen the sum of squares: in noise its springs find some ten
# Fraction of a loop's force range that a closed side carries at least: a law beside it is seldom known better.
LEAST = 0.02


def closing(loops: Sequence[MeasuredLoop], known: Law | None) -> tuple[list[MeasuredLoop], dict[str, float]]:
    """Choose the loops in which a stop shows, and find how far they go into its closed sides from zero [m], 0 for open ones.

    Loops within the gap of a bare stop hold noise alone and do not count. ValueError: none closes.
    """
    counted = [loop for loop in loops if known is not None or closes(loop)]
    low, high = (pick(float(pick(loop.deflection)) for loop in loops) for pick in (min, max))
    sides = _closed(counted, known) if counted else (False, False)
    if not any(sides):
        beyond = "" if known is None else f" beside the {known.name} law"
        raise ValueError(
            f"no loop closes a stop: between {1e3 * low:.4g} and {1e3 * high:.4g} mm no force is left{beyond} that grows "
            "towards an end. Test larger amplitudes, or about an operating point nearer to the stop."
        )
    return counted, {"below": max(-low, 0.0) * sides[0], "above": max(high, 0.0) * sides[1]}


def closes(loop: MeasuredLoop) -> bool:
    """True if a bare stop is closed at an end of the loop."""
    return any(_closed([loop], None))


def _closed(loops: Sequence[MeasuredLoop], known: Law | None) -> tuple[bool, bool]:
    """Tell whether a stop is closed at the lower end of loops, and whether at the upper one.

    Any elastic force that only grows with the depth is a sum of springs behind gaps, and a lossy one has another sum on the way
    back. They are fitted with stiffnesses >= 0; a side is closed if the fit without it is worse for sure.
    """
    forces = [loop.force - (0.0 if known is None else loop.model_force(known)) for loop in loops]
    force = np.concatenate([(f - f.mean()) / loop.weight for f, loop in zip(forces, loops, strict=True)])
    sides = []  # forces (n_t, n) of unit springs behind gaps, those of pressing and letting go apart, without means
    for side in (-1.0, 1.0):
        reach = max(0.0, *(float((side * loop.deflection).max()) for loop in loops))
        gaps, rows = np.linspace(0.0, reach, HINGES, endpoint=False), []
        for loop in loops:
            pressed = (side * np.gradient(loop.deflection) > 0.0)[:, None]
            springs = side * np.maximum(side * loop.deflection[:, None] - gaps, 0.0) / loop.weight
            columns = np.hstack([springs * pressed, springs * ~pressed])
            rows.append(columns - columns.mean(axis=0))
        sides.append(np.concatenate(rows))

    def cost(*parts: Array) -> tuple[float, Array]:
        matrix = np.hstack(parts)
        stiffness = scipy.optimize.lsq_linear(matrix, force, (0.0, np.inf)).x
        return float(np.sum((matrix @ stiffness - force) ** 2)), stiffness

    both, stiffness = cost(*sides)
    gains = [(cost(without)[0] - both) / max(both / force.size, 1e-12) for without in sides[::-1]]
    pushes = [float(np.ptp(part @ half)) for part, half in zip(sides, np.split(stiffness, 2), strict=True)]
    first, second = (gain > SURE and push > LEAST * np.ptp(force) for gain, push in zip(gains, pushes, strict=True))
    return bool(first), bool(second)
