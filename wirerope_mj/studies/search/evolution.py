"""Evolution towards the front of designs: its steps, and what of the designs is on the front."""

import math
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from typing import Any

import numpy as np
import pyarrow as pa

from wirerope_mj.foundation.arrays import Array, Booleans, Entries
from wirerope_mj.studies.ended import ended_early
from wirerope_mj.studies.engines.compute import DONE
from wirerope_mj.studies.vary import distributions

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
        """Begin with the designs of the first generation; later ones have as many, or fewer where no others are found."""
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

        other = MixedVariableDuplicateElimination()
        kinds = [type(_variable(one)) for one in variables.values()]
        # One variable of each kind in a child on average: pymoo's own rule, which it breaks for choices alone.
        often = {"prob_var": min(0.5, 1.0 / max(kinds.count(Choice), 1))}
        mutation = {Binary: BFM(), Real: PM(), Choice: ChoiceRandomMutation(**often)}
        # One constraint more: that the design could be simulated at all.
        self._problem = Problem(
            vars={name: _variable(one) for name, one in variables.items()}, n_obj=n_objectives, n_ieq_constr=n_limits + 1,
        )  # fmt: skip
        self._algorithm = NSGA2(
            pop_size=len(first), sampling=Population.new(X=np.array([dict(design) for design in first], dtype=object)),
            mating=MixedVariableMating(
                selection=TournamentSelection(func_comp=binary_tournament), mutation=mutation, eliminate_duplicates=other,
            ),
            eliminate_duplicates=other,
        )  # fmt: skip
        self._algorithm.setup(self._problem, seed=seed, termination=NoTermination(), verbose=False)
        self._asked: Any = None

    def ask(self) -> list[Design]:
        """Return the designs of the next generation; none if there are no other ones."""
        self._asked = self._algorithm.ask()
        designs = [] if self._asked is None else self._asked.get("X")
        # Numbers of NumPy's own types as Python's.
        return [{k: one.item() if isinstance(one, np.generic) else one for k, one in row.items()} for row in designs]

    def tell(self, objectives: Array, violations: Array) -> None:
        """Take what is minimised of the designs asked for last, (n, n_objectives), and by how much each limit is exceeded.

        Violations, (n, n_limits), are <= 0 where limits are kept; what is not known is infinite.
        """
        from pymoo.core.evaluator import Evaluator
        from pymoo.problems.static import StaticProblem

        unknown = ~(np.isfinite(objectives).all(axis=1) & np.isfinite(violations).all(axis=1))
        limits = np.column_stack([np.where(unknown, UNKNOWN, 0.0), np.where(np.isfinite(violations), violations, 0.0)])
        values = np.where(np.isfinite(objectives), objectives, UNKNOWN)
        Evaluator().eval(StaticProblem(self._problem, F=values, G=limits), self._asked)
        self._algorithm.tell(infills=self._asked)


def _variable(distribution: distributions.Uniform | distributions.Choice) -> object:
    from pymoo.core import variable

    if isinstance(distribution, distributions.Uniform):
        return variable.Real(bounds=(distribution.low, distribution.high))
    if set(distribution.choices) == {False, True} and isinstance(distribution.choices[0], bool):
        return variable.Binary()
    return variable.Choice(options=list(distribution.choices))


def objectives(table: pa.Table, names: Sequence[str]) -> Array:
    """Return what is minimised of every design, (n, n_names); infinite where a design failed or nothing is judged.

    Neither is a design whose run ends before its peaks are over: softer ones would win for having been stopped.
    """
    values = np.full((table.num_rows, len(names)), np.inf)
    done = np.asarray(table["status"]) == DONE
    for index, name in enumerate(names):
        column = np.asarray(table[name], dtype=np.float64)
        values[:, index] = np.where(done & ~ended_early(table, name) & ~np.isnan(column), column, np.inf)
    return values


def violations(table: pa.Table, limits: Mapping[str, float]) -> Array:
    """Return by how much every design exceeds each limit, relative to it, (n, n_limits): <= 0 where it is kept.

    Of a limit 0 it is the value itself. Infinite where a design failed or nothing is judged: nobody knows that it is kept.
    """
    allowed = np.array(list(limits.values()))
    return (objectives(table, list(limits)) - allowed) / np.where(allowed == 0.0, 1.0, np.abs(allowed))


def feasible(table: pa.Table, names: Sequence[str], limits: Mapping[str, float]) -> Booleans:
    """Return the mask of the designs that were simulated, have a value of all that is minimised, and keep all limits, (n,)."""
    return np.asarray(np.isfinite(objectives(table, names)).all(axis=1) & (violations(table, limits) <= 0.0).all(axis=1))


def front(table: pa.Table, names: Sequence[str], limits: Mapping[str, float]) -> list[int]:
    """Return the rows of the Pareto-optimal feasible designs, those with the least of the first name first.

    A design is one of them unless another feasible one is not worse in any respect and better in one; of several that are
    equal in all respects it is the first.
    """
    values = objectives(table, names)
    candidates = np.flatnonzero(feasible(table, names, limits))
    order = candidates[np.lexsort([candidates, *values[candidates].T[::-1]])]
    kept: list[int] = []
    for row in order:  # what beats a row stands before it
        if not any((values[other] <= values[row]).all() for other in kept):
            kept.append(int(row))
    return kept


def nearest(table: pa.Table, names: Sequence[str], limits: Mapping[str, float]) -> tuple[int, str, float] | None:
    """Return the row that exceeds its limits the least, the limit that it exceeds most, and by how much; None without one."""
    rows = nearest_first(table, names, limits)
    if not limits or not rows:
        return None
    over = violations(table, limits)[rows[0]]
    index = int(np.argmax(over))
    return rows[0], list(limits)[index], float(over[index])


def nearest_first(table: pa.Table, names: Sequence[str], limits: Mapping[str, float]) -> list[int]:
    """Return the rows that can be judged, that which exceeds its limits the least first."""
    over = violations(table, limits).max(axis=1, initial=-math.inf)
    worst = np.where(np.isfinite(objectives(table, names)).all(axis=1), over, np.inf)
    return [int(row) for row in np.argsort(worst, kind="stable") if worst[row] < np.inf]
