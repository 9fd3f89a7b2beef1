"""A film of one run or two: the 400 ms about the worst instant in slow motion, as scenes and histories show them."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.assessment.criteria import EXCEEDED, Verdict
from wirerope_mj.assessment.criteria.ended import Used
from wirerope_mj.assessment.criteria.verdict import against_limit
from wirerope_mj.content.blocks import Panel, SceneView, Statement, with_room
from wirerope_mj.content.first_sheet import first_histories, passage
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.numbers import fixed
from wirerope_mj.content.scene_outline import USED_KEY, SceneMotion, critical_verdict, ring_around, scene_motion
from wirerope_mj.content.verdicts import headline
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.units import instant_text

LENGTH = 0.4  # of the run that is shown [s]
RATE, SLOWER = 25, 20.0  # frames a second; times that the film is slower: 8 s
PAUSE = RATE  # further frames at the worst instant: 1 s


@dataclass(frozen=True, kw_only=True)
class FilmedRun:
    """A run as a film shows it."""

    title: str
    verdict: Statement
    passage: str  # base motion and largest acceleration of the payload, in a sentence
    critical: Verdict | None  # most critical verdict that has an instant; None if nothing is judged
    motion: SceneMotion
    panels: Sequence[Panel]  # histories of the most critical acceleration and deflection
    time: Array  # of the samples [s], (n_t,)
    used: Sequence[Used]  # utilisation of limits at each of them

    def reached(self, instant: float) -> bool:
        """Tell whether the most critical value has been reached at an instant [s]."""
        return self.critical is not None and self.critical.time is not None and instant >= self.critical.time - 1e-9

    def view(self, instant: float) -> SceneView:
        """Show the scene at an instant [s], with a ring around the subject of the most critical verdict."""
        moved, row = self.motion.at(instant), self.critical
        return SceneView(
            scene=self.motion.scene, caption="", moved=moved, ring=ring_around(moved, row.subject) if row else None,
            exceeded=row is not None and row.verdict == EXCEEDED and self.reached(instant),
            used={entry.subject: float(np.interp(instant, self.time, entry.course)) for entry in self.used},
        )  # fmt: skip

    def instant_text(self, instant: float) -> str:
        """Write the instant [s], and once the most critical value has been reached, that value against its limit."""
        reached = f". Most critical: {against_limit(self.critical)}" if self.critical and self.reached(instant) else ""
        return f"t = {instant_text(instant)}{reached}"

    def values(self, instant: float) -> list[str]:
        """Write the value of the first curve of each panel at an instant [s]."""
        texts = []
        for panel in self.panels:
            curve, largest = panel.curves[0], max(map(abs, panel.ylim or (1.0, 1.0)))
            value = float(np.interp(instant, curve.x, curve.y))
            texts.append(f"{curve.name} {fixed(value, max(2 - math.floor(math.log10(largest)), 0))} {panel.unit}")
        return texts


@dataclass(frozen=True, kw_only=True)
class Film:
    """Runs beside each other over the same instants."""

    runs: tuple[FilmedRun, ...]
    instants: Array  # of the frames [s], (n,)
    worst: int  # number of the frame at which the film pauses
    caption: str


def film_of(runs: Mapping[str, JudgedRun], at: float | None = None) -> Film:
    """Choose the instants about the worst one of all runs, or about `at` [s], and what is shown of each run, by its name.

    RecordError if no instant is the worst, since nothing is judged over time, or if nothing moves; ValueError if a run has
    ended, or not begun, at the instant.
    """
    judged = {
        name: critical_verdict([row for row in run.verdicts if row.utilisation is not None]) for name, run in runs.items()
    }
    for name, row in judged.items():
        if row is None and at is None:
            raise RecordError(
                f"{name}: nothing of this run is judged over time, so that it has no worst instant. State a limit when it is "
                'run, --limit "acceleration/NAME = 10 g", or say an instant, --at "120 ms".'
            )
    times = [run.response.time for run in runs.values()]
    begin, end = max(float(time[0]) for time in times), min(float(time[-1]) for time in times)
    worst = max((row for row in judged.values() if row is not None), key=lambda row: row.utilisation or 0.0, default=None)
    instant = at if at is not None else (worst.time if worst is not None else None) or 0.0
    if not begin <= instant <= end:
        raise ValueError(
            f'the film would be about {instant_text(instant)}, and the runs have {begin:g} to {end:g} s in common. '
            "Run them equally long, or say an instant in that, --at."
        )  # fmt: skip
    begin = max(begin, min(instant - 0.5 * LENGTH, end - LENGTH))
    end, step = min(end, begin + LENGTH), 1.0 / (RATE * SLOWER)
    before = int((instant - begin) / step + 1e-9)
    instants = instant + step * np.arange(-before, int((end - instant) / step + 1e-9) + 1)
    filmed = [_filmed(name, run, judged[name], (begin, end), several=len(runs) > 1) for name, run in runs.items()]
    factor = min(run.motion.factor for run in filmed)
    # panels that show the same quantity have the same range, in all runs
    shown: dict[str, list[Array]] = {}
    for panel in (panel for run in filmed for panel in run.panels):
        rows = [(curve.x > begin) & (curve.x < end) for curve in panel.curves]
        ends = [np.interp((begin, end), curve.x, curve.y) for curve in panel.curves]
        inside = [np.append(both, curve.y[row]) for both, curve, row in zip(ends, panel.curves, rows, strict=True)]
        least = 0.5 * _LEAST_RANGE * np.abs(inside[0]).max() * np.array([-1.0, 1.0]) + inside[0].mean()
        others = np.array([*(level for _, level in panel.limits), *(y for _, y, *_ in panel.notes)])
        shown.setdefault(panel.title, []).extend([*inside, others, least])
    panels = [[replace(panel, ylim=with_room(np.concatenate(shown[panel.title]))) for panel in run.panels] for run in filmed]
    scale = f"{factor:g} times as large" if factor > 1.0 else "in true scale"
    both = zip(filmed, panels, strict=True)
    return Film(
        runs=tuple(replace(run, motion=replace(run.motion, factor=factor), panels=each) for run, each in both),
        instants=np.asarray(instants, dtype=np.float64), worst=before,
        caption=f"{SLOWER:g} times slower. Everything as it stands from the base, displacements {scale}; dashed: the "
        f"modelled, unloaded geometry. {USED_KEY}",
    )  # fmt: skip


def _filmed(name: str, run: JudgedRun, row: Verdict | None, window: tuple[float, float], *, several: bool) -> FilmedRun:
    """Collect what a film shows of a run over an interval [s]: the moving scene, histories, verdict; RecordError if still."""
    response = run.response
    rows = slice(max(int(np.searchsorted(response.time, window[0])) - 1, 0), int(np.searchsorted(response.time, window[1])) + 2)
    motion = scene_motion(response, rows)
    if motion is None or not motion.moves:
        raise RecordError(
            f"{name}: nothing that is drawn moves from {instant_text(window[0])} to {instant_text(window[1])}: the load is "
            "still. Film a run whose base moves, or say another instant, --at."
        )
    into, title = passage(run), f"{run.title} ({name})" if several else run.title
    return FilmedRun(
        title=title, verdict=headline(run.verdicts), passage=into.text if into else "", critical=row,
        motion=motion, panels=first_histories(run, window), time=response.time, used=run.selection.used,
    )  # fmt: skip


_LEAST_RANGE = 0.05  # of a panel, as a fraction of its largest value: what hardly changes is not blown up
