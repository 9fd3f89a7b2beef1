"""Evolution of designs towards the Pareto front, and the result of a search: the table of all designs, and the front."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from wirerope_mj.engine.response.scene import Scene
from wirerope_mj.engine.simulation.recorder import scene_of
from wirerope_mj.foundation.arrays import Array, Booleans, Entries
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.ended import ended_early, why_early
from wirerope_mj.studies.engines.compute import DONE
from wirerope_mj.studies.inputs_file import read_inputs
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.measure import measure_of
from wirerope_mj.studies.stored_table import TABLE, StoredTable
from wirerope_mj.studies.vary import distributions
from wirerope_mj.studies.vary.quantity import acts

Design = Entries
# Value of a design that failed, for the optimiser: a number, because it adds them up, and worse than any that did not.
UNKNOWN = 1e12


def check_installed() -> str:
    """Return the optimiser and its version; ValueError if it is not installed."""
    try:
        import pymoo  # noqa: F401
    except ModuleNotFoundError as error:
        raise ValueError("a search needs pymoo: pip install 'wirerope-mj[optimise]'.") from error
    return f"pymoo {version('pymoo')}, NSGA-II"


class Evolution:
    """Generations of designs, each made of the best so far; the same arguments and answers give the same designs.

    NSGA-II (Deb et al. 2002): of parents and children those survive that fewest others beat, and of equals those that stand
    apart. A design that keeps its limits beats one that does not; of two that do not, the one that exceeds them less. Numbers
    are crossed by simulated binary crossover and mutated by a polynomial, booleans and choices are taken from either
    parent and flipped.
    """

    def __init__(
        self, variables: Mapping[str, distributions.Uniform | distributions.Choice], first: Sequence[Design], *,
        n_objectives: int, n_limits: int, seed: int,
    ) -> None:  # fmt: skip
        """Begin with the designs of the first generation; later ones have as many, or fewer if no new designs are found."""
        from pymoo.algorithms.moo.nsga2 import NSGA2, binary_tournament
        from pymoo.core.mixed import MixedVariableDuplicateElimination, MixedVariableMating
        from pymoo.core.population import Population
        from pymoo.core.problem import Problem
        from pymoo.core.termination import NoTermination
        from pymoo.core.variable import Binary, Choice, Real
        from pymoo.operators.mutation.bitflip import BFM
        from pymoo.operators.mutation.pm import PM
        from pymoo.operators.mutation.rm import ChoiceRandomMutation
        from pymoo.operators.selection.tournament import TournamentSelection

        duplicates = MixedVariableDuplicateElimination()
        optimised = {name: _variable(distribution) for name, distribution in variables.items()}
        kinds = list(map(type, optimised.values()))
        # One variable of each kind in a child on average: pymoo's own rule, which it breaks for choices alone.
        probability = {"prob_var": min(0.5, 1.0 / max(kinds.count(Choice), 1))}
        mutation = {Binary: BFM(), Real: PM(), Choice: ChoiceRandomMutation(**probability)}
        # One constraint more: that the design could be simulated at all.
        self._problem = Problem(vars=optimised, n_obj=n_objectives, n_ieq_constr=n_limits + 1)
        self._algorithm = NSGA2(
            pop_size=len(first), sampling=Population.new(X=np.array([dict(design) for design in first], dtype=object)),
            mating=MixedVariableMating(
                selection=TournamentSelection(func_comp=binary_tournament), mutation=mutation, eliminate_duplicates=duplicates,
            ),
            eliminate_duplicates=duplicates,
        )  # fmt: skip
        self._algorithm.setup(self._problem, seed=seed, termination=NoTermination(), verbose=False)
        self._asked: Any = None

    def ask(self) -> list[Design]:
        """Return the designs of the next generation; an empty list if there are no new designs."""
        self._asked = self._algorithm.ask()
        designs = [] if self._asked is None else self._asked.get("X")
        # Numbers of NumPy's own types as Python's.
        return [{k: value.item() if isinstance(value, np.generic) else value for k, value in row.items()} for row in designs]

    def tell(self, objectives: Array, violations: Array) -> None:
        """Give the optimiser the objectives of the designs asked for last, (n, n_objectives), and their excess over each limit.

        Violations, (n, n_limits), are <= 0 where limits are kept; unknown values are infinite.
        """
        from pymoo.core.evaluator import Evaluator
        from pymoo.problems.static import StaticProblem

        unknown = ~(np.isfinite(objectives).all(axis=1) & np.isfinite(violations).all(axis=1))
        limits = np.column_stack([np.where(unknown, UNKNOWN, 0.0), np.where(np.isfinite(violations), violations, 0.0)])
        values = np.where(np.isfinite(objectives), objectives, UNKNOWN)
        Evaluator().eval(StaticProblem(self._problem, F=values, G=limits), self._asked)
        self._algorithm.tell(infills=self._asked)


def _variable(distribution: distributions.Uniform | distributions.Choice) -> object:
    """Make the optimiser's variable for a distribution: a real number, a boolean or a choice."""
    from pymoo.core import variable

    if isinstance(distribution, distributions.Uniform):
        return variable.Real(bounds=(distribution.low, distribution.high))
    if set(distribution.choices) == {False, True} and isinstance(distribution.choices[0], bool):
        return variable.Binary()
    return variable.Choice(options=list(distribution.choices))


