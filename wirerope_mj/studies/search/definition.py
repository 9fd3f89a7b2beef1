"""The definition of a search: variables of a design, measures that are minimised, limits, and the first generation."""

from collections.abc import Mapping, Sequence
from typing import Any

import pyarrow as pa

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import finite, integer
from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.inputs.distributions import Choice, Uniform
from wirerope_mj.studies.measures import measure_names
from wirerope_mj.studies.results.measure import kinds_of, unknown_measure
from wirerope_mj.studies.search.evolution import Design

FEWEST = 4  # Designs of a generation below which nothing can be crossed


class SearchDefinition:
    """The designs among which a search chooses, and what makes one better; `Search` evolves them."""

    def __init__(
        self,
        study: StudyDefinition,
        *,
        minimise: Sequence[str],
        limits: Mapping[str, float] | None = None,
        generations: int = 20,
        start: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        """Prepare a search; nothing is simulated, and names are checked.

        Args:
            study: its quantities are the design; its variants the first generation, and as many are in every later one; its
                seed is the optimiser's, too.
            minimise: measures that are to be small, columns of the table: "acceleration", "mounts", "travel/m01"; of several
                the Pareto front is sought.
            limits: largest value of measures, SI.
            generations: how many, the first one counted.
            start: designs that the first generation begins with, by the names of `vary` or of the columns: what stands today,
                for instance.

        Raises:
            ValueError: an argument is out of range, a measure does not exist, or something scatters that must be chosen.
        """
        if not isinstance(study, StudyDefinition):
            raise ValueError(f"`study` must be a Study, got {study!r}.")
        self.study, self.generations = study, integer("generations", generations, least=1)
        self.minimise = tuple([minimise] if isinstance(minimise, str) else minimise)
        self.limits = dict(limits or {})
        self._check_measures()
        self.variables = _variables(study)
        self.start = tuple(self._design(index, design) for index, design in enumerate(start))
        names = list(self.variables)
        sampled = study.table().select(names).to_pylist()
        self.first = list(
            {tuple(design[name] for name in names): design for design in (*self.start, *sampled)}.values()
        )
        if len(self.first) < FEWEST:
            raise ValueError(
                f"the first generation has {len(self.first)} designs; it must have at least {FEWEST}, `variants` of the study "
                "and `start` together."
            )
        what = f"a search of {self.generations} generations of {self.size} designs"
        study.require_time(what, float(self.generations) * self.size, "`generations`")

    @property
    def base(self) -> System:
        """The system as the model says it."""
        return self.study.base

    @property
    def name(self) -> str:
        """Name of the search: that of its study."""
        return self.study.name

    @name.setter
    def name(self, name: str) -> None:
        self.study.name = name

    @property
    def question(self) -> str:
        """Question of the search: that of its study."""
        return self.study.question

    @question.setter
    def question(self, question: str) -> None:
        self.study.question = question

    @property
    def size(self) -> int:
        """Number of designs in the first generation, and at most in each later one."""
        return len(self.first)

    def table(self) -> pa.Table:
        """Return the designs of the first generation: `variant` and one column for every number that is chosen."""
        return self.rows(self.first, 0)

    def rows(self, designs: Sequence[Design], first: int) -> pa.Table:
        """Return designs as rows of a study's inputs, numbered from `first`."""
        types = {column.name: column.type for one in self.study.quantities for column in one.columns}
        columns = {name: pa.array([design[name] for design in designs], type=types[name]) for name in self.variables}
        return pa.table({"variant": pa.array(range(first, first + len(designs)), type=pa.int64()), **columns})

    def to_dict(self) -> dict[str, Any]:
        """Return what the search adds to the study, as plain TOML values."""
        return {
            "minimise": list(self.minimise),
            "limits": [{"measure": name, "largest": value} for name, value in self.limits.items()],
            "generations": self.generations,
            "start": [dict(design) for design in self.start],
        }

    def _check_measures(self) -> None:
        names = measure_names(self.study.base)
        if not self.minimise:
            raise ValueError(f"`minimise` must name at least one measure, {kinds_of(names)}.")
        for argument, given in (("minimise", self.minimise), ("limits", tuple(self.limits))):
            for name in given:
                if name not in names:
                    raise ValueError(f"`{argument}`: {unknown_measure(name, names)}")
        if len(set(self.minimise)) < len(self.minimise):
            raise ValueError(f"`minimise` names a measure twice: {', '.join(self.minimise)}.")
        for name, value in self.limits.items():
            self.limits[name] = finite(f"limits[{name!r}]", value)

    def _design(self, index: int, given: Mapping[str, Any]) -> Design:
        """Return a given design by column."""
        design: Design = {}
        known = {one.name for one in self.study.quantities} | set(self.variables)
        unknown = [name for name in given if name not in known]
        if unknown:
            raise ValueError(
                f"`start[{index}]`: nothing called {unknown[0]!r} varies; {', '.join(self.study.vary)} do."
            )
        for quantity in self.study.quantities:
            for column in quantity.columns:
                if column.name not in given and quantity.name not in given:
                    raise ValueError(f"`start[{index}]` must say {column.name!r}, too.")
                value = given.get(column.name, given.get(quantity.name))
                design[column.name] = _checked(index, column.name, value, self.variables[column.name])
        return design


def _variables(study: StudyDefinition) -> dict[str, Uniform | Choice]:
    """Return the distributions of all columns; ValueError if one is nothing to choose from."""
    variables: dict[str, Uniform | Choice] = {}
    for quantity in study.quantities:
        if not isinstance(quantity.distribution, Uniform | Choice):
            raise ValueError(
                f"`vary`: {quantity.name!r} is {quantity.distribution!r}; a search chooses among the values of a Uniform or a "
                "Choice. What scatters belongs into a study of the design that results."
            )
        variables |= dict.fromkeys((column.name for column in quantity.columns), quantity.distribution)
    return variables


def _checked(index: int, name: str, value: Any, variable: Uniform | Choice) -> Any:
    """Return a value of a given design; ValueError unless it is one that may be chosen."""
    if isinstance(variable, Choice):
        chosen = next((one for one in variable.choices if type(one) is type(value) and one == value), None)
        if chosen is None:
            raise ValueError(f"`start[{index}]`: {name!r} must be one of {list(variable.choices)}, got {value!r}.")
        return chosen
    if isinstance(value, bool) or not isinstance(value, int | float) or not variable.low <= value <= variable.high:
        raise ValueError(
            f"`start[{index}]`: {name!r} must be from {variable.low:g} to {variable.high:g}, got {value!r}."
        )
    return float(value)
