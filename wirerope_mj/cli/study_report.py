"""`wirerope study-report`: one page of a study that can be handed over."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from wirerope_mj.foundation.plain_text import plain


def study_report(
    folder: Path,
    *,
    by: str | None = None,
    out: Path | None = None,
    pdf: Annotated[bool, Parameter(negative=())] = False,
    force: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Make the report of a study: one HTML page that holds everything it shows, and a PDF of it.

    The verdict first, then the varied quantities, the measures and their distributions, the inputs that matter and the worst
    variants.

    Args:
        folder: folder of a study.
        by: measure that is looked at most; travel if anything is rated.
        out: the page, .html; report.html in the study's folder by default, where it is made anew.
        pdf: write a PDF of the page beside it, which needs the extra "pdf" (WeasyPrint).
        force: replace files that `--out` names.
    """
    from wirerope_mj.runs.study_report import write_study_report

    for path in write_study_report(folder, by=by, out=out, pdf=pdf, force=force):
        print(plain(f"written: {path} ({path.stat().st_size / 1e6:.2f} MB)"))
    return 0
