"""The page of a content: HTML that holds everything it shows."""

import math
from base64 import b64encode
from collections.abc import Iterable
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from wirerope_mj.content.blocks import Block, Chart, Content, SceneView, Statement, letter_of
from wirerope_mj.content.numbers import ABSENT, MINUS
from wirerope_mj.foundation.plain_text import plain_lines
from wirerope_mj.foundation.tables import LONGEST_BAR, Column, Table
from wirerope_mj.views.colours import style_sheet
from wirerope_mj.views.plots.scene_svg import scene_svgs
from wirerope_mj.views.plots.svg_chart import chart_svg

_FOLDER = Path(__file__).parent
_LONG = 30  # letters of a cell that may be broken anywhere, rather than widen its column


def report_html(content: Content) -> str:
    """Write a content as an HTML page that holds its styles and pictures; every text is escaped."""
    # Whatever a user has named reaches the page through the template, which escapes it.
    css = Markup(f"{block_styles()}\n{(_FOLDER / 'report.css').read_text(encoding='utf-8').strip()}")
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


def block_styles() -> str:
    """Write the styles of blocks and the colours that they take, for any page that shows them."""
    return f"{style_sheet()}\n{(_FOLDER / 'blocks.css').read_text(encoding='utf-8').strip()}"


def blocks_html(blocks: Iterable[Block | None]) -> str:
    """Write blocks as HTML, as they stand in a page; every text is escaped."""
    block = _environment().get_template("blocks.html.jinja").module.block  # type: ignore[attr-defined]
    return "\n".join(str(block(item)) for item in blocks if item is not None)


@cache
def _environment() -> Environment:
    """Make the environment of the page's templates: safe texts, and filters and tests for blocks."""

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
        "fraction": lambda cell: f"{min(cell.content, LONGEST_BAR):.4g}",
        "letter": lambda column: column.align[0],
        "heading": Column.line,
        "cells": lambda table: table.marks(absent=ABSENT, minus=MINUS),
    }
    for name, kind in (("statement", Statement), ("table", Table), ("chart", Chart), ("scene", SceneView)):
        environment.tests[name] = lambda item, kind=kind: isinstance(item, kind)
    return environment
