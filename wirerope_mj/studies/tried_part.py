"""A part of a catalogue in the places of a model's mounts: what it uses of every limit under every load case."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatchcase

from wirerope_mj.assessment.criteria.verdict import ACCELERATION, COMBINED, RATTLE_SPACE, SIGMA, STATIC_LOAD, TRAVEL
from wirerope_mj.engine.system import System
from wirerope_mj.mounts.isolator import Isolator

# Measures that are utilisations of limits, and the criteria that they stand for.
CRITERIA = {
    "static_load": STATIC_LOAD, "travel": TRAVEL, "combined_travel": str(COMBINED), "fragility": ACCELERATION,
    "clearance": RATTLE_SPACE, "sigma": SIGMA,
}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class TriedPart:
    """A catalogue part in place of a model's mounts, with the measures of its simulations."""

    name: str  # of the part
    isolator: Isolator | None = None  # the part; None if it has none
    system: System | None = field(default=None, repr=False)  # the model on it; None without an isolator
    placement: str = ""  # how many mounts there are and where, as it was asked for
    mounts: int = 0  # number of mounts that carry the part
    # by the load case, those of `wirerope_mj.studies.measures`; of cases that were computed
    measures: Mapping[str, Mapping[str, float]] = field(default_factory=dict, repr=False)
    reason: str = ""  # why it was not computed, "" if it was

    def used(self, measure: str) -> tuple[float, str]:
        """Return the largest utilisation by a criterion over the load cases [-], NaN if not judged, and its load case."""
        known = {case: own[measure] for case, own in self.measures.items() if not math.isnan(own[measure])}
        worst = max(known, key=lambda case: known[case], default="")
        return known.get(worst, math.nan), worst

    @property
    def governing(self) -> tuple[float, str, str]:
        """Utilisation, criterion and load case of the most critical verdict; NaN and "" if nothing is judged."""
        judged = [(*self.used(measure), criterion) for measure, criterion in CRITERIA.items()]
        value, case, criterion = max(judged, key=lambda candidate: -1.0 if math.isnan(candidate[0]) else candidate[0])
        return (value, "", "") if math.isnan(value) else (value, criterion, case)

    @property
    def meets(self) -> bool:
        """True if the part was computed and exceeds no limit."""
        return not self.reason and not self.governing[0] > 1.0

    @property
    def acceleration(self) -> float:
        """Largest acceleration of the payload's bodies and points over the load cases [m/s^2]."""
        return self.largest("acceleration*")

    @property
    def displacement(self) -> float:
        """Largest displacement of a point along x, y or z relative to the base over the load cases [m]; NaN without points."""
        return self.largest("displacement/*/*")

    def largest(self, pattern: str, case: str | None = None) -> float:
        """Find the largest of the measures whose names match a pattern, under all load cases or one; NaN if there is none."""
        cases = self.measures if case is None else {case: self.measures.get(case, {})}
        values = [value for row in cases.values() for name, value in row.items() if fnmatchcase(name, pattern)]
        return max((value for value in values if not math.isnan(value)), default=math.nan)
