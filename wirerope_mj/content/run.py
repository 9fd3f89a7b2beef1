"""The content of a run."""

import math
from collections.abc import Callable, Iterable, Iterator
from functools import partial

from wirerope_mj.assessment.criteria.sampled import samples_hold
from wirerope_mj.content.base import base_blocks, warnings_of
from wirerope_mj.content.blocks import Block, Content, Depth, Section, Statement
from wirerope_mj.content.contacts import contact_blocks, contact_history_blocks
from wirerope_mj.content.credibility import credibility_blocks
from wirerope_mj.content.decks import deck_blocks, decks_blocks
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.model import model_blocks
from wirerope_mj.content.modes import run_modes_blocks
from wirerope_mj.content.mounts import mount_blocks, mount_history_blocks
from wirerope_mj.content.numbers import paragraphs, several, with_unit
from wirerope_mj.content.payload import acceleration_blocks, payload_blocks
from wirerope_mj.content.statics import run_statics_blocks
from wirerope_mj.content.verdicts import answer_blocks, full_table, grounds_blocks, headline
from wirerope_mj.content.worst import worst_instant
from wirerope_mj.engine.response import Numerics
from wirerope_mj.engine.response.histories import SENSITIVE
from wirerope_mj.foundation.tables import Column, Table

START = {
    "settled": "at rest in the equilibrium of the first loading",
    "relaxed": "at rest in the relaxed equilibrium, as after long vibration",
    "unloaded": "in the modelled geometry, with unloaded mounts",
}


def run_content(run: JudgedRun) -> Content:
    """Compose what a run says: the verdict first, what it rests on after it."""
    versions = run.inputs.get("versions", {})
    return Content(
        title=run.title,
        facts=(
            ("Model", run.model_file),
            ("Excitation" if run.motion.loaded_sites else "Base motion", run.acting),
            ("Simulated", run.written),
            ("By", f"wirerope-mj {versions.get('wirerope-mj', 'unknown')}"),
        ),
        question=tuple(paragraphs(str(run.inputs.get("question", "")))) or ("The scenario asks no question.",),
        verdict=headline(run.verdicts),
        sections=(
            _section(run, "warnings", "", _warnings, "headline"),
            _section(run, "answer", "", answer_blocks, "headline"),
            _section(run, "grounds", "", lambda judged: (worst_instant(judged), *grounds_blocks(judged))),
            _section(run, "accelerations", "Peak accelerations", acceleration_blocks, "summary"),
            _section(run, "mounts", "Peaks of the mounts", mount_blocks, "summary"),
            _section(run, "contacts", "Stops and contacts", contact_blocks, "summary"),
            _section(run, "model", "Model and mounts", model_blocks),
            _section(run, "statics", "At rest under gravity", run_statics_blocks),
            _section(run, "modes", "Modes", run_modes_blocks),
            _section(run, "base", "Base motion", base_blocks),
            _section(run, "payload", "What reaches the payload", payload_blocks),
            _section(run, "mounts-in-motion", "Mounts in motion", mount_history_blocks),
            _section(run, "contact-histories", "Stops and contacts over time", contact_history_blocks),
            _section(run, "decks", "On a deck that bends", decks_blocks),
            _section(run, "deck", "Loads on the deck", deck_blocks),
            _section(run, "credibility", "How far this can be relied on", credibility_blocks),
            _section(run, "numerics", "Numerics, options and versions", _numerics),
            _section(run, "verdicts", "All verdicts", lambda run: [full_table(run.verdicts)]),
        ),
    )


def _section(
    run: JudgedRun, name: str, title: str, blocks: Callable[[JudgedRun], Iterable[Block | None]], depth: Depth = "full"
) -> Section:
    return Section(name, title, partial(blocks, run), depth)


def _warnings(run: JudgedRun) -> Iterator[Block | None]:
    for number, warning in enumerate(run.model_warnings, start=1):
        yield Statement(id=f"model-warning-{number}", text=f"warning: {warning}", tone="unjudged")
    yield warnings_of(run)


def numerics_statement(numerics: Numerics) -> Statement:
    """Return how the numbers were computed, in one sentence."""
    limit = f", limited by {numerics.limited_by}" if numerics.limited_by else ""
    steps = f"{several(numerics.steps, 'step')} of at most {with_unit(numerics.timestep, 'ms', digits=4)}{limit}"
    return Statement(
        id="numerics", text=f"{steps}, computed by {numerics.computed_by}, {numerics.error_text}", tone="quiet",
        values={"timestep_s": numerics.timestep, "steps": float(numerics.steps), "error": numerics.error_estimate},
    )  # fmt: skip


def _numerics(run: JudgedRun) -> Iterator[Block]:
    """Yield how the numbers were computed, and by what."""
    numerics, arguments = run.response.numerics, run.inputs.get("simulate", {})
    initial, versions = str(arguments.get("initial", "settled")), run.inputs.get("versions", {})
    rows = [
        ("simulated", f"{arguments.get('duration', run.response.time[-1]):g} s from {START.get(initial, initial)}"),
        ("steps", f"{several(numerics.steps, 'step')} of at most {with_unit(numerics.timestep, 'ms', digits=4)}"),
        ("step limited by", numerics.limited_by or "not recorded"),
        ("estimated error", _error(numerics)),
        ("samples", f"{run.response.time.size}; {samples_hold(run.response)}; peaks are those of every step"),
        ("computed by", f"{numerics.computed_by}{f': {numerics.why}' if numerics.why else ''}"),
    ]
    rows += [(f"option {name}", str(value)) for name, value in run.inputs.get("options", {}).items()]
    if versions:
        rows.append(("versions", ", ".join(f"{name} {version}" for name, version in versions.items())))
    columns = (Column("what", align="left"), Column("value", align="text"))
    yield Table(id="settings", title="How it was computed", columns=columns, rows=rows)


def _error(numerics: Numerics) -> str:
    if not math.isfinite(numerics.error_estimate):
        return "not estimated: the step was given" if math.isnan(numerics.accuracy) else numerics.error_text
    if numerics.limited_by == SENSITIVE:
        return numerics.error_text
    error = f"{with_unit(numerics.error_estimate, '%', digits=2)} of the peaks, by halving the step"
    if math.isnan(numerics.accuracy):
        return f"{error} that was given"
    asked = f"{with_unit(numerics.accuracy, '%', digits=2)} asked for"
    return f"{error}; {'above the ' if numerics.error_estimate > numerics.accuracy else ''}{asked}"
