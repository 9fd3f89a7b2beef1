"""A run or a job handed on, from its folder alone: its report, and a folder that any web server shows."""

import math
import shutil
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

from wirerope_mj.assessment.correlation import correlate
from wirerope_mj.content.blocks import Content
from wirerope_mj.content.correlation import correlation_sections
from wirerope_mj.content.job import job_content
from wirerope_mj.content.run import run_content
from wirerope_mj.engine.response import load_response
from wirerope_mj.foundation.atomic_files import atomic_file, atomic_folder, check_writable
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.exports import picked
from wirerope_mj.foundation.quantities import parse_phrase
from wirerope_mj.runs.analyses import KIND, is_frequency_response, stored_response
from wirerope_mj.runs.folder import alterations, update_checksums, warn_of_alterations
from wirerope_mj.runs.job import is_job, judged_job
from wirerope_mj.runs.measured import tests_of
from wirerope_mj.runs.page import REPORT, page_files, write_page
from wirerope_mj.runs.scenario_file import judged_folder
from wirerope_mj.runs.study import result_content, write_study_report
from wirerope_mj.studies.inputs_file import STUDY
from wirerope_mj.studies.study import load_study
from wirerope_mj.views.recording.viewer import FILE, find_recording
from wirerope_mj.views.share import VIEWER, linked_report, viewer_pages
from wirerope_mj.views.workbook import write_workbook


def write_report(
    folder: str | Path, *, out: str | Path | None = None, pdf: bool = False, force: bool = False, docx: bool = False,
    decks: bool = False,
) -> list[Path]:  # fmt: skip
    """Write the report of a run or a job and return the files, the page first.

    Args:
        folder: of the run or the job; nothing outside it is read.
        out: the page, .html; by default report.html in that folder, which is made anew.
        pdf: whether a PDF is written beside it.
        force: whether files at `out` are replaced.
        docx: whether a DOCX of it is.
        decks: whether the peaks of a run on decks that bend are in it, which four more simulations find.

    Raises:
        RecordError: the folder is not a run, its files are damaged or not of one run, or a file is there and must not be
            replaced.
        WireRopeError: a PDF cannot be made here.
    """
    folder = Path(folder)
    if decks and (is_job(folder) or (folder / STUDY).is_file()):
        raise ValueError("`decks` is for the report of one run.")
    if (folder / STUDY).is_file() and not docx:
        return write_study_report(folder, out=out, pdf=pdf, force=force)
    files = page_files(folder, out, pdf=pdf, force=force, docx=docx)
    write_page(_content_of(folder, decks=decks), files)
    if not is_job(folder):
        update_checksums(folder, files)
    return files


def _content_of(folder: Path, *, decks: bool = False) -> Content:
    """Compose the content of a run or a job."""
    if is_job(folder):
        return job_content(judged_job(folder))
    warn_of_alterations(_run_folder(folder))
    run = replace(judged_folder(folder), decks=decks)
    content = run_content(run)
    tests = tuple(correlate(run.response, test) for test in tests_of(folder))
    return replace(content, sections=(*content.sections, *correlation_sections(tests))) if tests else content


# Functions that write a content and samples as a file, by the file's ending.
RENDERERS = {".xlsx": write_workbook}


def write_content_of(folder: Path, out: Path, *, channels: Sequence[str] = (), force: bool = False) -> Path:
    """Write the content of a run, job, study or frequency response as a file of `RENDERERS`, with columns as `channels` match.

    RecordError if the folder is none of them, or the file cannot be written; ValueError if a pattern matches no column, or
    a job has none.
    """
    write = RENDERERS[out.suffix.lower()]
    if (folder / STUDY).is_file():
        study = load_study(folder)
        return write(result_content(study), picked(study.exported, channels or ["*"]), out, force=force)
    if is_frequency_response(folder):
        content, curves = stored_response(folder)
        return write(content, picked(curves, channels or ["*"]), out, force=force)
    if is_job(folder) and channels:
        raise ValueError("`channels` are those of one run: name the folder of a load case, JOB/cases/NAME.")
    samples = picked(load_response(folder).exported, channels) if channels else None
    return write(_content_of(folder), samples, out, force=force)


def write_still(folder: Path, out: Path, *, at: str | None = None, force: bool = False) -> Path:
    """Write the scene of a run at an instant, "120 ms", or at its most critical verdict, as a PNG; return its path.

    RecordError if the folder is no run, or the file is there and must not be replaced; ValueError if the instant is no time
    within the run, or nothing has moved at it.
    """
    from wirerope_mj.content.scene_outline import scene_at, worst_instant
    from wirerope_mj.views.pictures import save_pictures

    check_writable(out, force=force)
    run = judged_folder(_run_folder(folder))
    view = worst_instant(run) if at is None else scene_at(run.response, _instant(at, float(run.response.time[-1])))
    if view is None:
        raise ValueError("nothing that is drawn has moved from its modelled place at this instant; say another with `at`.")
    save_pictures([view], out, title=run.title)
    return out


