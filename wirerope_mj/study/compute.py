"""What every engine computes: the rows of some variants, from what all variants share and their own inputs."""

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import Any

import pyarrow as pa

from wirerope_mj.errors import WireRopeError
from wirerope_mj.simulation import BatchFailure, BatchResult, simulate_batch
from wirerope_mj.study.measures import NAN, measure_names, measures
from wirerope_mj.study.sampling import arrow_type
from wirerope_mj.study.variants import Maker, Work

DONE, FAILED = "done", "failed"
"""What `status` says."""


@dataclass(frozen=True, kw_only=True)
class Chunk:
    """Some variants that are computed together.

    Attributes:
        number: of the chunk, which names its part of the table.
        rows: "variant" and inputs of every variant.
    """

    number: int
    rows: Sequence[dict[str, Any]]


Engine = Callable[..., Generator[tuple[int, pa.Table], None, None]]
"""`engine(work, chunks, *, workers, address)` yields number and table of chunks, as they are ready, in any order.

`chunks` may be long and is read as workers become free. Of a chunk that cannot be computed it yields
`failed(work, chunk, message)`.
"""


def schema(work: Work) -> pa.Schema:
    """Return names and types of the table's columns."""
    fields = [("variant", pa.int64()), *((column.name, arrow_type(column)) for column in work.columns)]
    fields += [(name, pa.float64()) for name in measure_names(work.system)]
    return pa.schema([*fields, ("status", pa.string()), ("message", pa.string())])


def compute(work: Work, chunk: Chunk) -> pa.Table:
    """Return the rows of a chunk, the same in any process; variants that fail have rows, too."""
    return _table(work, chunk, _outcomes(work, chunk.rows))


def failed(work: Work, chunk: Chunk, message: str) -> pa.Table:
    """Return the rows of a chunk that could not be computed at all."""
    return _table(work, chunk, [message] * len(chunk.rows))


Outcome = dict[str, float] | str
"""Measures of a variant, or why it failed."""


def _outcomes(work: Work, rows: Sequence[dict[str, Any]]) -> list[Outcome]:
    make = Maker(work.system, work.motions, work.columns)
    found: dict[int, Outcome] = {}
    systems, motions, places = [], [], []
    for place, row in enumerate(rows):
        try:
            system, motion = make.system(row), make.motion(row)
        except (ValueError, WireRopeError) as error:
            found[place] = str(error)
        else:
            systems.append(system)
            motions.append(motion)
            places.append(place)
    try:
        results = simulate_batch(
            systems, motions, duration=work.duration, timestep=work.timestep, initial=work.initial,
            sample_rate=work.sample_rate, corners=work.corners, threads=1,
        )  # fmt: skip
    except Exception as error:  # whatever one variant does must not cost the others their results
        if len(rows) > 1:
            return [outcome for row in rows for outcome in _outcomes(work, [row])]
        return [f"{type(error).__name__}: {error}"]
    for place, system, result in zip(places, systems, results, strict=True):
        found[place] = _outcome(system, result)
    return [found[place] for place in range(len(rows))]


def _outcome(system: Any, result: BatchResult | BatchFailure) -> Outcome:
    return result.message if isinstance(result, BatchFailure) else measures(system, result.peaks)


def _table(work: Work, chunk: Chunk, outcomes: Sequence[Outcome]) -> pa.Table:
    nothing = dict.fromkeys(measure_names(work.system), NAN)
    rows = [
        {**row, **nothing, "status": FAILED, "message": outcome}
        if isinstance(outcome, str)
        else {**row, **outcome, "status": DONE, "message": ""}
        for row, outcome in zip(chunk.rows, outcomes, strict=True)
    ]
    return pa.Table.from_pylist(rows, schema=schema(work))
