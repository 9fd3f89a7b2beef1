"""The report of a run or a job, from its folder alone: what that does not hold, statics, modes, spectra, is computed here."""

from pathlib import Path

from wirerope_mj.content.job import job_content
from wirerope_mj.content.run import run_content
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.runs.checksums import update_checksums, warn_of_alterations
from wirerope_mj.runs.frequency_response import KIND, MARKS
from wirerope_mj.runs.job import is_job, judged_job
from wirerope_mj.runs.page import REPORT, page_files, write_page
from wirerope_mj.runs.sources import judged_folder


def write_report(
    folder: str | Path, *, out: str | Path | None = None, pdf: bool = False, force: bool = False, docx: bool = False
) -> list[Path]:
    """Write the report of a run or a job and return the files, the page first.

    Args:
        folder: of the run or the job; nothing outside it is read.
        out: the page, .html; by default report.html in that folder, which is made anew.
        pdf: whether a PDF of the page is written beside it.
        force: whether files at `out` are replaced.
        docx: whether a DOCX of it is.

    Raises:
        RecordError: the folder is not a run, its files are damaged or not of one run, or a file is there and must not be
            replaced.
        WireRopeError: a PDF cannot be made here.
    """
    folder = Path(folder)
    files = page_files(folder, out, pdf=pdf, force=force, docx=docx)
    if is_job(folder):
        write_page(job_content(judged_job(folder)), files)
        return files
    warn_of_alterations(_run_folder(folder))
    write_page(run_content(judged_folder(folder)), files)
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
