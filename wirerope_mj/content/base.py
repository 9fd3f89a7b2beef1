"""Blocks on the base's motion: histories, extremes, events, spectrum, and measured records with baseline corrections."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from wirerope_mj.assessment.criteria.loads import foundation_force
from wirerope_mj.assessment.criteria.sampled import elements, has_peak
from wirerope_mj.assessment.criteria.verdict import AMPLIFIED
from wirerope_mj.content.blocks import MEASURED, PAYLOADS, Block, Chart, Curve, Panel, Statement
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.numbers import fixed, listed
from wirerope_mj.content.run_spectra import BASE, moving_axes
from wirerope_mj.content.spectrum_charts import base_spectrum_chart
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.tables import Cell, Column, Table, left
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.motions import BaseMotion, RandomVibration, Record
from wirerope_mj.motions.records.record import records_in

_RESIDUAL_VELOCITY = 1e-3  # [m/s] at the end of the motion, above which the base is said to keep a velocity
_NEGLIGIBLE = 1e-6  # fraction of the largest component of a force, below which a component is not drawn
_MOST_EVENTS = 12  # rows of the table of base events: a record may have any number
_MOST_CORNERS = 100  # above it no instants are added: a record has a corner at every sample
_INSTANTS = 4001  # at which a motion is sampled beside its corners: finds the peak of a half-sine within 1e-6
_INTERVALS = 64  # of equal length between two corners: find the peak of a half-sine within 0.03 %
_MOST_SAMPLES = 200_000  # of a response whose corners are joined to its samples
_BASELINE_TEXTS = {
    "none": "no baseline correction", "rest": "baseline: the level at rest taken off", "mean": "baseline: the mean taken off",
    "velocity": "baseline: the constant taken off that leaves no final velocity",
    "highpass": "baseline: high-pass filter without phase",
}  # fmt: skip


def base_blocks(run: JudgedRun) -> Iterator[Block | None]:
    """Yield the base's motion and spectrum, and what acts on the payload."""
    response = run.response
    yield Statement("motion", f"{'Excitation' if run.motion.loaded_sites else 'Base motion'}: {run.acting}.")
    if run.motion.loaded_sites:
        yield _loads_chart(response, run.motion, run.selection.window)
    axes = moving_axes(response)
    if run.motion.rotates:
        yield from _rotation_blocks(response, run.motion, run.selection.window)
    if not axes:
        text = "The base's origin rests." if run.motion.rotates else "The base rests."
        yield Statement(text=text, tone="quiet")
        yield from record_blocks(run)
        return
    window = run.selection.window
    time, acceleration = base_acceleration(response, run.motion)
    panels = []
    for label, shown_unit, x, values in (
        ("acceleration [g]", "g", time, in_unit(acceleration, "g")),
        ("velocity [m/s]", "m/s", response.time, response.base.velocity),
        ("displ. [mm]", "mm", response.time, in_unit(response.base.displacement, "mm")),
    ):
        panels.append(_axis_panels(x, values, axes, label, shown_unit, "time [s]" if shown_unit == "mm" else "", window))
    names = listed(["xyz"[axis] for axis in axes])
    still = "" if len(axes) == 3 else f" along {names}; it does not move along the others"
    end = float(np.linalg.norm(response.base.velocity[-1]))
    kept = f" The base keeps {end:.3g} m/s after the motion." if end > _RESIDUAL_VELOCITY else ""
    yield Chart(
        rows=panels, height=95.0, id="base-motion", caption=f"The base's acceleration, velocity and displacement{still}.{kept}",
        alt=f"Histories of the base along {names}.",
    )  # fmt: skip
    base = response.base
    peak = response.peaks.bodies[response.scene.base].acceleration  # of every step, as in the table of peaks
    rows: list[list[Cell]] = []
    for axis in axes:
        extremes = [peak.minimum[axis], peak.maximum[axis]]
        for history in (base.velocity[:, axis], base.displacement[:, axis]):
            extremes += [history.min(), history.max()]
        rows.append(["xyz"[axis], *map(float, extremes)])
    columns = left("axis")
    for quantity, unit in (("acceleration", "g"), ("velocity", "m/s"), ("displacement", "mm")):
        columns += [Column(f"{quantity}, minimum", unit), Column("maximum", unit)]
    yield Table("base-extremes", "Extremes of the base's motion", columns, rows)
    texts = {(fixed(time, 4), text): time for time, text in response.events}  # each once: pulses along two axes
    events = [(time, text) for (_, text), time in texts.items() if response.reaches(time)]
    if events:
        later = [text for (_, text), time in texts.items() if not response.reaches(time)]
        notes = [f"And {len(events) - _MOST_EVENTS} more."] if len(events) > _MOST_EVENTS else []
        if later:
            notes.append(f"After the end of the run at {response.final_state.time:g} s, and not simulated: {listed(later)}.")
        columns = [Column("at", "s", "z.4f"), Column("event", align="text")]
        yield Table("base-events", "What the base does when", columns, events[:_MOST_EVENTS], note=" ".join(notes))
    yield from record_blocks(run)
    shock = run.spectra.shock
    if isinstance(shock, Absent):
        yield Statement("base-spectrum", shock.reason, tone="quiet")
    else:
        yield base_spectrum_chart({axis: lines[BASE] for axis, lines in shock.items()})


