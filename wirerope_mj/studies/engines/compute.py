"""Computation of some variants of a study, the same in a process of this machine and on a cluster."""

from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyarrow as pa

from wirerope_mj.assessment.criteria.ended import GROWTH, growth_note
from wirerope_mj.engine.response.response import FILE
from wirerope_mj.engine.simulation import BatchFailure, BatchResult
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.studies.ended import Lengths, growth_text
from wirerope_mj.studies.engines.together import NONE, Together, go_alone, together, together_again
from wirerope_mj.studies.measures import NAN, latest_extreme, measure_names, measures, needs_samples
from wirerope_mj.studies.vary.variants import Maker, Work

UNLOADED = "unloaded"  # The start of a variant that does not begin at rest
DONE, FAILED = "done", "failed"  # Values of `status`
_OF_LIMITS = ("travel", "combined_travel", "fragility", "clearance")  # measures over their limits


@dataclass(frozen=True, kw_only=True)
class Chunk:
    """Some variants that are computed together."""

    number: int  # of the chunk, which names its part of the table
    rows: Sequence[Entries]  # "variant" and inputs of every variant
    responses: bool = False  # whether whole responses are kept of them


@dataclass(frozen=True, kw_only=True)
class Part:
    """Result of a chunk: its rows of the study's table, and whole responses if they are kept."""

    number: int
    table: pa.Table  # its rows of the table
    # by variant the content of the file of its response, if it is kept; of those that failed there is none
    responses: dict[int, bytes] = field(default_factory=dict)
    # whether no process lived long enough to compute it, or an accident kept one from it: its rows say so, and it is
    # computed again on resume
    died: bool = False


# `engine(work, chunks, *, workers, address)` yields the parts of chunks, as they are ready, in any order. `chunks` may be
# long and is read as workers become free. Of a chunk that cannot be computed it yields `failed_part(work, chunk, message)`.
Engine = Callable[..., Generator[Part, None, None]]


# Errors that a variant's own numbers lead to, the next time too.
_RESULTS = (ValueError, ArithmeticError, WireRopeError)


def schema(work: Work) -> pa.Schema:
    """Return names and types of the columns of a study's table."""
    fields = [("variant", pa.int64()), *((column.name, column.type) for column in work.columns)]
    fields += [(name, pa.float64()) for name in measure_names(work.system)]
    return pa.schema([*fields, ("status", pa.string()), ("message", pa.string())])


def compute(work: Work, chunk: Chunk) -> Part:
    """Compute a chunk, with the same result in any process; variants that fail have rows, too."""
    responses: dict[int, bytes] = {}
    alone = chunk.responses or needs_samples(work.system)  # responses are those of single systems
    done = NONE if alone else _side_by_side(partial(together, work, chunk.rows))
    rest = np.setdiff1d(np.arange(len(chunk.rows)), done.indices).tolist()
    outcomes = _outcomes(work, [chunk.rows[i] for i in rest], responses if chunk.responses else None) if rest else []
    accident = any(isinstance(outcome, Accident) for outcome in outcomes)
    table = _table(work, chunk, dict(zip(rest, outcomes, strict=True)), done)
    return Part(number=chunk.number, table=table, responses=responses, died=accident)


def _side_by_side(go: Callable[[], Together]) -> Together:
    """Return the result of `go`, or `NONE` if it raises, so that every variant is computed alone."""
    try:
        return go()
    except Exception:  # whatever one variant does must not cost the others their results: each says alone what it is
        return NONE


def failed_part(work: Work, chunk: Chunk, message: str) -> Part:
    """Return the part of a chunk whose process died each time."""
    return Part(number=chunk.number, table=_table(work, chunk, dict.fromkeys(range(len(chunk.rows)), message)), died=True)


class Accident(str):
    """Message of an error that says nothing about its variant, as of a machine without memory, threads or files."""


@dataclass(frozen=True)
class Measured:
    """Measures of a variant, and the instant of its latest significant extreme [s]."""

    values: Mapping[str, float]
    late: float


Outcome = Measured | str  # What came of a variant, or why it failed


def _outcomes(work: Work, rows: Sequence[Entries], responses: dict[int, bytes] | None) -> list[Outcome]:
    """Simulate each row as a system of its own; return measures or error message of each; `responses` collects responses."""
    make = Maker(work.system, work.motions, work.columns)
    outcomes: dict[int, Outcome] = {}
    systems, motions, indices = [], [], []
    for index, row in enumerate(rows):
        try:
            system, motion = make.system(row), make.motion(row)
        except (ValueError, WireRopeError) as error:
            outcomes[index] = str(error)
        else:
            systems.append(system)
            motions.append(motion)
            indices.append(index)
    try:
        results = go_alone(work, systems, motions, threads=1, responses=responses is not None or needs_samples(work.system))
    except Exception as error:  # whatever one variant does must not cost the others their results
        if len(rows) > 1:
            return [outcome for row in rows for outcome in _outcomes(work, [row], responses)]
        return [failure_message(error)]
    for index, system, result in zip(indices, systems, results, strict=True):
        outcomes[index] = _outcome(work, system, result)
        if responses is not None and isinstance(result, BatchResult) and result.response is not None:
            with TemporaryDirectory() as folder:  # the content of its file is a fraction of the samples
                result.response.save(folder)
                responses[int(rows[index]["variant"])] = (Path(folder) / FILE).read_bytes()
    return [outcomes[index] for index in range(len(rows))]


