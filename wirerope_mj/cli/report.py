"""`wirerope report`: one page of a run or a job that can be handed over."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from wirerope_mj.foundation.plain_text import plain


def report(
    folder: Path,
    *,
    out: Path | None = None,
    pdf: Annotated[bool, Parameter(negative=())] = False,
    docx: Annotated[bool, Parameter(negative=())] = False,
    force: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Make the report of a run, a job or a study: one HTML page that holds everything it shows, and a PDF or DOCX of it.

    Question and verdicts first, then model and mounts with the provenance of their figures, statics, modes, the base's motion,
    peaks, histories, loops and spectra. Everything comes from the folder.

    Args:
        folder: folder of a run, of a job as `wirerope cases` writes it, or of a study, which has no DOCX.
        out: the page, .html; report.html in the folder by default, where it is made anew.
        pdf: write a PDF of the page beside it, which needs the extra "pdf" (WeasyPrint).
        docx: write a DOCX document beside it, which needs the extra "docx" (python-docx).
        force: replace files that `--out` names.
    """
    from wirerope_mj.foundation.atomic_files import check_writable
    from wirerope_mj.runs.page import REPORT
    from wirerope_mj.runs.report import write_report

    if out is not None:
        check_writable(out)
    elif folder.is_dir():  # what is no folder at all has a message of its own
        check_writable(folder / REPORT)
    for path in write_report(folder, out=out, pdf=pdf, force=force, docx=docx):
        print(plain(f"written: {path} ({path.stat().st_size / 1e6:.2f} MB)"))
    return 0
