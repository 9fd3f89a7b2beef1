"""A run as the page shows it."""

from collections.abc import Mapping
from dataclasses import dataclass

from wirerope_mj.assessment.criteria import EXCEEDED, NOT_JUDGED, STRUCK, WITHIN, Verdict, verdict_lines
from wirerope_mj.engine.response import Response


@dataclass(frozen=True, kw_only=True)
class ShownRun:
    """A run, what made it, and what came out.

    Attributes:
        number: counted from 1 in the order in which runs were shown.
        values: of the sliders, by key.
        changes: what differs from the scenario, as text by the slider's label.
        motion: description of the base motion.
        response: of the run.
        verdicts: on it.
        headline: the answer in one sentence.
        seconds: how long simulating and judging took [s].
        exact: True if the step was chosen for the scenario's accuracy, False if it is that of the first run.
        passing: True if a slider was on its way: the next run takes its place.
        warnings: that the simulation gave.
    """

    number: int
    values: Mapping[str, float]
    changes: Mapping[str, str]
    motion: str
    response: Response
    verdicts: tuple[Verdict, ...]
    headline: str
    seconds: float
    exact: bool
    passing: bool
    warnings: tuple[str, ...]

    @property
    def name(self) -> str:
        """What the page and the recording call it."""
        return f"run {self.number}"

    @property
    def tone(self) -> str:
        """Worst verdict among all: "exceeded", "struck", "within" or "not judged"."""
        present = {row.verdict for row in self.verdicts}
        return next((verdict for verdict in (EXCEEDED, STRUCK, WITHIN) if verdict in present), NOT_JUDGED)

    @property
    def lines(self) -> list[str]:
        """The verdicts in a few sentences."""
        return verdict_lines(self.response, self.verdicts)
