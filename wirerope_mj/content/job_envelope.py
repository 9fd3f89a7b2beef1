"""Envelopes over the load cases of a job: the largest accelerations, travels and forces, and shock response spectra."""

from collections.abc import Iterator, Mapping

import numpy as np

from wirerope_mj.assessment.criteria import body_peaks, mount_peaks
from wirerope_mj.assessment.criteria.foundation import area_forces
from wirerope_mj.assessment.criteria.summary import BodyPeak
from wirerope_mj.assessment.criteria.verdict import by_use
from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.mounts import EXTREMES
from wirerope_mj.content.numbers import listed
from wirerope_mj.content.panels import OTHERS, Chart, Curve, Panel, short
from wirerope_mj.content.run_spectra import BASE
from wirerope_mj.content.selection import worst_names
from wirerope_mj.content.spectrum_charts import spectrum_panel
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.payload_limits import SIDES
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table
from wirerope_mj.foundation.units import in_unit

_COLOURS = 6  # numbered colours of a chart; further cases have those of the first again, and dashes


def envelope_blocks(runs: Mapping[str, JudgedRun]) -> Iterator[Block | None]:
    """Yield what the base does and the deck bears, the largest of every case: accelerations, room, mounts; and spectra."""
    yield _base(runs)
    yield _accelerations(runs)
    yield _room(runs)
    yield _mounts(runs)
    yield from _spectra(runs)


def _base(runs: Mapping[str, JudgedRun]) -> Table:
    """Tabulate how far the base goes in each case, and what all mounts together exert on it."""
    rows: list[Row] = []
    for case, run in runs.items():
        base = run.response.base
        moved = [float(np.linalg.norm(one, axis=1).max()) for one in (base.velocity, base.displacement)]
        peak = max((row.value for row in body_peaks(run.response) if row.kind == "base"), default=0.0)
        deck = area_forces(run.response)[0]
        rows.append([case, peak, *moved, deck.at_rest, deck.down, deck.up, deck.across])
    return Table(
        id="envelope-base", title="Base motion, and loads of all mounts on the deck",
        columns=[
            Column("load case", align="left"), Column("acceleration", "g", "z.2f"), Column("velocity", "m/s", "z.2f"),
            Column("displacement", "mm", "z.1f"), Column("at rest", "kN", 3), Column("down", "kN", 3), Column("up", "kN", 3),
            Column("horizontally", "kN", 3),
        ],
        rows=rows, note="Largest sizes; a base that coasts after a pulse does so to the end of the run. The loads are sums "
        "over all mounts and stops, weight included, at the samples.",
    )  # fmt: skip


def _room(runs: Mapping[str, JudgedRun]) -> Table | None:
    """Tabulate how far every point goes along each way in any case: the room that must be kept free there."""
    names = list(next(iter(runs.values())).response.peaks.points)
    if not names:
        return None
    rows: list[Row] = []
    for name in names:
        moved = {case: run.response.peaks.points[name].relative_displacement for case, run in runs.items()}
        worst = max(moved, key=lambda case: moved[case].value)
        ways = [(max(-one.minimum[axis], 0.0), max(one.maximum[axis], 0.0)) for one in moved.values() for axis in range(3)]
        largest = np.array(ways).reshape(len(moved), 6).max(axis=0)
        rows.append([name, *map(float, largest), worst])
    return Table(
        id="envelope-room", title="Room that points need in all load cases",
        columns=[
            Column("point", align="left"), *(Column(side, "mm", "z.1f") for side in SIDES),
            Column("largest displacement in", align="left"),
        ],
        rows=rows, note="Displacement from the modelled place relative to the base, sag included, the largest of any case.",
    )  # fmt: skip


def _accelerations(runs: Mapping[str, JudgedRun]) -> Table:
    """Tabulate the largest acceleration of base, bodies and points, along each axis too, and the case of the largest."""
    found: dict[str, list[tuple[str, BodyPeak]]] = {}
    for case, run in runs.items():
        for row in body_peaks(run.response):
            name = "base" if row.kind == "base" else row.name if row.kind == "body" else f"{row.name} (point)"
            found.setdefault(name, []).append((case, row))
    rows: list[Row] = []
    for name, peaks in found.items():
        case, worst = max(peaks, key=lambda pair: pair[1].value)
        axes = [max(peak.axes[axis] for _, peak in peaks) for axis in range(3)]
        rows.append([name, Mark(worst.value, "strong"), case, *axes])
    columns = [Column(align="left"), Column("peak", "g", "z.2f"), Column("in", align="left")]
    return Table(
        id="envelope-accelerations", title="Largest accelerations of all load cases",
        columns=[*columns, *(Column(axis, "g", "z.2f") for axis in "xyz")], rows=rows,
        note="The peak is the size of the vector; along x, y and z each the largest of any case.",
    )  # fmt: skip


