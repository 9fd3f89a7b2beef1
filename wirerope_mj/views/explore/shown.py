"""A run as the page shows it."""

from collections.abc import Mapping
from dataclasses import dataclass

from wirerope_mj.content.judged_run import RunResult


@dataclass(frozen=True, kw_only=True)
class ShownRun(RunResult):
    """A run, what made it, and what came out."""

    number: int  # counted from 1 in the order in which runs were shown
    values: Mapping[str, float]  # of the sliders, by key
    changes: Mapping[str, str]  # what differs from the scenario, as text by the slider's label
    motion: str
    seconds: float  # how long simulating and judging took [s]
    exact: bool  # True if the step was chosen for the scenario's accuracy, False if it is that of the first run
    passing: bool  # True if a slider was on its way: the next run takes its place
    warnings: tuple[str, ...]  # that the simulation gave

    @property
    def name(self) -> str:
        """What the page and the recording call it."""
        return f"run {self.number}"
