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
from wirerope_mj.mounts.identification.search import Found, Search, run_search

Method = Literal["three-stage", "time", "frequency"]


@dataclass(frozen=True, kw_only=True)
class Stage:
    """One stage of a fit: its name, steps, evaluations, the root mean square that was left of the loops, the values found."""

    name: str
    iterations: int
    evaluations: int
    error: float
    values: dict[str, float]


def run_stages(
    search: Search, loops: Sequence[MeasuredLoop], full: Residual, values: Mapping[str, float], method: Method
) -> tuple[Found, tuple[Stage, ...]]:
    """Return the end of a search and what its stages did.

    Args:
        search: what is free.
        loops: what was measured.
        full: the residual that counts.
        values: where to begin.
        method: "three-stage": stiffness from mid-lines, hysteresis from areas, everything from forces; "time": the last of
            these at once; "frequency": everything from the Fourier coefficients of the forces.
    """
    stages: list[Stage] = []

    def stage(
        name: str, part: Search, residual: Residual, begin: Mapping[str, float]
    ) -> tuple[Found, dict[str, float]]:
        found = run_search(part, residual, begin)
        ended = part.values(found.numbers)
        error = rms(full(part.law(found.numbers)))
        spent = {"iterations": found.iterations, "evaluations": found.evaluations}
        stages.append(Stage(name=name, **spent, error=error, values=ended))
        return found, ended

    if method == "frequency":
        found, ended = stage("frequency", search, harmonic_residual(loops), values)
        # What counts, and what the data fix, is still said by the forces.
        there = run_search(search, full, ended, most=1)
        return replace(there, converged=found.converged, message=found.message), tuple(stages)
    if method == "three-stage":
        begin = {**{c.name: values[c.name] for c in search.coordinates}, **search.fixed}
        parts = (("stiffness", True, mid_line_residual(loops)), ("areas", False, area_residual(loops)))
        for name, stiffness, residual in parts:
            held = {c.name: begin[c.name] for c in search.coordinates if c.stiffness is not stiffness}
            part = Search(family=search.family, coordinates=search.coordinates, fixed={**held, **search.fixed})
            if part.free:
                _, begin = stage(name, part, residual, begin)
        values = begin
    found, _ = stage("everything", search, full, values)
    return found, tuple(stages)
