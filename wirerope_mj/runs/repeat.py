"""A run computed again from its folder alone."""

import math
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wirerope_mj.content.judged_run import judged_run
from wirerope_mj.engine.response import Response, load_response
from wirerope_mj.engine.simulation import simulate
from wirerope_mj.engine.simulation.in_lanes import moving
from wirerope_mj.engine.simulation.simulate import versions
from wirerope_mj.foundation.errors import RecordError, WireRopeError
from wirerope_mj.foundation.summary import Summarised
from wirerope_mj.runs.differences import Difference, peak_differences, rest_differences, sample_differences, summary_differences
from wirerope_mj.runs.folder import SUMMARY, Alterations, alterations
from wirerope_mj.runs.scenario_file import scenario_content
from wirerope_mj.runs.sources import check_one_run, system_and_motion
from wirerope_mj.runs.summary import read_summary, summary_content
from wirerope_mj.runs.write import is_streamed

# Largest difference relative to a column's peak that another processor's rounding explains; a wrong input is far above.
AGREES = 1e-9


@dataclass(frozen=True, kw_only=True, repr=False)
class Replay(Summarised):
    """Comparison of a run with itself computed again, and the files of its folder that were altered."""

    # every stored number has the same bits: samples, peaks, states, scene, events, step, and those of summary.json
    identical: bool
    # of a stored number: of a sample relative to the largest of its column, of a peak to the largest of its components;
    # infinite where a text differs, or where there is something else
    largest_difference: float
    column: str  # where it is, a column or what else is stored; "" if all is identical
    response: Response | None  # what was computed; None if its samples were streamed and are gone
    # files that are not as they were written; None without checksums, as in older runs
    alterations: Alterations | None = None

    def _summary(self) -> tuple[str, dict[str, str]]:
        lines = {} if self.identical else {"largest difference": f"{self.largest_difference:.1e} in {self.column}"}
        known = "as written" if self.intact else "altered since they were written"
        lines["files"] = "not known" if self.alterations is None else known
        if self.identical:
            return "Replay: every stored number is bit-identical", lines
        return f"Replay: {'in agreement' if self.agrees else 'DIFFERENT'}", lines

    @property
    def agrees(self) -> bool:
        """True if the numbers are the same but for what rounding on another processor explains."""
        return self.identical or self.largest_difference <= AGREES

    @property
    def intact(self) -> bool:
        """True if no file is known to be altered or missing."""
        return self.alterations is None or self.alterations.intact


def replay(folder: str | Path, *, progress: bool = False) -> Replay:
    """Return the comparison of a run with itself computed again; nothing outside its folder is read.

    Raises:
        RecordError: the folder is not a complete run, or its files are damaged or not of one run; names those that were
            altered since it was written.
        ModelError: the model or an isolator in it is not what it must be.
    """
    folder = Path(folder)
    altered = alterations(folder) if folder.is_dir() else None
    with _naming(altered):
        content = scenario_content(folder)
        system, motion = system_and_motion(folder, content)
        stored = load_response(folder)
        check_one_run(folder, content, system, stored)
        computed = summary_content(judged_run(system, motion, stored, content), seconds=0.0)
        same_version = stored.numerics.versions.get("wirerope-mj") == versions()["wirerope-mj"]
        # Folders without checksums are older than some of the sentences.
        texts = same_version and altered is not None
        differences = list(summary_differences(read_summary(folder), computed, texts=texts))
        arguments = {key: value for key, value in content["simulate"].items() if key != "accuracy"}
        arguments.setdefault("engine", "mujoco")  # older runs knew no other
        long = is_streamed(arguments)
        with tempfile.TemporaryDirectory() as out:
            again = simulate(system, motion, **arguments, out=out if long else None, progress=progress)
            differences += sample_differences(stored, again)
            differences += peak_differences(stored, again)
            parts = np.split(moving(system), [system.model.nq, system.model.nq + system.model.nv])
            differences += rest_differences(stored, again, parts)
    difference, where = _largest(differences)
    return Replay(
        identical=not where, largest_difference=difference, column=where, response=None if long else again, alterations=altered
    )


def replay_study(folder: str | Path) -> tuple[float, str]:
    """Simulate every variant of a study or a search again from its folder alone, and compare the tables.

    Returns:
        The largest difference of a measure, relative to the largest of its column, infinite where a text or what is missing
        differs; and the column, "" if every number has the same bits.

    Raises:
        RecordError: the folder is no study, is not complete, or is damaged.
    """
    from wirerope_mj.studies.engines.local import run_local  # late: with it comes all that studies need
    from wirerope_mj.studies.study import chunk_size, chunks, load_study

    result = load_study(folder)
    if not result.complete:
        raise RecordError(result.message)
    study = result.study
    numbers = range(math.ceil(study.size / chunk_size(study)))
    again = {part.number: part.table for part in run_local(study.work, chunks(study, numbers))}
    worst = (0.0, "")
    for name in again[0].column_names:
        old, new = (
            np.concatenate([np.asarray(one[name]) for one in tables])
            for tables in ([result.table], [again[number] for number in numbers])
        )
        same = (old == new) | ((old != old) & (new != new))
        if not same.all():
            sizes = np.abs(old.astype(float)) if old.dtype.kind == "f" else np.ones(1)
            apart = np.abs(old - new)[~same] if old.dtype.kind == "f" else np.array([math.inf])
            size = np.nanmax(sizes) or 1.0
            largest = float(np.nan_to_num(apart, nan=math.inf).max() / size)
            worst = max(worst, (largest, name))
    return worst


@contextmanager
def _naming(altered: Alterations | None) -> Iterator[None]:
    """Name the altered files in the message of what they led to."""
    try:
        yield
    except (WireRopeError, ValueError) as error:
        if altered is None or altered.intact:
            raise
        raise type(error)(f"{error} {altered.text}") from None


def _largest(differences: list[Difference]) -> Difference:
    """Return the largest difference; the summary repeats what the response says, which is named first."""
    nonzero = [one for one in differences if one[0] > 0.0]
    worst = max(nonzero, default=(0.0, ""))
    of_response = max((one for one in nonzero if not one[1].startswith(SUMMARY)), default=worst)
    return of_response if (of_response[0] > AGREES) == (worst[0] > AGREES) else worst