def nominal(work: Work) -> Mapping[str, float] | str:
    """Return the measures of the nominal system under the first motion, or the reason why there are none."""
    try:
        (result,) = go_alone(work, [work.system], [work.motions[0]], threads=1, responses=needs_samples(work.system))
    except _RESULTS as error:
        return failure_message(error)
    outcome = _outcome(work, work.system, result)
    return outcome if isinstance(outcome, str) else outcome.values


def failure_message(error: Exception) -> str:
    """Return the message of an error, as an Accident unless the variant's own numbers lead to it."""
    if isinstance(error, WireRopeError):
        return str(error)
    quoted = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    if isinstance(error, _RESULTS):
        return (
            f"the numbers of this variant cannot be computed with ({quoted}). Simulate it alone, or vary less far from the "
            "nominal system."
        )
    return Accident(
        f"the computer or the program, not this variant's numbers, kept it from being computed ({quoted}). Free memory, or "
        "use fewer `workers`, and go on with --resume (`resume=True`)."
    )


def _outcome(work: Work, system: System, result: BatchResult | BatchFailure) -> Outcome:
    """Return the measures of a variant that was simulated, or the message of its failure."""
    if isinstance(result, BatchFailure):
        return result.message
    rest = None if work.initial == UNLOADED else result.initial_state
    values = measures(system, result.peaks, rest, result.response if needs_samples(system) else None)
    return Measured(values, latest_extreme(system, result.peaks))


def _values(work: Work, n: int, outcomes: Mapping[int, Outcome], done: Together) -> tuple[dict[str, Array], Array]:
    """Return the measures of n variants by name, (n,) each, NaN if failed, and instants of latest significant extremes [s]."""
    values, ends = {name: np.full(n, NAN) for name in measure_names(work.system)}, np.zeros(n)
    for name, column in done.columns.items():
        values[name][done.indices] = column
    ends[done.indices] = done.late
    for index, outcome in outcomes.items():
        if isinstance(outcome, Measured):
            ends[index] = outcome.late
            for name, column in values.items():  # what is there of a stop that is absent has measures that no stop has
                column[index] = outcome.values[name]
    return values, ends


def _growing(
    work: Work, begin: float, rows: Sequence[Entries], values: Mapping[str, Array], which: Sequence[int], done: Together
) -> list[list[str]]:
    """Return the kinds of measures of variants that grow after `begin` [s], by computing the variants up to `begin` again."""
    # What has a limit may grow by `GROWTH` of it, as in a run, and what has none by as much of itself.
    shorter = replace(work, duration=begin)
    again = _side_by_side(partial(together_again, shorter, done, which))
    rest = np.setdiff1d(np.arange(len(rows)), again.indices).tolist()
    outcomes = dict(zip(rest, _outcomes(shorter, [rows[i] for i in rest], None), strict=True)) if rest else {}
    before, _ = _values(shorter, len(rows), outcomes, again)
    kinds: list[dict[str, None]] = [{} for _ in rows]
    for name, until in before.items():
        reached, kind = values[name][which], name.partition("/")[0]
        allowed = GROWTH * (1.0 if kind in _OF_LIMITS else reached)
        for number in np.flatnonzero(reached - until > allowed):
            kinds[number][kind] = None
    return [list(values) for values in kinds]


def _table(work: Work, chunk: Chunk, outcomes: Mapping[int, Outcome], done: Together = NONE) -> pa.Table:
    """Return the rows of a chunk, from single outcomes by their index and from those computed side by side."""
    n, lengths = len(chunk.rows), Lengths(work)
    values, ends = _values(work, n, outcomes, done)
    slowest = np.full(n, NAN)
    slowest[done.indices] = done.slowest
    status = [DONE] * n
    messages = [""] * n
    begins: dict[float, list[int]] = {}
    for index, row in enumerate(chunk.rows):
        if isinstance(failed := outcomes.get(index), str):
            messages[index], status[index] = failed, FAILED
            continue
        messages[index] = lengths.early(row, float(slowest[index]))
        if not messages[index] and ends[index] > (begin := lengths.quiet_from(row)):
            begins.setdefault(begin, []).append(index)
    for begin, which in begins.items():
        for index, kinds in zip(which, _growing(work, begin, [chunk.rows[i] for i in which], values, which, done), strict=True):
            messages[index] = growth_text(growth_note(work.duration), kinds) if kinds else ""
    inputs = ["variant", *(column.name for column in work.columns)]
    columns = {name: [row[name] for row in chunk.rows] for name in inputs} | values
    return pa.table(columns | {"status": status, "message": messages}, schema=schema(work))
