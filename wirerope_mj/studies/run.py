"""The run of a study: chunks of variants handed to an engine, and their parts written as they are ready."""

import math
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from time import perf_counter

from wirerope_mj.engine.simulation.progress import share_bar
from wirerope_mj.foundation.arguments import integer, one_of
from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.engines.compute import Chunk, Engine
from wirerope_mj.studies.engines.local import run_local
from wirerope_mj.studies.folder import done, write_part
from wirerope_mj.studies.measures import needs_samples
from wirerope_mj.studies.responses import PEAKS, RESPONSES, most_together

CHUNK, LARGEST_CHUNK = 32, 512  # variants, at the least and at the most: enough that stepping costs more than handing over
STEPS = 1_000_000  # mounts times steps of a chunk, about: half a second of a processor, which a kill may cost each worker
FEWEST_CHUNKS = 16  # Chunks that a small study has, so that all workers have something to do until the end
ENGINES = ("local", "dask")


def compute_missing(study: StudyDefinition, folder: Path, keep: str, run: Engine, progress: bool) -> None:
    """Write the parts that are missing as they are ready."""
    size = chunk_size(study, keep)
    missing = sorted(set(range(math.ceil(study.size / size))) - done(folder))
    already = study.size - sum(min(size, study.size - number * size) for number in missing)
    with share_bar(
        "study", "variants/s", total=study.size, parts="variants", enabled=progress, begun=already / study.size
    ) as update:
        began, ended = perf_counter(), 0
        with closing(run(study.work, chunks(study, missing, keep))) as results:  # no process goes on after this one
            for part in results:
                write_part(folder, part)
                ended += part.table.num_rows
                update((already + ended) / study.size, ended / (perf_counter() - began))


def chunk_size(study: StudyDefinition, keep: str = PEAKS) -> int:
    """Return how many variants a chunk has; the study alone says it, so that it may go on with other workers."""
    each = max(len(study.base.mounts), 1) * study.work.duration / study.work.timestep
    size = min(max(CHUNK, min(int(STEPS / each), LARGEST_CHUNK)), math.ceil(study.size / FEWEST_CHUNKS))
    return min(size, most_together(study.work)) if keep == RESPONSES or needs_samples(study.base) else size


def chunks(study: StudyDefinition, numbers: Sequence[int], keep: str = PEAKS) -> Iterator[Chunk]:
    """Yield the chunks of some numbers."""
    size = chunk_size(study, keep)
    for number in numbers:
        rows = study.table().slice(number * size, size).to_pylist()
        yield Chunk(number=number, rows=rows, responses=keep == RESPONSES)


def checked_engine(name: str, *, workers: int | None, address: str | None) -> Engine:
    """Return the engine of a name.

    ValueError if there is none, or the other arguments do not suit it; SimulationError if its cluster does not answer.
    """
    if workers is not None:
        integer("workers", workers, least=1)
    one_of("engine", name, ENGINES)
    if name == "local":
        if address is not None:
            raise ValueError(f"`address` is for an engine with a cluster; the local engine has none, got {address!r}.")
        return run_local
    from wirerope_mj.studies.engines.dask_engine import check_cluster, run_dask  # an extra that is not always installed

    check_cluster(workers, address)  # before anything is checked or written
    return run_dask
