"""Credibility of an answer: numerical error, input, form of the model and isolator data, each graded in plain words."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from wirerope_mj.assessment.criteria.verdict import most_used
from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.content.decks import deck_bends
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.numbers import listed, number, several, with_unit
from wirerope_mj.engine.simulation.stability import slowest_period
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.tables import Column, Mark, Table, left
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.motions import BaseMotion
from wirerope_mj.motions.records.record import record_warnings, records_in
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.isolator.parts import MOVING
from wirerope_mj.mounts.isolator.travel import RATINGS, SIDES
from wirerope_mj.mounts.laws.law import Law

if TYPE_CHECKING:
    from wirerope_mj.studies.result import StudyResult  # of tables: a run says its verdict without them

# Names of the grades of a part, 0 to 4, after NASA-STD-7009's credibility levels
GRADES = ("not known", "assumed", "stated", "measured", "measured, error known")
NORMAL = 1.645  # standard deviations on both sides that hold 90 % of a normal distribution

_STATED, _TITLE = 2, "What the answer rests on"
_PROVENANCE_GRADES = {"illustrative": 1, "estimated": 1, "catalogue": 2, "published": 2, "identified": 3}
_STEP = 1e-3  # relative change of a parameter, for the derivative of the stiffness
_STIFFNESS_EXPONENT = 0.5  # of the stiffness in a frequency, and so in peaks after a velocity change


@dataclass(frozen=True, kw_only=True)
class _Part:
    """A part of the credibility: name, grade (index of `GRADES`), description, relative effect on peaks (90 %) or NaN."""

    name: str
    grade: int
    text: str
    size: float = math.nan


def credibility_blocks(run: JudgedRun) -> Iterator[Block]:
    yield from _blocks(_run_parts(run))


def reliance(run: JudgedRun) -> Statement:
    """State in a line whether the deck bends, how far the peaks are known, and the weakest part of what they rest on."""
    parts = _run_parts(run)
    deck = "bends in the model" if deck_bends(run) else 'rigid (--deck "10 Hz 800 kg 4 %" lets it bend)'
    weakest = min(parts, key=lambda part: part.grade)
    band = _band_text(parts) or "The uncertainty of the peaks has no number"
    worst = most_used(run.verdicts)
    sizes = [part.size for part in parts if math.isfinite(part.size)]
    if worst is not None and abs((used := worst.utilisation or 0.0) - 1.0) < math.hypot(*sizes) * used:
        band += f". The {in_unit(used, '%'):.0f} % used by {worst.subject} differ from the limit by less than that"
    return Statement("reliance", f"Deck: {deck}. {band}. Weakest: {weakest.name} ({GRADES[weakest.grade]}).", tone="quiet")


def _band_text(parts: Sequence[_Part]) -> str:
    """Write the uncertainty of peaks by the parts that have a number, and name parts without; "" if none has one."""
    known = [part.size for part in parts if math.isfinite(part.size)]
    unknown = [part.name for part in parts if not math.isfinite(part.size)]
    text = f"Uncertainty of the peaks: ±{with_unit(math.hypot(*known), '%', digits=2)} (90 %), by what has a number"
    return f"{text}; {listed(unknown)}: no number, so that the true band is wider" if known else ""


def study_credibility_blocks(result: "StudyResult") -> Iterator[Block]:
    """Yield the credibility of a study's answer, at the largest deflections of all variants."""

    def largest(measure: str) -> float:
        values = np.asarray(result.columns[measure], dtype=np.float64)
        return float(np.max(values, initial=0.0, where=np.isfinite(values)))

    study, error = result.study, result.step_error
    reached = {
        name: np.array([largest(f"deflection/{name}/{rating}") for rating in RATINGS])
        for name, mount in study.base.mounts.items()
        if not mount.isolator.is_stop
    }
    half_strokes = {name: np.array([roll, shear, 0.5 * (down + up)]) for name, (down, up, shear, roll) in reached.items()}
    step = f"steps of at most {with_unit(study.work.timestep, 'ms', digits=4)} in all variants"
    isolators = _isolator_part(study.base)
    if any(name.startswith("mount/") for name in study.vary):
        isolators = replace(isolators, text=f"{isolators.text}; what varies of them is in the study's bands", size=math.nan)
    warnings = [text for motion in study.motions for text in record_warnings(motion)]
    isolators_vary = any(name.endswith("/isolator") for name in study.vary)  # whose friction may yield over shorter travels
    effect = f"halving them moves peaks of the nominal system by {with_unit(error, '%', digits=2)}"
    computation = _Part(name="computation", grade=1, text=f"{step}; their error is not known")
    if math.isfinite(error):
        unknown = ", those of the other parts by what is not known" if isolators_vary else ""
        text = f"{step}; {effect}{unknown}"
        computation = _Part(name="computation", grade=3 if isolators_vary else 4, size=error, text=text)
    motion = _input_part(study.motions, len(warnings))
    yield from _blocks((computation, motion, _form_part(study.base, half_strokes, slowest_period(study.base)), isolators))


