"""Verdicts of what a board shows: quick ones, exact ones, and what they differ by from those before."""

import json
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime

from wirerope_mj.content.job import JudgedCase, JudgedJob
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import SimulationError, WireRopeError
from wirerope_mj.motions import Measured
from wirerope_mj.runs.board.loaded import Loaded, judged_case
from wirerope_mj.runs.board.room import in_thin_air
from wirerope_mj.runs.board.what_if import frequency_ratio
from wirerope_mj.runs.job_file import LoadCase
from wirerope_mj.views.board import columns

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
            html = {"verdict": columns.failure_html(str(error)), "statics": at_rest_html(loaded), "compared": ""}
            yield html, {"stale": False}

    def _judgements(self, loaded: Loaded, *, exact: bool) -> Iterator[Told]:
        """Judge the load cases, at first with the steps of the last positions, and yield what is known of them."""
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
        yield {"compared": columns.compared_html(dict(zip(names, self._shown, strict=True)), self._tests)}, {}

    def _told(self, loaded: Loaded, runs: Sequence[JudgedRun], *, quick: bool = False) -> Told:
        """Return the verdict of the first load cases."""
        job = loaded.job
        cases = [
            JudgedCase(name=case.name, folder=case.folder, note=case.note, run=run)
            for case, run in zip(job.cases, runs, strict=False)
        ]
        judged = JudgedJob(
            name=job.name, question=job.question, cases=tuple(cases), report=job.report, document=job.document,
            written=f"{datetime.now(UTC):%Y-%m-%d %H:%M} UTC",
        )  # fmt: skip
        self.used = {}
        for row in (row for run in runs for row in run.verdicts):
            self.used[row.subject] = max(row.utilisation or 0.0, self.used.get(row.subject, 0.0))
        left = len(job.cases) - len(cases)
        what_if = [f"{each.label} {each.text(value)}" for each, value in loaded.moved]
        html = columns.verdict_html(judged, left, what_if, quick=quick)
        return {"verdict": html}, {"stale": bool(left)}


def _key(case: LoadCase, loaded: Loaded) -> str:
    """Write all that the result of a case depends on."""
    scenario, texts = case.scenario, loaded.texts
    parts = {
        "tables": {kind: text for kind, text in texts.items() if kind != "job"}, "model": str(scenario.model),
        "motion": scenario.motion.to_dict(), "simulate": dict(scenario.simulate), "limits": repr(scenario.limits),
        "judged": scenario.combined_travel, "isolators": repr(scenario.isolators),
        "sliders": {each.key: value for each, value in loaded.moved},
    }  # fmt: skip
    return json.dumps(parts, sort_keys=True, default=str)


def at_rest_html(shown: Loaded) -> str:
    """Write loads at rest and natural frequencies, and which mounts stand in thin air."""
    return columns.statics_html(shown.sag, shown.frequencies, in_thin_air(shown.system, shown.layout))
