"""The report of a run, from its folder alone: what the run does not hold, statics, modes and spectra, is computed here."""

from dataclasses import replace
from pathlib import Path

from wirerope_mj.assessment.correlation import correlate
from wirerope_mj.content.correlation import correlation_sections
from wirerope_mj.content.judged_run import judged_run
from wirerope_mj.content.run import run_content
from wirerope_mj.engine.response import load_response
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.runs.checksums import update_checksums, warn_of_alterations
from wirerope_mj.runs.frequency_response import KIND, MARKS
from wirerope_mj.runs.measured import tests_of
from wirerope_mj.runs.page import REPORT, page_files, write_page
from wirerope_mj.runs.scenario_file import scenario_content
from wirerope_mj.runs.sources import check_one_run, system_and_motion
from wirerope_mj.views.report import report_html


def write_report(
    folder: str | Path, *, out: str | Path | None = None, pdf: bool = False, force: bool = False
) -> list[Path]:
    """Write the report of a run and return the files, the page first.

    Args:
        folder: of the run; nothing outside it is read.
        out: the page, .html; by default report.html in the run's folder, which is made anew.
        pdf: whether a PDF of the page is written beside it.
        force: whether files at `out` are replaced.

    Raises:
        RecordError: the folder is not a run, its files are damaged or not of one run, or a file is there and must not be
            replaced.
        WireRopeError: a PDF cannot be made here.
    """
    folder = Path(folder)
    files = page_files(folder, out, pdf=pdf, force=force)
    warn_of_alterations(_run_folder(folder))
    content = scenario_content(folder)
    system, motion = system_and_motion(folder, content)
    response = load_response(folder)
    check_one_run(folder, content, system, response)
    page = run_content(judged_run(system, motion, response, content))
    tests = tuple(correlate(response, one) for one in tests_of(folder))
    if tests:
        page = replace(page, sections=(*page.sections, *correlation_sections(tests)))
    write_page(report_html(page), files)
    update_checksums(folder, files)
    return files


def _run_folder(folder: Path) -> Path:
    """Return the folder; RecordError if it is something else than a run."""
    if not folder.is_dir():
        raise RecordError(
            f"{folder}: there is no such folder; a report is made of the folder that `wirerope run` wrote."
        )
    if all((folder / mark).is_file() for mark in MARKS):
        raise RecordError(f"{folder}: this is a {KIND}, whose {REPORT} stands in its folder; reports are made of runs.")
    return folder
