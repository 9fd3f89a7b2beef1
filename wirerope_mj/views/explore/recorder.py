"""A run as the page shows it, and recordings of the last two runs, written by a process of its own beside simulations."""

import os
import signal
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory

from wirerope_mj.content.judged_run import RunResult


@dataclass(frozen=True, kw_only=True)
class ShownRun(RunResult):
    """A run with the slider values that it was simulated for, and how it was simulated."""

    number: int  # counted from 1 in the order in which runs were shown
    values: Mapping[str, float]  # of the sliders, by key
    changes: Mapping[str, str]  # what differs from the scenario, as text by the slider's label
    motion: str
    seconds: float  # how long simulating and judging took [s]
    exact: bool  # True if the step was chosen for the scenario's accuracy, False if it is that of the first run
    passing: bool  # True if a slider was still moving: the next run replaces this one
    warnings: tuple[str, ...]  # that the simulation gave

    @property
    def name(self) -> str:
        """Name of the run on the page and in the recording."""
        return f"run {self.number}"


class Recorder:
    """Writes recordings in a process of its own, which `close` ends."""

    def __init__(self) -> None:
        # Not forked: this process has threads, and rerun and Numba have more of them.
        self._pool = ProcessPoolExecutor(1, mp_context=get_context("spawn"), initializer=_ignore_interrupts)
        before = os.environ.get("PYTHONSAFEPATH", "")
        os.environ["PYTHONSAFEPATH"] = "1"  # it would look for modules in the current folder, which may be anybody's
        try:
            self._pool.submit(_import_writer)  # starts the process, whose imports take as long as a recording
        finally:
            os.environ["PYTHONSAFEPATH"] = before  # empty is as not set

    def recording(self, runs: Sequence[ShownRun], title: str) -> bytes:
        """Write the recording of one run, or of two runs over each other, the first as reference, and return its bytes."""
        with TemporaryDirectory(prefix="wirerope-explore-") as folder:  # here: it goes with this process, if not before
            return self._pool.submit(_recording, tuple(runs), title, Path(folder) / "run.rrd").result()

    def close(self) -> None:
        """End the process after its current recording."""
        self._pool.shutdown(wait=False, cancel_futures=True)


def _ignore_interrupts() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the command, which ends this process


def _import_writer() -> None:
    import wirerope_mj.views.recording.record  # noqa: F401


def _recording(runs: tuple[ShownRun, ...], title: str, target: Path) -> bytes:
    from wirerope_mj.views.recording.drawn_runs import several_runs
    from wirerope_mj.views.recording.record import record_run, record_runs

    if len(runs) == 1:
        record_run(runs[0], target, title=title)
    else:
        responses = {run.name: run.response for run in runs}
        names = dict.fromkeys(name for run in runs for name in run.changes)
        inputs = {run.name: {name: run.changes.get(name, "as in the scenario") for name in names} for run in runs}
        verdicts = {run.name: run.verdicts for run in runs}
        record_runs(several_runs(responses, "start", verdicts), target, inputs=inputs)
    return target.read_bytes()
