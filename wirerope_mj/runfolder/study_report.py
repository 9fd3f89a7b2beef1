"""The report of a study, from its folder alone."""

from pathlib import Path

from wirerope_mj.errors import RecordError
from wirerope_mj.report.page import report_html
from wirerope_mj.report.pdf import check_pdf, write_pdf
from wirerope_mj.report.study import study_content
from wirerope_mj.study.findings import HEADLINES, checked_measure, headlines, input_names
from wirerope_mj.study.result import load_study
from wirerope_mj.study.sensitivity import influences
from wirerope_mj.whole import written_whole

REPORT = "report.html"


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
    page = folder / REPORT if out is None else Path(out)
    if page.suffix.lower() not in (".html", ".htm"):
        raise ValueError(
            f"`out` must end with .html, got {str(out)!r}; a PDF is written beside it with --pdf (`pdf=True`)."
        )
    files = [page, page.with_suffix(".pdf")] if pdf else [page]
    for path in files:
        if out is not None and path.exists() and not (force and path.is_file()):
            raise RecordError(
                f"{path}: this exists already. Replace it with --force (`force=True`), or choose another name."
            )
    if pdf:
        check_pdf()
    result = load_study(folder)
    if not result.complete:
        raise RecordError(result.message)
    table = result.table
    by = checked_measure(table, by or (headlines(table) or HEADLINES)[0])
    text = report_html(study_content(result, by, influences(table, input_names(table), by)))
    page.parent.mkdir(parents=True, exist_ok=True)
    with written_whole(page) as beside:
        beside.write_text(text, encoding="utf-8")
    if pdf:
        with written_whole(files[1]) as beside:
            write_pdf(text, beside)
    return files
