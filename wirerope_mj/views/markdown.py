"""Content as Markdown, as the viewer of recordings and files of text show it."""

from collections.abc import Iterable

from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.foundation.plain_text import markdown
from wirerope_mj.foundation.tables import Table

_SIGNS = ("-", "=")  # cells that are not escaped: inside a table they begin no list or heading
_BOLD = ("exceeded", "strong")


def markdown_blocks(blocks: Iterable[Block | None]) -> str:
    parts = []
    for block in blocks:
        if isinstance(block, Statement):
            parts.append(markdown_statement(block))
        elif isinstance(block, Table):
            parts.append(markdown_table(block))
    return "\n\n".join(filter(None, parts))


def markdown_statement(statement: Statement) -> str:
    items = "\n".join(f"- {markdown(item)}" for item in statement.items)
    return "\n\n".join(filter(None, (_emphasised(markdown(statement.text), statement.tone), items)))


def markdown_table(table: Table) -> str:
    """Write a table below its title; "" without rows."""
    if not table.rows:
        return ""
    lines = [
        [markdown(column.title().replace("\n", " ")) for column in table.columns],
        ["--:" if column.align == "right" else ":--" for column in table.columns],
        *([_emphasised(text if text in _SIGNS else markdown(text), tone) for text, tone in row] for row in table.marks()),
    ]
    parts = [f"### {markdown(table.title)}"] if table.title else []
    parts.append("\n".join(f"| {' | '.join(line)} |" for line in lines))
    return "\n".join(parts) + (f"\n\n{markdown(table.note)}" if table.note else "")


def _emphasised(text: str, tone: str) -> str:
    return f"**{text}**" if text and tone in _BOLD else text
