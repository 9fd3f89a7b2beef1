"""A content for paper: nothing is folded away, long tables begin in the text and stand whole in an appendix."""

from collections.abc import Sequence
from dataclasses import replace

from wirerope_mj.content.blocks import Block, Content, Section
from wirerope_mj.foundation.tables import Table

_FITS = 30  # rows of a table that stands whole where it belongs


def with_appendices(content: Content) -> Content:
    """Return the content with every table whole: what is folded on a page goes into appendices behind all sections."""
    sections: list[Section] = []
    appendices: list[Section] = []
    for section in sorted(content.sections, key=lambda one: one.appendix):
        if section.appendix:
            whole = [replace(block, shown=None) if isinstance(block, Table) else block for block in section.blocks]
            appendices.append(_section(section, whole))
            continue
        blocks: list[Block] = []
        for block in section.blocks:
            if isinstance(block, Table) and block.shown is not None and block.shown < len(block.rows) <= _FITS:
                blocks.append(replace(block, shown=None))
            elif isinstance(block, Table) and block.shown is not None and block.shown < len(block.rows):
                letter = letter_of(len(appendices))
                rest = f"{block.shown} of {len(block.rows)} rows; all of them stand in appendix {letter}."
                cut = replace(
                    block, rows=block.rows[: block.shown], shown=None, note=" ".join(filter(None, (block.note, rest)))
                )
                blocks.append(cut)
                title = f"{section.title}: {block.title}" if section.title else block.title
                appendices.append(_section(
                    replace(section, title=title, appendix=True), [replace(block, shown=None)], f"{section.id}-{block.id}",
                ))  # fmt: skip
            else:
                blocks.append(block)
        sections.append(_section(section, blocks))
    return replace(content, sections=(*sections, *appendices))


def letter_of(number: int) -> str:
    """Return the letter of an appendix: A, B, .., Z, AA, .."""
    return chr(ord("A") + number) if number < 26 else letter_of(number // 26 - 1) + letter_of(number % 26)


def _section(section: Section, blocks: Sequence[Block], name: str = "") -> Section:
    return replace(section, id=name or section.id, build=lambda: blocks)
