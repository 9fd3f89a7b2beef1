"""Envelopes over the load cases of a job: the largest accelerations, travels and forces, and shock response spectra."""

from collections.abc import Iterator, Mapping

import numpy as np

from wirerope_mj.assessment.criteria import body_peaks, mount_peaks
from wirerope_mj.assessment.criteria.peaks import BodyPeak
from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.mounts import EXTREMES
from wirerope_mj.content.numbers import listed
from wirerope_mj.content.panels import OTHERS, Chart, Curve, Panel, short
from wirerope_mj.content.run_spectra import BASE
from wirerope_mj.content.selection import worst_names
from wirerope_mj.content.spectra import spectrum_panel
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table
from wirerope_mj.foundation.units import in_unit

_COLOURS = 6  # numbered colours of a chart; further cases have those of the first again, and dashes


def envelope_blocks(runs: Mapping[str, JudgedRun]) -> Iterator[Block | None]:
    """Yield the largest of every case: accelerations, mounts, and spectra of what is shaken most."""
    yield _accelerations(runs)
    yield _mounts(runs)
    yield from _spectra(runs)


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
    for name, figures_of in found.items():
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
        _panel(curves, axis, f"SRS, Q = {q:g}: peak acceleration [g]" if number == 0 else "")
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


def _panel(lines: Mapping[str, tuple[Array, Array]], axis: str, label: str) -> Panel:
    curves = [
        Curve(x=x, y=y, name=short(case), kind=number % _COLOURS, dash="" if number < _COLOURS else "dashed")
        for number, (case, (x, y)) in enumerate(lines.items())
    ]
    if len(curves) > 1:
        grid = max((x for x, _ in lines.values()), key=len)
        every = [np.interp(np.log(grid), np.log(x), y, left=0.0, right=0.0) for x, y in lines.values()]
        curves.append(Curve(x=grid, y=np.max(every, axis=0), name="envelope", kind=OTHERS, weight=4.0, opacity=0.6))
    return spectrum_panel(curves, label, "g", title=f"along {axis}")
