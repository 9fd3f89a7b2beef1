"""Figures that show every text as it is."""

import warnings
from typing import Any

from matplotlib.figure import Figure
from matplotlib.text import Text

from wirerope_mj.foundation.plain_text import plain_lines


class PlainFigure(Figure):
    """A figure in which no text is a formula: a name may hold a dollar sign, or a letter that the font does not have."""

    def draw(self, renderer: Any) -> None:
        """Draw the figure; whatever it is written to passes here."""
        for text in self.findobj(Text):
            text.set_parse_math(False)
            text.set_text(plain_lines(text.get_text()))
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Glyph .* missing from font")  # it draws a box instead
            super().draw(renderer)
