"""Runs as a recording draws them, alone or several over each other: colours, frames, panels, texts, shared selection."""

import re
import tomllib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np

from wirerope_mj.assessment.comparison import Align, ComparedRun, Comparison, Subject, compare_runs, subjects_of
from wirerope_mj.assessment.correlation import Correlation
from wirerope_mj.assessment.criteria import Verdict
from wirerope_mj.assessment.criteria.ended import Used
from wirerope_mj.content.blocks import Block, Panel
from wirerope_mj.content.comparison import Inputs, comparison_content
from wirerope_mj.content.correlation import agreement
from wirerope_mj.content.first_sheet import passage
from wirerope_mj.content.histories import TOTAL, USED, Histories, difference_key, differing, overlay_histories, run_histories
from wirerope_mj.content.judged_run import JudgedRun, RunResult
from wirerope_mj.content.modes import run_modes_blocks
from wirerope_mj.content.mounts import contact_blocks, mount_blocks
from wirerope_mj.content.random_vibration import random_blocks
from wirerope_mj.content.required_spectra import required_spectrum_blocks
from wirerope_mj.content.run import acceleration_blocks, numerics_statement
from wirerope_mj.content.selection import Selection, main_direction, select
from wirerope_mj.content.verdicts import answer_blocks, full_table, headline, open_statement
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.plain_text import markdown, plain_lines
from wirerope_mj.foundation.tables import Table
from wirerope_mj.views.colours import ARROW, RUNS, Color
from wirerope_mj.views.markdown import markdown_blocks
from wirerope_mj.views.recording.paths import AXES, root_of
from wirerope_mj.views.recording.shapes import Frame, frames_of

MOST_MOUNTS = 4  # mounts of an axis that are drawn for several runs: each has its own plot


@dataclass(frozen=True, kw_only=True)
class DrawnRun(ComparedRun):
    """A run as it is drawn; its name is "" if it is alone."""

    color: Color  # of its lines, mounts and ghosts among several runs
    selection: Selection  # that a recording of the run alone shows; among several runs mounts have the run's colour
    frames: dict[str, Frame]  # of its bodies

    @property
    def root(self) -> str:
        return root_of(self.name)

    @property
    def names(self) -> tuple[str, ...]:
        return (self.name,) if self.name else ()


@dataclass(frozen=True, kw_only=True)
class Text:
    """A text of a recording: its entity, its name, and its place: "banner", "below", or the name of a tab."""

    path: tuple[str, ...]
    name: str
    place: str
    text: str


@dataclass(frozen=True, kw_only=True)
class Drawn:
    """The content of a recording of a run alone, or of several runs over each other."""

    runs: tuple[DrawnRun, ...]  # as they are drawn
    comparison: Comparison  # of the runs with the first; of a run alone, its parts
    # selection that is shown: of one run its own; of several the mounts that two have, those shown in
    # `ranked`, `utilisations` the largest of any run
    shared: Selection
    panels: Histories  # over time
    over_frequency: Panel | None = None  # panel over frequency; None without one
    texts: tuple[Text, ...] = field(default=())
    answer: tuple[str, str] = ("", "")  # in a word, for the banner, and its tone
    listed: bool = False  # whether its file holds several recordings: the panel that lists them is then open

    @property
    def alone(self) -> DrawnRun | None:
        """The only run; None if there are several."""
        return self.runs[0] if not self.runs[0].name else None

    @property
    def overview(self) -> tuple[tuple[str, ...], ...]:
        """Names of the panels in the first tab of the viewer.

        Of a run alone utilisation, governing deflection and acceleration; only the first where spectra stand below it. Of
        several the worst mount, the most accelerated part, the base, and the largest differences.
        """
        if self.alone is not None:
            keys: list[tuple[str, ...]] = [(USED,)] if self.shared.used else []
            keys += [("deflection", axis) for axis in self.shared.axes[:1]]
            keys.append(("acceleration", main_direction(self.alone.response)))
            return tuple(keys if self.over_frequency is None else keys[:1])
        mount = self.shared.governing or ""
        axis = next((axis for axis in self.shared.axes if ("deflection", axis, mount) in self.panels), "")
        keys = [(quantity, axis, mount) for quantity in ("deflection", "force")]
        parts = [key for key in self.panels if key[:2] == ("acceleration", TOTAL)]
        keys += [key for key in parts if key[2] != "base"][:1] + [key for key in parts if key[2] == "base"][:1]
        keys += [difference_key(subject) for subject in differing(self.comparison)]
        return tuple(key for key in keys if key in self.panels)

    def having(self, subject: Subject) -> list[DrawnRun]:
        return [run for run in self.runs if subject in subjects_of(run.response)]


