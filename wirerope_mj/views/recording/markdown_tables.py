"""Blocks as Markdown, as the viewer and files of text show them."""

from collections.abc import Iterable

from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.foundation.plain_text import markdown
from wirerope_mj.foundation.tables import Table

_SIGNS = ("-", "=")
"""Cells that would begin a list or a heading elsewhere, and nothing here."""


def markdown_blocks(blocks: Iterable[Block | None]) -> str:
    """Write statements and tables below each other; charts and scenes have views of their own."""
    parts = []
    for block in blocks:
        if isinstance(block, Statement):
            parts.append(markdown_statement(block))
        elif isinstance(block, Table):
            parts.append(markdown_table(block))
    return "\n\n".join(filter(None, parts))


def markdown_statement(statement: Statement) -> str:
    """Return a sentence, bold where it is strong, and the list below it."""
    text, items = markdown(statement.text), "\n".join(f"- {markdown(item)}" for item in statement.items)
    strong = f"**{text}**" if text and statement.tone in ("exceeded", "strong") else text
    return "\n\n".join(filter(None, (strong, items)))


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
