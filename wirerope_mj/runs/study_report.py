"""The report of a study, from its folder alone."""

from pathlib import Path

from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.runs.report import page_files, write_page
from wirerope_mj.studies.results.study_summary import summary_of
from wirerope_mj.studies.search.result import SearchResult
from wirerope_mj.studies.study import load_study
from wirerope_mj.views.report.page import report_html
from wirerope_mj.views.report.search import search_content
from wirerope_mj.views.report.study import study_content


def write_study_report(
    folder: str | Path,
    *,
    by: str | None = None,
    out: str | Path | None = None,
    pdf: bool = False,
    force: bool = False,
) -> list[Path]:
    """Write the report of a study and return the files, the page first.

    Args:
        folder: of the study; nothing outside it is read.
        by: measure that is looked at most; travel if anything is rated.
        out: the page, .html; by default report.html in the study's folder, which is made anew.
        pdf: whether a PDF of the page is written beside it.
        force: whether files at `out` are replaced.

    Raises:
        RecordError: the folder is not a study that is complete, or a file is there and must not be replaced.
        ValueError: there is no such measure.
        WireRopeError: a PDF cannot be made here.
    """
    folder = Path(folder)
    files = page_files(folder, out, pdf=pdf, force=force)
    result = load_study(folder)
    if not result.complete:
        raise RecordError(result.message)
    if by is not None and isinstance(result, SearchResult):
        raise ValueError("`by` is for studies: the designs of a search are ordered by what it minimises.")
    content = search_content(result) if isinstance(result, SearchResult) else study_content(summary_of(result, by))
    write_page(report_html(content), files)
    return files
