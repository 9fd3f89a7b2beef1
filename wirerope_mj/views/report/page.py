"""The page of a content, HTML that holds everything it shows, and the PDF of it."""

import logging
import math
import warnings
from base64 import b64encode
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from wirerope_mj.content.blocks import Chart, Content, SceneView, Statement, letter_of
from wirerope_mj.content.numbers import ABSENT, MINUS
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.foundation.plain_text import plain_lines
from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.views.plots.letters import text_of, warn_of_letters
from wirerope_mj.views.plots.scene_svg import scene_svgs
from wirerope_mj.views.plots.svg_chart import chart_svg

_FOLDER = Path(__file__).parent
_LONG = 30  # letters of a cell that may be broken anywhere, rather than widen its column


def report_html(content: Content) -> str:
    """Write a content as an HTML page that holds its styles and pictures; every text is escaped."""
    # Whatever a user has named reaches the page through the template, which escapes it.
    css = Markup((_FOLDER / "report.css").read_text(encoding="utf-8").strip())
    template = _environment().get_template("report.html.jinja")
    script = (_FOLDER / "read_curves.js").read_text(encoding="utf-8").strip()
    titled = [section for section in content.sections if section.title and section.blocks]
    filed = content.document
    logo = ""
    if filed and filed.logo:  # as the address of itself, so that the page needs no other file
        picture = filed.logo.read_bytes()
        kind = "png" if picture.startswith(b"\x89PNG") else "jpeg"
        logo = Markup(f"data:image/{kind};base64,{b64encode(picture).decode('ascii')}")
    page = template.render(
        content=content, sections=[section for section in titled if not section.appendix],
        appendices=[section for section in titled if section.appendix], letter=letter_of,
        logo=logo, css=css, script=Markup(script),
        script_hash=f"sha256-{b64encode(sha256(script.encode()).digest()).decode('ascii')}",
        version=version("wirerope-mj"),
    )  # fmt: skip
    return page + "\n"


@cache
def _environment() -> Environment:
    def shown(value: object) -> object:
        return plain_lines(value) if isinstance(value, str) and not isinstance(value, Markup) else value

    def instant(column: Column, value: object) -> float | None:  # of the run, that a cell gives [s]
        inside = column.unit == "s" and column.heading in ("at", "first touch")
        return float(value) if inside and isinstance(value, int | float) and math.isfinite(value) else None

    environment = Environment(
        loader=FileSystemLoader(_FOLDER), autoescape=True, undefined=StrictUndefined, trim_blocks=True, finalize=shown
    )
    environment.filters |= {
        "svg": lambda chart: Markup(chart_svg(chart)),  # whose texts are escaped where they are put in
        "drawings": lambda view: Markup("".join(scene_svgs(view))),  # so, too
        "named": lambda block: Markup(f' data-id="{escape(plain_lines(block.id))}"') if block.id else "",
        "breakable": lambda text: " long" if len(text) > _LONG else "",
        "instant": instant,
        "letter": lambda column: column.align[0],
        "heading": lambda column: column.title().replace("/\n", "/").replace("\n", " "),
        "cells": lambda table: table.marks(absent=ABSENT, minus=MINUS),
    }
    for name, kind in (("statement", Statement), ("table", Table), ("chart", Chart), ("scene", SceneView)):
        environment.tests[name] = lambda item, kind=kind: isinstance(item, kind)
    return environment


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
