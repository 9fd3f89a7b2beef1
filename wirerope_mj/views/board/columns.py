"""What stands beside the drawing of a board, as HTML: templates that are filled in, and content in the width of a column."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from wirerope_mj.content.blocks import Block, Chart, Statement
from wirerope_mj.foundation.tables import Table
from wirerope_mj.views.plots.svg_chart import chart_svg
from wirerope_mj.views.report.page import blocks_html

_TEMPLATES = Environment(
    loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined, trim_blocks=True
)  # fmt: skip
_WIDTH = 400.0  # of a chart in the column, in pixels


def fragment(template: str, **content: Any) -> str:
    """Write a template that lies beside this file."""
    return _TEMPLATES.get_template(template).render(content)


def column_html(blocks: Iterable[Block | None]) -> Markup:
    """Write blocks for a column: the panels of charts below each other, without drawings of the scene."""
    written = []
    for block in blocks:
        if isinstance(block, Chart):
            chart = replace(block, rows=[[panel] for row in block.rows for panel in row])
            written.append(Markup('<figure class="drawn">{}<figcaption>{}</figcaption></figure>').format(
                Markup(chart_svg(chart, _WIDTH)), chart.caption
            ))  # fmt: skip
        elif isinstance(block, Statement | Table):
            written.append(Markup(blocks_html([block])))
    return Markup("\n").join(written)
