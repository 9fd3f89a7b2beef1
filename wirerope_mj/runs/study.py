"""Pictures of a study, and its worst variants as runs."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from wirerope_mj.content.search_tables import front_table
from wirerope_mj.content.study_tables import measures_table, worst_table
from wirerope_mj.engine.response import load_response
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.tables import Table
from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.runs.write import run_scenario
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.measure import input_names
from wirerope_mj.studies.results.statistics import worst
from wirerope_mj.studies.results.study_summary import StudySummary, summary_of
from wirerope_mj.studies.search.result import SearchResult

if TYPE_CHECKING:
    from wirerope_mj.views.plots.study_pictures import StudyPicture

MOST = 6
"""Variants in one comparison: more cannot be distinguished."""

_ROWS = 12  # of a table in the viewer


def checked_count(count: int) -> int:
    """Return the number of worst variants that are written; ValueError if it is out of range."""
    if not 0 <= count <= MOST:
        raise ValueError(f"`--open-worst` must be from 0 to {MOST}, got {count}: each becomes a run of its own.")
    return count


def write_study_pictures(summary: StudySummary) -> list[Path]:
    """Write the pictures of a study into its folder and return them."""
    from wirerope_mj.views.plots.study_pictures import study_pictures  # late: matplotlib takes a while

    return _write(summary.result.folder, study_pictures(summary))


def write_search_pictures(result: SearchResult) -> list[Path]:
    """Write the pictures of a search into its folder and return them."""
    from wirerope_mj.views.plots.search import search_pictures  # late, too

    return _write(result.folder, search_pictures(result))


def _write(folder: Path, pictures: "Sequence[StudyPicture]") -> list[Path]:
    paths = []
    for picture in pictures:
        paths.append(folder / f"{picture.name}.png")
        with atomic_file(paths[-1]) as temporary_path:
            picture.figure.savefig(temporary_path, format="png", dpi=150)
    return paths


def write_worst(result: StudyResult, by: str, count: int) -> list[Path]:
    """Write the worst variants, or the best designs of a search, as runs, and return the paths that can be opened.

    A run replaces one that is there. Of a search they are its front's: the knee, the ends, those between; without a front
    those that are nearest to the limits.

    Each run is that of the variant alone, with its changes beside the model as written. Two or more are laid over each other in
    one recording, too, which is returned first.

    Args:
        result: of the study.
        by: measure whose largest values are the worst.
        count: how many.
    """
    from wirerope_mj.views.recording import record_overlay
    from wirerope_mj.views.recording.viewer import OVERLAY, WORST

    folders = {}
    checked_count(count)
    best = result.chosen[:count] if isinstance(result, SearchResult) else []
    for number in best or worst(result.independent, by, count):
        folder = result.folder / WORST / f"variant-{number:06d}"
        run_scenario(_scenario(result, number), folder, force=True)
        folders[f"variant {number}"] = folder
    if not folders:
        raise RecordError(f"{result.folder}: no variant has a value of {by!r}.")
    together = result.folder / WORST / OVERLAY
    if len(folders) < 2:
        together.unlink(missing_ok=True)  # of others that were written before
        return list(folders.values())
    responses = {name: load_response(folder) for name, folder in folders.items()}
    inputs = {name: _inputs(result, int(name.split()[1])) for name in folders}
    return [record_overlay(responses, together, inputs=inputs, tables=_tables(result, by)), *folders.values()]


def _tables(result: StudyResult, by: str) -> list[Table]:
    """Return the tables of a study or a search that stand beside its worst variants."""
    if isinstance(result, SearchResult):
        return [front_table(result, _ROWS)] if result.front.num_rows else []
    summary = summary_of(result, by)
    return [measures_table(summary), worst_table(summary, _ROWS, inputs=4)]


def _inputs(result: StudyResult, number: int) -> dict[str, str]:
    """Return the inputs of a variant as text."""
    row = result.study.row(number)
    return {
        name: f"{row[name]:.5g}" if isinstance(row[name], float) else str(row[name])
        for name in input_names(result.table)
    }


def _scenario(result: StudyResult, number: int) -> Scenario:
    """Return the scenario of one variant, from the study's folder; its options are the variant's inputs."""
    study, work = result.study, result.study.work
    simulate = {
        "duration": work.duration, "timestep": work.timestep, "sample_rate": work.sample_rate, "initial": work.initial,
    }  # fmt: skip
    if len(study.motions) > 1:  # steps of all variants end at the corners of all motions
        simulate["corners"] = work.corners.tolist()
    row = study.row(number)
    return Scenario(
        question=f"{study.question}\n\nThis is variant {number} of the study {study.name}, which has {study.size}.",
        model=result.folder / result.inputs["model"]["file"],
        motion=study.motion(number),
        simulate=simulate,
        name=f"{study.name}-{number:06d}",
        options={name: row[name] for name in input_names(result.table)},
        changes=study.system(number).changes,
    )
