"""Content as plain values: what a file of a result says under the ids that every output uses."""

from wirerope_mj.content.blocks import Content, Statement
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.tables import Table


def plain_content(content: Content, *sections: str) -> Entries:
    """Return statements and tables of some sections by their ids, the headline first: SI values, texts and tones."""
    said: Entries = {"headline": _statement(content.verdict)}
    for section in content.sections:
        for block in section.blocks if section.id in sections else ():
            if isinstance(block, Table) and block.id:
                said[block.id] = block.to_dict()
            elif isinstance(block, Statement) and block.id:
                said[block.id] = _statement(block)
    return said


def _statement(block: Statement) -> Entries:
    parts = {"text": block.text, "items": list(block.items), "tone": block.tone, "values": dict(block.values)}
    return {name: part for name, part in parts.items() if part}
