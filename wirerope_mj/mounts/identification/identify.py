"""Cyclic tests -> a law, with what the data could and could not fix."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from wirerope_mj.mounts.identification.arguments import require_finite, require_kind, require_loops, require_options
from wirerope_mj.mounts.identification.coordinates import FAMILIES, Coordinate, Family, masing_family
from wirerope_mj.mounts.identification.measured import MeasuredLoop, prepare, scales_of
from wirerope_mj.mounts.identification.profiles import Survey, survey
from wirerope_mj.mounts.identification.residuals import Data, Residual, joined, loop_residual, rms
from wirerope_mj.mounts.identification.result import Identification as Identification
from wirerope_mj.mounts.identification.search import Found, Search
from wirerope_mj.mounts.identification.stages import Method, Stage, run_stages
from wirerope_mj.mounts.identification.start import grid_starts
from wirerope_mj.mounts.identification.stops import STOP, beside_known, closing
from wirerope_mj.mounts.identification.sufficient import require_amplitudes, require_dissipation, require_movement
from wirerope_mj.mounts.identification.uncertainty import certainty_of
from wirerope_mj.mounts.laws import AsymmetricBoucWen, Law, Loop, Masing, Stop

Constraint = Literal["beta>gamma", "beta=gamma", "beta<gamma"]

STARTS = 2
"""Best places of the grid from which a search begins, beside the best one for each pattern of signs."""

DEEPER = 2
"""How often a fit begins again where moving a value has shown a better one."""

SAME = 0.01
"""Variances within which the ends of two searches are one: a tenth of a standard error. The earlier one counts."""


def identify(
    loops: Sequence[Loop],
    *,
    law: type[Law] = AsymmetricBoucWen,
    extra_residuals: Sequence[Residual] = (),
    start: Law | None = None,
    fixed: Mapping[str, float] | None = None,
    free: Sequence[str] = (),
    beside: Law | None = None,
    constraint: Constraint | None = None,
    elements: int = 5,
    method: Method = "three-stage",
    data: Data = "loops",
    weights: str = "range",
    noise: float | None = None,
    grid: bool = True,
    profiles: bool = True,
) -> Identification:
    """Return the law of a class that fits closed cyclic loops best, and what they leave open.

    The law is compared along each loop's own path of deflections: led through what a record holds before it where that is
    known, as `read_cycles` gives it, else in its steady state. The mean of each loop's force is free, as a load cell's zero
    drifts. Searches begin at `start` and at the best places of a grid, and the best end counts.
    From `start` a search goes the thesis' way: stiffness from the mid-lines, then the hysteresis from the areas with the
    stiffness fixed, then everything (Levenberg-Marquardt with bounds in each); and, beside a grid, straight to everything.

    Args:
        loops: closed cycles of at least one amplitude.
        law: class of the law; any rate-independent one without wear.
        extra_residuals: functions of a law that return further residuals, over their own noise relative to that of the loops;
            dynamic measurements join the loops through them.
        start: where to begin, beside the grid.
        fixed: values of parameters that are not searched for, by name.
        free: names of those that are searched for, though they are given otherwise: a stop's `exponent` 1 and `rounding` 0.
        beside: law that is known and acts in parallel, as that of an isolator that strikes the bumper which is searched for;
            the law found is both, a `Parallel`.
        constraint: on Bouc-Wen's beta and gamma.
        elements: Jenkin elements of a Masing law.
        method: "three-stage", or from `start` in one stage "time" (forces) or "frequency" (their Fourier coefficients, which
            needs a start); places of the grid are searched by forces at once.
        data: "loops", or "skeleton" for the forces at the turning points alone.
        weights: "range": loops count alike; "equal": a newton counts alike.
        noise: standard deviation of the force relative to `weights`, if it is known; None: what the fit leaves.
        grid: whether the grid is tried; False needs a start.
        profiles: whether standard errors are checked by moving every value and fitting the others again; False takes those of
            the Jacobian, and is quicker.

    Raises:
        ValueError: the loops or the arguments cannot be used, there are too few amplitudes, or a free parameter does not move
            the residual; names what and why.
    """
    require_loops(loops)
    require_options(
        method=method, data=data, constraint=constraint, noise=noise, grid=grid, start=start, fixed=fixed or {},
        extra_residuals=extra_residuals,
    )  # fmt: skip
    measured = prepare(loops, weights=weights, stop=law is Stop and beside is None)
    require_dissipation(measured)
    sides: Mapping[str, float] = {}
    if law is Stop:
        measured, sides = closing(measured, beside)
    family = family_of(law, len(start.stiffness) if isinstance(start, Masing) else elements)
    coordinates = family.coordinates(replace(scales_of(measured), **sides))
    search = _search(law, beside_known(family, beside), coordinates, dict(fixed or {}), free, constraint, start)
    require_amplitudes(measured, search, data)
    full = joined(loop_residual(measured, data), extra_residuals)
    ends: list[_End] = []
    failures: list[str] = []
    for origin, values in _candidates(search, measured, start, grid):
        try:
            require_finite(extra_residuals, search.law(search.numbers(values)))
            require_movement(search, full, values)
        except ValueError as failure:
            failures.append(str(failure))
            continue
        ways: list[Method] = [method if origin == "given" and data == "loops" else "time"]
        if grid and ways == ["three-stage"]:  # its first stages may lead away from a start that was good already
            ways.append("time")
        for way in ways:
            found, stages = run_stages(search, measured, full, values, way)
            ends.append(_End(found=found, stages=stages, started=origin))
    if not ends:
        raise ValueError(failures[0] if failures else f"no {law.name} law could be evaluated on these loops.")
    return _result(search, measured, full, ends, noise, profiles)


@dataclass(frozen=True, kw_only=True)
class _End:
    """Where one search ended, what its stages did, and which start it had."""

    found: Found
    stages: tuple[Stage, ...]
    started: str


def family_of(law: type[Law], elements: int = 5) -> Family:
    """Return how laws of a class are searched for, or raise ValueError if cyclic tests cannot fix them."""
    require_kind(law)
    if law is Stop:
        return STOP
    if law is Masing:
        if not isinstance(elements, int) or elements < 1:
            raise ValueError(f"`elements` must be an integer >= 1, got {elements!r}.")
        return masing_family(elements)
    if law not in FAMILIES:
        kinds: list[type[Law]] = [*FAMILIES, Masing, Stop]
        known = ", ".join(sorted(kind.name for kind in kinds))
        raise ValueError(f"`law` must be one that cyclic tests can fix ({known}), got {getattr(law, 'name', law)!r}.")
    return FAMILIES[law]


def _search(
    law: type[Law],
    family: Family,
    coordinates: list[Coordinate],
    fixed: dict[str, float],
    free: Sequence[str],
    constraint: Constraint | None,
    start: Law | None,
) -> Search:
    if start is not None and type(start) is not law:
        raise ValueError(f"`start` must be a {law.name} law, got {start!r}.")
    if fixed.get("loss") == 0.0:  # an elastic stop has none
        coordinates = [c for c in coordinates if c.name != "reversal"]
    names = [c.name for c in coordinates]
    for option, named in (("fixed", fixed), ("free", free)):
        for name in named:
            if name not in names:
                raise ValueError(
                    f"`{option}` names {name!r}, which {law.name} does not have; it has {', '.join(names)}."
                )
    if both := [name for name in free if name in fixed]:
        raise ValueError(f"`fixed` and `free` both name {', '.join(both)}.")
    fixed = {**{name: value for name, value in family.usual.items() if name not in free}, **fixed}
    if start is not None and (missing := [n for n in names if n not in fixed and n not in family.read(start)]):
        raise ValueError(
            f"`start` must give {', '.join(missing)}, which the loops show and the search moves, got {start!r}."
        )
    if set(names) <= set(fixed):
        raise ValueError(f"`fixed` names all parameters, {', '.join(names)}: nothing is left to search for.")
    if constraint is not None:
        if "sigma" not in names:
            raise ValueError(f"`constraint` is between beta and gamma, and {law.name} does not have both.")
        if "sigma" in fixed:
            raise ValueError(
                "`constraint` and `fixed` both say what sigma = beta / (beta + gamma) may be; give one of them."
            )
        coordinates = [_constrained(c, constraint) if c.name == "sigma" else c for c in coordinates]
        if constraint == "beta=gamma":
            fixed["sigma"] = 0.5
    return Search(family=family, coordinates=coordinates, fixed=fixed)


def _candidates(
    search: Search, loops: list[MeasuredLoop], start: Law | None, grid: bool
) -> list[tuple[str, dict[str, float]]]:
    """Return where searches begin, the values of the coordinates, and whether they were given or come from the grid."""
    found = [("given", search.family.read(start))] if start is not None else []
    if grid:
        places = grid_starts(search.family, search.coordinates, loops, search.fixed, count=STARTS)
        found += [("grid", values) for values in places]
    return found


def _constrained(sigma: Coordinate, constraint: Constraint) -> Coordinate:
    """Return the coordinate sigma = beta / (beta + gamma) within the thesis' constraint."""
    low, high = {"beta>gamma": (0.5, sigma.upper), "beta<gamma": (sigma.lower, 0.5)}.get(
        constraint, (sigma.lower, sigma.upper)
    )
    return Coordinate(name=sigma.name, unit=sigma.unit, lower=low, upper=high)


