"""A page as a PDF: WeasyPrint sets it on A4 with the page's own print styles."""

import warnings
from pathlib import Path
from types import ModuleType

from wirerope_mj.foundation.errors import WireRopeError


def write_pdf(page: str, path: Path) -> None:
    """Write the page as a PDF file.

    WireRopeError if WeasyPrint is not installed, or the libraries that it draws with are missing.
    """
    weasyprint = _weasyprint()
    fetcher = weasyprint.urls.URLFetcher(allowed_protocols={"data"})  # a report holds all it needs: nothing is fetched
    weasyprint.HTML(string=page, url_fetcher=fetcher).write_pdf(path, pdf_tags=True)


def check_pdf() -> None:
    """Raise WireRopeError unless PDF files can be written here; for asking before anything long is computed."""
    _weasyprint()


def _weasyprint() -> ModuleType:
    try:
        with warnings.catch_warnings():
            # It announces which system libraries its next versions will need; what is written today needs none of them.
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
