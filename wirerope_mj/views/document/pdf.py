"""A content as a PDF document: its data for the template that lays them out."""

from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

from wirerope_mj.content.blocks import WIDTH, Block, Chart, Content, Statement
from wirerope_mj.content.numbers import ABSENT, MINUS
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.tables import Table
from wirerope_mj.views.colours import LIGHT
from wirerope_mj.views.pictures import joined_svg
from wirerope_mj.views.typesetting import typeset

_TALLEST = 1.25  # height of a picture, as a fraction of the width of the text: a page without its caption


def write_pdf(content: Content, path: Path) -> None:
    """Write an unfolded content as a PDF; warnings and errors of `typeset`."""
    filed = content.document
    template = Path(__file__).with_name("document.typ").read_text(encoding="utf-8")
    typeset(filed.template if filed and filed.template else template, _report(content), path)


def _report(content: Content) -> Entries:
    """Collect the data that a template reads: texts, tables by rows, drawings as SVG."""
    filed = content.document
    return {
        "colours": LIGHT.named,
        "kind": "Shock and vibration report", "program": f"wirerope-mj {version('wirerope-mj')}", "title": content.title,
        "verdict": _entry(content.verdict), "facts": [*(filed.facts if filed else ()), *content.facts],
        "question": content.question, "logo": list(filed.logo.read_bytes()) if filed and filed.logo else None,
        "document": filed and {
            **{name: getattr(filed, name) for name in ("author", "classification", "reference")},
            "tables": [_entry(table) for table in (filed.signatures(), filed.revisions()) if table],
        },
        "summary": [_entry(block) for section in content.sections if not section.title for block in section.blocks],
        "sections": [
            {"id": section.id, "number": number, "title": section.title, "appendix": section.appendix,
             "blocks": [_entry(block) for block in section.blocks]}
            for number, section in content.numbered
        ],
    }  # fmt: skip


def _entry(block: Block) -> Entries:
    """Write a block as the template reads it: a statement, a table by rows, or a picture as SVG."""
    if isinstance(block, Statement):
        return {"kind": "statement", "id": block.id, "text": block.text, "items": block.items, "tone": block.tone}
    if isinstance(block, Table):
        columns = [{"heading": column.line(), "align": column.align} for column in block.columns]
        rows = [
            [
                {"text": text, "tone": tone, "bar": block.value(number, place) if column.bar else None}
                for place, (column, (text, tone)) in enumerate(zip(block.columns, row, strict=True))
            ]
            for number, row in enumerate(block.marks(absent=ABSENT, minus=MINUS))
        ]
        return {"kind": "table", "id": block.id, "title": block.title, "columns": columns, "rows": rows, "note": block.note}
    bare, alt, part = (block, block.alt, 0.8) if isinstance(block, Chart) else (replace(block, caption=""), block.caption, 0.75)
    svg, height = joined_svg([bare])
    part = min(part, _TALLEST * WIDTH / height)
    return {"kind": "picture", "id": block.id, "svg": svg, "caption": block.caption, "alt": alt, "part": part}
