"""The content of a result: sections of statements, tables, charts and scenes with ids, document data, and appendices."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Annotated, Literal

import numpy as np

from wirerope_mj.content.numbers import paragraphs
from wirerope_mj.engine.response.scene import Scene
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.schema import example
from wirerope_mj.foundation.structure import DATE, Key
from wirerope_mj.foundation.tables import TONES, Column, Table, left

WIDTH, LEFT, RIGHT = 760.0, 58.0, 16.0  # of a chart, about pixels of a page; margins beside its panels
# What a curve is of, which gives it its colour in every output (`views/colours.py`); `LIMIT` must not be exceeded
BASE, OTHERS, LIMIT, EXCEEDED, MEASURED, MODEL = "base", "others", "limit", "exceeded", "measured", "model"
PAYLOADS, MOUNTS = ("payload", "payload-2", "payload-3"), ("mount", "mount-2", "mount-3")  # the most critical ones first


@dataclass(frozen=True)
class Curve:
    """A curve of a panel: a line, dots or bars."""

    # x, y: positions, (n,)
    x: Array
    y: Array
    _: KW_ONLY
    name: str  # in the legend; "" for a curve without a name
    kind: int | str  # what it is of, by name; a number among runs, cases, levels or choices that a chart compares
    marks: bool = False  # whether dots are drawn at the positions instead of a line
    bars: float = 0.0  # height of the bars that go from zero to each x instead; 0 for none
    ends: Array | None = None  # of an interval across the end of each bar, (n, 2)
    dash: str = ""  # "dashed" or "dotted"
    weight: float = 1.0  # width of the line, size of the dots, times the usual
    opacity: float = 1.0  # from 0 to 1, by which curves of a family are told apart
    # largest value of every step and where it is; None if unmarked
    peak: tuple[float, float] | None = None


@dataclass(frozen=True, kw_only=True)
class Field:
    """Values on a grid over two axes, drawn as coloured cells."""

    # x, y: edges of the cells, (n_x + 1,) and (n_y + 1,), rising
    x: Array
    y: Array
    values: Array  # (n_y, n_x); NaN where there is no value
    name: str  # quantity with its unit
    limit: float | None = None  # value beyond which cells are marked; None without a limit


Note = tuple[float, float, str, bool]  # A text beside a position, and whether it stands on its left
Ticks = Sequence[tuple[float, str]]  # Positions along an axis with their texts; empty for round numbers


@dataclass(frozen=True)
class Panel:
    """Curves in one pair of axes."""

    curves: Sequence[Curve]  # the first in front
    # ylabel, xlabel, title: texts; "" for none
    ylabel: str
    _: KW_ONLY
    xlabel: str = ""
    title: str = ""
    limits: Sequence[tuple[str, float]] = ()  # levels that are dashed, with their names
    xlimits: Sequence[tuple[str, float]] = ()  # the same on the horizontal axis
    exceeded: Collection[str] = ()  # names of those of both that are exceeded
    dots: Sequence[tuple[float, float]] = ()  # positions of single points
    notes: Sequence[Note] = ()  # texts at positions
    field: Field | None = None  # behind the curves; None for none
    # yticks, xticks: where round numbers would not do: names of bars, angles
    yticks: Ticks = ()
    xticks: Ticks = ()
    bands: Sequence[tuple[str, float, float]] = ()  # ranges of the horizontal axis that are shaded, with their names
    # xlim, ylim: ranges; None for those of the curves
    xlim: tuple[float, float] | None = None
    ylim: tuple[float, float] | None = None
    log: str = ""  # logarithmic axes: "xy" for both, "x" for the horizontal axis
    # unit, xunit: units of the vertical and the horizontal axis
    unit: str = ""
    xunit: str = "s"

    def kind_of_limit(self, name: str) -> str:
        return EXCEEDED if name in self.exceeded else LIMIT


@dataclass(frozen=True, kw_only=True)
class Chart:
    """Panels in rows, whose curves are named once above all of them."""

    rows: Sequence[Sequence[Panel]]  # of panels beside each other
    height: float = 120.0  # of a panel without its texts; a page is `WIDTH` wide
    id: str = ""  # the same in every output
    caption: str = ""  # description below the chart
    alt: str = ""  # text alternative in few words


_NEGLIGIBLE = 1e-6  # g or mm: an axis without larger values has no panel
_LEGEND_LETTERS = 28  # longest name in a legend
_CRESTS = 300  # intervals of an envelope: each should hold a period at least


def short(name: str, most: int = _LEGEND_LETTERS) -> str:
    return name if len(name) <= most else f"{name[: most // 2 - 1]}…{name[-most // 2 :]}"


def crest(x: Array, values: Array) -> tuple[Array, Array]:
    """Reduce a curve to its maxima in `_CRESTS` intervals of equal length: their x and their values."""
    length = max(x.size // _CRESTS, 1)
    parts = values[: length * (x.size // length)].reshape(-1, length)
    rows = length * np.arange(parts.shape[0]) + parts.argmax(axis=1)
    return x[rows], values[rows]


def stacked(panels: Sequence[Panel]) -> Chart:
    """Stack panels below each other without their titles; panels of negligible values are left out."""
    kept = [panel for panel in panels if any(np.abs(curve.y).max() > _NEGLIGIBLE for curve in panel.curves)] or panels[-1:]
    rows = [[replace(panel, title="", xlabel="time [s]" if panel is kept[-1] else "")] for panel in kept]
    return Chart(rows=rows, height=190.0 if len(kept) == 1 else 140.0)


def with_room(x: Array, part: float = 0.05) -> tuple[float, float]:
    """Compute the range of `x`, widened at both ends by a fraction of it, by 1 if all values are equal."""
    room = part * float(np.ptp(x)) or 1.0
    return float(x.min()) - room, float(x.max()) + room


@dataclass(frozen=True, kw_only=True)
class Paragraphs:
    """Paragraphs that the author of a document adds to its results."""

    scope: Annotated[str, example("Four mounts below one camera.")] = ""  #: below the answer
    assumptions: Annotated[str, example("The camera is rigid.")] = ""  #: beside what is assumed
    validation: Annotated[str, example("Compared with the test of 3 May.")] = ""  #: beside what was validated
    conclusion: Annotated[str, example("The camera may be used on the mast.")] = ""  #: after the results


@dataclass(frozen=True, kw_only=True)
class Revision:
    """A line of the history of a document."""

    revision: Annotated[str, example("A")]
    date: Annotated[str, DATE, example("2026-11-25")] = ""
    author: Annotated[str, example("A. Engineer")] = ""
    change: Annotated[str, example("First issue")] = ""


@dataclass(frozen=True, kw_only=True)
class Document:
    """Data of a document; empty fields are left open in its title block."""

    # project, number, revision, date: by which it is filed
    project: Annotated[str, example("F130 refit")] = ""
    number: Annotated[str, example("NV-4711-02")] = ""
    revision: Annotated[str, example("B")] = ""
    date: Annotated[str, DATE, example("2026-11-25")] = ""
    # author, checker, approver: who signs
    author: Annotated[str, example("A. Engineer")] = ""
    checker: Annotated[str, example("B. Second")] = ""
    approver: Annotated[str, example("C. Third")] = ""
    classification: Annotated[str, example("Company confidential")] = ""  # printed on every page
    client: Annotated[str, example("The Shipyard")] = ""  # for whom it is written
    standard: Annotated[str, example("Specification 4711, issue 3")] = ""  # by which the load cases and limits were chosen
    logo: Annotated[Path | None, example("logo.png")] = None  # PNG or JPEG file; None for none
    template: Annotated[Path | None, example("ours.typ")] = None  # of Typst, the layout of the PDF; None for the package's
    history: tuple[Revision, ...] = ()  # revisions, the first one first
    texts: Annotated[Paragraphs, Key("text")] = Paragraphs()

    @property
    def facts(self) -> tuple[tuple[str, str], ...]:
        named = {
            "Project": self.project, "Document": self.number, "Revision": self.revision, "Date": self.date,
            "Client": self.client, "Classification": self.classification, "Standard": self.standard,
        }  # fmt: skip
        return tuple((name, value) for name, value in named.items() if value)

    @property
    def reference(self) -> str:
        return " ".join(filter(None, (self.number, self.revision and f"revision {self.revision}")))

    def signatures(self) -> Table:
        people = (("Author", self.author), ("Checked", self.checker), ("Approved", self.approver))
        rows = [(role, name, "", "") for role, name in people]
        return Table("signatures", "Signatures", left("", "name", "date", "signature"), rows)

    def revisions(self) -> Table | None:
        """Tabulate the history; None without revisions."""
        if not self.history:
            return None
        columns = [*left("revision", "date", "author"), Column("change", align="text")]
        rows = [(entry.revision, entry.date, entry.author, entry.change) for entry in self.history]
        return Table("revisions", "Revisions", columns, rows)

    def paragraphs(self, name: str) -> list[str]:
        return paragraphs(getattr(self.texts, name))


# Shown on every screen, on the screen of the result, or on its pages only
Depth = Literal["headline", "summary", "full"]


@dataclass(frozen=True)
class Statement:
    """A sentence, with a list of short sentences below it."""

    id: str = ""  # the same in every output
    text: str = ""  # the sentence; "" where the list says all
    _: KW_ONLY
    items: tuple[str, ...] = ()  # below it
    tone: str = ""  # one of `foundation.tables.TONES`
    values: Mapping[str, float | str | None] = field(default_factory=dict)  # numbers of the sentence by name, SI

    def __post_init__(self) -> None:
        if self.tone not in TONES:
            raise ValueError(f"`tone` must be one of {', '.join(TONES)}, got {self.tone!r}.")

    def to_dict(self) -> Entries:
        parts = {"text": self.text, "items": list(self.items), "tone": self.tone, "values": dict(self.values)}
        return {name: part for name, part in parts.items() if part}


@dataclass(frozen=True, kw_only=True)
class SceneView:
    """A scene from two sides: its modelled geometry, or its position at an instant over the modelled geometry."""

    scene: Scene  # in the modelled geometry
    caption: str  # what it shows
    # the scene at an instant, relative to its base; None for the modelled geometry alone
    moved: Scene | None = None
    ring: tuple[str, Array] | None = None  # name and position (3,) [m] of the ringed part; None without a ring
    exceeded: bool = False  # whether the ring is red
    used: Mapping[str, float] = field(default_factory=dict)  # largest utilisation of mounts, by which they are coloured
    # names of mounts that are not fitted, drawn as crosses; None to label all mounts
    absent: tuple[str, ...] | None = None
    id: str = ""  # the same in every output


Block = Statement | Table | Chart | SceneView


@dataclass(frozen=True)
class Section:
    """A part of a result with a heading, whose blocks are built when a renderer asks for them."""

    id: str  # the same in every output
    title: str  # its heading
    build: Callable[[], Iterable[Block | None]]  # makes its blocks in reading order; None among them is left out
    depth: Depth = "full"  # least depth at which it is shown
    appendix: bool = False  # whether it stands behind all others, with a letter in place of a number

    @cached_property
    def blocks(self) -> tuple[Block, ...]:
        return tuple(block for block in self.build() if block is not None)


@dataclass(frozen=True, kw_only=True)
class Content:
    """Verdict, facts and sections of a result, which every output shows."""

    title: str  # what was computed
    verdict: Statement  # the conclusion in one sentence
    sections: tuple[Section, ...]  # everything else, the grounds of the conclusion first
    facts: tuple[tuple[str, str], ...] = ()  # below the title: name and value of model, base motion, date
    question: tuple[str, ...] = ()  # what was asked, a text for each paragraph
    document: Document | None = None  # of a document that is filed and signed; None for a plain report

    @property
    def numbered(self) -> list[tuple[str, Section]]:
        """Number the titled sections that have blocks, 1, 2, .., and behind them the appendices, Appendix A, B, .."""
        titled = [section for section in self.sections if section.title and section.blocks]
        numbered = [section for section in titled if not section.appendix]
        appendices = [section for section in titled if section.appendix]
        named = [(f"Appendix {letter_of(number)}", section) for number, section in enumerate(appendices)]
        return [(str(number), section) for number, section in enumerate(numbered, start=1)] + named

    def blocks(self, *depths: Depth) -> Iterator[Block]:
        for section in self.sections:
            if not depths or section.depth in depths:
                yield from section.blocks

    def sections_of(self, *depths: Depth) -> tuple[str, ...]:
        return tuple(section.id for section in self.sections if section.depth in depths)

    def table(self, name: str) -> Table | None:
        """Find a table by its id; None if there is no such table."""
        return next((block for block in self.blocks() if isinstance(block, Table) and block.id == name), None)

    def to_dict(self, *sections: str) -> Entries:
        entries: Entries = {"headline": self.verdict.to_dict()}
        for section in self.sections:
            for block in section.blocks if section.id in sections else ():
                if isinstance(block, Table | Statement) and block.id:
                    entries[block.id] = block.to_dict()
        return entries


_MOST_ROWS = 30  # of a table that is not moved into an appendix


def with_appendices(content: Content) -> Content:
    """Show every table in full; tables of more than `_MOST_ROWS` rows move into appendices."""
    sections: list[Section] = []
    appendices: list[Section] = []
    for section in sorted(content.sections, key=lambda section: section.appendix):
        blocks: list[Block] = []
        for block in section.blocks:
            shown = block.shown if isinstance(block, Table) else None
            if not isinstance(block, Table) or shown is None or shown >= len(block.rows):
                blocks.append(block)
                continue
            whole = replace(block, shown=None)
            if section.appendix or len(block.rows) <= _MOST_ROWS:
                blocks.append(whole)
                continue
            remark = f"{shown} of {len(block.rows)} rows; all of them stand in appendix {letter_of(len(appendices))}."
            blocks.append(replace(whole, rows=block.rows[:shown], note=" ".join(filter(None, (block.note, remark)))))
            title = f"{section.title}: {block.title}" if section.title else block.title
            appendices.append(Section(f"{section.id}-{block.id}", title, partial(list, [whole]), section.depth, appendix=True))
        (appendices if section.appendix else sections).append(replace(section, build=partial(list, blocks)))
    return replace(content, sections=(*sections, *appendices))


def letter_of(number: int) -> str:
    """Name an appendix by its number from 0: A to Z, then AA, AB and so on."""
    return chr(ord("A") + number) if number < 26 else letter_of(number // 26 - 1) + letter_of(number % 26)