def write_films(
    folders: Sequence[Path], out: Path, *, gif: bool = False, at: str | None = None, force: bool = False
) -> list[Path]:  # fmt: skip
    """Write a film of one run, or of two beside each other, as .mp4, and with `gif` as .gif beside it; return the files.

    It shows the 400 ms about the worst instant, or about `at`, "120 ms". RecordError if a folder is no run, nothing of it is
    judged over time or moves, or a file is there and must not be replaced; ValueError if the instant is no time within the
    runs; WireRopeError if nothing writes films here.
    """
    from wirerope_mj.content.film import film_of
    from wirerope_mj.views.film import write_film

    if out.suffix.lower() != ".mp4" or len(folders) not in (1, 2):
        raise ValueError("a film is made of one run or two, and its file ends with .mp4: wirerope film RUN [RUN] OUT.mp4")
    files = [out, out.with_suffix(".gif")] if gif else [out]
    for file in files:
        check_writable(file, force=force)
    names = [folder.resolve().name for folder in folders]
    if len(set(names)) < len(names):
        names = list(map(str, folders))
    runs = {name: judged_folder(_run_folder(folder)) for name, folder in zip(names, folders, strict=True)}
    last = min(float(run.response.time[-1]) for run in runs.values())
    film = film_of(runs, None if at is None else _instant(at, last))
    with ExitStack() as stack:
        write_film(film, *(stack.enter_context(atomic_file(file)) for file in files))
    return files


def _instant(text: str, last: float) -> float:
    """Read an instant within a run [s]; ValueError for another text."""
    try:
        (instant,) = parse_phrase(text, words={}).quantities["time"]
    except (KeyError, ValueError):
        instant = math.nan
    if not 0.0 <= instant <= last:
        raise ValueError(f'`at` must be a time within the run, 0 to {last:g} s, such as "120 ms"; got {text!r}.')
    return instant


def _run_folder(folder: Path) -> Path:
    """Return the folder; RecordError if it is not that of a run."""
    if not folder.is_dir():
        raise RecordError(f"{folder}: there is no such folder; a report is made of the folder that `wirerope run` wrote.")
    if is_frequency_response(folder):
        raise RecordError(f"{folder}: this is a {KIND}, whose {REPORT} stands in its folder; reports are made of runs.")
    return folder


INDEX = "index.html"


def share_run(folder: str | Path, out: str | Path, *, force: bool = False) -> list[Path]:
    """Write a run as a folder to be handed on, whole or not at all, and return its files.

    Nothing in it needs the network: a web server hands it out from any place, as `python -m http.server` does. RecordError
    if the run has no report or no recording, or one that is a link or was altered since it was written, or `out` lies in
    the run, or is there and `force` does not replace it; WireRopeError if the viewer does not hand out its files.
    """
    folder, target = Path(folder), Path(out)
    report = folder / REPORT
    if not report.is_file():
        raise RecordError(f"{folder}: there is no {REPORT} here to share. `wirerope report {folder}` makes one of a run.")
    recording = find_recording(folder)
    if target.resolve().is_relative_to(folder.resolve()):
        raise RecordError(f"{target}: this is inside the run, whose files are its record; choose a place outside.")
    for file in (report, recording):
        if file.is_symlink():
            raise RecordError(
                f"{file}: this is a link, and what it leads to is not the run's to share. Put the file itself in "
                f"its place; `wirerope report {folder}` writes the report anew."
            )
    if (changed := alterations(folder)) is not None:  # else a run of an older version
        names = {file.relative_to(folder).as_posix() for file in (report, recording)}
        if faulty := sorted(names & {*changed.altered, *changed.added}):
            raise RecordError(
                f"{folder}: {' and '.join(faulty)} was altered or added since the run was written, and is not shared. "
                f"`wirerope report {folder}` writes the report anew; a recording is written with its run."
            )
    with atomic_folder(target, force=force, kind="shared run", marks=(INDEX, f"{VIEWER}/{INDEX}")) as beside:
        pages = viewer_pages()
        (beside / INDEX).write_text(linked_report(report.read_text(encoding="utf-8")), encoding="utf-8")
        shutil.copyfile(recording, beside / FILE)
        (beside / VIEWER).mkdir()
        for name, content in pages.items():
            (beside / VIEWER / name).write_bytes(content)
    return sorted(path for path in target.rglob("*") if path.is_file())
