"""What a report is made of: sections of paragraphs, tables and pictures, with nothing left to compute."""

from dataclasses import dataclass

from wirerope_mj.views.plots.report_image import Image

TONES = ("", "within", "exceeded", "unjudged", "quiet", "strong")
"""How a cell or a paragraph is set; the words say the same, so that nothing is told by colour alone."""


@dataclass(frozen=True, kw_only=True)
class Mark:
    """Text in a cell that is set apart by one of `TONES`."""

    text: str
    tone: str

    def __post_init__(self) -> None:
        if self.tone not in TONES:
            raise ValueError(f"`tone` must be one of {', '.join(map(repr, TONES))}, got {self.tone!r}.")


Cell = str | Mark


@dataclass(frozen=True, kw_only=True)
class Paragraph:
    """Running text; `tone` is one of `TONES`."""

    text: str
    tone: str = ""


@dataclass(frozen=True, kw_only=True)
class Listing:
    """Short statements below each other."""

    items: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Table:
    """Rows under a heading.

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
        for row in self.rows:
            if len(row) != len(self.head):
                raise ValueError(f"`rows` must have {len(self.head)} cells each, got {row!r}.")


@dataclass(frozen=True, kw_only=True)
class Picture:
    """An image with what it shows: `caption` below it, and `alt` for who cannot see it."""

    image: Image
    caption: str
    alt: str


Block = Paragraph | Listing | Table | Picture


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
