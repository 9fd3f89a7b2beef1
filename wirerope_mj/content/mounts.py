"""The mounts in motion: peaks against their ratings, histories of what is used, deflections and loops, and the course."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from wirerope_mj.assessment.criteria import COMBINED, EXCEEDED, NOT_JUDGED, WITHIN, MountPeak, Verdict, mount_peaks
from wirerope_mj.assessment.criteria.verdict import by_use
from wirerope_mj.content.blocks import Block
from wirerope_mj.content.events import events_of
from wirerope_mj.content.histories import Line, history_panel, used_panel
from wirerope_mj.content.judged_run import JudgedRun, RunResult
from wirerope_mj.content.numbers import listed
from wirerope_mj.content.panels import Chart, Curve, Panel, short, stacked, with_room
from wirerope_mj.content.selection import MOST, Selection, kind_of
from wirerope_mj.content.verdicts import TONE, used_mark
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table
from wirerope_mj.foundation.units import force_unit, in_unit
from wirerope_mj.mounts.isolator import AXES

_LONG = 10_000  # samples from which loops are drawn around the largest deflection only
_AROUND = 300  # samples before and after it
_ROUNDING = 1e-9  # of the largest force, below which an axis carries none
_ACROSS = (("shear", 1), ("roll", 0))
_SENSES = ("compr.", "tension", "shear", "roll")
# A mount with its extremes by sense
EXTREMES = (
    Column("mount", align="left"), *(Column(head, "mm", "z.1f") for head in _SENSES),
    *(Column(head, "kN", "z.2f") for head in _SENSES),
)  # fmt: skip


def mount_blocks(run: RunResult) -> Iterator[Block | None]:
    """Yield the peaks of the mounts, travel and force by sense, and what they use of their ratings."""
    order = [*by_use(run.verdicts), *(mount.name for mount in run.response.scene.mounts)]
    if rows := sorted(mount_peaks(run.response), key=lambda row: order.index(row.name)):
        yield _peaks(run, rows)


def mount_history_blocks(run: JudgedRun) -> Iterator[Block | None]:
    """Yield histories of what is used and of deflections, loops of the worst mount, and the course of the run."""
    rows, selection = mount_peaks(run.response), run.selection
    if not rows:
        return
    names = [one.subject for one in selection.used if one.subject in selection.mounts][:MOST]
    order = "that use most of their limits" if names else "in the order of the model"
    names = names or [row.name for row in rows[:MOST]]
    if selection.used:
        yield Chart(
            id="used", rows=[[replace(used_panel(run.response, selection), title="", xlabel="time [s]")]], height=190.0,
            caption="What is used of the limits over time, the largest of all criteria of each mount, body or point.",
            alt="Utilisation of limits over time.",
        )  # fmt: skip
    yield _histories_chart("deflection", run.response, names, selection, order)
    yield _histories_chart("force", run.response, names, selection, order)
    yield _loops_chart(run.response, names[0], selection)
    yield _course(run)


def _peaks(run: RunResult, peaks: Sequence[MountPeak]) -> Table:
    """Tabulate the extremes of every mount by sense, and what it uses of its rated travel."""
    combined = {row.subject: row for row in run.verdicts if row.criterion == COMBINED}
    rated = any(row.utilisation is not None for row in peaks)
    marked = False
    rows: list[Row] = []
    for row in peaks:
        force = run.response.peaks.mounts[row.name].force
        low, high = float(force.minimum[2]), float(force.maximum[2])
        known = run.validity.get(row.name)
        outside = known and known.outside(np.asarray(row.minimum), np.asarray(row.maximum), small=False)
        marked |= bool(outside)
        cells: list[Cell] = [f"{row.name} *" if outside else row.name]
        cells += [min(row.minimum[2], 0.0), max(row.maximum[2], 0.0)]
        cells += [max(row.maximum[axis], -row.minimum[axis]) for _, axis in _ACROSS]
        cells += [min(low, 0.0), max(high, 0.0), *(abs(row.force[axis]) for _, axis in _ACROSS)]
        if rated:
            cells += [used_mark(row.utilisation), row.governing or "-"]
            cells += [used_mark(combined[row.name].utilisation if row.name in combined else None)] if combined else []
        rows.append([*cells, _verdict(row, combined.get(row.name))])
    columns = list(EXTREMES)
    if rated:
        columns += [Column("travel used", "%", "z.0f"), Column("in", align="left")]
        columns += [Column("combined", "%", "z.0f")] if combined else []
    note = "Compression negative, tension positive; shear and roll by size. The most critical mount stands first."
    if marked:
        note += " *: outside the cycles that the isolator was identified from, so that its forces are extrapolated."
    return Table(
        id="mounts", title="Peaks of the mounts", columns=[*columns, Column("verdict", align="left")], rows=rows, note=note,
    )  # fmt: skip


def _verdict(row: MountPeak, combined: Verdict | None) -> Mark:
    """Return the verdict in a word, along single axes and with all of them together."""
    if row.exceeded or (combined is not None and combined.verdict == EXCEEDED):
        return Mark(EXCEEDED, TONE[EXCEEDED])
    word = WITHIN if row.governing else NOT_JUDGED
    return Mark(word, TONE[word])


def _course(run: JudgedRun) -> Table | None:
    """Tabulate the events of the run: the few that tell its course first, the others folded away."""
    events = events_of(run.response, run.selection)
    events.sort(key=lambda event: not event.main)
    main = sum(event.main for event in events)
    if not events:
        return None
    return Table(
        id="course",
        title="The course of the run, and below it all other peaks and limits that are passed",
        columns=(Column("at", "s", "z.4f"), Column("event", align="text")),
        rows=[(event.time, Mark(event.text, "exceeded" if event.level == "ERROR" else "")) for event in events],
        shown=max(main, 1),
    )


def _histories_chart(quantity: str, response: Response, names: Sequence[str], selection: Selection, order: str) -> Chart:
    """Draw deflections or forces of some mounts over time, a panel for each axis with any."""
    lines = [
        Line(response=response, subject=name, name=name, kind=kind_of(selection, name, rank))
        for rank, name in enumerate(names[:MOST])
    ]
    return replace(
        stacked([history_panel(quantity, axis, lines, selection.window) for axis in AXES]),
        id=f"{quantity}s",
        caption=f"{quantity.capitalize()}s of the mounts {order}: {listed(list(names))}. Axial is positive in tension.",
        alt=f"Histories of the {quantity}s of {listed(list(names))} along roll, shear and axial.",
    )


def _loops_chart(response: Response, name: str, selection: Selection) -> Chart:
    """Return force over deflection of a mount, a panel for each axis that carries a force; see `_loop_rows`."""
    rows = _loop_rows(response, name)
    deflection, force = (
        np.stack([response.column(f"mounts/{name}/{part}/{axis}")[rows] for axis in AXES], axis=1)
        for part in ("deflection", "force")
    )
    unit = force_unit(float(np.abs(force).max()))
    largest = np.abs(force).max(axis=0)
    axes = np.flatnonzero(largest > _ROUNDING * largest.max()).tolist() or [AXES.index("axial")]
    row = []
    for axis in axes:
        x, y = in_unit(deflection[:, axis], "mm"), in_unit(force[:, axis], unit)
        row.append(Panel(
            curves=[Curve(x=x, y=y, name=short(name), kind=kind_of(selection, name, 0))],
            ylabel=f"force [{unit}]" if axis == axes[0] else "", xlabel="deflection [mm]", title=AXES[axis],
            dots=[(float(x[0]), float(y[0]))], xlim=with_room(x), unit=unit, xunit="mm",
        ))  # fmt: skip
    isolator = next(mount.isolator for mount in response.scene.mounts if mount.name == name)
    time = response.time[rows]
    interval = "" if rows == slice(None) else f" from {time[0]:.5g} to {time[-1]:.5g} s"
    return Chart(
        id="loops", rows=[row], height=190.0,
        caption=f"Force over deflection of {name} ({isolator}){interval}; the dot is where it begins.",
        alt=f"Loops of {name}.",
    )  # fmt: skip


def _loop_rows(response: Response, name: str) -> slice:
    """Return which samples of a mount make its loops: all, or of a long response those around its largest deflection."""
    if response.time.size <= _LONG:
        return slice(None)
    middle = int(np.searchsorted(response.time, response.peaks.mounts[name].deflection.time))
    return slice(max(middle - _AROUND, 0), middle + _AROUND)