def compared_credibility_blocks(runs: Mapping[str, JudgedRun]) -> Iterator[Block]:
    """Yield the credibility of the answers of several runs, a column for each run."""
    if not runs:
        return
    parts = {name: _run_parts(run) for name, run in runs.items()}
    weakest, name = min(((part, name) for name, of_run in parts.items() for part in of_run), key=lambda pair: pair[0].grade)
    yield Statement(
        "credibility",
        f"The comparison is as good as its weakest part, {weakest.name} of {name} ({GRADES[weakest.grade]}): "
        f"{weakest.text}. What is wrong in all runs alike differs less between them.",
        tone="unjudged" if weakest.grade < _STATED else "",
        values={"grade": float(weakest.grade)},
    )
    rows = [
        (of_all[0].name, *(Mark(f"{part.grade} of 4, {GRADES[part.grade]}: {part.text}", "") for part in of_all))
        for of_all in zip(*parts.values(), strict=True)
    ]
    columns = (*left("part"), *(Column(name, align="text") for name in parts))
    yield Table("credibility-parts", _TITLE, columns, rows)


def _run_parts(run: JudgedRun) -> tuple[_Part, ...]:
    """Grade computation, input, form of the model and isolator data of a run."""
    peaks, slowest = run.response.peaks, run.response.numerics.slowest_period
    half_strokes = {
        name: 0.5 * (np.asarray(peak.deflection.maximum) - np.asarray(peak.deflection.minimum))
        for name, peak in peaks.mounts.items()
    }
    numerics = run.response.numerics
    known, step_given = math.isfinite(numerics.error_estimate), math.isnan(numerics.accuracy)
    grade = 1 if step_given and not known else 3
    grade = 4 if numerics.error_estimate <= numerics.accuracy else grade
    size = numerics.error_estimate if known else math.nan
    computation = _Part(name="computation", grade=grade, text=numerics.error_text, size=size)
    return (
        computation, _input_part([run.motion], len(run.record_warnings)), _form_part(run.system, half_strokes, slowest),
        _isolator_part(run.system),
    )  # fmt: skip


def _blocks(parts: Sequence[_Part]) -> Iterator[Block]:
    """Yield the lowest grade, the uncertainty of peaks by all that is graded, and a table of what is graded."""
    weakest = min(parts, key=lambda part: part.grade)
    known = [part for part in parts if math.isfinite(part.size)]
    total = sum(part.size**2 for part in known)
    texts = [f"The answer is as good as its weakest part, {weakest.name} ({GRADES[weakest.grade]}): {weakest.text}."]
    texts += [f"{band}."] if (band := _band_text(parts)) else []
    yield Statement(
        "credibility", " ".join(texts), tone="unjudged" if weakest.grade < _STATED else "",
        values={"grade": float(weakest.grade), "band": math.sqrt(total)},
    )  # fmt: skip
    rows = [
        (
            part.name, Mark(f"{part.grade} of 4, {GRADES[part.grade]}", "unjudged" if part.grade < _STATED else ""), part.text,
            part.size, part.size**2 / total if total > 0.0 else None,
        )
        for part in parts
    ]  # fmt: skip
    columns = (
        *left("part", "rests on"), Column("what is known", align="text"),
        Column("moves peaks by ±", "%", 2), Column("fraction of these", "%", 2),
    )  # fmt: skip
    yield Table("credibility-parts", _TITLE, columns, rows)


def _input_part(motions: Sequence[BaseMotion], warnings: int) -> _Part:
    """Grade the base's motions: as measured, with or without warnings, or as stated."""
    text = "; ".join(motion.description for motion in motions)
    if not all(list(records_in(motion)) for motion in motions):
        return _Part(name="input", grade=2, text=f"{text}: as it was stated; the event itself may differ")
    text = f"{text}: as it was measured, {several(warnings, 'warning') if warnings else 'without warnings'}"
    return _Part(name="input", grade=2 if warnings else 3, text=text)


