"""Identification of a law from cyclic tests, with its uncertainty, and the number of scales that the loops support."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np

from wirerope_mj.mounts.identification.families import beside_known, family_of
from wirerope_mj.mounts.identification.measured import MeasuredLoop, ScaleLoop, prepare, require_loops, scales_of
from wirerope_mj.mounts.identification.profiles import Survey, survey
from wirerope_mj.mounts.identification.result import Identification as Identification
from wirerope_mj.mounts.identification.result import ScaleRow
from wirerope_mj.mounts.identification.scales import SCALES, require_scales, scales_family
from wirerope_mj.mounts.identification.search import (
    Data,
    Method,
    Minimum,
    Residual,
    Stage,
    Unknowns,
    joined,
    loop_residual,
    rms,
    run_stages,
)
from wirerope_mj.mounts.identification.start import grid_starts, scale_starts
from wirerope_mj.mounts.identification.sufficient import (
    Constraint,
    closing,
    require_amplitudes,
    require_dissipation,
    require_finite,
    require_movement,
    require_options,
    unknowns_of,
)
from wirerope_mj.mounts.identification.uncertainty import uncertainty_of, with_noise_of_each
from wirerope_mj.mounts.laws import AsymmetricBoucWen, Law, Loop, Parallel, Stop

REPEATED = 0.05  # relative difference within which two amplitudes are one: a rig does not repeat its stroke closer


def amplitude_groups(loops: Sequence[MeasuredLoop]) -> list[list[int]]:
    """Group the indices of the loops by amplitude; the loops are in the order of their amplitudes."""
    groups: list[list[int]] = []
    for index, loop in enumerate(loops):
        if groups and loop.amplitude <= (1.0 + REPEATED) * loops[groups[-1][0]].amplitude:
            groups[-1].append(index)
        else:
            groups.append([index])
    return groups


def group_error(law: Law, loops: Sequence[MeasuredLoop], group: Sequence[int]) -> float:
    """Compute the rms difference of a law's force from the loops of one amplitude, over half of the force range.

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
    """Fit friction on one, two and three scales; return the largest number of scales that the loops support, and all fits.

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


STARTS = 2  # Best points of the grid from which a search begins, beside the best one for each pattern of signs
DEEPER = 2  # Restarts of a fit from a better one that its profiles have shown
# Variances within which the minima of two searches are equal: a tenth of a standard error. The earlier one counts.
SAME = 0.01


@dataclass(frozen=True, kw_only=True)
class _Search:
    """Minimum of one search, with its stages and its start, "given" or "grid"."""

    minimum: Minimum
    stages: tuple[Stage, ...]
    started: str


def identify(
    loops: Sequence[Loop], *, law: type[Law] = AsymmetricBoucWen, scales: int | Literal["auto"] = 1,
    extra_residuals: Sequence[Residual] = (), start: Law | None = None, fixed: Mapping[str, float] | None = None,
    free: Sequence[str] = (), beside: Law | None = None, constraint: Constraint | None = None, elements: int = 5,
    method: Method = "three-stage", data: Data = "loops", weights: str = "range", noise: float | None = None,
    grid: bool = True, profiles: bool = True,
) -> Identification:  # fmt: skip
    """Find the law of a class that fits closed cyclic loops best, and its uncertainty.

    The law is compared along each loop's own path of deflections: led through what a record holds before it where that is
    known, as `load_cycles` gives it, else in its steady state. The mean of each loop's force is free, as a load cell's zero
    drifts. Searches begin at `start` and at the best points of a grid, and the best minimum counts.
    From `start` a search goes the thesis' way: stiffness from the mid-lines, then the hysteresis from the areas with the
    stiffness fixed, then everything (Levenberg-Marquardt with bounds in each); and, beside a grid, straight to everything.

    Args:
        loops: closed cycles of at least one amplitude.
        law: class of the law; any rate-independent one without wear.
        scales: of friction, 1 to 3, of a Bouc-Wen law or one of Ni's: so many sets in parallel with one spring, asymmetry and
            sigma, yield deflections apart by a factor of three at least, n of each at least 0.5; the law returned is a
            `Parallel`, the large scale first. "auto": as many as the Bayesian criterion and amplitudes left out support.
        extra_residuals: functions of a law that return further residuals, over their own noise relative to that of the loops;
            dynamic measurements join the loops through them.
        start: law at which a search begins too.
        fixed: values of parameters that are not searched for, by name.
        free: names of those that are searched for, though they are given otherwise unless `start` has others: a stop's
            `exponent` 1 and `rounding` 0, and a Masing law's `k2` and `k3`, which are 0.
        beside: law that is known and acts in parallel, as that of an isolator that strikes the bumper which is searched for;
            the law returned is both, a `Parallel`.
        constraint: on Bouc-Wen's beta and gamma.
        elements: Jenkin elements of a Masing law.
        method: "three-stage", or from `start` in one stage "time" (forces) or "frequency" (their Fourier coefficients, which
            needs a start); from the grid searches go by forces at once.
        data: "loops", or "skeleton" for the forces at the turning points alone.
        weights: "range": loops count alike; "equal": a newton counts alike.
        noise: standard deviation of the force relative to `weights`, if it is known; None: what the fit leaves of each loop.
        grid: whether the grid is tried; False needs a start.
        profiles: whether standard errors are checked by moving every value and fitting the others again; False takes those of
            the Jacobian, and is quicker.

    Raises:
        ValueError: the loops or the arguments cannot be used, there are too few amplitudes, or a free parameter does not move
            the residual; names what and why.
    """
    require_loops(loops)
    require_scales(law, scales, start=start, beside=beside)
    require_options(method, data, constraint, noise, grid, start, fixed or {}, extra_residuals)
    if isinstance(scales, str):
        search = partial(
            identify, law=law, extra_residuals=extra_residuals, fixed=fixed, free=free, constraint=constraint, data=data,
            weights=weights, noise=noise,
        )  # fmt: skip

        def fit(part_of_loops: Sequence[Loop], count: int, begin: Identification | None) -> Identification:
            if begin is None:
                return search(part_of_loops, scales=count, profiles=False)
            return search(part_of_loops, scales=count, start=begin.law, grid=False, method="time", profiles=False)

        count, tried = supported_scales(loops, fit, weights=weights)
        return replace(search(loops, scales=count, profiles=profiles), scale_rows=tried)
    names = SCALES[scales]
    measured = prepare(loops, weights=weights, stop=law is Stop and beside is None)
    require_dissipation(measured)
    sides: Mapping[str, float] = {}
    if law is Stop:
        measured, sides = closing(measured, beside)
    measured = [ScaleLoop.of(loop) for loop in measured] if names else measured
    elements = elements if start is None else start.n_states  # of Masing's law
    family = scales_family(law, names) if names else family_of(law, elements)
    coordinates = family.coordinates(replace(scales_of(measured), **sides))
    unknowns = unknowns_of(
        Parallel if names else law, beside_known(family, beside), coordinates, dict(fixed or {}), free, constraint, start
    )
    require_amplitudes(measured, unknowns, data)
    full = joined(loop_residual(measured, data), extra_residuals)
    starts = [("given", family.read(start))] if start is not None else []
    if grid:
        points = scale_starts(unknowns, measured, names) if names else grid_starts(unknowns, measured, count=STARTS)
        starts += [("grid", values) for values in points]
    results: list[_Search] = []
    failures: list[str] = []
    for origin, values in starts:
        try:
            require_finite(extra_residuals, unknowns.law(unknowns.numbers(values)))
            require_movement(unknowns, full, values)
        except ValueError as failure:
            failures.append(str(failure))
            continue
        methods: list[Method] = [method if origin == "given" and data == "loops" else "time"]
        if grid and methods == ["three-stage"]:  # its first stages may lead away from a start that was good already
            methods.append("time")
        for route in methods:
            minimum, stages = run_stages(unknowns, measured, full, values, route)
            results.append(_Search(minimum=minimum, stages=stages, started=origin))
    if not results:
        raise ValueError(failures[0] if failures else f"no {law.name} law could be evaluated on these loops.")
    return replace(_result(unknowns, measured, full, results, noise, profiles, data), scales=names)


def _result(
    unknowns: Unknowns, loops: list[MeasuredLoop], full: Residual, results: list[_Search], noise: float | None, profiles: bool,
    data: Data,
) -> Identification:  # fmt: skip
    """Return the identification at the best minimum, restarted from any better fit that moving single parameters shows."""
    evaluations = sum(stage.evaluations for result in results for stage in result.stages)
    for restarts_left in range(DEEPER, -1, -1):
        least = min(result.minimum.cost for result in results)
        best = next(result for result in results if result.minimum.cost <= least * (1.0 + SAME / result.minimum.residual.size))
        if profiles:
            surveyed = survey(unknowns, full, best.minimum, [result.minimum for result in results if result is not best], noise)
        else:
            surveyed = Survey(uncertainty=uncertainty_of(unknowns, best.minimum, noise), better=None, evaluations=0)
        uncertainty = surveyed.uncertainty
        if noise is None and data == "loops":
            uncertainty = with_noise_of_each(uncertainty, unknowns, best.minimum, [loop.force.size for loop in loops])
        evaluations += surveyed.evaluations
        if surveyed.better is None or restarts_left == 0:
            break
        minimum, stages = run_stages(unknowns, loops, full, surveyed.better, "time")
        evaluations += sum(stage.evaluations for stage in stages)
        results.append(_Search(minimum=minimum, stages=(*best.stages, *stages), started=best.started))
    minimum, law = best.minimum, unknowns.law(best.minimum.numbers)
    differences = [(loop.model_force(law) - loop.force) / (0.5 * float(np.ptp(loop.force))) for loop in loops]
    residuals = np.array([rms(difference - difference.mean()) for difference in differences])
    message = f"ended from the {best.started} start: {minimum.message.rstrip('.')}"
    if bounded := [p.name for p in uncertainty.parameters.values() if p.at_bound]:
        message += f"; at its bound: {', '.join(bounded)}"
    return Identification(
        law=law, parameters=uncertainty.parameters, residual=float(np.sqrt(np.mean(residuals**2))), residuals=residuals,
        converged=minimum.converged, message=message, non_identifiable=uncertainty.non_identifiable,
        uncertainty=uncertainty, stages=best.stages, evaluations=evaluations, started=best.started, loops=tuple(loops),
    )  # fmt: skip