def base_acceleration(response: Response, motion: BaseMotion) -> tuple[Array, Array]:
    """Compute the base's acceleration at the samples and between corners of the motion: instants [s], [m/s^2] (n_t, 3)."""
    corners = motion.corners
    if corners.size > _MOST_CORNERS or response.time.size > _MOST_SAMPLES:
        return response.time, response.base.acceleration
    inside = corners[(corners > response.time[0]) & (corners <= response.time[-1])]
    between = np.linspace(inside[:-1], inside[1:], _INTERVALS + 1).ravel() if inside.size > 1 else inside
    time = np.unique(np.concatenate([response.time, between, np.nextafter(inside, -np.inf)]))  # both sides of a jump
    return time, motion.acceleration(time)


def _loads_chart(response: Response, motion: BaseMotion, window: tuple[float, float]) -> Chart:
    """Draw forces and moments at the loaded sites, and the force on the foundation without its initial value."""

    def components(values: Array, label: str, unit: str, kind: str, xlabel: str = "") -> list[Panel]:
        size = np.abs(values).max(initial=0.0)
        axes = [axis for axis in range(3) if np.abs(values[:, axis]).max(initial=0.0) > _NEGLIGIBLE * size] or [2]
        return _axis_panels(response.time, values, axes, label, unit, xlabel, window, kind)

    rows = []
    for site in motion.loaded_sites:
        load = motion.load(site, response.time)
        for values, quantity, unit in ((load[:, :3], "force", "N"), (load[:, 3:], "moment", "N m")):
            if np.abs(values).max(initial=0.0) > 0.0:
                rows.append(components(values, f"{quantity} at {site} [{unit}]", unit, PAYLOADS[0]))
    transmitted = foundation_force(response)
    rows.append(components(transmitted - transmitted[0], "on the foundation [N]", "N", BASE, "time [s]"))
    return Chart(
        rows=rows, height=95.0, id="loads",
        caption="What acts on the payload, along the axes of its site, and what the mounts pass on to the foundation, along "
        "the world's, without what they carry at the beginning.",
        alt="Histories of the forces on the payload and on the foundation.",
    )  # fmt: skip


def _axis_panels(
    x: Array,
    values: Array,
    axes: Sequence[int],
    label: str,
    unit: str,
    xlabel: str,
    window: tuple[float, float],
    kind: str = BASE,
) -> list[Panel]:
    """Draw the components `axes` of `values` (n_t, 3) over `x`, a panel for each."""
    return [
        Panel(
            [Curve(x, values[:, axis], name="", kind=kind)], label if axis == axes[0] else "", xlabel=xlabel,
            title="xyz"[axis], xlim=window, unit=unit,
        )
        for axis in axes
    ]  # fmt: skip


def _rotation_blocks(response: Response, motion: BaseMotion, window: tuple[float, float]) -> Iterator[Block]:
    """Yield the base's roll, pitch and yaw, its angular velocity and acceleration, with their extremes."""
    angles = motion.angular_displacement(response.time)
    spin, turning = motion.angular_velocity(response.time), motion.angular_acceleration(response.time)
    turned = [axis for axis in range(3) if np.abs(angles[:, axis]).max(initial=0.0) > 0.0]
    names = ("roll", "pitch", "yaw")
    curves = [
        Curve(response.time, in_unit(angles[:, axis], "deg"), name=names[axis], kind=BASE, dash=dash)
        for axis, dash in zip(turned, ("", "dashed", "dotted"), strict=False)
    ]
    about = listed([f"{names[axis]} about {'xyz'[axis]}" for axis in turned])
    yield Chart(
        id="base-rotation", rows=[[Panel(curves, "angle [deg]", xlabel="time [s]", xlim=window, unit="deg")]], height=55.0,
        caption=f"The base's rotation, {about}, axes of the world as modelled; roll first, then pitch, then yaw.",
        alt=f"Histories of the base's {about}.",
    )  # fmt: skip
    columns = [*left("angle"), Column("minimum", "deg"), Column("maximum", "deg")]
    columns += [Column("angular velocity", "rad/s"), Column("angular acceleration", "rad/s^2")]
    rows: list[list[Cell]] = [
        [
            names[axis], float(angles[:, axis].min()), float(angles[:, axis].max()), float(np.abs(spin[:, axis]).max()),
            float(np.abs(turning[:, axis]).max()),
        ]
        for axis in turned
    ]  # fmt: skip
    yield Table(
        "base-rotation-extremes", "Extremes of the base's rotation", columns, rows,
        note="Angular velocity and acceleration are the largest about the world's x, y and z.",
    )  # fmt: skip


