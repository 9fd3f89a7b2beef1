"""Figures that show every text as it is, laid out once and drawn once."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

from matplotlib.backend_bases import RendererBase
from matplotlib.figure import Figure
from matplotlib.text import Text

from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.plain_text import plain_lines


class PlainFigure(Figure):
    """A figure in which no text is a formula: a name may hold a dollar sign, or a letter that the font does not have."""

    def savefig(self, fname: Any, **kwargs: Any) -> None:
        """Write the figure, a file whole or not at all; it is laid out without the drawing that `Figure` lays it out by."""
        engine = self.get_layout_engine()
        if engine is not None:
            self._make_plain()
            with _missing_letters_allowed():
                engine.execute(self)
            self.set_layout_engine(None)  # "none" would leave a placeholder, for which `Figure` draws twice
        if not isinstance(fname, str | Path):
            super().savefig(fname, **kwargs)
            return
        # In memory first: on a full disk matplotlib's writers end with errors of their own.
        path, drawn = Path(fname), BytesIO()
        super().savefig(drawn, **{"format": path.suffix[1:] or "png"} | kwargs)
        with atomic_file(path) as temporary:
            temporary.write_bytes(drawn.getvalue())

    def draw(self, renderer: RendererBase) -> None:
        """Draw the figure; whatever it is written to passes here."""
        self._make_plain()
        with _missing_letters_allowed():
            super().draw(renderer)

    def _make_plain(self) -> None:
        for text in self.findobj(Text):
            text.set_parse_math(False)
            text.set_text(plain_lines(text.get_text()))


@contextmanager
def _missing_letters_allowed() -> Iterator[None]:
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from font")  # a box is drawn instead
        yield