def one_run(run: RunResult, over_frequency: Panel | None = None) -> Drawn:
    """Compose the recording of a run alone."""
    response, selection = run.response, run.selection
    comparison = compare_runs({"": response}, verdicts={"": run.verdicts}) if subjects_of(response) else None
    drawn = DrawnRun(
        name="", response=response, moved=0.0, verdicts=run.verdicts, color=ARROW, selection=selection,
        frames=frames_of(response),
    )  # fmt: skip
    empty = Comparison(runs=(drawn,), components=(), mounts=(), alone={}, differences=())
    return Drawn(
        runs=(drawn,), comparison=comparison or empty, shared=selection, panels=run_histories(response, selection),
        over_frequency=over_frequency,
    )  # fmt: skip


def several_runs(
    responses: Mapping[str, Response], align: Align, verdicts: Mapping[str, Sequence[Verdict]] | None = None
) -> Drawn:
    """Compose the recording of runs over each other; `verdicts` by run, those of `judge` where none are given.

    ValueError if there are too few or too many, or `align` is unknown; RecordError if they share nothing, or a run has no
    shock to align.
    """
    if not 2 <= len(responses) <= len(RUNS):
        raise ValueError(f"`responses` must be two to {len(RUNS)}, got {len(responses)}.")
    comparison = compare_runs(responses, align, verdicts)
    runs = tuple(
        DrawnRun(
            **vars(run), color=color, selection=replace(select(run.response, run.verdicts), run_color=color),
            frames=frames_of(run.response),
        )
        for run, color in zip(comparison.runs, RUNS, strict=False)
    )  # fmt: skip
    shared = shared_selection(runs, comparison.mounts)
    worst = tuple(used for used in shared.used if used.subject in shared.mounts)[:1]
    shared = replace(shared, used=worst, bodies=(), points=(), kinds={})
    return Drawn(runs=runs, comparison=comparison, shared=shared, panels=overlay_histories(comparison, shared))


def shared_selection(runs: Sequence[DrawnRun], mounts: tuple[str, ...]) -> Selection:
    """Select the mounts of several runs, the worst mount of any run first, at most `MOST_MOUNTS` of an axis."""
    utilisations = np.full((len(mounts), 3), np.nan)
    travel = np.zeros((len(mounts), 3))
    acting = np.zeros((len(mounts), 3), dtype=bool)
    for row, name in enumerate(mounts):
        for run in runs:
            if name in run.selection.mounts:
                selection, peak = run.selection, run.response.peaks.mounts[name].deflection
                utilisations[row] = np.fmax(utilisations[row], selection.utilisations[selection.mounts.index(name)])
                travel[row] = np.maximum(travel[row], peak.maximum - peak.minimum)
                acting[row] |= [name in selection.ranked[axis] for axis in AXES]
    used: dict[str, Used] = {}
    for entry in sorted((entry for run in runs for entry in run.selection.used), key=lambda entry: -entry.largest):
        used.setdefault(entry.subject, entry)
    worst = next((name for name in used if name in mounts), "")
    ranked = {}
    for number, axis in enumerate(AXES):
        order = np.lexsort([-travel[:, number], -np.nan_to_num(utilisations[:, number])])
        names = [mounts[row] for row in order if acting[row, number]]
        ranked[axis] = tuple(sorted(names, key=lambda name: name != worst)[:MOST_MOUNTS])
    starts, ends = zip(*(run.selection.window for run in runs), strict=True)
    critical = max(runs, key=lambda run: max((entry.largest for entry in run.selection.used), default=0.0))
    return replace(
        runs[0].selection, window=(min(starts), max(ends)), utilisations=utilisations, mounts=mounts, ranked=ranked,
        used=tuple(used.values()), verdicts=critical.selection.verdicts,
    )  # fmt: skip


