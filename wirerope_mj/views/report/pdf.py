"""A page as a PDF: WeasyPrint sets it on A4 with the page's own print styles."""

import logging
import warnings
from pathlib import Path
from types import ModuleType

from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.views.plots.letters import text_of, warn_of_letters


def write_pdf(page: str, path: Path) -> None:
    """Write the page as a PDF file.

    Warns of the names that no font of this machine has letters for. WireRopeError if WeasyPrint is not installed, or the
    libraries that it draws with are missing.
    """
    weasyprint = _weasyprint()
    fetcher = weasyprint.urls.URLFetcher(allowed_protocols={"data"})  # a report holds all it needs: nothing is fetched
    missing = _MissingLetters()
    logger = logging.getLogger("weasyprint")
    logger.addHandler(missing)
    try:
        weasyprint.HTML(string=page, url_fetcher=fetcher).write_pdf(path, pdf_tags=True)
    finally:
        logger.removeHandler(missing)
    warn_of_letters(text_of(page), missing.letters)


class _MissingLetters(logging.Handler):
    """Collects the letters for which WeasyPrint, which lays out with the fonts of this machine, has drawn boxes."""

    def __init__(self) -> None:
        super().__init__()
        self.letters = set[str]()

    def emit(self, record: logging.LogRecord) -> None:
        if str(record.msg).startswith(".notdef") and isinstance(record.args, tuple):
            self.letters.add(str(record.args[0]))


def check_pdf() -> None:
    """Raise WireRopeError unless PDF files can be written here."""
    _weasyprint()


def _weasyprint() -> ModuleType:
    try:
        with warnings.catch_warnings():
            # It announces which system libraries its next versions will need.
            warnings.simplefilter("ignore", DeprecationWarning)
            import weasyprint.urls
    except ModuleNotFoundError:
        text = "a PDF needs WeasyPrint: pip install 'wirerope-mj[pdf]'. Or print the HTML page from a browser."
        raise WireRopeError(text) from None
    except OSError as error:  # Pango is loaded as a shared library when WeasyPrint is imported
        raise WireRopeError(
            f"a PDF needs Pango, which WeasyPrint cannot load ({' '.join(str(error).split())}). Install Pango from your "
            "system's packages, or print the HTML page from a browser."
        ) from None
    return weasyprint