def _form_part(system: System, half_strokes: Mapping[str, Array], slowest: float) -> _Part:
    """Grade the form of the model by half the stroke of each mount, (3,) [m], over the largest amplitude of its laws' tests."""
    farthest, untested, frequencies = (0.0, ""), set[str](), []
    for name, strokes in half_strokes.items():
        mount = system.mounts[name]
        for stroke, (axis, law) in zip(strokes.tolist(), mount.isolator.axes.items(), strict=True):
            if law is None or stroke <= MOVING * strokes.max():
                continue
            tested = mount.isolator.validity.stated.get(axis)
            if tested is None:
                untested.add(axis)
                continue
            farthest = max(farthest, (stroke / tested.amplitude[1], f"{name} {axis}"))
            frequencies += list(tested.frequency or ())
    if not farthest[1]:
        return _Part(
            name="form of the model",
            grade=1,
            text="no isolator file says which cycles its laws come from, and no test of this assembly is known",
        )
    ratio, where = farthest
    texts = [
        f"amplitude {number(ratio, digits=2)} times the largest tested, at {where}",
        f"direction: no test along {listed(sorted(untested))}" if untested else "direction: every axis tested",
    ]
    if frequencies and math.isfinite(slowest):
        span = f"{number(min(frequencies), digits=2)} to {number(max(frequencies), digits=2)} Hz"
        texts.append(f"frequency: tested at {span}, the slowest mode is at {number(1.0 / slowest, digits=2)} Hz")
    texts.append("mass: no test of the whole assembly")
    return _Part(name="form of the model", grade=3 if ratio <= 1.0 and not untested else 2, text="; ".join(texts))


def _isolator_part(system: System) -> _Part:
    """Grade the isolators by the weakest provenance among their figures; its effect on peaks is that of stated scatter."""
    devices = {mount.isolator.name: mount.isolator for mount in system.mounts.values()}
    if not devices:
        return _Part(name="isolator data", grade=4, text="there are no isolators")
    kinds: list[str] = sorted({device.provenance.kind for device in devices.values()}, key=_PROVENANCE_GRADES.__getitem__)
    assumed = sum(len(device.provenance.assumed) for device in devices.values())
    scatter = [_scatter(device) for device in devices.values() if device.spread is not None]
    grade = _PROVENANCE_GRADES[kinds[0]] + (len(scatter) == len(devices) and kinds[0] == "identified")
    text = f"{several(len(devices), 'isolator')}: {listed(kinds)}"
    text += f"; {several(assumed, 'value')} assumed" if assumed else ""
    if not scatter:
        return _Part(name="isolator data", grade=grade, text=f"{text}; no file states a scatter")
    size = NORMAL * _STIFFNESS_EXPONENT * max(scatter)
    text += f"; stiffness scatters by {with_unit(max(scatter), '%', digits=2)} (one standard deviation)"
    return _Part(name="isolator data", grade=grade, text=text, size=size)


def _scatter(isolator: Isolator) -> float:
    """Compute the largest relative standard deviation of a secant stiffness under the stated scatter of parameters.

    Secants run from rest to half of each rated travel; on axes without a rating they are initial stiffnesses.
    """
    assert isolator.spread is not None
    ratios = [0.0]
    for axis, law in isolator.axes.items():
        rated = [getattr(isolator.limits.travel, rating) for rating in SIDES[axis]] if law and law.rate_independent else []
        ends = [0.5 * sign * travel for sign, travel in zip((-1.0, 1.0), rated, strict=False) if travel]
        for end in ends or [0.0]:
            if law is None or (stiffness := _secant(law, end)) <= 0.0:
                continue
            slopes = []
            for name in isolator.spread.parameters:
                law_axis, _, parameter = name.partition(".")
                value = law.parameter(parameter) if law_axis == axis else 0.0
                step = _STEP * value if isinstance(value, float) else 0.0
                moved = replace(law, **law.completed({parameter: value + step})) if step else law
                slopes.append((_secant(moved, end) - stiffness) / step if step else 0.0)
            variance = float(np.array(slopes) @ np.array(isolator.spread.covariance) @ np.array(slopes))
            ratios.append(math.sqrt(max(variance, 0.0)) / stiffness)
    return max(ratios)


def _secant(law: Law, deflection: float) -> float:
    """Compute the secant stiffness of a law from rest to a deflection, its initial stiffness at 0 [N/m]."""
    return float(law.trace([0.0, deflection]).force[-1]) / deflection if deflection else law.initial_stiffness
