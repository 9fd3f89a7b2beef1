"""Envelopes over the load cases of a job: the largest accelerations, travels and forces, and shock response spectra."""

from collections.abc import Iterator, Mapping

import numpy as np

from wirerope_mj.assessment.criteria import body_peaks, mount_peaks
from wirerope_mj.assessment.criteria.loads import area_forces
from wirerope_mj.assessment.criteria.summary import BodyPeak
from wirerope_mj.assessment.criteria.verdict import by_use
from wirerope_mj.content.blocks import OTHERS, Block, Chart, Curve, Panel, Statement, short
from wirerope_mj.content.decks import stop_loads_table
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.mounts import EXTREMES
from wirerope_mj.content.numbers import listed
from wirerope_mj.content.run_spectra import BASE
from wirerope_mj.content.selection import worst_names
from wirerope_mj.content.spectrum_charts import spectrum_panel
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.payload_limits import SIDES
from wirerope_mj.foundation.tables import Column, Mark, Row, Table, left
from wirerope_mj.foundation.units import in_unit

_COLOURS = 6  # numbered colours of a chart; further cases repeat them in dashes


def envelope_blocks(runs: Mapping[str, JudgedRun]) -> Iterator[Block | None]:
    yield _base_table(runs)
    yield _accelerations_table(runs)
    yield _room_table(runs)
    yield _mounts_table(runs)
    yield stop_loads_table(runs) if len(runs) > 1 else None
    yield from _spectra_chart(runs)


def _base_table(runs: Mapping[str, JudgedRun]) -> Table:
    """Tabulate the largest base motion and the loads on the deck by load case."""
    rows: list[Row] = []
    for case, run in runs.items():
        base = run.response.base
        moved = [float(np.linalg.norm(history, axis=1).max()) for history in (base.velocity, base.displacement)]
        peak = max((row.value for row in body_peaks(run.response) if row.kind == "base"), default=0.0)
        deck = area_forces(run.response, run.motion.up)[0]
        rows.append([case, None if run.motion.up is not None else peak, *moved, deck.at_rest, deck.down, deck.up, deck.across])
    return Table(
        "envelope-base", "Base motion, and loads of all mounts on the deck",
        [
            *left("load case"), Column("acceleration", "g", "z.2f"), Column("velocity", "m/s", "z.2f"),
            Column("displacement", "mm", "z.1f"), Column("at rest", "kN", 3), Column("down", "kN", 3), Column("up", "kN", 3),
            Column("horizontally", "kN", 3),
        ],
        rows,
        note="Largest sizes; a base that coasts after a pulse does so to the end of the run, and one that falls has no "
        "acceleration but that of its fall before it stops at once. The loads, down along gravity, are sums "
        "over all mounts and stops, weight included, at the samples.",
    )  # fmt: skip


def _room_table(runs: Mapping[str, JudgedRun]) -> Table | None:
    """Tabulate the largest displacements of each point to all sides, over the load cases; None without points."""
    names = list(next(iter(runs.values())).response.peaks.points)
    if not names:
        return None
    rows: list[Row] = []
    for name in names:
        moved = {case: run.response.peaks.points[name].relative_displacement for case, run in runs.items()}
        worst = max(moved, key=lambda case: moved[case].value)
        strokes = [
            (max(-peak.minimum[axis], 0.0), max(peak.maximum[axis], 0.0)) for peak in moved.values() for axis in range(3)
        ]
        largest = np.array(strokes).reshape(len(moved), 6).max(axis=0)
        rows.append([name, *map(float, largest), worst])
    return Table(
        "envelope-room", "Room that points need in all load cases",
        [
            *left("point"), *(Column(side, "mm", "z.1f") for side in SIDES),
            *left("largest displacement in"),
        ],
        rows, note="Displacement from the modelled position relative to the base, sag included, the largest of any case.",
    )  # fmt: skip


def _accelerations_table(runs: Mapping[str, JudgedRun]) -> Table:
    """Tabulate the largest acceleration of each body and point over the load cases, and in which case it occurs."""
    by_name: dict[str, list[tuple[str, BodyPeak]]] = {}
    for case, run in runs.items():
        for row in body_peaks(run.response):
            name = {"base": "base", "body": row.name}.get(row.kind, f"{row.name} (point)")
            by_name.setdefault(name, []).append((case, row))
    rows: list[Row] = []
    for name, peaks in by_name.items():
        case, worst = max(peaks, key=lambda pair: pair[1].value)
        axes = [max(peak.axes[axis] for _, peak in peaks) for axis in range(3)]
        rows.append([name, Mark(worst.value, "strong"), case, *axes])
    columns = [Column(align="left"), Column("peak", "g", "z.2f"), *left("in")]
    return Table(
        "envelope-accelerations", "Largest accelerations of all load cases",
        [*columns, *(Column(axis, "g", "z.2f") for axis in "xyz")], rows,
        note="The peak is the size of the vector; along x, y and z each the largest of any case.",
    )  # fmt: skip


