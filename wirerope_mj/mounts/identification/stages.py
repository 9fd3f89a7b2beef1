"""The thesis' three stages, and the one-stage searches that it compares them with."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from wirerope_mj.mounts.identification.measured import MeasuredLoop
from wirerope_mj.mounts.identification.residuals import (
    Residual,
    area_residual,
    harmonic_residual,
    mid_line_residual,
    rms,
)
from wirerope_mj.mounts.identification.search import Minimum, Unknowns, run_search

Method = Literal["three-stage", "time", "frequency"]


@dataclass(frozen=True, kw_only=True)
class Stage:
    """One stage of a fit: its name, steps, evaluations, the root mean square that was left of the loops, the fitted values."""

    name: str
    iterations: int
    evaluations: int
    error: float
    values: dict[str, float]


def run_stages(
    unknowns: Unknowns, loops: Sequence[MeasuredLoop], full: Residual, values: Mapping[str, float], method: Method
) -> tuple[Minimum, tuple[Stage, ...]]:
    """Return the end of a search from `values` in the residual `full`, and its stages.

    Args:
        unknowns: coordinates of the law.
        loops: as they were measured.
        full: the residual that counts.
        values: the start.
        method: "three-stage": stiffness from mid-lines, hysteresis from areas, everything from forces; "time": the last of
            these at once; "frequency": everything from the Fourier coefficients of the forces.
    """
    stages: list[Stage] = []

    def stage(
        name: str, part: Unknowns, residual: Residual, begin: Mapping[str, float]
    ) -> tuple[Minimum, dict[str, float]]:
        end = run_search(part, residual, begin)
        ended = part.values(end.numbers)
        error = rms(full(part.law(end.numbers)))
        stages.append(
            Stage(name=name, iterations=end.iterations, evaluations=end.evaluations, error=error, values=ended)
        )
        return end, ended

    if method == "frequency":
        end, ended = stage("frequency", unknowns, harmonic_residual(loops), values)
        # The error, and what the data identify, are still those of the forces.
        there = run_search(unknowns, full, ended, most=1)
        return replace(there, converged=end.converged, message=end.message), tuple(stages)
    if method == "three-stage":
        begin = {**{c.name: values[c.name] for c in unknowns.coordinates}, **unknowns.fixed}
        parts = (("stiffness", True, mid_line_residual(loops)), ("areas", False, area_residual(loops)))
        for name, stiffness, residual in parts:
            held = {c.name: begin[c.name] for c in unknowns.coordinates if c.stiffness is not stiffness}
            part = replace(unknowns, fixed={**held, **unknowns.fixed})
            if part.free:
                _, begin = stage(name, part, residual, begin)
        values = begin
    end, _ = stage("everything", unknowns, full, values)
    return end, tuple(stages)