def objectives(table: pa.Table, names: Sequence[str]) -> Array:
    """Return the minimised measures of every design, (n, n_names); infinite where a design failed or has no value.

    A design whose run ends before its peaks are over counts as without a value: softer ones would win for having been stopped.
    """
    values = np.full((table.num_rows, len(names)), np.inf)
    done = np.asarray(table["status"]) == DONE
    for index, name in enumerate(names):
        column = np.asarray(table[name], dtype=np.float64)
        values[:, index] = np.where(done & ~ended_early(table, name) & ~np.isnan(column), column, np.inf)
    return values


def violations(table: pa.Table, limits: Mapping[str, float]) -> Array:
    """Return the relative excess of every design over each limit, (n, n_limits): <= 0 where it is kept.

    Of a limit 0 it is the value itself. Infinite where a design failed or nothing is judged: nobody knows that it is kept.
    """
    allowed = np.array(list(limits.values()))
    return (objectives(table, list(limits)) - allowed) / np.where(allowed == 0.0, 1.0, np.abs(allowed))


def feasible(table: pa.Table, names: Sequence[str], limits: Mapping[str, float]) -> Booleans:
    """Return the mask of the designs that were simulated, have every minimised measure, and keep all limits, (n,)."""
    return np.asarray(np.isfinite(objectives(table, names)).all(axis=1) & (violations(table, limits) <= 0.0).all(axis=1))


def front(table: pa.Table, names: Sequence[str], limits: Mapping[str, float]) -> list[int]:
    """Return the rows of the Pareto-optimal feasible designs, in rising order of the first minimised measure.

    A design is one of them unless another feasible one is not worse in any respect and better in one; of several that are
    equal in all respects it is the first.
    """
    values = objectives(table, names)
    candidates = np.flatnonzero(feasible(table, names, limits))
    order = candidates[np.lexsort([candidates, *values[candidates].T[::-1]])]
    kept: list[int] = []
    for row in order:  # what beats a row stands before it
        if not any((values[duplicates] <= values[row]).all() for duplicates in kept):
            kept.append(int(row))
    return kept


def nearest(table: pa.Table, names: Sequence[str], limits: Mapping[str, float]) -> tuple[int, str, float] | None:
    """Return the row with the least excess over its limits, its limit exceeded most, and the excess; None without rows."""
    rows = nearest_first(table, names, limits)
    if not limits or not rows:
        return None
    over = violations(table, limits)[rows[0]]
    index = int(np.argmax(over))
    return rows[0], list(limits)[index], float(over[index])


def nearest_first(table: pa.Table, names: Sequence[str], limits: Mapping[str, float]) -> list[int]:
    """Return the rows of judged designs in the order of their largest excess over a limit."""
    over = violations(table, limits).max(axis=1, initial=-math.inf)
    worst = np.where(np.isfinite(objectives(table, names)).all(axis=1), over, np.inf)
    return [int(row) for row in np.argsort(worst, kind="stable") if worst[row] < np.inf]


GENERATION = "generation"  # Column of the table: in which generation a design was first made
_LINE = 1e-9  # Distance from the line between the front's ends that is rounding


