"""Decks and equipment that bend: a panel of one mode, and parts by their modes, in a model of any."""

from pathlib import Path

from wirerope_mj.engine.flexible.files import load_flexible as load_flexible
from wirerope_mj.engine.flexible.files import save_flexible as save_flexible
from wirerope_mj.engine.flexible.panel import Panel as Panel
from wirerope_mj.engine.flexible.panel import panel_of_phrase as panel_of_phrase
from wirerope_mj.engine.flexible.part import FlexiblePart as FlexiblePart

Deck = Panel | FlexiblePart


def deck_of(text: str) -> Deck:
    """Read a deck: the folder of a flexible part, or a phrase such as "10 Hz 800 kg 4 %"."""
    return load_flexible(text) if Path(text).is_dir() else panel_of_phrase(text)
