"""The optimiser of a search: NSGA-II of pymoo, asked for generations of designs and told their results."""

from collections.abc import Mapping, Sequence
from importlib.metadata import version
from typing import Any

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.studies.inputs import distributions

Design = dict[str, Any]
# Value of a design that failed, for the optimiser: a number, because it adds them up, and worse than any that did not.
UNKNOWN = 1e12


def check_installed() -> str:
    """Return the optimiser and its version; ValueError if it is not installed."""
    try:
        import pymoo  # noqa: F401
    except ImportError as error:
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
        self,
        variables: Mapping[str, distributions.Uniform | distributions.Choice],
        first: Sequence[Design],
        *,
        n_objectives: int,
        n_limits: int,
        seed: int,
    ) -> None:
        """Begin with the designs of the first generation.

        Args:
            variables: of a design, with their values.
            first: the designs of the first generation; later ones have as many, or fewer where no others are found.
            n_objectives: how many numbers are minimised.
            n_limits: how many limits there are.
            seed: of the optimiser's random numbers.
        """
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
            vars={name: _variable(one) for name, one in variables.items()},
            n_obj=n_objectives,
            n_ieq_constr=n_limits + 1,
        )
        self._algorithm = NSGA2(
            pop_size=len(first),
            sampling=Population.new(X=np.array([dict(design) for design in first], dtype=object)),
            mating=MixedVariableMating(
                selection=TournamentSelection(func_comp=binary_tournament),
                mutation=mutation,
                eliminate_duplicates=other,
            ),
            eliminate_duplicates=other,
        )
        self._algorithm.setup(self._problem, seed=seed, termination=NoTermination(), verbose=False)
        self._asked: Any = None

    def ask(self) -> list[Design]:
        """Return the designs of the next generation; none if there are no other ones."""
        self._asked = self._algorithm.ask()
        designs = [] if self._asked is None else self._asked.get("X")
        return [{name: _plain(value) for name, value in design.items()} for design in designs]

    def tell(self, objectives: Array, violations: Array) -> None:
        """Take the results of the designs that were asked for last.

        Args:
            objectives: what is minimised, (n, n_objectives); infinite where it is not known.
            violations: of the limits, (n, n_limits), <= 0 where they are kept; infinite where that is not known.
        """
        from pymoo.core.evaluator import Evaluator
        from pymoo.problems.static import StaticProblem

        unknown = ~(np.isfinite(objectives).all(axis=1) & np.isfinite(violations).all(axis=1))
        limits = np.column_stack([np.where(unknown, UNKNOWN, 0.0), np.where(np.isfinite(violations), violations, 0.0)])
        values = np.where(np.isfinite(objectives), objectives, UNKNOWN)
        Evaluator().eval(StaticProblem(self._problem, F=values, G=limits), self._asked)
        self._algorithm.tell(infills=self._asked)


def _variable(distribution: distributions.Uniform | distributions.Choice) -> Any:
    from pymoo.core import variable

    if isinstance(distribution, distributions.Uniform):
        return variable.Real(bounds=(distribution.low, distribution.high))
    if set(distribution.choices) == {False, True} and isinstance(distribution.choices[0], bool):
        return variable.Binary()
    return variable.Choice(options=list(distribution.choices))


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value
