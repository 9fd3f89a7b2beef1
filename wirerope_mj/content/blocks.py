"""A content: sections of statements, tables, charts and scenes by their ids, the data of its document, its layout on paper."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal

from wirerope_mj.content.numbers import paragraphs
from wirerope_mj.content.panels import Chart
from wirerope_mj.engine.response.scene import Scene
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.structure import DATE, Key
from wirerope_mj.foundation.tables import TONES, Column, Table


@dataclass(frozen=True, kw_only=True)
class Paragraphs:
    """What the author of a document adds to what its results say."""

    scope: str = ""  #: below the answer
    assumptions: str = ""  #: beside what is assumed
    validation: str = ""  #: beside what was validated
    conclusion: str = ""  #: after the results


@dataclass(frozen=True, kw_only=True)
class Revision:
    """A line of the history of a document."""

    revision: str
    date: Annotated[str, DATE] = ""
    author: str = ""
    change: str = ""


@dataclass(frozen=True, kw_only=True)
class Document:
    """Data of a document; what is empty is left open in its title block."""

    # project, number, revision, date: by which it is filed
    project: str = ""
    number: str = ""
    revision: str = ""
    date: Annotated[str, DATE] = ""
    # author, checker, approver: who signs
    author: str = ""
    checker: str = ""
    approver: str = ""
    classification: str = ""  # said on every page
    client: str = ""  # for whom it is written
    standard: str = ""  # by which the load cases and limits were chosen
    logo: Path | None = None  # PNG or JPEG file; None for none
    history: tuple[Revision, ...] = ()  # revisions, the first one first
    texts: Annotated[Paragraphs, Key("text")] = Paragraphs()

    @property
    def facts(self) -> tuple[tuple[str, str], ...]:
        """Name and value of what stands in the title block."""
        named = {
            "Project": self.project, "Document": self.number, "Revision": self.revision, "Date": self.date,
            "Client": self.client, "Classification": self.classification, "Standard": self.standard,
        }  # fmt: skip
        return tuple((name, value) for name, value in named.items() if value)

    @property
    def reference(self) -> str:
        """Number and revision, as every page says them."""
        return " ".join(filter(None, (self.number, self.revision and f"revision {self.revision}")))

    def signatures(self) -> Table:
        """Tabulate who signs, with room for date and signature."""
        people = (("Author", self.author), ("Checked", self.checker), ("Approved", self.approver))
        columns = [Column(one, align="left") for one in ("", "name", "date", "signature")]
        rows = [(role, name, "", "") for role, name in people]
        return Table(id="signatures", title="Signatures", columns=columns, rows=rows)

    def revisions(self) -> Table | None:
        """Tabulate the history; None without one."""
        if not self.history:
            return None
        names = [one.name for one in fields(Revision)]
        columns = [Column(name, align="text" if name == "change" else "left") for name in names]
        rows = [[getattr(one, name) for name in names] for one in self.history]
        return Table(id="revisions", title="Revisions", columns=columns, rows=rows)

    def paragraphs(self, name: str) -> list[str]:
        """Return the paragraphs of the `Paragraphs`."""
        return paragraphs(getattr(self.texts, name))


# How far down something stands: on every screen, on the screen of the result, or on its pages only.
Depth = Literal["headline", "summary", "full"]


@dataclass(frozen=True, kw_only=True)
class Statement:
    """A sentence, and short ones below it."""

    text: str = ""  # the sentence; "" where the list says all
    items: tuple[str, ...] = ()  # below it
    tone: str = ""  # one of `foundation.tables.TONES`
    id: str = ""  # the same in every output
    values: Mapping[str, float | str | None] = field(default_factory=dict)  # what it says in numbers, SI, by name

    def __post_init__(self) -> None:
        if self.tone not in TONES:
            raise ValueError(f"`tone` must be one of {', '.join(TONES)}, got {self.tone!r}.")

    def to_dict(self) -> Entries:
        """Return text, items, tone and values as plain values, without those that are empty."""
        parts = {"text": self.text, "items": list(self.items), "tone": self.tone, "values": dict(self.values)}
        return {name: part for name, part in parts.items() if part}


@dataclass(frozen=True, kw_only=True)
class SceneView:
    """A scene from two sides: in its modelled geometry, or as it stands at an instant over that."""

    scene: Scene  # in the modelled geometry
    caption: str  # what it shows
    # the same at an instant, relative to its base; None for the modelled geometry alone, with labels
    moved: Scene | None = None
    ring: tuple[str, Array] | None = None  # name and position (3,) [m] of what is ringed; None for nothing
    exceeded: bool = False  # whether the ring is red
    # names of mounts that are not fitted, whose places are crossed; the others have no labels then. None: labels.
    absent: tuple[str, ...] | None = None
    id: str = ""  # the same in every output


Block = Statement | Table | Chart | SceneView


@dataclass(frozen=True)
class Section:
    """A part of a result with a heading, whose blocks are built when a renderer asks for them."""

    id: str  # the same in every output
    title: str  # its heading
    build: Callable[[], Iterable[Block | None]]  # makes its blocks in reading order; None among them is left out
    depth: Depth = "full"  # from which on it is shown
    appendix: bool = False  # whether it stands behind all others, with a letter in place of a number

    @cached_property
    def blocks(self) -> tuple[Block, ...]:
        """The blocks; a section without any is left out."""
        return tuple(block for block in self.build() if block is not None)


@dataclass(frozen=True, kw_only=True)
class Content:
    """Verdict, facts and sections of a result, which every output shows."""

    title: str  # what was computed
    verdict: Statement  # the conclusion in one sentence
    sections: tuple[Section, ...]  # everything else, the grounds of the conclusion first
    facts: tuple[tuple[str, str], ...] = ()  # name and value of what stands below the title: model, base motion, date
    question: tuple[str, ...] = ()  # what was asked, a text for each paragraph
    document: Document | None = None  # data of a document that is filed and signed; None for a plain report

    def blocks(self, *depths: Depth) -> Iterator[Block]:
        """Yield the blocks of the sections of these depths, of all without any."""
        for section in self.sections:
            if not depths or section.depth in depths:
                yield from section.blocks

    def sections_of(self, *depths: Depth) -> tuple[str, ...]:
        """Return the ids of the sections of these depths."""
        return tuple(section.id for section in self.sections if section.depth in depths)

    def table(self, name: str) -> Table | None:
        """Return the table with an id; None if this result has none."""
        return next((block for block in self.blocks() if isinstance(block, Table) and block.id == name), None)

    def to_dict(self, *sections: str) -> Entries:
        """Return statements and tables of some sections by their ids, the headline first: SI values, texts and tones."""
        said: Entries = {"headline": self.verdict.to_dict()}
        for section in self.sections:
            for block in section.blocks if section.id in sections else ():
                if isinstance(block, Table | Statement) and block.id:
                    said[block.id] = block.to_dict()
        return said


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