def _mounts_table(runs: Mapping[str, JudgedRun]) -> Table | None:
    """Tabulate the largest travels and forces of each mount over the load cases; None without mounts."""
    by_name: dict[str, list[tuple[str, tuple[float, ...]]]] = {}
    for case, run in runs.items():
        for row in mount_peaks(run.response):
            force = run.response.peaks.mounts[row.name].force
            figures = (  # of the columns `EXTREMES`
                max(-row.minimum[2], 0.0), max(row.maximum[2], 0.0), max(row.maximum[1], -row.minimum[1]),
                max(row.maximum[0], -row.minimum[0]), max(-float(force.minimum[2]), 0.0), max(float(force.maximum[2]), 0.0),
                abs(row.force[1]), abs(row.force[0]),
            )  # fmt: skip
            by_name.setdefault(row.name, []).append((case, figures))
    if not by_name:
        return None
    rows: list[Row] = []
    order = [*by_use(row for run in runs.values() for row in run.verdicts), *by_name]
    for name, figures_of in sorted(by_name.items(), key=lambda pair: order.index(pair[0])):
        largest = [max(column) for column in zip(*(figures for _, figures in figures_of), strict=True)]
        rows.append([name, *largest, max(figures_of, key=lambda pair: max(pair[1][:4]))[0]])
    return Table(
        "envelope-mounts", "Largest travels and forces of the mounts in all load cases",
        [*EXTREMES, *left("largest deflection in")], rows,
        note="Sizes; each figure is the largest of any case, so that those of a row need not occur together. The case named "
        "last has the largest deflection in mm; which case uses most of a rating stands with the limits.",
    )  # fmt: skip


def _spectra_chart(runs: Mapping[str, JudgedRun]) -> Iterator[Block]:
    """Draw shock response spectra of the worst body or point in each load case, and their envelope."""
    name = next((name for run in runs.values() for name in worst_names(run.response)[:1]), None)
    lines: dict[str, dict[str, tuple[Array, Array]]] = {"x": {}, "y": {}, "z": {}}
    missing, q = [], 10.0
    for case, run in runs.items():
        shock = run.spectra.shock
        if isinstance(shock, Absent) or name is None:
            missing.append(case)
            continue
        for axis, spectra in shock.items():
            if name in spectra and name != BASE:
                lines[axis][case] = spectra[name].frequencies, in_unit(spectra[name].maximax, "g")
                q = spectra[name].q
    panels: list[Panel] = []
    several_cases = len(set[str]().union(*lines.values())) > 1
    for axis, along in lines.items():
        curves = []
        for number, case in enumerate(runs):
            if case in along:
                dash = "" if number < _COLOURS else "dashed"
                curves.append(Curve(*along[case], name=short(case), kind=number % _COLOURS, dash=dash))
        if curves and several_cases:
            grid = max((x for x, _ in along.values()), key=len)
            every = [np.interp(np.log(grid), np.log(x), y, left=0.0, right=0.0) for x, y in along.values()]
            curves.append(Curve(grid, np.max(every, axis=0), name="envelope", kind=OTHERS, weight=4.0, opacity=0.6))
        if curves:
            label = "" if panels else f"SRS, Q = {q:g}: peak acceleration [g]"
            panels.append(spectrum_panel(curves, label, "g", title=f"along {axis}"))
    if panels:
        left_out = f" Without {listed(missing)}: steady or random motions have no such spectrum." if missing else ""
        yield Chart(
            id="envelope-spectra", rows=[panels], height=190.0,
            caption=f"Shock response spectra of {name} under each load case along the axes that it moves the base"
            f"{', and their envelope' * several_cases}, maximax, Q = {q:g}.{left_out}",
            alt=f"Shock response spectra of {name} under all load cases{' and their envelope' * several_cases}.",
        )  # fmt: skip
    elif missing:
        yield Statement("envelope-spectra", "No load case has a shock response spectrum.", tone="quiet")
