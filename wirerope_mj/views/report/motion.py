"""The parts of a report about what moves: the base, the payload and the mounts."""

from collections.abc import Iterator

import numpy as np

from wirerope_mj.assessment.criteria import MountPeak, body_peaks, mount_peaks
from wirerope_mj.assessment.criteria.steady import steady_interval
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table
from wirerope_mj.motions import Sweep
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.views.display import fixed, listed, several
from wirerope_mj.views.plots.report_motion import base_acceleration, loads_chart, motion_chart, moving_axes
from wirerope_mj.views.plots.report_response import (
    MOST,
    acceleration_along,
    accelerations_chart,
    deflections_chart,
    loop_rows,
    mount_loops_chart,
    sweep_chart,
    used_chart,
)
from wirerope_mj.views.plots.report_spectra import base_spectrum_chart, densities_chart, payload_spectra_chart
from wirerope_mj.views.random_table import random_table
from wirerope_mj.views.recording.events import events_of
from wirerope_mj.views.report.content import Block, Folded, Paragraph, Picture, Section
from wirerope_mj.views.report.record import record_blocks
from wirerope_mj.views.report.run import BASE, FinishedRun, worst_names

_COASTING = 1e-3  # [m/s] at the end, from which the base is said to coast
_STILL = 1e-6  # [m/s^2]: an rms that is rounding
_AXIAL_FIRST = (2, 1, 0)
_MOST_EVENTS = 12  # in the table of what the base does: a record may have any number


def motion_section(run: FinishedRun) -> Section:
    """Return the base's motion: histories and shock response spectrum."""
    kind = "Excitation" if run.motion.loaded_sites else "Base motion"
    blocks: list[Block] = [Paragraph(text=f"{kind}: {run.motion.description}.")]
    if run.motion.loaded_sites:
        blocks.append(
            Picture(
                image=loads_chart(run.response, run.motion, run.selection.window),
                caption="What acts on the payload, along the axes of its site, and what the mounts pass on to the foundation, "
                "along the world's, without what they carry at the beginning.",
                alt="Histories of the forces on the payload and on the foundation.",
            )
        )
    axes = moving_axes(run.response)
    if not axes:
        blocks += [Paragraph(text="The base rests.", tone="quiet"), *record_blocks(run)]
        return Section(title="Base motion", blocks=tuple(blocks))
    names = listed(["xyz"[axis] for axis in axes])
    still = "" if len(axes) == 3 else f" along {names}; it does not move along the others"
    end = run.response.base.velocity[-1]
    coasts = " At the end it coasts on at the velocity that is left." if np.abs(end).max() > _COASTING else ""
    blocks.append(
        Picture(
            image=motion_chart(run.response, run.motion, run.selection.window),
            caption=f"The base's acceleration, velocity and displacement{still}.{coasts}",
            alt=f"Histories of the base along {names}.",
        )
    )
    blocks += [table for table in (_extremes(run, axes), _events(run)) if table is not None]
    blocks += record_blocks(run)
    blocks.append(_base_spectrum(run))
    return Section(title="Base motion", blocks=tuple(blocks))


def response_section(run: FinishedRun) -> Section:
    """Return the response of payload and mounts: peaks, histories, loops and spectra."""
    worst = worst_names(run.response)
    blocks: list[Block] = [_accelerations(run)]
    if worst:
        blocks.append(
            Picture(
                image=accelerations_chart(
                    run.response, worst, base_acceleration(run.response, run.motion), run.selection
                ),
                caption=f"Absolute accelerations of {listed(worst)} and of the base; {_chosen(run)}.",
                alt=f"Histories of the accelerations of {listed(worst)} and the base along x, y and z.",
            )
        )
        if isinstance(run.motion, Sweep):
            blocks.append(_over_frequency(run, run.motion, worst))
        table = None if isinstance(run.random, Absent) else random_table(run.random)
        blocks += [table] if table is not None else []
        blocks += _payload_spectra(run) + _densities(run)
    return Section(title="What reaches the payload", blocks=tuple(blocks))


def _chosen(run: FinishedRun) -> str:
    """Return why these bodies and points are drawn."""
    limited = "those with limits come first, the nearest to them before the others; then "
    return f"{limited if run.response.scene.limits else ''}those with the largest accelerations"


