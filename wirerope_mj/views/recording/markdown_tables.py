"""Tables as Markdown, as the viewer and files of text show them."""

from wirerope_mj.foundation.plain_text import markdown
from wirerope_mj.foundation.tables import Table

_SIGNS = ("-", "=")
"""Cells that would begin a list or a heading elsewhere, and nothing here."""


def markdown_table(table: Table) -> str:
    """Return a table below its title; "" without rows."""
    if not table.rows:
        return ""
    lines = [
        [markdown(column.title().replace("\n", " ")) for column in table.columns],
        ["--:" if column.align == "right" else ":--" for column in table.columns],
        *([_cell(*mark) for mark in row] for row in table.marks()),
    ]
    parts = [f"### {markdown(table.title)}"] if table.title else []
    parts.append("\n".join(f"| {' | '.join(line)} |" for line in lines))
    return "\n".join(parts) + (f"\n\n{markdown(table.note)}" if table.note else "")


def _cell(text: str, tone: str) -> str:
    escaped = text if text in _SIGNS else markdown(text)
    return f"**{escaped}**" if tone in ("exceeded", "strong") and text else escaped