def _mounts(runs: Mapping[str, JudgedRun]) -> Table | None:
    """Tabulate the extremes of every mount over all cases, by sense, and the case of its largest travel."""
    found: dict[str, list[tuple[str, tuple[float, ...]]]] = {}
    for case, run in runs.items():
        for row in mount_peaks(run.response):
            force = run.response.peaks.mounts[row.name].force
            figures = (
                max(-row.minimum[2], 0.0), max(row.maximum[2], 0.0), max(row.maximum[1], -row.minimum[1]),
                max(row.maximum[0], -row.minimum[0]), max(-float(force.minimum[2]), 0.0), max(float(force.maximum[2]), 0.0),
                abs(row.force[1]), abs(row.force[0]),
            )  # fmt: skip
            found.setdefault(row.name, []).append((case, figures))
    if not found:
        return None
    rows: list[Row] = []
    order = [*by_use(row for run in runs.values() for row in run.verdicts), *found]
    for name, figures_of in sorted(found.items(), key=lambda pair: order.index(pair[0])):
        cells: list[Cell] = [name]
        for number in range(8):
            cells.append(max(figures[number] for _, figures in figures_of))
        worst = max(figures_of, key=lambda pair: max(pair[1][:4]))
        rows.append([*cells, worst[0]])
    return Table(
        id="envelope-mounts", title="Largest travels and forces of the mounts in all load cases",
        columns=[*EXTREMES, Column("largest deflection in", align="left")], rows=rows,
        note="Sizes; each figure is the largest of any case, so that those of a row need not occur together. The case named "
        "last has the largest deflection in mm; which case uses most of a rating stands with the limits.",
    )  # fmt: skip


def _spectra(runs: Mapping[str, JudgedRun]) -> Iterator[Block]:
    """Yield the shock response spectra of what is shaken most under every case that has them, and their envelope."""
    name = next((name for run in runs.values() for name in worst_names(run.response)[:1]), None)
    lines: dict[str, dict[str, tuple[Array, Array]]] = {"x": {}, "y": {}, "z": {}}
    without, q = [], 10.0
    for case, run in runs.items():
        shock = run.spectra.shock
        if isinstance(shock, Absent) or name is None:
            without.append(case)
            continue
        for axis, along in shock.items():
            if name in along and name != BASE:
                lines[axis][case] = along[name].frequencies, in_unit(along[name].maximax, "g")
                q = along[name].q
    panels = [
        _panel(curves, list(runs), axis, f"SRS, Q = {q:g}: peak acceleration [g]" if number == 0 else "")
        for number, (axis, curves) in enumerate((axis, curves) for axis, curves in lines.items() if curves)
    ]
    if panels:
        left_out = f" Without {listed(without)}: steady or random motions have no such spectrum." if without else ""
        yield Chart(
            id="envelope-spectra", rows=[panels], height=190.0,
            caption=f"Shock response spectra of {name} under each load case along the axes that it moves the base, and their "
            f"envelope, maximax, Q = {q:g}.{left_out}",
            alt=f"Shock response spectra of {name} under all load cases and their envelope.",
        )  # fmt: skip
    elif without:
        yield Statement(id="envelope-spectra", text="No load case has a shock response spectrum.", tone="quiet")


def _panel(lines: Mapping[str, tuple[Array, Array]], cases: list[str], axis: str, label: str) -> Panel:
    curves = [
        Curve(x=x, y=y, name=short(case), kind=number % _COLOURS, dash="" if number < _COLOURS else "dashed")
        for number, (case, (x, y)) in ((cases.index(case), (case, pair)) for case, pair in lines.items())
    ]
    if len(curves) > 1:
        grid = max((x for x, _ in lines.values()), key=len)
        every = [np.interp(np.log(grid), np.log(x), y, left=0.0, right=0.0) for x, y in lines.values()]
        curves.append(Curve(x=grid, y=np.max(every, axis=0), name="envelope", kind=OTHERS, weight=4.0, opacity=0.6))
    return spectrum_panel(curves, label, "g", title=f"along {axis}")
