"""The content of a run's report, from the answer to the versions."""

import math
from collections.abc import Sequence

from wirerope_mj.assessment.criteria import EXCEEDED, STRUCK
from wirerope_mj.assessment.criteria.sampled import samples_hold
from wirerope_mj.engine.response.histories import SENSITIVE
from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.views.display import several, with_unit
from wirerope_mj.views.report.contacts import contacts_section
from wirerope_mj.views.report.content import Block, Folded, Listing, Paragraph, ReportContent, Section
from wirerope_mj.views.report.deck import deck_section
from wirerope_mj.views.report.judged import answer, headline
from wirerope_mj.views.report.model import model_section
from wirerope_mj.views.report.motion import motion_section, mounts_section, response_section
from wirerope_mj.views.report.record import warnings_of
from wirerope_mj.views.report.rest import modes_section, statics_section
from wirerope_mj.views.report.run import FinishedRun
from wirerope_mj.views.report.worst import worst_instant
from wirerope_mj.views.verdict_table import full_table

_WORST = 10
"""Verdicts that are shown beside those that fail: the smallest margins. The others are folded away."""

_START = {
    "settled": "at rest in the equilibrium of the first loading",
    "relaxed": "at rest in the relaxed equilibrium, as after long vibration",
    "unloaded": "in the modelled geometry, with unloaded mounts",
}


def report_content(run: FinishedRun) -> ReportContent:
    """Return the report of a run: the verdict first, what it rests on after it."""
    question = " ".join(run.question.split()) and [
        " ".join(part.split()) for part in run.question.strip().split("\n\n")
    ]
    return ReportContent(
        title=run.title,
        facts=(
            ("Model", run.model),
            ("Excitation" if run.motion.loaded_sites else "Base motion", run.motion.description),
            ("Simulated", run.written),
            ("By", f"wirerope-mj {run.versions.get('wirerope-mj', 'unknown')}"),
        ),
        question=tuple(question or ("The scenario asks no question.",)),
        verdict=headline(run.verdicts),
        answer=(*_model_warnings(run), *warnings_of(run), *_untested(run), *worst_instant(run), *answer(run.verdicts)),
        sections=(
            model_section(run),
            statics_section(run),
            modes_section(run),
            motion_section(run),
            response_section(run),
            mounts_section(run),
            contacts_section(run),
            deck_section(run),
            _numerics_section(run),
            _annex(run),
        ),
    )


def _model_warnings(run: FinishedRun) -> list[Block]:
    if not run.model_warnings:
        return []
    return [Paragraph(text="Said of the model, perhaps not meant:", tone="unjudged"), Listing(items=run.model_warnings)]


def _untested(run: FinishedRun) -> list[Block]:
    return [Paragraph(text=run.untested, tone="unjudged")] if run.untested else []


def _numerics_section(run: FinishedRun) -> Section:
    """Return how the numbers were computed, and by what."""
    numerics = run.response.numerics
    rows = [
        ("simulated", f"{run.duration:g} s from {_START.get(run.initial, run.initial)}"),
        ("steps", f"{several(numerics.steps, 'step')} of at most {with_unit(numerics.timestep, 'ms', digits=4)}"),
        ("step limited by", numerics.limited_by or "not recorded"),
        ("estimated error", _error(run)),
        ("samples", f"{run.response.time.size}; {samples_hold(run.response)}; peaks are those of every step"),
        ("computed by", f"{numerics.computed_by}{f': {numerics.why}' if numerics.why else ''}"),
    ]
    rows += [(f"option {name}", str(value)) for name, value in run.options.items()]
    if run.versions:
        rows.append(("versions", ", ".join(f"{name} {version}" for name, version in run.versions.items())))
    return Section(title="Numerics, options and versions", blocks=(settings_table(rows),))


def settings_table(rows: Sequence[tuple[str, str]]) -> Table:
    """Return names and values of what a result was computed with."""
    columns = (Column("what", align="left"), Column("value", align="text"))
    return Table(title="How it was computed", columns=columns, rows=rows)


def _error(run: FinishedRun) -> str:
    numerics = run.response.numerics
    if not math.isfinite(numerics.error_estimate):
        return "not estimated: the step was given" if math.isnan(numerics.accuracy) else numerics.error_text
    if numerics.limited_by == SENSITIVE:
        return numerics.error_text
    error = f"{with_unit(numerics.error_estimate, '%', digits=2)} of the peaks, by halving the step before the run"
    asked = f"{with_unit(numerics.accuracy, '%', digits=2)} asked for"
    return f"{error}; {'above the ' if numerics.error_estimate > numerics.accuracy else ''}{asked}"


def _annex(run: FinishedRun) -> Section:
    table = full_table(run.verdicts)
    if table is None:
        return Section(title="All verdicts", blocks=())
    failed = sum(verdict.verdict in (EXCEEDED, STRUCK) for verdict in run.verdicts)
    return Section(title="All verdicts", blocks=(Folded(table=table, shown=failed + _WORST),))
