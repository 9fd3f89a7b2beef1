"""Files of a report: the page, and its PDF."""

from pathlib import Path

from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.views.report import check_pdf, write_pdf

REPORT = "report.html"  # The report in a folder


def page_files(folder: Path, out: str | Path | None, *, pdf: bool, force: bool) -> list[Path]:
    """Return the files that a report will be, the page first, before anything is computed.

    Args:
        folder: of the run or the study.
        out: the page, .html; None: report.html in the folder, which is made anew.
        pdf: whether a PDF of the page stands beside it.
        force: whether files at `out` are replaced.

    Raises:
        ValueError: the page does not end with .html.
        RecordError: a file is there and must not be replaced.
        WireRopeError: a PDF cannot be made here.
    """
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
    return files


def write_page(text: str, files: list[Path]) -> None:
    """Write a page to the first of `files`, and its PDF to the second if there is one, each whole or not at all."""
    page, *pdf = files
    page.parent.mkdir(parents=True, exist_ok=True)
    with atomic_file(page) as beside:
        beside.write_text(text, encoding="utf-8")
    for path in pdf:
        with atomic_file(path) as beside:
            write_pdf(text, beside)
