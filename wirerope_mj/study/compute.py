"""What every engine computes: the rows of some variants, from what all variants share and their own inputs."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import pyarrow as pa


@dataclass(frozen=True, kw_only=True)
class Work:
    """What all variants of a study share; can be pickled, and needs no file."""


@dataclass(frozen=True, kw_only=True)
class Chunk:
    """Some variants that are computed together.

    Attributes:
        number: of the chunk, which names its part of the table.
        rows: "variant" and inputs of every variant.
    """

    number: int
    rows: Sequence[dict[str, Any]]


Engine = Callable[..., Iterator[tuple[int, pa.Table]]]
"""`engine(work, chunks, *, workers, address)` yields number and table of chunks, as they are ready, in any order.

`chunks` may be long and is read as workers become free. A chunk that cannot be computed yields `failed(work, chunk, message)`."""


def compute(work: Work, chunk: Chunk) -> pa.Table:
    """Return the rows of a chunk; variants that fail are rows, too. A pure function: any process may call it."""
    raise NotImplementedError


def failed(work: Work, chunk: Chunk, message: str) -> pa.Table:
    """Return the rows of a chunk that could not be computed at all."""
    raise NotImplementedError


def run_local(work: Work, chunks: Iterable[Chunk], *, workers: int | None, address: None = None) -> Iterator[tuple[int, pa.Table]]:
    """In study/local.py; study/dask_engine.py has `run_dask` of the same form."""
    raise NotImplementedError