def mounts_section(run: FinishedRun) -> Section:
    """Return what is used of the limits, and deflections, forces and loops of the mounts."""
    rows, selection = mount_peaks(run.response), run.selection
    if not rows:
        return Section(title="Mounts in motion", blocks=())
    names = [one.subject for one in selection.used if one.subject in selection.mounts][:MOST]
    order = "that use most of their limits" if names else "in the order of the model"
    names = names or [row.name for row in rows[:MOST]]
    isolator = next(mount.isolator for mount in run.response.scene.mounts if mount.name == names[0])
    time, part = run.response.time, loop_rows(run.response, names[0])
    interval = f" from {time[part][0]:.5g} to {time[part][-1]:.5g} s" if part != slice(None) else ""
    pictures = [
        Picture(
            image=deflections_chart(run.response, names, selection),
            caption=f"Deflections of the mounts {order}: {listed(names)}. Axial is positive in tension.",
            alt=f"Histories of the deflections of {listed(names)} along roll, shear and axial.",
        ),
        Picture(
            image=mount_loops_chart(run.response, names[0], selection),
            caption=f"Force over deflection of {names[0]} ({isolator}){interval}; the dot is where it begins.",
            alt=f"Loops of {names[0]}.",
        ),
    ]
    if selection.used:
        used = Picture(
            image=used_chart(run.response, selection),
            caption="What is used of the limits over time, the largest of all criteria of each mount, body or point.",
            alt="Utilisation of limits over time.",
        )
        pictures.insert(0, used)
    return Section(title="Mounts in motion", blocks=(*pictures, *_course(run), _peaks(rows)))


def _course(run: FinishedRun) -> list[Block]:
    """Return the events of the run as the recording has them: the few that tell its course first, the others folded away."""
    events = events_of(run.response, run.selection)
    events.sort(key=lambda event: not event.main)
    main = sum(event.main for event in events)
    table = Table(
        title="The course of the run, and below it all other peaks and limits that are passed",
        columns=(Column("at", "s", "z.4f"), Column("event", align="text")),
        rows=[(event.time, Mark(event.text, "exceeded" if event.level == "ERROR" else "")) for event in events],
    )
    return [Folded(table=table, shown=max(main, 1))] if events else []


def _extremes(run: FinishedRun, axes: list[int]) -> Table:
    base = run.response.base
    peak = run.response.peaks.bodies[
        run.response.scene.base
    ].acceleration  # of every step, as in the table of the peaks
    rows: list[list[Cell]] = []
    for axis in axes:
        extremes = [peak.minimum[axis], peak.maximum[axis]]
        for values in (base.velocity[:, axis], base.displacement[:, axis]):
            extremes += [values.min(), values.max()]
        rows.append(["xyz"[axis], *map(float, extremes)])
    columns = [Column("axis", align="left")]
    for quantity, unit in (("acceleration", "g"), ("velocity", "m/s"), ("displacement", "mm")):
        columns += [Column(f"{quantity}, minimum", unit), Column("maximum", unit)]
    return Table(title="Extremes of the base's motion", columns=columns, rows=rows)


def _events(run: FinishedRun) -> Table | None:
    every = {(fixed(time, 4), text): time for time, text in run.response.events}  # each once: pulses along two axes
    events = [(time, text) for (_, text), time in every.items() if run.response.reaches(time)]
    later = [text for (_, text), time in every.items() if not run.response.reaches(time)]
    if not events:
        return None
    left = max(len(events) - _MOST_EVENTS, 0)
    end = f"{run.response.final_state.time:g}"
    beyond = f"After the end of the run at {end} s, and not simulated: {listed(later)}." if later else ""
    return Table(
        title="What the base does when",
        columns=(Column("at", "s", "z.4f"), Column("event", align="text")),
        rows=events[:_MOST_EVENTS],
        note=" ".join(filter(None, [f"And {left} more." if left else "", beyond])),
    )


def _base_spectrum(run: FinishedRun) -> Block:
    if isinstance(run.spectra, Absent):
        return Paragraph(text=run.spectra.reason, tone="quiet")
    spectra = {axis: lines[BASE] for axis, lines in run.spectra.items()}
    q = next(iter(spectra.values())).q
    return Picture(
        image=base_spectrum_chart(spectra),
        caption=f"Shock response spectrum of the base, maximax, Q = {q:g}: absolute acceleration and pseudo-velocity of "
        "oscillators that stand on the base without isolators.",
        alt="Shock response spectrum of the base.",
    )