def _result(
    search: Search, loops: list[MeasuredLoop], full: Residual, ends: list[_End], noise: float | None, profiles: bool
) -> Identification:
    evaluations = sum(stage.evaluations for end in ends for stage in end.stages)
    for left in range(DEEPER, -1, -1):
        least = min(end.found.cost for end in ends)
        best = next(end for end in ends if end.found.cost <= least * (1.0 + SAME / end.found.residual.size))
        rivals = [end.found for end in ends if end is not best]
        surveyed = (
            survey(search, full, best.found, rivals, noise)
            if profiles
            else Survey(certainty=certainty_of(search, best.found, noise), better=None, evaluations=0)
        )
        evaluations += surveyed.evaluations
        if surveyed.better is None or left == 0:
            break
        found, stages = run_stages(search, loops, full, surveyed.better, "time")
        evaluations += sum(stage.evaluations for stage in stages)
        ends.append(_End(found=found, stages=(*best.stages, *stages), started=best.started))
    found, certainty = best.found, surveyed.certainty
    law = search.law(found.numbers)
    parts = [(loop.model_force(law) - loop.force) / (0.5 * float(np.ptp(loop.force))) for loop in loops]
    residuals = np.array([rms(part - part.mean()) for part in parts])
    bounded = [p.name for p in certainty.parameters.values() if p.at_bound]
    words = f"ended from the {best.started} start: {found.message.rstrip('.')}"
    words += f"; at its bound: {', '.join(bounded)}" if bounded else ""
    return Identification(
        law=law,
        parameters=certainty.parameters,
        residual=float(np.sqrt(np.mean(residuals**2))),
        residuals=residuals,
        converged=found.converged,
        message=words,
        open_combinations=certainty.open_combinations,
        certainty=certainty,
        stages=best.stages,
        evaluations=evaluations,
        started=best.started,
        loops=tuple(loops),
    )
