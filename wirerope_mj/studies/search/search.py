"""Search for designs: its variables, measures and limits, the evolution over generations, resumed where it was stopped."""

import math
import queue
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import closing, nullcontext
from dataclasses import replace
from pathlib import Path
from time import perf_counter

import numpy as np
import pyarrow as pa

from wirerope_mj.engine.simulation.progress import Update, share_bar
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import finite, integer, one_of
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.processes import processors
from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.engines.compute import Chunk, Engine, Part
from wirerope_mj.studies.engines.local import run_local
from wirerope_mj.studies.folder import TABLE, finish, part_path, read_part, study_folder, write_part
from wirerope_mj.studies.inputs_file import KEPT, RESPONSES
from wirerope_mj.studies.measures import measure_names
from wirerope_mj.studies.results.measure import kinds_of, unknown_measure
from wirerope_mj.studies.results.varied import head
from wirerope_mj.studies.search.result import (
    GENERATION,
    Design,
    Evolution,
    SearchResult,
    check_installed,
    objectives,
    read_result,
    violations,
)
from wirerope_mj.studies.study import checked_engine, chunk_size, memory_of_worker
from wirerope_mj.studies.vary.distributions import Choice, Uniform

FEWEST = 4  # Designs that a generation needs for crossover


class Search:
    """Search for designs that minimise measures within limits, by an evolution of many generations.

    What a designer may choose varies as in a `Study`, as Uniform or Choice; the variants of this study, sampled as it says,
    are the first generation, after designs that are given. Each later one is made by the optimiser (pymoo's NSGA-II)
    from the best so far, and computed as variants are: by the same engines, with the same bits.

    All arguments are attributes, and further `first`, the designs of the first generation by column, those of `start` first.
    """

    def __init__(
        self, study: StudyDefinition, *, minimise: Sequence[str], limits: Mapping[str, float] | None = None,
        generations: int = 20, start: Sequence[Mapping[str, object]] = (),
    ) -> None:  # fmt: skip
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
        known = measure_names(study.base)
        if not self.minimise:
            raise ValueError(f"`minimise` must name at least one measure, {kinds_of(known)}.")
        for argument, given in (("minimise", self.minimise), ("limits", tuple(self.limits))):
            for name in given:
                if name not in known:
                    raise ValueError(f"`{argument}`: {unknown_measure(name, known)}")
        if len(set(self.minimise)) < len(self.minimise):
            raise ValueError(f"`minimise` names a measure twice: {', '.join(self.minimise)}.")
        for name, value in self.limits.items():
            self.limits[name] = finite(f"limits[{name!r}]", value)
        self.variables: dict[str, Uniform | Choice] = {}
        for quantity in study.quantities:
            if not isinstance(quantity.distribution, Uniform | Choice):
                raise ValueError(
                    f"`vary`: {quantity.name!r} is {quantity.distribution!r}; a search chooses among the values of a Uniform "
                    "or a Choice. What scatters belongs into a study of the design that results."
                )
            self.variables |= dict.fromkeys((column.name for column in quantity.columns), quantity.distribution)
        self.start = tuple(self._design(index, design) for index, design in enumerate(start))
        names = list(self.variables)
        sampled = study.table().select(names).to_pylist()
        every = (*self.start, *sampled)
        self.first = list({tuple(design[name] for name in names): design for design in every}.values())
        if len(self.first) < FEWEST:
            raise ValueError(
                f"the first generation has {len(self.first)} designs; it must have at least {FEWEST}, `variants` of the study "
                "and `start` together."
            )
        what = f"a search of {self.generations} generations of {self.size} designs"
        study.require_time(what, float(self.generations) * self.size, "`generations`")

    @property
    def base(self) -> System:
        """System without changes."""
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
        types = {column.name: column.type for quantity in self.study.quantities for column in quantity.columns}
        columns = {name: pa.array([design[name] for design in designs], type=types[name]) for name in self.variables}
        return pa.table({"variant": pa.array(range(first, first + len(designs)), type=pa.int64()), **columns})

    def to_dict(self) -> Entries:
        """Return the settings of the search beside those of its study, as plain TOML values."""
        return {
            "minimise": list(self.minimise),
            "limits": [{"measure": name, "largest": value} for name, value in self.limits.items()],
            "generations": self.generations,
            "start": [dict(design) for design in self.start],
        }

    def _design(self, index: int, stated: Mapping[str, object]) -> Design:
        """Check a given design and return it by column."""
        design: Design = {}
        known = {quantity.name for quantity in self.study.quantities} | set(self.variables)
        unknown = [name for name in stated if name not in known]
        if unknown:
            raise ValueError(f"`start[{index}]`: nothing called {unknown[0]!r} varies; {', '.join(self.study.vary)} do.")
        for quantity in self.study.quantities:
            for column in quantity.columns:
                if column.name not in stated and quantity.name not in stated:
                    raise ValueError(f"`start[{index}]` must say {column.name!r}, too.")
                value = stated.get(column.name, stated.get(quantity.name))
                variable, wanted = self.variables[column.name], f"`start[{index}]`: {column.name!r} must be"
                if isinstance(variable, Choice):
                    if not any(type(choice) is type(value) and choice == value for choice in variable.choices):
                        raise ValueError(f"{wanted} one of {list(variable.choices)}, got {value!r}.")
                    design[column.name] = value
                    continue
                number = value if isinstance(value, int | float) and not isinstance(value, bool) else math.nan
                if not variable.low <= number <= variable.high:
                    raise ValueError(f"{wanted} from {variable.low:g} to {variable.high:g}, got {value!r}.")
                design[column.name] = float(number)
        return design

    def run(
        self, folder: str | Path, *, keep: str = "peaks", engine: str = "local", workers: int | None = None,
        address: str | None = None, resume: bool = False, force: bool = False, progress: bool = False,
        when_done: Callable[[SearchResult], object] = lambda result: None,
    ) -> SearchResult:  # fmt: skip
        """Compute all generations and return the result, which is stored in `folder`; arguments are those of `Study.run`.

        The folder is that of a study whose variants are the designs, no design twice. A search that was killed goes on: the
        optimiser begins again, and is given what the finished parts hold.

        Raises:
            ValueError: an argument is out of range, or the optimiser is not installed.
            ModelError: a design of the first generation cannot be.
            RecordError: the folder is not that of this search.
            SimulationError: the cluster cannot be reached, or what would replace another search is not whole.
        """
        folder, study = Path(folder), self.study
        run = checked_engine(engine, workers=workers, address=address)
        one_of("keep", keep, KEPT)
        added = {"optimiser": check_installed(), **self.to_dict()}

        def call(place: Path) -> None:
            when_done(_loaded(place, study))

        def summary() -> Entries:
            """Return the front, SI, and its knee; percentiles of selected designs would be meaningless."""
            result = _loaded(place, study)
            names = ["variant", GENERATION, *result.shown]
            return {
                **head(result), "minimised": list(result.minimise), "limits": result.limits,
                "within_limits": int(result.feasible.sum()), "front": result.front.select(names).to_pylist(),
                "knee": result.knee,
            }  # fmt: skip

        with study_folder(study, folder, keep=keep, resume=resume, force=force, when_done=call, search=added) as place:
            parts = 0
            if not (place / TABLE).is_file():
                used = 1 if engine != "local" else workers or processors()
                with share_bar(
                    "search", "designs/s", total=self.generations, parts="generations", enabled=progress,
                    memory=(used > 1) * used * memory_of_worker(keep),
                ) as update:  # fmt: skip
                    evolving = Evolving(self, place, keep, run, {"workers": workers, "address": address}, update)
                    with closing(evolving):  # so that no process goes on if this one is interrupted
                        evolving.evolve()
                parts = evolving.parts
            finish(place, parts, summary)
        return _loaded(folder, study)


