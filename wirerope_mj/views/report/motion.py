"""The parts of a report about what moves: the base, the payload and the mounts."""

from collections.abc import Iterator

import numpy as np

from wirerope_mj.assessment.criteria import MountPeak, body_peaks, mount_peaks
from wirerope_mj.assessment.criteria.steady import steady_interval
from wirerope_mj.motions import Sweep
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.views.plots.report_image import image_of
from wirerope_mj.views.plots.report_motion import base_acceleration, motion_figure, moving_axes
from wirerope_mj.views.plots.report_response import (
    MOST,
    acceleration_along,
    accelerations_figure,
    deflections_figure,
    loop_rows,
    mount_loops_figure,
    sweep_figure,
)
from wirerope_mj.views.plots.report_spectra import base_spectrum_figure, densities_figure, payload_spectra_figure
from wirerope_mj.views.report.content import Block, Paragraph, Picture, Section, Table
from wirerope_mj.views.report.display import ABSENT, fixed, listed, several, shown
from wirerope_mj.views.report.record import record_blocks
from wirerope_mj.views.report.run import BASE, Absent, FinishedRun, worst_names

_COASTING = 1e-3  # [m/s] at the end, from which the base is said to coast
_STILL = 1e-6  # [m/s^2]: an rms that is rounding
_MOST_EVENTS = 12  # in the table of what the base does: a record may have any number


def motion_section(run: FinishedRun) -> Section:
    """Return the base's motion: histories and shock response spectrum."""
    blocks: list[Block] = [Paragraph(text=f"Base motion: {run.motion.description}.")]
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
            image=image_of(motion_figure(run.response, run.motion)),
            caption=f"The base's acceleration, velocity and displacement{still}.{coasts}",
            alt=f"Histories of the base along {names}.",
        )
    )
    blocks += [table for table in (_extremes(run, axes), _events(run)) if table is not None]
    blocks += record_blocks(run)
    blocks.append(_base_spectrum(run))
    return Section(title="Base motion", blocks=tuple(blocks))


def response_section(run: FinishedRun) -> Section:
    """Return what reaches the payload and the mounts: peaks, histories, loops and spectra."""
    worst = worst_names(run.response)
    blocks: list[Block] = [_accelerations(run)]
    if worst:
        blocks.append(
            Picture(
                image=image_of(accelerations_figure(run.response, worst, base_acceleration(run.response, run.motion))),
                caption=f"Absolute accelerations of {listed(worst)} and of the base; {_chosen(run)}.",
                alt=f"Histories of the accelerations of {listed(worst)} and the base along x, y and z.",
            )
        )
        if isinstance(run.motion, Sweep):
            blocks.append(_over_frequency(run, run.motion, worst))
        blocks += _payload_spectra(run) + _densities(run)
    return Section(title="What reaches the payload", blocks=tuple(blocks))


def _chosen(run: FinishedRun) -> str:
    """Return why these bodies and points are drawn."""
    first = (
        "those with limits come first, the nearest to them before the others; then "
        if run.response.scene.limits
        else ""
    )
    return f"{first}those with the largest accelerations"


def mounts_section(run: FinishedRun) -> Section:
    """Return deflections, forces and loops of the mounts."""
    rows = mount_peaks(run.response)
    if not rows:
        return Section(title="Mounts in motion", blocks=())
    names = [row.name for row in rows[:MOST]]
    rated = " Dashed: the rated travel of the first." if rows[0].governing else ""
    order = "that use most of their rated travel" if rows[0].governing else "in the order of the model"
    time, part = run.response.time, loop_rows(run.response, names[0])
    where = f" from {time[part][0]:.5g} to {time[part][-1]:.5g} s" if part != slice(None) else ""
    return Section(
        title="Mounts in motion",
        blocks=(
            Picture(
                image=image_of(deflections_figure(run.response, names)),
                caption=f"Deflections of the mounts {order}: {listed(names)}. Axial is positive in tension.{rated}",
                alt=f"Histories of the deflections of {listed(names)} along roll, shear and axial.",
            ),
            Picture(
                image=image_of(mount_loops_figure(run.response, names[0])),
                caption=f"Force over deflection of {names[0]} ({rows[0].isolator}){where}; the dot is where it begins.",
                alt=f"Loops of {names[0]}.",
            ),
            _peaks(rows),
        ),
    )


def _extremes(run: FinishedRun, axes: list[int]) -> Table:
    base = run.response.base
    peak = run.response.peaks.bodies[
        run.response.scene.base
    ].acceleration  # of every step, as in the table of the peaks
    rows = []
    for axis in axes:
        cells = ["xyz"[axis], shown(float(peak.minimum[axis]), "m/s^2"), shown(float(peak.maximum[axis]), "m/s^2")]
        for values, unit in ((base.velocity[:, axis], "m/s"), (base.displacement[:, axis], "m")):
            cells += [shown(float(values.min()), unit), shown(float(values.max()), unit)]
        rows.append(tuple(cells))
    head = ("axis", "acceleration [g], lowest", "highest", "velocity [m/s], lowest", "highest")
    return Table(
        caption="Extremes of the base's motion",
        head=(*head, "displacement [mm], lowest", "highest"),
        align="lrrrrrr",
        rows=tuple(rows),
    )


