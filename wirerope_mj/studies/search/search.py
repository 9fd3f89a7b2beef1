"""A search for designs: asked, run, and resumed where it was interrupted."""

import queue
from collections.abc import Generator, Iterator, Sequence
from contextlib import closing, nullcontext
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import pyarrow as pa

from wirerope_mj.engine.simulation.progress import Update, share_bar
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.engines.compute import Chunk, Engine, Part
from wirerope_mj.studies.engines.local import run_local
from wirerope_mj.studies.folder import TABLE, computed_alone, finish, part_path, prepare, read_part, write_part
from wirerope_mj.studies.responses import KEPT, RESPONSES
from wirerope_mj.studies.results.varied import head
from wirerope_mj.studies.run import checked_engine, chunk_size
from wirerope_mj.studies.search.definition import SearchDefinition
from wirerope_mj.studies.search.evolution import Design, Evolution, check_installed, objectives, violations
from wirerope_mj.studies.search.result import GENERATION, SearchResult, read_result


class Evolving:
    """A search that runs: `parts` counts those of the table so far, and their numbers go on through the generations."""

    def __init__(
        self, search: SearchDefinition, folder: Path, keep: str, engine: Engine, options: dict[str, Any], update: Update
    ) -> None:
        self._search, self._folder, self._keep = search, folder, keep
        self._engine, self._options, self._update = engine, options, update
        self._known: dict[tuple[Any, ...], tuple[Array, Array]] = {}
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
            new = list(
                {self._key(design): design for design in designs if self._key(design) not in self._known}.values()
            )
            for table in self._tables(new, generation):
                self._remember(table)
            results = [self._known[self._key(design)] for design in designs]
            evolution.tell(np.array([one for one, _ in results]), np.array([one for _, one in results]))
            self._report(generation + 1)

    def _key(self, design: Design) -> tuple[Any, ...]:
        return tuple(design[name] for name in self._search.variables)

    def _remember(self, table: pa.Table) -> None:
        values = objectives(table, self._search.minimise), violations(table, self._search.limits)
        for design, *result in zip(table.select(list(self._search.variables)).to_pylist(), *values, strict=True):
            self._known[self._key(design)] = (result[0], result[1])

    def _tables(self, designs: Sequence[Design], generation: int) -> list[pa.Table]:
        """Return the rows of new designs: of the parts that are done already, and of those that are computed now."""
        rows, size = self._search.rows(designs, len(self._known)), chunk_size(self._search.study, self._keep)
        blocks = {self.parts + n: rows.slice(first, size) for n, first in enumerate(range(0, len(designs), size))}
        tables = {number: table for number, block in blocks.items() if (table := self._done(number, block)) is not None}
        missing = [
            Chunk(number=one, rows=block.to_pylist(), responses=self._keep == RESPONSES)
            for one, block in blocks.items()
            if one not in tables
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
        """Yield the parts of some chunks; processes of this machine wait for the chunks of later generations."""
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

    def _done(self, number: int, rows: pa.Table) -> pa.Table | None:
        """Return a part that is done, if its designs are these: those after a process's death may be others."""
        path = part_path(self._folder, number)
        table = read_part(path) if path.is_file() else None
        return table if table is not None and table.select(rows.column_names).equals(rows) else None

    def _report(self, generations: float) -> None:
        rate = self._computed / (perf_counter() - self._began)
        self._update(generations / self._search.generations, rate)


class Search(SearchDefinition):
    """Designs with the least of some measures within limits, found by an evolution of many generations.

    What a designer may choose varies as in a `Study`, as Uniform or Choice; the variants of this study, sampled as it says,
    are the first generation, after designs that are given. Each later one is made by the optimiser (pymoo's NSGA-II)
    from the best so far, and computed as variants are: by the same engines, with the same bits.

    All arguments are attributes, and further:

    Attributes:
        study: what varies, and how a design is simulated.
        first: the designs of the first generation, by column; those of `start` first.
    """

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
        optimiser begins again, and is given what the finished parts hold.

        Raises:
            ValueError: an argument is out of range, or the optimiser is not installed.
            ModelError: a design of the first generation cannot be.
            RecordError: the folder is not that of this search.
            SimulationError: the cluster cannot be reached.
        """
        folder, study = Path(folder), self.study
        run = checked_engine(engine, workers=workers, address=address)
        one_of("keep", keep, KEPT)
        added = {"optimiser": check_installed(), **self.to_dict()}
        identity = prepare(study, folder, keep=keep, resume=resume, force=force, search=added)
        with computed_alone(folder, identity):
            parts = 0
            if not (folder / TABLE).is_file():
                with share_bar(
                    "search", "designs/s", total=self.generations, parts="generations", enabled=progress
                ) as update:
                    evolving = Evolving(self, folder, keep, run, {"workers": workers, "address": address}, update)
                    with closing(evolving):  # so that no process goes on if this one is interrupted
                        evolving.evolve()
                parts = evolving.parts
            finish(folder, parts, lambda: _summary(_loaded(folder, study)))
        return _loaded(folder, study)


def _loaded(folder: Path, study: StudyDefinition) -> SearchResult:
    result = read_result(folder, type(study))
    assert isinstance(result, SearchResult)
    return result


def _summary(result: SearchResult) -> dict[str, Any]:
    """Return the front of a search, SI, and its knee; percentiles of designs that an evolution has chosen mean nothing."""
    names = ["variant", GENERATION, *result.shown]
    return {
        **head(result),
        "minimised": list(result.minimise),
        "limits": result.limits,
        "within_limits": int(result.feasible.sum()),
        "front": result.front.select(names).to_pylist(),
        "knee": result.knee,
    }
