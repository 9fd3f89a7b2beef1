"""Verdicts of what a board shows: quick ones, exact ones, and what they differ by from those before."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from wirerope_mj.assessment.comparison import compare_runs
from wirerope_mj.assessment.correlation import correlate
from wirerope_mj.assessment.criteria import COMBINED
from wirerope_mj.assessment.criteria.summary import COMBINED_MEANS
from wirerope_mj.assessment.criteria.verdict import ACCELERATION, by_use, most_used
from wirerope_mj.content.blocks import Block, Chart, Statement
from wirerope_mj.content.comparison import accelerations_table, figures_table, travel_tables
from wirerope_mj.content.correlation import channel_panel
from wirerope_mj.content.first_sheet import brief_blocks, passage
from wirerope_mj.content.histories import TOTAL, overlay_histories
from wirerope_mj.content.job import JudgedCase, JudgedJob, brief, job_headline
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.modes import TIPS
from wirerope_mj.content.numbers import several
from wirerope_mj.content.selection import worst_names
from wirerope_mj.content.verdicts import criteria_blocks, headline, used_tone
from wirerope_mj.dynamics.modes import NaturalFrequencies
from wirerope_mj.engine.statics import Sag
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import Absent, SimulationError, WireRopeError
from wirerope_mj.foundation.tables import Column, Mark, Table, left
from wirerope_mj.motions import Measured
from wirerope_mj.runs.board.loaded import Loaded, judged_case
from wirerope_mj.runs.board.what_if import frequency_ratio
from wirerope_mj.runs.job_file import LoadCase
from wirerope_mj.runs.room import in_thin_air
from wirerope_mj.views.board.columns import column_html, fragment

_ROWS = 8  # of a table of differences: those that a reader compares; the report of a run has them all
_CHANNELS = 4  # measured channels whose curves are drawn
_MODES = 6  # that are shown: those of a rigid payload
_KEPT = 40  # judged cases of earlier positions, which undoing shows again
Told = tuple[Mapping[str, str], Entries]  # HTML by what it is of, and whether it is of a former position, if that changes


class Verdicts:
    """Judged load cases of the positions that a board has shown."""

    def __init__(self, tests: Sequence[Measured]) -> None:
        """Begin without any; `tests` are those with which runs are compared."""
        self.used: dict[str, float] = {}  # of the last verdict, by what is judged
        self.governing = ""  # load case of the last verdict
        self._tests = tests
        self._judged: dict[str, JudgedRun] = {}
        self._steps: dict[str, float] = {}  # of the last run of each case [s]
        self._shown: list[JudgedRun] = []  # runs of the case that governs: of the last verdict, and of the one before it

    def of(self, loaded: Loaded, *, exact: bool) -> Iterator[Told]:
        """Judge the load cases and yield what is known of them, or why they cannot be simulated."""
        try:
            yield from self._judgements(loaded, exact=exact)
        except (WireRopeError, ValueError) as error:
            self.used = {}
            failure = Statement("headline", f"No verdict: {error}", tone="exceeded")
            html = {"verdict": column_html([failure]), "statics": at_rest_html(loaded), "compared": ""}
            yield html, {"stale": False}

    def _judgements(self, loaded: Loaded, *, exact: bool) -> Iterator[Told]:
        """Judge the load cases, at first with the time steps of the last positions, and yield what is known of them."""
        keys = {case.name: _key(case, loaded) for case in loaded.job.cases}
        if any(key not in self._judged for key in keys.values()) and keys.keys() <= self._steps.keys():
            ratio = frequency_ratio(loaded.values)
            try:
                quick = [
                    self._judged.get(keys[case.name]) or judged_case(case, loaded, self._steps[case.name] / ratio)
                    for case in loaded.job.cases
                ]
            except SimulationError:
                pass  # these steps are too long for what stands there now
            else:
                yield self._told(loaded, quick, quick=True)
        yield {"statics": at_rest_html(loaded)}, {}
        if not exact:
            return
        runs = list[JudgedRun]()
        for case in loaded.job.cases:
            key = keys[case.name]
            if key not in self._judged:
                self._judged[key] = judged_case(case, loaded)
                self._judged = dict(list(self._judged.items())[-max(_KEPT, len(keys)) :])
            runs.append(self._judged[key])
            self._steps[case.name] = runs[-1].response.numerics.timestep / frequency_ratio(loaded.values)
            yield self._told(loaded, runs)
        used = [max((row.utilisation or 0.0 for row in run.verdicts), default=0.0) for run in runs]
        governing = runs[used.index(max(used))]
        self.governing = loaded.job.cases[used.index(max(used))].name
        if not self._shown or self._shown[-1] is not governing:
            self._shown = [*self._shown[-1:], governing]
        names = ["before", "now"][-len(self._shown) :]
        shown = dict(zip(names, self._shown, strict=True))
        yield {"compared": column_html(_compared(shown, self._tests))}, {}

    def _told(self, loaded: Loaded, runs: Sequence[JudgedRun], *, quick: bool = False) -> Told:
        """Return the verdict on the first load cases, as many as there are `runs`, and whether others are yet to come."""
        cases = tuple(
            JudgedCase(name=case.name, folder=case.folder, note=case.note, run=run)
            for case, run in zip(loaded.job.cases, runs, strict=False)
        )
        judged = JudgedJob(name=loaded.job.name, question="", cases=cases, report=(), document=None, written="")
        self.used = {name: row.utilisation or 0.0 for name, row in by_use(row for run in runs for row in run.verdicts).items()}
        remaining, of_cases = len(loaded.job.cases) - len(cases), cases if len(cases) > 1 else ()
        passages = {case.name: f"{case.name}\n{said.text}" for case in of_cases if (said := passage(case.run))}
        combined = any(row.criterion == COMBINED and row.utilisation is not None for run in runs for row in run.verdicts)
        blocks = [
            replace(
                block, note=COMBINED_MEANS if combined else "",
                rows=[(passages.get(str(name), name), *rest) for name, *rest in block.rows],
            ) if isinstance(block, Table) and block.id == "criteria" else block
            for block in (brief(judged) if of_cases else brief_blocks(runs[0]))
        ]  # fmt: skip
        bars = next((number for number, block in enumerate(blocks, start=1) if isinstance(block, Table)), 0)
        html = fragment(
            "right.html.jinja", said=job_headline(judged.verdicts) if of_cases else headline(runs[0].verdicts),
            what_if=", ".join(f"{slider.label} {slider.text(value)}" for slider, value in loaded.moved), quick=quick,
            more=several(remaining, "load case") if remaining else "",
            bars=column_html(blocks[:bars]), blocks=column_html(blocks[bars:]),
            cases=[
                (case.name, headline(case.run.verdicts), column_html(criteria_blocks(case.run.verdicts))) for case in of_cases
            ],
        )  # fmt: skip
        return {"verdict": html}, {"stale": bool(remaining)}


def _compared(runs: Mapping[str, JudgedRun], tests: Sequence[Measured]) -> Iterator[Block]:
    """Yield tables and curves that compare the last of `runs` with the run before it, if any, and with measured tests."""
    name, now = list(runs.items())[-1]
    correlations = [correlate(now.response, test) for test in tests]
    channels = [channel for test in correlations for channel in test.responses][:_CHANNELS]
    panels = [replace(panel, title=f"{panel.title} {panel.ylabel}") for panel in (channel_panel(c, name) for c in channels)]
    if len(runs) > 1:
        comparison = compare_runs(
            {name: run.response for name, run in runs.items()}, verdicts={name: run.verdicts for name, run in runs.items()}
        )
        for table in (figures_table(comparison), accelerations_table(comparison), *travel_tables(comparison)):
            yield replace(table, shown=min(_ROWS, len(table.rows)))
        # the most critical mount along its governing axis, and the most critical acceleration, or else the largest
        worst = most_used(row for row in now.verdicts if row.criterion.kind == ACCELERATION)
        parts = [worst.subject] if worst else worst_names(now.response)[:1]
        along = (worst.criterion.axis if worst else "") or TOTAL
        drawn = overlay_histories(comparison, now.selection)
        keys = [("deflection", *now.selection.axes[:1], now.selection.governing or "")]
        keys += [("acceleration", along, kind, part) for kind in ("body", "point") for part in parts]
        panels += [drawn[key] for key in keys if key in drawn]
    if correlations:
        yield Statement("tests", items=tuple(f"{test.name}: {test.statement}" for test in correlations))
    if panels:
        yield Chart(
            id="compared", rows=[[panel] for panel in panels], height=150.0, caption="Now, before, and as measured.",
            alt="Histories now, before, and as measured.",
        )  # fmt: skip


def _key(case: LoadCase, loaded: Loaded) -> str:
    """Write all that the result of a case depends on as a key."""
    scenario, texts = case.scenario, loaded.texts
    parts = {
        "tables": {kind: text for kind, text in texts.items() if kind != "job"}, "model": str(scenario.model),
        "motion": scenario.motion.to_dict(), "simulate": dict(scenario.simulate), "limits": repr(scenario.limits),
        "judged": scenario.combined_travel, "isolators": repr(scenario.isolators),
        "sliders": {each.key: value for each, value in loaded.moved},
    }  # fmt: skip
    return json.dumps(parts, sort_keys=True, default=str)


def at_rest_html(shown: Loaded) -> str:
    """Write as HTML the mounts' loads at rest, the natural frequencies, and which mounts stand far from the equipment."""
    blocks = [Statement("doubts", items=tuple(in_thin_air(shown.system, shown.layout)), tone="near")]
    return column_html([*blocks, *_at_rest(shown.sag, shown.frequencies)])


