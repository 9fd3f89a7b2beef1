"""A part in the places of a model's mounts: what it uses of every limit under each load case."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from wirerope_mj.assessment.criteria.criterion import ACCELERATION, COMBINED, RATTLE_SPACE, STATIC_LOAD, TRAVEL
from wirerope_mj.engine.system import System
from wirerope_mj.mounts.isolator import Isolator

# Measures that are utilisations of limits, and the criteria that they stand for.
CRITERIA = {
    "static_load": STATIC_LOAD, "travel": TRAVEL, "combined_travel": str(COMBINED), "fragility": ACCELERATION,
    "clearance": RATTLE_SPACE,
}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class TriedPart:
    """A part in the places of a model's mounts."""

    name: str  # of the part
    isolator: Isolator | None = None  # the part; None if it has none
    system: System | None = field(default=None, repr=False)  # the model on it; None without an isolator
    placement: str = ""  # how many mounts there are and where, as it was asked for
    mounts: int = 0  # number of mounts that carry the part
    # by the load case, those of `wirerope_mj.studies.measures`; of cases that were computed
    measures: Mapping[str, Mapping[str, float]] = field(default_factory=dict, repr=False)
    reason: str = ""  # why it was not computed, "" if it was

    def used(self, measure: str) -> tuple[float, str]:
        """Return the largest utilisation of a criterion over the load cases [-], NaN if it is not judged, and the case."""
        known = {case: own[measure] for case, own in self.measures.items() if not math.isnan(own[measure])}
        worst = max(known, key=lambda case: known[case], default="")
        return known.get(worst, math.nan), worst

    @property
    def governing(self) -> tuple[float, str, str]:
        """Utilisation, criterion and load case that are the most critical; NaN and "" if nothing is judged."""
        judged = [(*self.used(measure), criterion) for measure, criterion in CRITERIA.items()]
        value, case, criterion = max(judged, key=lambda one: -1.0 if math.isnan(one[0]) else one[0])
        return (value, "", "") if math.isnan(value) else (value, criterion, case)

    @property
    def meets(self) -> bool:
        """Whether everything that is judged is within its limits."""
        return not self.reason and not self.governing[0] > 1.0

    @property
    def acceleration(self) -> float:
        """Largest acceleration of the payload's bodies and points over the load cases [m/s^2]."""
        return self._largest("acceleration")

    @property
    def displacement(self) -> float:
        """Largest displacement of a point relative to the base over the load cases [m]; NaN without points."""
        return self._largest("displacement/")

    def _largest(self, start: str) -> float:
        found = [value for own in self.measures.values() for name, value in own.items() if name.startswith(start)]
        return max((one for one in found if not math.isnan(one)), default=math.nan)
