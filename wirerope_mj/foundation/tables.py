"""A table, the same for the screen, the page of a report and the text of a recording, each of which renders it in its wing."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.units import force_unit, in_unit, significant

# Tones in which a cell or a paragraph is set; the text says the same, so that nothing depends on colour alone.
TONES = ("", "within", "near", "exceeded", "unjudged", "quiet", "strong")
# Numbers to the right, names to the left on one line, text to the left on as many lines as it needs.
Alignment = Literal["right", "left", "text"]
# Text as it is displayed, or an SI value, which the column displays in its unit; None and NaN become a dash.
Content = str | float | None


@dataclass(frozen=True)
class Mark:
    """Content of a cell that is set apart by one of `TONES`."""

    content: Content
    tone: str

    def __post_init__(self) -> None:
        one_of("tone", self.tone, TONES)


Cell = Content | Mark
Row = Sequence[Cell]


@dataclass(frozen=True)
class Column:
    """Heading of a column, and how its cells are set."""

    heading: str = ""  # without the unit; may hold a line break for narrow screens
    unit: str = ""  # in which the values of its cells are displayed, in brackets after the heading; "" for none
    form: str | int = 3  # of its values: a format specification, or a number of significant digits without an exponent
    align: Alignment = "right"
    bar: bool = False  # whether fractions of a limit are drawn as bars, with a tick at the limit, beside their numbers

    def title(self, separator: str = " ") -> str:
        return f"{self.heading}{separator}[{self.unit}]" if self.unit else self.heading

    def line(self) -> str:
        return self.title().replace("/\n", "/").replace("\n", " ")

    def text(self, value: float | None, absent: str = "-") -> str:
        """Format an SI value in the column's unit and form; `absent` if it is None, infinite or NaN."""
        if value is None or not math.isfinite(value):
            return absent
        shown = in_unit(value, self.unit)
        return significant(shown, self.form) if isinstance(self.form, int) else format(shown, self.form)


FIGURE_SPACE = "\N{FIGURE SPACE}"  # as wide as a digit
LONGEST_BAR = 1.25  # of a limit that a bar shows


def bar_text(used: float, cells: int, empty: str = "░", eighths: str = "") -> str:
    """Draw a utilisation as a bar of letters: `cells` of them up to the limit, a tick, and a quarter as many beyond it.

    `empty` fills cells without a bar; the bar's last cell is drawn by one of eight letters, `eighths`, or else is whole.
    """
    parts = len(eighths) or 1
    whole, rest = divmod(round(parts * cells * min(max(used, 0.0), LONGEST_BAR)), parts)
    drawn = ("█" * whole + (eighths[rest] if rest else "")).ljust(round(cells * LONGEST_BAR), empty)
    return f"{drawn[:cells]}│{drawn[cells:]}"


def left(*headings: str) -> list[Column]:
    return [Column(heading, align="left") for heading in headings]


@dataclass(frozen=True)
class Table:
    """Rows under headings; every row has as many cells as there are columns. Forces below 1 kN are displayed in N."""

    id: str = ""  # the same in every output; "" for a table that only one output has
    title: str = ""  # what it shows, above it
    columns: Sequence[Column] = ()
    rows: Sequence[Row] = ()
    note: str = field(default="", kw_only=True)  # what must be known to read it, below it
    shown: int | None = field(default=None, kw_only=True)  # rows at once, where others can be folded away; None for all

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.columns):
                raise ValueError(f"`rows` must have {len(self.columns)} cells each, got {row!r}.")
        strong = [number for number, column in enumerate(self.columns) if column.unit == "kN"]
        values = [plain for row in self.rows for number in strong if isinstance(plain := _plain(row[number]), float)]
        if values and force_unit(max(map(abs, values))) == "N":
            weak = [
                replace(column, unit="N", form=column.form if isinstance(column.form, int) else "z.1f")
                for column in self.columns
            ]
            columns = [weak[number] if number in strong else column for number, column in enumerate(self.columns)]
            object.__setattr__(self, "columns", columns)

    def to_dict(self) -> Entries:
        """Return titles, headings, units and rows as JSON takes them: values in SI, cells without one as None."""
        return {
            "title": self.title,
            "columns": [{"heading": " ".join(column.heading.split()), "shown_in": column.unit} for column in self.columns],
            "rows": [[_plain(cell) for cell in row] for row in self.rows],
            **({"note": self.note} if self.note else {}),
        }

    def value(self, row: int, column: int) -> float | None:
        """Return the number in a cell; None without one."""
        plain = _plain(self.rows[row][column])
        return plain if isinstance(plain, float) else None

    def marks(self, *, absent: str = "-", minus: str = "-", bars: int = 0) -> list[list[tuple[str, str]]]:
        """Write text and tone of every cell, with these signs for absent values and for minus.

        Where a column has bars they stand before its numbers, `bars` letters long up to the limit; 0 for none.
        """
        rows = [[_mark(*pair, absent, minus) for pair in zip(self.columns, row, strict=True)] for row in self.rows]
        for number in (number for number, column in enumerate(self.columns) if bars and column.bar):
            for row, marks in enumerate(rows):
                text, tone = marks[number]
                marks[number] = f"{bar_text(self.value(row, number) or 0.0, bars)}{text.rjust(4, FIGURE_SPACE)}", tone
        return rows


def _plain(cell: Cell) -> Content:
    """Return the content of a cell; None in place of NaN and infinite numbers."""
    content = cell.content if isinstance(cell, Mark) else cell
    return None if isinstance(content, float) and not math.isfinite(content) else content


def _mark(column: Column, cell: Cell, absent: str, minus: str) -> tuple[str, str]:
    """Write text and tone of a cell, with these signs for an absent value and for minus."""
    content, tone = (cell.content, cell.tone) if isinstance(cell, Mark) else (cell, "")
    if isinstance(content, str):
        return content, tone
    text = column.text(content, absent)
    return (text if text == absent else text.replace("-", minus)), tone