BANNER, BELOW = "banner", "below"


def run_texts(run: RunResult, *, title: str, scenario_text: str) -> tuple[Text, ...]:
    """Write verdict, scenario, peaks, all verdicts and the modes of a run; `scenario_text` is Markdown, or TOML, set as such.

    A run without its system has no modes.
    """
    peaks: list[Block | None] = [headline(run.verdicts), *answer_blocks(run)]
    peaks += [*acceleration_blocks(run), *mount_blocks(run), *contact_blocks(run)]
    peaks += [*random_blocks(run), *required_spectrum_blocks(run)] if isinstance(run, JudgedRun) else []
    body = scenario_text.strip()
    with suppress(tomllib.TOMLDecodeError):
        if tomllib.loads(scenario_text):  # a block of code, whose fence is longer than any row of backticks in it
            fence = "`" * max(max(map(len, re.findall("`+", body)), default=0) + 1, 3)
            body = f"{fence}toml\n{plain_lines(body)}\n{fence}"
    numerics = markdown(numerics_statement(run.response.numerics).text)
    scenario = [f"### {markdown(title or run.response.scene.name)}", body, f"*{numerics}*"]
    modes = markdown_blocks(run_modes_blocks(run)) if isinstance(run, JudgedRun) else ""
    named = f"{markdown(title)}: " if title else ""
    said = [passage(run) if isinstance(run, JudgedRun) else None, open_statement(run.verdicts)]
    below = " · ".join(markdown(statement.text) for statement in said if statement)
    return (
        Text(path=("verdict",), name="Verdict", place=BANNER, text=f"{named}**{markdown(run.headline)}**\\\n{below}"),
        Text(path=("scenario",), name="Scenario", place=BELOW, text="\n\n".join(filter(None, scenario))),
        Text(path=("peaks",), name="Peaks", place="Peaks", text=markdown_blocks(peaks)),
        Text(path=("verdicts",), name="Verdicts", place="Verdicts", text=markdown_blocks([full_table(run.verdicts)])),
        *([Text(path=("modes",), name="Modes", place="Modes", text=modes)] if modes else []),
    )


def test_texts(tests: Sequence[Correlation]) -> tuple[Text, ...]:
    return tuple(
        Text(
            path=("tests", test.name), name=test.name, place="Agreement",
            text=markdown_blocks([agreement(test), test.table, test.ratings]),
        )
        for test in tests
    )  # fmt: skip


def overlay_texts(
    comparison: Comparison, inputs: Inputs, tables: Sequence[Table], judged: Mapping[str, JudgedRun] | None = None
) -> tuple[Text, ...]:
    """Write texts beside runs laid over each other: which is better, what differs, peaks side by side, tables of the study."""
    content = comparison_content(comparison, inputs, judged)
    sections = {section.id: markdown_blocks(section.blocks) for section in content.sections}

    def joined(*names: str) -> str:
        return "\n\n".join(filter(None, (sections[name] for name in names)))

    study = [Text(path=("study",), name="Study", place="Study", text=markdown_blocks(tables))] if tables else []
    return (
        Text(path=("verdict",), name="Which is better", place=BANNER, text=f"**{markdown(content.verdict.text)}**"),
        Text(
            path=("differences",),
            name="What differs",
            place=BELOW,
            text=joined("differences", "headlines", "findings", "credibility"),
        ),
        Text(
            path=("peaks", "accelerations"), name="Accelerations", place="Peaks", text=joined("accelerations", "components")
        ),
        Text(
            path=("peaks", "mounts"), name="Mounts", place="Peaks", text=joined("travel", "mounts") or "There are no mounts.",
        ),
        Text(path=("peaks", "apart"), name="Farthest apart", place="Peaks", text=joined("apart")), *study,
    )  # fmt: skip
