"""Output of a run: peaks against limits, and where the files are; and lists of what ships."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from rich.markup import escape

from wirerope_mj.assessment.criteria import (
    COMBINED,
    EXCEEDED,
    NOT_JUDGED,
    STRUCK,
    WITHIN,
    MountPeak,
    Verdict,
    body_peaks,
    contact_verdicts,
    mount_peaks,
    verdict_lines,
)
from wirerope_mj.assessment.criteria.sentences import rule_lines
from wirerope_mj.cli.screen import console, print_table, print_warnings
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.motions import Sweep
from wirerope_mj.mounts.isolator.travel import RATINGS
from wirerope_mj.runs.judged import JudgedRun
from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.views.random_table import random_table

_NEAR = 0.9  # utilisation from which it is coloured as a warning


def print_questions(kind: str, questions: Mapping[str, str]) -> None:
    """Print what ships with the package: names of scenarios or studies and the question of each."""
    columns = Column(kind, align="left"), Column("question", align="text")
    print_table(Table(title="", columns=columns, rows=list(questions.items())))


def print_verdict(scenario: Scenario, response: Response, judged: JudgedRun, *, seconds: float) -> None:
    """Print peaks against limits, how they were computed, and how long that took [s]."""
    out, verdicts = console(), judged.verdicts
    out.print(f"\n[bold]{escape(scenario.name)}[/]  {escape(scenario.motion.description)}")
    print_warnings(judged.model_warnings)
    print_table(_accelerations(scenario, response, verdicts))
    _print_random(judged)
    if response.scene.isolating:
        out.print()
        print_table(_mounts(response, verdicts))
        out.print()
    contacts = _contacts(response)
    if contacts is not None:
        print_table(contacts)
        out.print()
    out.print(f"  [bold]{escape(judged.headline)}[/]", soft_wrap=True)
    for line in filter(None, [judged.untested, *verdict_lines(response, verdicts), *rule_lines(verdicts)]):
        out.print(f"  {escape(line)}")
    out.print(f"\n  {_numerics(response)}; verdict after {seconds:.1f} s")


def _print_random(judged: JudgedRun) -> None:
    """Print rms and 3-sigma accelerations of random vibration, or why there are none."""
    if isinstance(judged.random, Absent):
        console().print(f"  No rms and 3-sigma values: {escape(judged.random.reason)}")
    elif (table := random_table(judged.random)) is not None:
        console().print()
        print_table(table)


def print_written(folder: Path, *, seconds: float) -> None:
    """Print where the files of a run are, how long all of it took [s], and how they are shown."""
    out = console()
    files = sorted(path for path in folder.iterdir() if path.is_file())
    shown = escape(str(folder))
    out.print(f"  written to {shown}/, {seconds:.1f} s in all", soft_wrap=True)
    out.print(f"  {', '.join(path.name for path in files)}, {_folders(folder)}", soft_wrap=True)
    out.print(f"  [bold]wirerope show {shown}[/] opens the view", soft_wrap=True)


def _folders(folder: Path) -> str:
    return ", ".join(f"{path.name}/" for path in sorted(folder.iterdir()) if path.is_dir())


def _accelerations(scenario: Scenario, response: Response, verdicts: Sequence[Verdict]) -> Table:
    sweep = scenario.motion if isinstance(scenario.motion, Sweep) else None
    judged = [row for row in verdicts if row.criterion.startswith("acceleration") and row.utilisation is not None]
    limited = {row.subject: row for row in sorted(judged, key=lambda row: row.utilisation or 0.0)}
    columns = [
        Column(align="left"),
        *(Column(f"{name}\n[g]") for name in ("peak", "x", "y", "z")),
        Column("at", "s", ".4f"),
    ]
    columns += [] if sweep is None else [Column("at", "Hz", ".2f")]
    columns += [Column("limit\n[g]"), Column("used", "%", ".0f")] if limited else []
    rows: list[Row] = []
    for row in body_peaks(response):
        name = row.name if row.kind == "body" else f"{row.name} ({row.kind})"
        cells: list[Cell] = [
            name,
            Mark(f"{row.value:.2f}", "strong"),
            *(f"{value:.2f}" for value in row.axes),
            row.time,
        ]
        cells += [] if sweep is None else [float(sweep.frequency([row.time])[0])]
        rows.append([*cells, *(_against_limit(limited.get(row.name)) if limited else [])])
    title = "Peak accelerations" if limited else "Peak accelerations, not judged: the model states no limits"
    return Table(title=title, columns=columns, rows=rows)


def _against_limit(row: Verdict | None) -> list[Cell]:
    """Return limit and utilisation of the component that is nearest to its limit."""
    if row is None or row.limit is None:
        return [Mark("-", "quiet")] * 2
    axis = row.criterion.removeprefix("acceleration along ")
    along = "" if axis == row.criterion else f"{axis} "
    return [f"{along}{in_unit(row.limit, 'g'):.4g}", _used(row.utilisation)]


def _mounts(response: Response, verdicts: Sequence[Verdict]) -> Table:
    peaks = mount_peaks(response)
    ratings = [name for name in RATINGS if any(row.travel[name].utilisation is not None for row in peaks)]
    combined = {row.subject: row for row in verdicts if row.criterion == COMBINED}
    columns = [Column("mount", align="left"), *(Column(axis, "mm", ".1f") for axis in ("axial", "shear", "roll"))]
    columns += [Column(axis, "kN", ".2f") for axis in ("axial", "shear", "roll")]
    columns += [Column(name.replace("compression", "compr."), "%", ".0f") for name in ratings]
    columns += [Column("comb.", "%", ".0f")] * bool(combined and ratings) + [Column("verdict", align="left")]
    rows: list[Row] = []
    for row in peaks:
        both = " ".join(f"{in_unit(extreme[2], 'mm'):+.1f}" for extreme in (row.minimum, row.maximum))
        sides = [max(row.maximum[axis], -row.minimum[axis]) for axis in (1, 0)]
        used = [_used(row.travel[name].utilisation) for name in ratings]
        used += [_used(combined[row.name].utilisation)] if combined and ratings else []
        rows.append([row.name, both, *sides, *reversed(row.force), *used, _verdict(row, combined.get(row.name))])
    return Table(title="Peaks of the mounts, and their utilisation of the rated travel [%]", columns=columns, rows=rows)


def _contacts(response: Response) -> Table | None:
    """Return first touch, peak force, penetration and verdict of every stop and pair that touched; None if none did."""
    contacts = response.peaks.contacts or {}
    rows: list[Row] = []
    for verdict in contact_verdicts(response):
        contact = contacts[verdict.subject]
        if contact.touches:
            touched = (contact.first_touch, contact.touches, contact.duration, contact.force, contact.force_time)
            judged = Mark(verdict.verdict, "exceeded" if verdict.verdict == STRUCK else "")
            rows.append([contact.called(verdict.subject), *touched, contact.penetration, judged])
    columns = (
        Column("stop or pair", align="text"), Column("first", "s", ".4f"), Column("touches", form="d"),
        Column("in all", "ms", ".1f"), Column("peak", "kN", ".2f"), Column("at", "s", ".4f"), Column("depth", "mm", ".2f"),
        Column("verdict", align="left"),
    )  # fmt: skip
    return Table(title="Stops and contacts", columns=columns, rows=rows) if rows else None


def _used(utilisation: float | None) -> Mark:
    near = "near" if utilisation is not None and utilisation > _NEAR else ""
    tone = "quiet" if utilisation is None else "exceeded" if utilisation > 1.0 else near
    return Mark(utilisation, tone)


def _numerics(response: Response) -> str:
    numerics = response.numerics
    limit = f", limited by {numerics.limited_by}" if numerics.limited_by else ""
    text = f"{numerics.steps} steps of at most {in_unit(numerics.timestep, 'ms'):.4g} ms{limit}"
    return f"{text}, computed by {numerics.computed_by}, {numerics.error_text}"


def _verdict(row: MountPeak, combined: Verdict | None) -> str:
    """Return the verdict in a word; the coloured values say in which direction, or that it is all of them together."""
    if row.exceeded or (combined is not None and combined.verdict == EXCEEDED):
        return EXCEEDED
    return WITHIN if row.governing else NOT_JUDGED
