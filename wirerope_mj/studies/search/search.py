"""A search: designs of one system, made better generation by generation, for the least of some measures within limits."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa

from wirerope_mj.engine.system import System
from wirerope_mj.studies.inputs.distributions import Choice, Uniform
from wirerope_mj.studies.inputs.sampling import arrow_type
from wirerope_mj.studies.measures import measure_names
from wirerope_mj.studies.search.evolution import Design
from wirerope_mj.studies.search.result import SearchResult
from wirerope_mj.studies.search.run import run_search
from wirerope_mj.studies.study import Study

FEWEST = 4
"""Designs of a generation below which nothing can be crossed."""


class Search:
    """Designs with the least of some measures within limits, found by an evolution of many generations.

    What a designer may choose varies as in a `Study`, as Uniform or Choice; the variants of this study, sampled as it says,
    are the first generation, after designs that are given. Each later one is made by the optimiser (pymoo's NSGA-II)
    from the best so far, and computed as variants are: by the same engines, with the same bits.

    Attributes:
        study: what varies, and how a design is simulated.
        first: the designs of the first generation, by column; those of `start` first.
        All arguments, too.
    """

    def __init__(
        self,
        study: Study,
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
        if not isinstance(study, Study):
            raise ValueError(f"`study` must be a Study, got {study!r}.")
        if isinstance(generations, bool) or not isinstance(generations, int) or generations < 1:
            raise ValueError(f"`generations` must be an integer >= 1, got {generations!r}.")
        self.study, self.generations = study, generations
        self.minimise = tuple([minimise] if isinstance(minimise, str) else minimise)
        self.limits = dict(limits or {})
        self._check_measures()
        self.variables = _variables(study)
        self.start = tuple(self._design(place, design) for place, design in enumerate(start))
        names = list(self.variables)
        drawn = study.table().select(names).to_pylist()
        self.first = list({tuple(design[name] for name in names): design for design in (*self.start, *drawn)}.values())
        if len(self.first) < FEWEST:
            raise ValueError(
                f"the first generation has {len(self.first)} designs; it must have at least {FEWEST}, `variants` of the study "
                "and `start` together."
            )

    @property
    def base(self) -> System:
        """The system as the model says it."""
        return self.study.base

    @property
    def name(self) -> str:
        """What the search is called: as its study."""
        return self.study.name

    @name.setter
    def name(self, name: str) -> None:
        self.study.name = name

    @property
    def question(self) -> str:
        """What it asks: as its study."""
        return self.study.question

    @question.setter
    def question(self, question: str) -> None:
        self.study.question = question

    def run(
        self,
        folder: str | Path,
        *,
        keep: str = "peaks",
        engine: str = "local",
        workers: int | None = None,
        address: str | None = None,
        resume: bool = False,
        force: bool = False,
        progress: bool = False,
    ) -> SearchResult:
        """Evolve all generations and return the result, which stands in `folder`; arguments are those of `Study.run`.

        The folder is that of a study whose variants are the designs, no design twice. A search that was killed goes on: the
        optimiser is asked again from the beginning, and told what the finished parts say.

        Raises:
            ValueError: an argument is out of range, or the optimiser is not installed.
            ModelError: a design of the first generation cannot be.
            RecordError: the folder is not that of this search.
            SimulationError: the cluster cannot be reached.
        """
        return run_search(
            self, Path(folder), keep=keep, engine=engine, workers=workers, address=address, resume=resume, force=force,
            progress=progress,
        )  # fmt: skip

    @property
    def size(self) -> int:
        """Number of designs in the first generation, and at most in each later one."""
        return len(self.first)

    def table(self) -> pa.Table:
        """Return the designs of the first generation: `variant` and one column for every number that is chosen."""
        return self.rows(self.first, 0)

    def rows(self, designs: Sequence[Design], first: int) -> pa.Table:
        """Return designs as rows of a study's inputs, numbered from `first`."""
        columns = {
            name: pa.array([design[name] for design in designs], type=self._types[name]) for name in self.variables
        }
        return pa.table({"variant": pa.array(range(first, first + len(designs)), type=pa.int64()), **columns})

    def to_dict(self) -> dict[str, Any]:
        """Return what the search adds to the study, as plain TOML values."""
        return {
            "minimise": list(self.minimise),
            "limits": [{"measure": name, "largest": value} for name, value in self.limits.items()],
            "generations": self.generations,
            "start": [dict(design) for design in self.start],
        }

    @property
    def _types(self) -> dict[str, pa.DataType]:
        return {column.name: arrow_type(column) for one in self.study.quantities for column in one.columns}

    def _check_measures(self) -> None:
        names = measure_names(self.study.base)
        if not self.minimise:
            raise ValueError(f"`minimise` must name at least one measure, {_shown(names)}.")
        for argument, given in (("minimise", self.minimise), ("limits", tuple(self.limits))):
            for name in given:
                if name not in names:
                    raise ValueError(f"`{argument}`: there is no measure {name!r}; there are {_shown(names)}.")
        if len(set(self.minimise)) < len(self.minimise):
            raise ValueError(f"`minimise` names a measure twice: {', '.join(self.minimise)}.")
        for name, value in self.limits.items():
            if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
                raise ValueError(f"`limits`: the largest {name!r} must be a finite number, got {value!r}.")
            self.limits[name] = float(value)

    def _design(self, place: int, given: Mapping[str, Any]) -> Design:
        """Return a given design by column."""
        found: Design = {}
        known = {one.name for one in self.study.quantities} | set(self.variables)
        unknown = [name for name in given if name not in known]
        if unknown:
            raise ValueError(
                f"`start[{place}]`: nothing called {unknown[0]!r} varies; {', '.join(self.study.vary)} do."
            )
        for quantity in self.study.quantities:
            for column in quantity.columns:
                if column.name not in given and quantity.name not in given:
                    raise ValueError(f"`start[{place}]` must say {column.name!r}, too.")
                value = given.get(column.name, given.get(quantity.name))
                found[column.name] = _checked(place, column.name, value, self.variables[column.name])
        return found


def _variables(study: Study) -> dict[str, Uniform | Choice]:
    """Return the distributions of all columns; ValueError if one is nothing to choose from."""
    found: dict[str, Uniform | Choice] = {}
    for quantity in study.quantities:
        if not isinstance(quantity.distribution, Uniform | Choice):
            raise ValueError(
                f"`vary`: {quantity.name!r} is {quantity.distribution!r}; a search chooses among the values of a Uniform or a "
                "Choice. What scatters belongs into a study of the design that is found."
            )
        found |= dict.fromkeys((column.name for column in quantity.columns), quantity.distribution)
    return found


def _checked(place: int, name: str, value: Any, variable: Uniform | Choice) -> Any:
    """Return a value of a given design; ValueError unless it is one that may be chosen."""
    if isinstance(variable, Choice):
        chosen = next((one for one in variable.choices if type(one) is type(value) and one == value), None)
        if chosen is None:
            raise ValueError(f"`start[{place}]`: {name!r} must be one of {list(variable.choices)}, got {value!r}.")
        return chosen
    if isinstance(value, bool) or not isinstance(value, int | float) or not variable.low <= value <= variable.high:
        raise ValueError(
            f"`start[{place}]`: {name!r} must be from {variable.low:g} to {variable.high:g}, got {value!r}."
        )
    return float(value)


def _shown(names: Sequence[str]) -> str:
    return ", ".join(names[:10]) + (", ..." if len(names) > 10 else "")