def warnings_of(run: JudgedRun) -> Statement | None:
    """State the warnings about the records that were played; None without warnings."""
    text = "Said of the measured record, on which every figure here rests:"
    items = run.record_warnings
    return Statement("record-warnings", text, items=items, tone="unjudged") if items else None


def record_blocks(run: JudgedRun) -> Iterator[Block | None]:
    """Yield the records in the base's motion: warnings, histories, baseline corrections."""
    yield warnings_of(run)
    for record in records_in(run.motion):
        yield record_chart(record)
        if record.baseline == "none":
            continue
        measured, rows = record.as_measured, []
        for axis in (axis for axis in range(3) if measured.samples[:, axis].any()):
            for version, text in ((measured, "as measured"), (record, "as played")):
                velocity, displacement = ends(version)
                peak = float(abs(version.samples[:, axis]).max())
                rows.append(("xyz"[axis], text, peak, float(velocity[axis]), float(displacement[axis])))
        yield Table(
            f"baseline-{record.path.name}", "What the baseline correction changes",
            (
                *left("axis", "record"), Column("largest acceleration", "g"), Column("velocity at its end", "m/s"),
                Column("displacement at its end", "mm"),
            ),
            rows,
        )  # fmt: skip


def record_chart(played: Record) -> Chart:
    """Draw a record along its axes, without its baseline correction and with it."""
    measured, corrected = played.as_measured, played.baseline != "none"
    axes = [axis for axis in range(3) if measured.samples[:, axis].any()] or [2]
    rows: list[list[Panel]] = []
    for number, (label, unit) in enumerate((("acceleration [g]", "g"), ("velocity [m/s]", "m/s"), ("displ. [mm]", "mm"))):
        row = []
        for axis in axes:
            curves = []
            for record, name, kind in ((played, "as played", BASE), (measured, "as measured", MEASURED))[: 1 + corrected]:
                values = (in_unit(record.samples, "g"), record.velocity, record.displacement)[number]
                y = values if isinstance(values, np.ndarray) else values(record.time)
                y = in_unit(y, "mm") if unit == "mm" else y
                curves.append(Curve(record.time, y[:, axis], name=name, kind=kind))
            row.append(Panel(
                curves, label if axis == axes[0] else "", xlabel="time [s]" if unit == "mm" else "",
                title="xyz"[axis] if number == 0 else "", unit=unit,
            ))  # fmt: skip
        rows.append(row)
    along, text = listed(["xyz"[axis] for axis in axes]), _BASELINE_TEXTS[played.baseline]
    text += "" if played.highpass is None else f", {played.highpass:g} Hz"
    velocity, displacement = ends(played)
    at_end = "; ".join(f"{velocity[n]:+.3g} m/s and {displacement[n]:+.3g} m along {'xyz'[n]}" for n in axes)
    how = "as measured and as it is played" if corrected else "as it is played"
    return Chart(
        id=f"record-{played.path.name}", rows=rows, height=95.0,
        caption=f"The whole record {played.path.name} along {along}, {how}, {text}. At its end {at_end}.",
        alt=f"Histories of {played.path.name} along {along}, {how}.",
    )  # fmt: skip


def ends(record: Record) -> tuple[np.ndarray, np.ndarray]:
    """Compute velocity [m/s] and displacement [m] at the end of a record, (3,) each, rounded to 1e-9."""
    return record.velocity(record.end)[0].round(9) + 0.0, record.displacement(record.end)[0].round(9) + 0.0


def shock_peak(motion: BaseMotion) -> float:
    """Compute the largest acceleration of a shock [m/s^2]; NaN of steady and random motions, and of sudden velocities."""
    stored = motion.to_dict()
    random = any(part.get("kind") == RandomVibration.kind for part in elements(stored))
    if random or not has_peak(stored) or not math.isfinite(motion.end):
        return math.nan
    times = np.union1d(motion.corners, np.linspace(0.0, motion.end, _INSTANTS))
    return float(np.linalg.norm(motion.acceleration(times), axis=1).max())


def amplified(value: float, motion: BaseMotion) -> str:
    """Describe in a clause the amplification of a peak [m/s^2] over the base's shock; "" without amplification."""
    peak = shock_peak(motion)
    if not (peak > 0.0 and value > AMPLIFIED * peak):
        return ""
    return f"amplification {value / peak:.3g} (peak {in_unit(value, 'g'):.3g} g, base {in_unit(peak, 'g'):.3g} g)"