class Evolving:
    """Running search; `parts` counts the finished parts of its table, numbered through all generations."""

    def __init__(self, search: Search, folder: Path, keep: str, engine: Engine, options: Entries, update: Update) -> None:
        self._search, self._folder, self._keep = search, folder, keep
        self._engine, self._options, self._update = engine, options, update
        self._known: dict[tuple[object, ...], tuple[Array, Array]] = {}
        self._chunks: queue.SimpleQueue[Chunk | None] = queue.SimpleQueue()
        self._results: Generator[Part, None, None] | None = None
        self._began, self._computed = perf_counter(), 0
        self.parts = 0

    def evolve(self) -> None:
        """Compute all generations."""
        search = self._search
        evolution = Evolution(
            search.variables, search.first, n_objectives=len(search.minimise), n_limits=len(search.limits),
            seed=search.study.seed,
        )  # fmt: skip
        for generation in range(search.generations):
            designs = evolution.ask()
            if not designs:
                return  # every design that the best can be crossed to is among them
            new = {self._key(design): design for design in designs if self._key(design) not in self._known}
            for table in self._tables(list(new.values()), generation):
                values = objectives(table, search.minimise), violations(table, search.limits)
                for design, *result in zip(table.select(list(search.variables)).to_pylist(), *values, strict=True):
                    self._known[self._key(design)] = (result[0], result[1])
            results = [self._known[self._key(design)] for design in designs]
            evolution.tell(np.array([minimised for minimised, _ in results]), np.array([excess for _, excess in results]))
            self._report(generation + 1)

    def _key(self, design: Design) -> tuple[object, ...]:
        return tuple(design[name] for name in self._search.variables)

    def _tables(self, designs: Sequence[Design], generation: int) -> list[pa.Table]:
        """Return the rows of new designs: of parts already finished, and of those computed now."""
        rows, size = self._search.rows(designs, len(self._known)), chunk_size(self._search.study, self._keep)
        blocks = {self.parts + n: rows.slice(first, size) for n, first in enumerate(range(0, len(designs), size))}
        tables = {}
        for number, block in blocks.items():  # parts that are done, if their designs are these
            path = part_path(self._folder, number)
            table = read_part(path) if path.is_file() else None
            if table is not None and table.select(block.column_names).equals(block):
                tables[number] = table
        missing = [
            Chunk(number=number, rows=block.to_pylist(), responses=self._keep == RESPONSES)
            for number, block in blocks.items()
            if number not in tables
        ]
        for part in self._computed_by_engine(missing):
            numbers = pa.array([generation] * part.table.num_rows, type=pa.int64())
            table = part.table.append_column(GENERATION, numbers)
            write_part(self._folder, replace(part, table=table))
            tables[part.number] = table
            self._computed += table.num_rows
            self._report(generation + len(tables) / len(blocks))
        self.parts += len(blocks)
        return [tables[number] for number in sorted(blocks)]

    def _computed_by_engine(self, missing: Sequence[Chunk]) -> Iterator[Part]:
        """Yield the parts of some chunks; processes of this machine stay alive for later generations."""
        work = self._search.study.work
        if self._engine is not run_local:
            with closing(self._engine(work, missing, **self._options)) if missing else nullcontext(()) as results:
                yield from results
            return
        for chunk in missing:
            self._chunks.put(chunk)
        if self._results is None:
            self._results = run_local(work, iter(self._chunks.get, None), **self._options)
        for _ in missing:
            yield next(self._results)

    def close(self) -> None:
        """End the processes of this machine."""
        if self._results is not None:
            self._chunks.put(None)  # a thread that waits for a chunk sees that there are no more
            self._results.close()

    def _report(self, generations: float) -> None:
        """Show how many generations are done, and the designs computed a second."""
        rate = self._computed / (perf_counter() - self._began)
        self._update(generations / self._search.generations, rate)


def _loaded(folder: Path, study: StudyDefinition) -> SearchResult:
    result = read_result(folder, type(study))
    assert isinstance(result, SearchResult)
    return result
