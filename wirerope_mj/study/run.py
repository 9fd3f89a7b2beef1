"""The run of a study: chunks of variants handed to an engine, and their parts written as they are ready."""

import math
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

from wirerope_mj.simulation.progress import share_bar
from wirerope_mj.study.compute import Chunk, Engine
from wirerope_mj.study.folder import TABLE, done, finish, prepare, write_part
from wirerope_mj.study.local import run_local
from wirerope_mj.study.result import StudyResult, load_study

if TYPE_CHECKING:
    from wirerope_mj.study.study import Study

CHUNK = 32
"""Variants of a chunk: enough that stepping them costs more than handing them over, few enough that a kill loses little."""

FEWEST_CHUNKS = 16
"""Chunks that a small study has, so that all workers have something to do until the end."""

ENGINES = ("local", "dask")


def run_study(
    study: "Study",
    folder: Path,
    *,
    engine: str,
    workers: int | None,
    address: str | None,
    resume: bool,
    force: bool,
    progress: bool,
) -> StudyResult:
    """Compute what is missing of a study and return its result; the arguments are those of `Study.run`."""
    if workers is not None and (isinstance(workers, bool) or not isinstance(workers, int) or workers < 1):
        raise ValueError(f"`workers` must be a whole number >= 1, got {workers!r}.")
    run = _engine(engine)
    if engine == "local" and address is not None:
        raise ValueError(f"`address` is for an engine with a cluster; the local engine has none, got {address!r}.")
    study.table()  # every variant is checked before anything is written
    prepare(study, folder, resume=resume, force=force)
    numbers = range(math.ceil(study.size / chunk_size(study.size)))
    if not (folder / TABLE).is_file():
        missing = sorted(set(numbers) - done(folder))
        already = study.size - _count(study, missing)
        with share_bar("study", "variants/s", enabled=progress) as update:
            began, ended = perf_counter(), 0
            results = run(study.work, chunks(study, missing), workers=workers, address=address)
            with closing(results):  # so that no process goes on if this one is interrupted
                for number, table in results:
                    write_part(folder, number, table)
                    ended += table.num_rows
                    update((already + ended) / study.size, ended / (perf_counter() - began))
    finish(study, folder, len(numbers))
    return load_study(folder)


def chunk_size(variants: int) -> int:
    """Return how many variants a chunk has; it depends on nothing else, so that a study may go on with other workers."""
    return min(CHUNK, math.ceil(variants / FEWEST_CHUNKS))


def chunks(study: "Study", numbers: Sequence[int]) -> Iterator[Chunk]:
    """Yield the chunks of some numbers."""
    size = chunk_size(study.size)
    for number in numbers:
        yield Chunk(number=number, rows=study.table().slice(number * size, size).to_pylist())


def _count(study: "Study", numbers: Sequence[int]) -> int:
    """Return how many variants some chunks have."""
    size = chunk_size(study.size)
    return sum(min(size, study.size - number * size) for number in numbers)


def _engine(name: str) -> Engine:
    if name == "local":
        return run_local
    if name == "dask":
        from wirerope_mj.study.dask_engine import run_dask  # an extra that is not always installed

        return run_dask
    raise ValueError(f"`engine` must be one of {', '.join(ENGINES)}, got {name!r}.")
