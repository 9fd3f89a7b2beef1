"""Pictures and report of a study, and its worst variants as runs."""

from pathlib import Path

from wirerope_mj.content.blocks import Chart, Content, SceneView
from wirerope_mj.content.search import front_table, search_content
from wirerope_mj.content.study import measures_table, study_content, worst_table
from wirerope_mj.engine.response import load_response
from wirerope_mj.foundation.atomic_files import write_json
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.runs.write import run_scenario
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.measure import input_names, worst
from wirerope_mj.studies.results.study_summary import summary_of
from wirerope_mj.studies.search.result import SearchResult
from wirerope_mj.studies.study import load_study
from wirerope_mj.views.pictures import save_pictures

MOST = 6  # Variants in one comparison: more cannot be distinguished
_ROWS = 12  # of a table in the viewer


def checked_count(count: int) -> int:
    """Return the number of worst variants that are written; ValueError if it is out of range."""
    if not 0 <= count <= MOST:
        raise ValueError(f"`--open-worst` must be from 0 to {MOST}, got {count}: each becomes a run of its own.")
    return count


def result_content(result: StudyResult, by: str | None = None) -> Content:
    """Compose what a complete study or search says; `by`: measure of a study that is looked at most, see `summary_of`."""
    if not isinstance(result, SearchResult):
        return study_content(summary_of(result, by))
    if by is not None:
        raise ValueError("`by` is for studies: the designs of a search are ordered by what it minimises.")
    return search_content(result)


CONTENT = "content.json"  # What a study or a search says, in its folder; the summary is complete before it


def write_content(content: Content, folder: Path) -> None:
    """Write what a study or a search says into its folder.

    Statements and tables stand in content.json under their ids, each chart is a picture by its id, scenes are placements.png.
    """
    write_json(folder / CONTENT, content.to_dict("answer", "results", "inputs", "worst"))
    blocks = list(content.blocks())
    for chart in blocks:
        if isinstance(chart, Chart):
            save_pictures([chart], folder / f"{chart.id}.png", title=content.title)
    scenes = [block for block in blocks if isinstance(block, SceneView)]
    if scenes:
        save_pictures(scenes, folder / "placements.png", title=content.title)


def write_study_report(
    folder: str | Path, *, by: str | None = None, out: str | Path | None = None, pdf: bool = False, force: bool = False
) -> list[Path]:
    """Write the report of a study, from its folder alone, and return the files, the page first; arguments as `page_files`.

    `by` is the measure that is looked at most; by default the most critical one. RecordError if the folder is not a study that
    is complete, or a file is there and must not be replaced; ValueError for another measure; WireRopeError if a PDF cannot
    be made.
    """
    from wirerope_mj.runs.page import page_files, write_page

    folder = Path(folder)
    files = page_files(folder, out, pdf=pdf, force=force)
    result = load_study(folder)
    if not result.complete:
        raise RecordError(result.message)
    write_page(result_content(result, by), files)
    return files


def write_worst(result: StudyResult, by: str | None, count: int) -> list[Path]:
    """Write the worst variants, or the best designs of a search, as runs, and return the paths that can be opened.

    A run replaces one that is there. The worst have the largest values of the measure `by`, or of that which is looked at
    most; of a search they are its front's: the knee, the ends, those between; without a front those that are nearest to the
    limits.

    Each run is that of the variant alone, with its changes beside the model as written. Two or more are laid over each
    other in one recording, too, which is returned first.
    """
    from wirerope_mj.views.recording import record_overlay
    from wirerope_mj.views.recording.viewer import OVERLAY, WORST

    folders = {}
    checked_count(count)
    by = by or (result.minimise[0] if isinstance(result, SearchResult) else summary_of(result).by)
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
    inputs = {}
    for name in folders:
        row = result.study.row(int(name.split()[1]))
        values = {one: row[one] for one in input_names(result.table)}
        inputs[name] = {one: f"{value:.5g}" if isinstance(value, float) else str(value) for one, value in values.items()}
    if isinstance(result, SearchResult):
        tables = [front_table(result, _ROWS)] if result.front.num_rows else []
    else:
        summary = summary_of(result, by)
        tables = [measures_table(summary), worst_table(summary)]
    return [record_overlay(responses, together, inputs=inputs, tables=tables), *folders.values()]


def _scenario(result: StudyResult, number: int) -> Scenario:
    """Return the scenario of one variant, from the study's folder; its options are the variant's inputs."""
    study, work = result.study, result.study.work
    simulate = {"duration": work.duration, "timestep": work.timestep, "sample_rate": work.sample_rate, "initial": work.initial}
    if len(study.motions) > 1:  # steps of all variants end at the corners of all motions
        simulate["corners"] = work.corners.tolist()
    row = study.row(number)
    return Scenario(
        question=f"{study.question}\n\nThis is variant {number} of the study {study.name}, which has {study.size}.",
        model=result.folder / result.inputs["model"]["file"], motion=study.motion(number), simulate=simulate,
        name=f"{study.name}-{number:06d}", options={name: row[name] for name in input_names(result.table)},
        changes=study.system(number).changes,
    )  # fmt: skip