def _payload_spectra(run: FinishedRun) -> list[Block]:
    if isinstance(run.spectra, Absent):
        return []
    shown_spectra = {axis: dict(lines) for axis, lines in run.spectra.items()}
    names = [name for name in next(iter(shown_spectra.values())) if name != BASE]
    if not names:
        return []
    q = next(iter(next(iter(shown_spectra.values())).values())).q
    return [
        Picture(
            image=payload_spectra_chart(shown_spectra, run.selection),
            caption=f"Shock response spectra of {listed(names)} and of the base, maximax, Q = {q:g}: what equipment meets "
            "that stands there. Where the payload's line lies above the base's, isolation makes it worse. "
            f"{run.sample_rate:g} samples a second hold the payload's lines within 1 % "
            f"{f'up to {run.spectra_held:.3g} Hz' if run.spectra_held else 'nowhere'}; above they are an indication.",
            alt=f"Shock response spectra of {listed(names)} and the base.",
        )
    ]


def _densities(run: FinishedRun) -> list[Block]:
    if not run.densities:
        return []
    one = next(iter(next(iter(run.densities.values())).values()))
    names = listed([name for name in next(iter(run.densities.values())) if name != BASE])
    return [
        Picture(
            image=densities_chart(run.densities, run.selection),
            caption=f"Power spectral densities of {names} and of the base while the response is stationary: "
            f"{one.duration:.4g} s, resolution {one.resolution:.3g} Hz, {several(one.segments, 'segment')}, so that each "
            f"density is known to {100.0 * one.standard_error:.0f} %.",
            alt=f"Power spectral densities of {names} and the base.",
        ),
        Table(
            title="Root mean squares, once the response has settled",
            columns=(
                Column("where", align="left"), Column("axis", align="left"), Column("rms", "g"), Column("3 sigma", "g"),
                Column("error of the rms", "%", "z.1f"),
            ),
            rows=[row for name in next(iter(run.densities.values())) for row in _rms_rows(run, name)],
            note="Along every axis that is moved. Error: one standard deviation of the estimate, from bandwidth and length; "
            "it is known along the base's motion.",
        ),
    ]  # fmt: skip


def _rms_rows(run: FinishedRun, name: str) -> Iterator[tuple[Cell, ...]]:
    """Yield the root mean square of a body along every axis: of its density, or else of the samples it was made of."""
    one = next(iter(run.densities.values()))[name]
    _, _, last = steady_interval(run.response.motion)
    rows = slice(*np.searchsorted(run.response.time, [min(last, run.response.time[-1]) - one.duration, last]))
    for axis in range(3):
        density = run.densities.get("xyz"[axis], {}).get(name)
        rms = float(density.rms if density else acceleration_along(run.response, name, axis)[rows].std())
        if rms > _STILL:
            yield name, "xyz"[axis], rms, 3.0 * rms, float(density.rms_error) if density else None


def _over_frequency(run: FinishedRun, motion: Sweep, names: list[str]) -> Picture:
    axes = moving_axes(run.response)
    return Picture(
        image=sweep_chart(run.response, names, motion.frequency(run.response.time), axes),
        caption="Accelerations along the base's motion over the frequency of the sweep.",
        alt="Accelerations over the frequency of the sweep.",
    )


def _accelerations(run: FinishedRun) -> Table:
    sweep = run.motion if isinstance(run.motion, Sweep) else None
    rows: list[Row] = []
    for row in body_peaks(run.response):
        sizes = [fixed(value, 2) for value in (row.value, *row.axes)]
        frequency = [] if sweep is None else [float(sweep.frequency([row.time])[0])]
        rows.append((row.name, row.kind, *sizes, row.time, *frequency))
    return Table(
        title="Largest absolute accelerations, over every step of the simulation",
        columns=(
            Column("name", align="left"), Column("kind", align="left"), Column("largest [g]"),
            *(Column(f"along {axis} [g]") for axis in "xyz"), Column("at", "s", "z.4f"),
            *([] if sweep is None else [Column("at", "Hz", "z.2f")]),
        ),
        rows=rows,
        note="Bodies at their centre of mass; zero at rest under gravity. Limits, where the model states any, are among the "
        "verdicts.",
    )  # fmt: skip


def _peaks(rows: list[MountPeak]) -> Table:
    body: list[Row] = []
    for row in rows:
        extremes = [value for axis in _AXIAL_FIRST for value in (row.minimum[axis], row.maximum[axis])]
        body.append((row.name, *extremes, *(row.force[axis] for axis in _AXIAL_FIRST)))
    columns = [Column("mount", align="left")]
    for axis in _AXIAL_FIRST:
        columns += [Column(f"{AXES[axis]}, {end}", "mm") for end in ("minimum", "maximum")]
    return Table(
        title="Extreme deflections and forces of the mounts",
        columns=(*columns, *(Column(AXES[axis], "kN") for axis in _AXIAL_FIRST)),
        rows=body,
        note="Axial: negative in compression. Forces: the extreme with its sign.",
    )
