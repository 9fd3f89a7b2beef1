"""What a report is made of: sections of paragraphs, tables and pictures, with nothing left to compute."""

from dataclasses import dataclass

from wirerope_mj.foundation.tables import Cell, Column, Mark
from wirerope_mj.foundation.tables import Table as OneTable
from wirerope_mj.views.plots.report_image import Image


@dataclass(frozen=True, kw_only=True)
class Paragraph:
    """Running text, set by its tone, one of `foundation.tables.TONES`."""

    text: str
    tone: str = ""


@dataclass(frozen=True, kw_only=True)
class Listing:
    """Short statements below each other."""

    items: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Table:
    """A table of texts, until every report uses `foundation.tables`.

    Attributes:
        caption: what it shows, above it.
        head: headings of the columns.
        rows: cells, as many in each row as there are headings.
        align: a letter for each column: "l" words, "r" numbers, "t" words that may take several lines.
        note: what must be known to read it, below it.
    """

    caption: str
    head: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    align: str
    note: str = ""

    def __post_init__(self) -> None:
        if len(self.align) != len(self.head) or not set(self.align) <= set("lrt"):
            raise ValueError(f"`align` must be {len(self.head)} letters of l, r and t, got {self.align!r}.")
        self.table()

    def table(self) -> OneTable:
        """Return it as the one type of tables."""
        sides = {"l": "left", "r": "right", "t": "text"}
        columns = [Column(head, align=sides[letter]) for head, letter in zip(self.head, self.align, strict=True)]  # type: ignore[arg-type]
        return OneTable(title=self.caption, columns=columns, rows=self.rows, note=self.note)


@dataclass(frozen=True, kw_only=True)
class Picture:
    """An image with what it shows: `caption` below it, and `alt` for who cannot see it."""

    image: Image
    caption: str
    alt: str


Block = Paragraph | Listing | Table | OneTable | Picture


@dataclass(frozen=True, kw_only=True)
class Section:
    """A part of the report with a heading; `blocks` in reading order. One without blocks is left out."""

    title: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True, kw_only=True)
class ReportContent:
    """A report, ready to be set.

    Attributes:
        title: what was simulated.
        facts: name and value of what stands below the title: model, base motion, date.
        question: what was asked, one text for each paragraph.
        verdict: the answer in a few words, set apart by its tone.
        answer: what these words rest on.
        sections: everything else.
    """

    title: str
    facts: tuple[tuple[str, str], ...]
    question: tuple[str, ...]
    verdict: Mark
    answer: tuple[Block, ...]
    sections: tuple[Section, ...]