def _at_rest(sag: Sag | Absent, known: NaturalFrequencies | Absent) -> Iterator[Block]:
    """Yield the tables of the mounts' loads at rest and of the natural frequencies, or why there is no equilibrium."""
    if isinstance(sag, Absent):
        yield Statement("statics", f"At rest: {sag.reason}", tone="exceeded")
    else:
        rows = [
            (name, -float(mount.deflection[2]) + 0.0, mount.carries, Mark(mount.utilisation, used_tone(mount.utilisation)))
            for name, mount in sag.listed.items()
        ]
        used = [mount.utilisation for mount in sag.mounts.values() if mount.utilisation is not None]
        figures = (("compressed", "mm", "z.1f"), ("carries", "kN", "z.3f"), ("of rated", "%", "z.0f"))
        columns = [*left("mount"), *(Column(*figure) for figure in figures)]
        title = "At rest" + (f": up to {100.0 * max(used):.0f} % of the rated static load" if used else "")
        yield Table("at-rest", title, columns, rows, shown=4)
    if not isinstance(known, Absent):  # as a rule for the same reason
        yield Table(
            "modes", "Natural frequencies, small amplitude", [Column("frequency", "Hz", "z.2f"), Column("shape", align="text")],
            [
                (TIPS if frequency != frequency else float(frequency), shape)
                for frequency, shape in zip(known.frequencies[:_MODES], known.descriptions, strict=False)
            ],
        )  # fmt: skip
