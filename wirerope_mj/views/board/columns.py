"""The columns beside the drawing, as HTML: tables and job on the left, statics and verdict on the right."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import chain
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from wirerope_mj.assessment.criteria import COMBINED, Verdict
from wirerope_mj.assessment.criteria.summary import COMBINED_MEANS
from wirerope_mj.content.blocks import Block, Chart, Statement
from wirerope_mj.content.first_sheet import brief_blocks
from wirerope_mj.content.job import JudgedJob, brief, job_headline
from wirerope_mj.content.judged_run import RunResult
from wirerope_mj.content.modes import TIPS
from wirerope_mj.content.numbers import several
from wirerope_mj.content.verdicts import headline, used_mark
from wirerope_mj.dynamics.modes import NaturalFrequencies
from wirerope_mj.engine.statics import Sag
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.tables import Column, Table, left
from wirerope_mj.motions import Measured
from wirerope_mj.views.board.compared import compared_blocks
from wirerope_mj.views.plots.svg_chart import chart_svg
from wirerope_mj.views.report.page import blocks_html

_FOLDER = Path(__file__).parent
_WIDTH = 400.0  # of a chart in the column, in pixels
_MODES = 6  # that are shown: those of a rigid payload


Field = tuple[str, str, str, str]  # key, value, label and example


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """A table that can be edited: its columns with their units, and its rows with their cells by column."""

    kind: str
    prefix: str  # of the names of what its rows place, such as "mount"
    units: Mapping[str, str]
    rows: Mapping[str, Mapping[str, str]]


@dataclass(frozen=True, kw_only=True)
class Form:
    """What tables and job say, as forms show it."""

    sheets: Sequence[Sheet]
    missing: Sequence[str]  # kinds of tables that can be added
    settings: Sequence[Field]  # deck, temperature and the like
    cases: Sequence[tuple[str, str, str]]  # name, motions in one line, and what else moves the base
    doubts: Mapping[str, str]  # by the words that they are about, such as a motion's phrase
    limits: Mapping[str, str]
    document: Sequence[Field]
    # choices that are offered: parts, what can be limited, kinds of motions with an example
    parts: Sequence[str]
    subjects: Sequence[str]
    motions: Mapping[str, str]
    # parts that were found, and the loops of one, as HTML that was written here
    found: str
    loops: str
    edited: bool  # whether there are files to edit, not a scenario or a run alone
    # key, label, note, minimum, maximum, value, its text, and whether it changes anything
    sliders: Sequence[tuple[str, str, str, float, float, float, str, bool]]


@dataclass(frozen=True)
class PartRow:
    """A part with its height, rated load and travel in compression, SI; None where not stated."""

    name: str
    height: float | None
    load: float | None
    travel: float | None
    used: float | None  # of its most critical limit, if it was simulated in place

    @property
    def tone(self) -> str:
        return "" if self.used is None else "exceeded" if self.used > 1.0 else "within"


def parts_html(rows: Sequence[PartRow], *, said: str = "") -> str:
    """Write parts with what they are rated for, each with a button that takes it."""
    return _environment().get_template("parts.html.jinja").render(rows=rows, said=said)


def chart_html(chart: Chart) -> str:
    """Write a chart for a column."""
    return _column([chart])


def left_column(form: Form) -> str:
    """Write tables and job as forms."""
    return _environment().get_template("left.html.jinja").render(form=form)


def sliders_html(form: Form) -> str:
    """Write the sliders of a what-if."""
    return _environment().get_template("sliders.html.jinja").render(form=form)


def compared_html(runs: Mapping[str, RunResult], tests: Sequence[Measured]) -> str:
    """Write what a run differs by from the one before it, and from tests."""
    return _column(compared_blocks(runs, tests))


def page_html(title: str) -> str:
    """Write the page around drawing and columns."""
    return _environment().get_template("board.html").render(title=title)


def statics_html(sag: Sag | Absent, known: NaturalFrequencies | Absent, doubts: Sequence[str]) -> str:
    """Write loads at rest of every mount, the natural frequencies, and what is doubtful about where things stand."""
    return blocks_html(_at_rest(sag, known, doubts))


def _at_rest(sag: Sag | Absent, known: NaturalFrequencies | Absent, doubts: Sequence[str]) -> Iterator[Block | None]:
    if doubts:
        yield Statement("doubts", items=tuple(doubts), tone="near")
    if isinstance(sag, Absent):
        yield Statement("statics", f"At rest: {sag.reason}", tone="exceeded")
    else:
        rows = [
            (name, -float(mount.deflection[2]) + 0.0, mount.carries, used_mark(mount.utilisation))
            for name, mount in sag.listed.items()
        ]
        used = [mount.utilisation for mount in sag.mounts.values() if mount.utilisation is not None]
        figures = (("down", "mm", "z.1f"), ("carries", "kN", "z.3f"), ("of rated", "%", "z.0f"))
        columns = [*left("mount"), *(Column(*figure) for figure in figures)]
        title = "At rest" + (f": up to {100.0 * max(used):.0f} % of the rated static load" if used else "")
        yield Table("at-rest", title, columns, rows, shown=4)
    if isinstance(known, Absent):  # as a rule for the same reason
        return
    yield Table(
        "modes", "Natural frequencies, small amplitude", [Column("frequency", "Hz", "z.2f"), Column("shape", align="text")],
        [
            (TIPS if frequency != frequency else float(frequency), shape)
            for frequency, shape in zip(known.frequencies[:_MODES], known.descriptions, strict=False)
        ],
    )  # fmt: skip


def verdict_html(job: JudgedJob, left_over: int, what_if: Sequence[str], *, quick: bool = False) -> str:
    """Write verdict, bars, what is not judged, and the charts of the load case that governs."""
    one = len(job.cases) == 1
    blocks = brief_blocks(job.cases[0].run) if one else brief(job)
    rows = chain.from_iterable(job.verdicts.values())
    said = headline(job.cases[0].run.verdicts) if one else job_headline(job.verdicts)
    return _environment().get_template("right.html.jinja").render(
        said=said, more=several(left_over, "load case") if left_over else "", what_if=", ".join(what_if), quick=quick,
        blocks=Markup(_column(_explained(blocks, rows))),
    )  # fmt: skip


def _explained(blocks: Iterable[Block | None], verdicts: Iterable[Verdict]) -> Iterator[Block | None]:
    """Say below the bars what combined travel is, where it is judged."""
    judged = any(row.criterion == COMBINED and row.utilisation is not None for row in verdicts)
    for block in blocks:
        if judged and isinstance(block, Table) and block.id == "criteria":
            block = replace(block, note=COMBINED_MEANS)
        yield block


def failure_html(reason: str) -> str:
    """Write why there is no verdict."""
    return blocks_html([Statement("headline", f"No verdict: {reason}", tone="exceeded")])


def _column(blocks: Iterable[Block | None]) -> str:
    """Write blocks for a column: the panels of charts below each other, without drawings of the scene."""
    written = []
    for block in blocks:
        if isinstance(block, Chart):
            chart = replace(block, rows=[[panel] for row in block.rows for panel in row])
            written.append(Markup('<figure class="drawn">{}<figcaption>{}</figcaption></figure>').format(
                Markup(chart_svg(chart, _WIDTH)), chart.caption
            ))  # fmt: skip
        elif isinstance(block, Statement | Table):
            written.append(Markup(blocks_html([block])))
    return "\n".join(written)


@cache
def _environment() -> Environment:
    return Environment(loader=FileSystemLoader(_FOLDER), autoescape=True, undefined=StrictUndefined, trim_blocks=True)
