"""Content of a report: sections of paragraphs, tables and pictures, with nothing left to compute."""

from dataclasses import dataclass

from wirerope_mj.foundation.tables import Mark, Table
from wirerope_mj.views.plots.report_image import Image
from wirerope_mj.views.plots.svg_chart import Chart


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
class Picture:
    """An image with what it shows: `caption` below it, and `alt` for who cannot see it."""

    image: Image | Chart
    caption: str
    alt: str


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """Drawings beside or below each other, with what they show below them.

    Attributes:
        svgs: SVG elements of `views.plots`, in which every text is escaped.
        caption: what they show.
    """

    svgs: tuple[str, ...]
    caption: str


@dataclass(frozen=True, kw_only=True)
class Folded:
    """A table of which only the first rows are shown at once, and printed."""

    table: Table
    shown: int


Block = Paragraph | Listing | Table | Folded | Picture | Drawing


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
        verdict: the conclusion in short, set apart by its tone.
        answer: the grounds of the verdict.
        sections: everything else.
    """

    title: str
    facts: tuple[tuple[str, str], ...]
    question: tuple[str, ...]
    verdict: Mark
    answer: tuple[Block, ...]
    sections: tuple[Section, ...]