@dataclass(frozen=True, kw_only=True, repr=False)
class SearchResult(StudyResult):
    """The result of a search: that of a study whose variants are all designs, in the order in which they were made.

    The table has one more column, `generation`, from 0.
    """

    @property
    def minimise(self) -> tuple[str, ...]:
        """Names of the minimised measures."""
        return tuple(self.inputs["search"]["minimise"])

    @property
    def limits(self) -> dict[str, float]:
        """Largest allowed value of each limited measure [SI]."""
        return {limit["measure"]: limit["largest"] for limit in self.inputs["search"]["limits"]}

    @property
    def start(self) -> int:
        """Number of given designs: variants 0, 1, ..."""
        return len(self.inputs["search"]["start"])

    @cached_property
    def study(self) -> StudyDefinition:
        """The study whose variants are the designs, made from the folder alone."""
        return super().study.of(self.table)

    @cached_property
    def feasible(self) -> Booleans:
        """Mask of the designs that were simulated and keep the limits, (n,)."""
        return feasible(self.table, self.minimise, self.limits)

    @cached_property
    def front(self) -> pa.Table:
        """Rows of the Pareto-optimal designs within the limits, in the order of the first minimised measure."""
        rows = front(self.table, self.minimise, self.limits)
        return self.table.take(pa.array(rows, type=pa.int64()))

    @cached_property
    def message(self) -> str:
        """Summary of the search in one sentence."""
        if not self.complete:
            return f"{self.folder}: not complete; go on with it with --resume (`resume=True`)."
        table = self.table
        generations = int(np.asarray(table[GENERATION]).max()) + 1
        text = f"{self.variants} designs in {generations} generations, {len(self.failed)} failed, "
        if self.feasible.any():
            front = self.front.num_rows
            return f"{text}{self.feasible.sum()} within the limits, {front} of them on the front.{self.missing}"
        return f"{text}none within the limits. {self._nearest()}{self.missing}"

    def scene(self, variant: int) -> Scene:
        """Return the modelled geometry of a design for drawing."""
        return scene_of(self.study.system(variant))

    def absent(self, variant: int) -> list[str]:
        """Return the names of the mounts that a design leaves out."""
        mounts = self.study.system(variant).mounts
        return [name for name, mount in mounts.items() if not acts(mount.isolator)]

    @cached_property
    def knee(self) -> int | None:
        """Number of the front's design that is farthest below the line between its ends, each measure relative to its range.

        Beyond it, either way, little is gained for much. None where fewer than two measures are minimised or three designs
        are on the front, and where none lies below the line: such a front has no knee.
        """
        if len(self.minimise) != 2 or self.front.num_rows < 3:
            return None
        x, y = (np.asarray(self.front[name]) for name in self.minimise)
        distance = (x - x[0]) / np.ptp(x) + (y - y[-1]) / np.ptp(y)  # the ends have 1
        row = int(np.argmin(distance))
        return int(self.front["variant"][row].as_py()) if distance[row] < 1.0 - _LINE else None

    @cached_property
    def chosen(self) -> list[int]:
        """Numbers of the designs in the order in which they are shown: of the front its knee, its ends, those between.

        Without a front they are all that can be judged, the nearest to the limits first.
        """
        if not self.front.num_rows:
            rows = nearest_first(self.table, self.minimise, self.limits)
            return [int(self.table["variant"][row].as_py()) for row in rows]
        front = [int(number) for number in self.front["variant"].to_pylist()]
        spread = [front[round(fraction * (len(front) - 1))] for fraction in (0.0, 1.0, 0.5, 0.25, 0.75)]
        return list(dict.fromkeys([*([] if self.knee is None else [self.knee]), *spread, *front]))

    @property
    def shown(self) -> tuple[str, ...]:
        """Measures displayed of a design: the minimised ones, the limited ones, and the number of mounts."""
        return tuple(dict.fromkeys([*self.minimise, *self.limits, "mounts"]))

    def remark(self, variant: int) -> str:
        """Return the remarks on a design: "given", "knee", both or ""."""
        return ", ".join(["given"] * (variant < self.start) + ["knee"] * (variant == self.knee))

    def _nearest(self) -> str:
        """Describe the design that is nearest to the limits in a sentence."""
        closest = nearest(self.table, self.minimise, self.limits)
        if closest is None:
            first = min(self.failed, default=None)
            why = why_early(self.table) or (
                "nothing is rated or stated by which the designs would be judged" if first is None else self.failed[first]
            )
            return f"None has values of all that is minimised or limited: {why.rstrip('.')}."
        row, name, over = closest
        measure, value = measure_of(name), self.table[name][row].as_py()
        number, percent = self.table["variant"][row].as_py(), 100.0 * over
        above = f"{percent:.2g} %" if percent < 99.5 else f"{percent:.0f} %"
        return (
            f"The nearest is design {number}: {measure.text} is {measure.factor * value:.4g} {measure.unit}, "
            f"{above} above its limit of {measure.factor * self.limits[name]:.4g} {measure.unit}."
        )


def read_result(folder: Path, study_class: type[StudyDefinition]) -> StudyResult:
    """Return the result in a folder; its `study` will be of this class.

    RecordError if the folder is not that of a study, or is damaged.
    """
    content = read_inputs(folder)
    complete = (folder / TABLE).is_file()
    rows = len(StoredTable(folder, str)["variant"]) if complete else 0
    if "search" in content:
        return SearchResult(folder=folder, inputs=content, variants=rows, complete=complete, study_class=study_class)
    variants = int(content["sampling"]["variants"])
    if complete and rows != variants:
        raise RecordError(
            f"{folder / TABLE}: the study has {variants} variants, and this table {rows} rows: it was changed, or is that of "
            "another study. Put a copy in its place, or compute the study again with --force (`force=True`)."
        )
    return StudyResult(folder=folder, inputs=content, variants=variants, complete=complete, study_class=study_class)
