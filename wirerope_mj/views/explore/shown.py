"""A run as the page shows it."""

from collections.abc import Mapping
from dataclasses import dataclass

from wirerope_mj.content.judged_run import RunResult


@dataclass(frozen=True, kw_only=True)
class ShownRun(RunResult):
    """A run, what made it, and what came out.

    Attributes:
        number: counted from 1 in the order in which runs were shown.
        values: of the sliders, by key.
        changes: what differs from the scenario, as text by the slider's label.
        motion: description of the base motion.
        seconds: how long simulating and judging took [s].
        exact: True if the step was chosen for the scenario's accuracy, False if it is that of the first run.
        passing: True if a slider was on its way: the next run takes its place.
        warnings: that the simulation gave.
    """

    number: int
    values: Mapping[str, float]
    changes: Mapping[str, str]
    motion: str
    seconds: float
    exact: bool
    passing: bool
    warnings: tuple[str, ...]

    @property
    def name(self) -> str:
        """What the page and the recording call it."""
        return f"run {self.number}"