def _events(run: FinishedRun) -> Table | None:
    end = float(run.response.time[-1])
    all_of_them = dict.fromkeys((time <= end, fixed(time, 4), words) for time, words in run.response.events)
    events = [(when, words) for inside, when, words in all_of_them if inside]  # each once: pulses along two axes
    later = [words for inside, _, words in all_of_them if not inside]
    if not events:
        return None
    rows, left = tuple(events[:_MOST_EVENTS]), max(len(events) - _MOST_EVENTS, 0)
    beyond = f"After the end of the run at {end:g} s, and not simulated: {listed(later)}." if later else ""
    return Table(
        caption="What the base does when", head=("at [s]", "event"), align="rt", rows=rows,
        note=" ".join(filter(None, [f"And {left} more." if left else "", beyond])),
    )  # fmt: skip


def _base_spectrum(run: FinishedRun) -> Block:
    if isinstance(run.spectra, Absent):
        return Paragraph(text=run.spectra.reason, tone="quiet")
    spectra = {axis: lines[BASE] for axis, lines in run.spectra.items()}
    q = next(iter(spectra.values())).q
    return Picture(
        image=image_of(base_spectrum_figure(spectra)),
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
            image=image_of(payload_spectra_figure(shown_spectra)),
            caption=f"Shock response spectra of {listed(names)} and of the base, maximax, Q = {q:g}: what equipment meets "
            "that stands there. Where the payload's line lies above the base's, isolation makes it worse.",
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
            image=image_of(densities_figure(run.densities)),
            caption=f"Power spectral densities of {names} and of the base while the response is stationary: "
            f"{one.duration:.4g} s, resolution {one.resolution:.3g} Hz, {several(one.segments, 'segment')}, so that each "
            f"density is known to {100.0 * one.standard_error:.0f} %.",
            alt=f"Power spectral densities of {names} and the base.",
        ),
        Table(
            caption="Root mean squares, once the response has settled",
            head=("where", "axis", "rms [g]", "3 sigma [g]", "error of the rms [%]"),
            align="llrrr",
            rows=tuple(row for name in next(iter(run.densities.values())) for row in _rms_rows(run, name)),
            note="Along every axis that is moved. Error: one standard deviation of the estimate, from bandwidth and length; "
            "it is known along the base's motion.",
        ),
    ]


def _rms_rows(run: FinishedRun, name: str) -> Iterator[tuple[str, ...]]:
    """Yield the root mean square of a body along every axis: of its density, or else of the samples it was made of."""
    one = next(iter(run.densities.values()))[name]
    _, _, last = steady_interval(run.response.motion)
    rows = slice(*np.searchsorted(run.response.time, [min(last, run.response.time[-1]) - one.duration, last]))
    for axis in range(3):
        found = run.densities.get("xyz"[axis], {}).get(name)
        rms = float(found.rms if found else acceleration_along(run.response, name, axis)[rows].std())
        if rms > _STILL:
            error = fixed(100.0 * float(found.rms_error), 1) if found else ABSENT
            yield name, "xyz"[axis], shown(rms, "m/s^2"), shown(3.0 * rms, "m/s^2"), error


def _over_frequency(run: FinishedRun, motion: Sweep, names: list[str]) -> Picture:
    axes = moving_axes(run.response)
    return Picture(
        image=image_of(sweep_figure(run.response, names, motion.frequency(run.response.time), axes)),
        caption="Accelerations along the base's motion over the frequency of the sweep.",
        alt="Accelerations over the frequency of the sweep.",
    )


def _accelerations(run: FinishedRun) -> Table:
    sweep = run.motion if isinstance(run.motion, Sweep) else None
    rows = []
    for row in body_peaks(run.response):
        cells = [
            row.name,
            row.kind,
            fixed(row.value, 2),
            *(fixed(value, 2) for value in row.axes),
            fixed(row.time, 4),
        ]
        cells += [fixed(float(sweep.frequency([row.time])[0]), 2)] if sweep is not None else []
        rows.append(tuple(cells))
    head = ("name", "kind", "largest [g]", "along x [g]", "along y [g]", "along z [g]", "at [s]")
    return Table(
        caption="Largest absolute accelerations, over every step of the simulation",
        head=(*head, "at [Hz]") if sweep is not None else head,
        align="llrrrrr" + ("r" if sweep is not None else ""),
        rows=tuple(rows),
        note="Bodies at their centre of mass; zero at rest under gravity. Limits, where the model states any, are among the "
        "verdicts.",
    )


def _peaks(rows: list[MountPeak]) -> Table:
    body = []
    for row in rows:
        cells = [row.name]
        for axis in (2, 1, 0):
            cells += [shown(row.minimum[axis], "m"), shown(row.maximum[axis], "m")]
        cells += [shown(row.force[axis], "N") for axis in (2, 1, 0)]
        body.append(tuple(cells))
    deflections = [f"{AXES[axis]} [mm], {end}" for axis in (2, 1, 0) for end in ("lowest", "highest")]
    forces = [f"{AXES[axis]} [kN]" for axis in (2, 1, 0)]
    return Table(
        caption="Extreme deflections and forces of the mounts",
        head=("mount", *deflections, *forces),
        align="l" + "r" * 9,
        rows=tuple(body),
        note="Axial: negative in compression. Forces: the extreme with its sign.",
    )
