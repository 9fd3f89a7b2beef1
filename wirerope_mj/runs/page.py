"""Files of a report: the page, and its PDF and DOCX."""

from pathlib import Path

from wirerope_mj.content.blocks import Content, with_appendices
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError

REPORT = "report.html"  # The report in a folder


def page_files(folder: Path, out: str | Path | None, *, pdf: bool, force: bool, docx: bool = False) -> list[Path]:
    """Return the files that a report will consist of, the page first, before anything is computed.

    The page, .html, is `out`, or report.html in the folder of the run or the study, which is made anew; a PDF and a DOCX of
    it stand beside it. ValueError if the page does not end with .html; RecordError if a file is at `out` that `force` does
    not replace; WireRopeError if a PDF or a DOCX cannot be made here.
    """
    from wirerope_mj.views.document import check_docx  # late: its libraries take long to import
    from wirerope_mj.views.typesetting import load_typst

    page = folder / REPORT if out is None else Path(out)
    if page.suffix.lower() not in (".html", ".htm"):
        raise ValueError(f"`out` must end with .html, got {str(out)!r}; a PDF is written beside it with --pdf (`pdf=True`).")
    wanted = ((".pdf", pdf, load_typst), (".docx", docx, check_docx))
    files = [page, *(page.with_suffix(ending) for ending, asked, _ in wanted if asked)]
    for path in files:
        if out is not None and path.exists() and not (force and path.is_file()):
            raise RecordError(f"{path}: this exists already. Replace it with --force (`force=True`), or choose another name.")
    for _, asked, check in wanted:
        if asked:
            check()
    return files


def write_page(content: Content, files: list[Path]) -> None:
    """Write a content as page, PDF or DOCX, by the endings of the files, each whole or not at all.

    On paper nothing is folded away: long tables stand whole in appendices.
    """
    from wirerope_mj.views.document import write_docx, write_pdf
    from wirerope_mj.views.report import report_html

    files[0].parent.mkdir(parents=True, exist_ok=True)
    whole = with_appendices(content) if len(files) > 1 else content
    for path in files:
        with atomic_file(path) as beside:
            if path.suffix == ".docx":
                write_docx(whole, beside)
            elif path.suffix == ".pdf":
                write_pdf(whole, beside)
            else:
                beside.write_text(report_html(content), encoding="utf-8")
