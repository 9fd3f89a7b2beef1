"""Parts in the places of a model's mounts under load cases, with steps that are halved until it is known what is judged."""

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from fnmatch import fnmatchcase

import numpy as np

from wirerope_mj.assessment.criteria.verdict import ACCELERATION, COMBINED, RATTLE_SPACE, STATIC_LOAD, TRAVEL
from wirerope_mj.engine.simulation import BatchFailure, BatchResult, simulate_batch
from wirerope_mj.engine.simulation.engines import unsupported_run
from wirerope_mj.engine.simulation.stability import slowest_period
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.lanes import WIDTH
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.studies.measures import measures, needs_samples, payload_bodies, payload_points

_LONGEST = 5e-4  # Step from which the halving begins [s]: a mode of 100 Hz has twenty of them in a period
LEVELS = 8  # steps that are tried, the last of them 4 microseconds
_PATIENCE = 4  # of them, after which a part whose run fails with each is given up
# Difference of two runs over the error of the finer: 3 at order 2, a little less at the order that is seen.
_FINER = 2.0
_CERTAIN = 5.0  # differences of two runs beyond a limit from which on it is exceeded for certain
_SWINGS = 6.0  # slowest periods after the motion: the largest peaks lie within them
_SAMPLES = 10.0  # ends of steps asked for [1/s]: peaks are those of every step, and fewer samples are faster
_RATE = 1000.0  # where samples judge what peaks do not [Hz]
_GREW = "a mount goes beyond where its law holds, or the motion grows without bound"
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
        return self.largest("acceleration*")

    @property
    def displacement(self) -> float:
        """Largest displacement of a point along x, y or z relative to the base over the load cases [m]; NaN without points."""
        return self.largest("displacement/*/*")

    def largest(self, pattern: str, case: str | None = None) -> float:
        """Find the largest of the measures of a pattern, under all load cases or one; NaN if there is none."""
        cases = self.measures if case is None else {case: self.measures.get(case, {})}
        found = [value for own in cases.values() for name, value in own.items() if fnmatchcase(name, pattern)]
        return max((one for one in found if not math.isnan(one)), default=math.nan)


class Race:
    """Parts under load cases, stepped side by side with one step after the other, each half the last one."""

    def __init__(self, runs: Mapping[str, TriedPart], cases: Mapping[str, BaseMotion], initial: str, accuracy: float) -> None:
        self._systems = {name: one.system for name, one in runs.items() if one.system is not None}
        self._periods = {name: slowest_period(one) for name, one in self._systems.items()}
        self._cases, self._initial, self._accuracy = cases, initial, accuracy
        self._left = [(case, name) for case in cases for name in sorted(self._systems, key=self._periods.__getitem__)]
        self.found: dict[str, dict[str, Mapping[str, float]]] = {name: {} for name in self._systems}
        self.reasons: dict[str, str] = {}

    def run(self, level: int) -> None:
        """Simulate what is left with the step of a level, and leave what is not known well enough yet."""
        groups = list(self._groups())
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            outcomes = list(pool.map(lambda group: self._batch(group[0], group[1], _LONGEST / 2**level), groups))
        left, beyond = [], set()
        for (case, names), results in zip(groups, outcomes, strict=True):
            for name, result in zip(names, results, strict=True):
                before, own = self.found[name].get(case), f"{case}: "
                if isinstance(result, BatchFailure):
                    self.reasons[name] = own + (_GREW if result.message.startswith("the kernel") else result.message)
                    left += [(case, name)] if before is None and level < _PATIENCE else []
                    continue
                if self.reasons.get(name, "").startswith(own):
                    del self.reasons[name]
                system = self._systems[name]
                self.found[name][case] = now = measures(system, result.peaks, result.initial_state, result.response)
                error = math.inf if before is None else _error(system, before, now)
                if now["static_load"] > 1.0 or (before is not None and _beyond(before, now)):
                    beyond.add(name)
                elif error > _FINER * self._accuracy:
                    left.append((case, name))
        for name in beyond:  # whatever failed of it at such steps
            self.reasons.pop(name, None)
        self._left = [(case, name) for case, name in left if name not in beyond]

    def _groups(self) -> Iterator[tuple[str, list[str]]]:
        """Yield load cases and parts of one layout and of like periods, as many as share lanes."""
        alike: dict[tuple[str, bytes], list[str]] = {}
        for case, name in self._left:
            alike.setdefault((case, self._systems[name].assembly.tables.layout.tobytes()), []).append(name)
        for (case, _), names in alike.items():
            yield from ((case, names[first : first + WIDTH]) for first in range(0, len(names), WIDTH))

    def _batch(self, case: str, names: Sequence[str], step: float) -> Sequence[BatchResult | BatchFailure]:
        systems, motion = [self._systems[name] for name in names], self._cases[case]
        samples = needs_samples(systems[0])
        kernel = not unsupported_run(systems[0], motion)
        return simulate_batch(
            systems, motion, duration=motion.end + _SWINGS * max(self._periods[name] for name in names), timestep=step,
            initial=self._initial, sample_rate=_RATE if samples else _SAMPLES, threads=1,
            engine="kernel" if kernel else "auto", responses=samples, judged=False,
        )  # fmt: skip


def _error(system: System, coarse: Mapping[str, float], fine: Mapping[str, float]) -> float:
    """Return the largest relative difference of what is judged of two runs."""
    judged = [*CRITERIA, *(f"acceleration/{name}" for name in (*payload_bodies(system), *payload_points(system)))]
    pairs = [(coarse[name], fine[name]) for name in judged if not math.isnan(fine[name])]
    sizes = np.maximum(np.abs(pairs).max(axis=1), 1e-12)
    return float((np.abs(np.subtract(*np.transpose(pairs))) / sizes).max())


def _beyond(coarse: Mapping[str, float], fine: Mapping[str, float]) -> bool:
    """Return whether a limit is exceeded for certain, whatever a finer step would say."""
    return any(fine[name] - 1.0 > _CERTAIN * abs(fine[name] - coarse[name]) for name in CRITERIA)
