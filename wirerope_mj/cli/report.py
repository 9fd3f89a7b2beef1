"""`wirerope report` and `study-report`: one page of a run, a job or a study that can be handed over."""

from collections.abc import Iterable
from pathlib import Path

from wirerope_mj.cli.options import Decks, Flag
from wirerope_mj.foundation.plain_text import plain


def report(
    folder: Path, *, out: Path | None = None, pdf: Flag = False, docx: Flag = False, decks: Decks = False, force: Flag = False
) -> int:
    """Make the report of a run, a job or a study: one HTML page that holds everything it shows, and a PDF or DOCX of it.

    Question and verdicts first, then model and mounts with the provenance of their figures, statics, modes, the base's motion,
    peaks, histories, loops and spectra. Everything comes from the folder.

    Args:
        folder: folder of a run, of a job as `wirerope cases` writes it, or of a study, which has no DOCX.
        out: the page, .html; report.html in the folder by default, where it is made anew.
        pdf: write a PDF of the page beside it, which needs the extra "pdf" (Typst).
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
    return _written(write_report(folder, out=out, pdf=pdf, force=force, docx=docx, decks=decks))


def study_report(
    folder: Path, *, by: str | None = None, out: Path | None = None, pdf: Flag = False, force: Flag = False
) -> int:  # fmt: skip
    """Make the report of a study: one HTML page that holds everything it shows, and a PDF of it.

    The verdict first, then the varied quantities, the measures and their distributions, the inputs that matter and the worst
    variants.

    Args:
        folder: folder of a study.
        by: measure that is looked at most; by default the most critical one.
        out: the page, .html; report.html in the study's folder by default, where it is made anew.
        pdf: write a PDF of the page beside it, which needs the extra "pdf" (Typst).
        force: replace files that `--out` names.
    """
    from wirerope_mj.runs.study import write_study_report

    return _written(write_study_report(folder, by=by, out=out, pdf=pdf, force=force))


def _written(files: Iterable[Path]) -> int:
    """Print where files were written and how large they are."""
    for path in files:
        print(plain(f"written: {path} ({path.stat().st_size / 1e6:.2f} MB)"))
    return 0
