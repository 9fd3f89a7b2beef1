"""Measured records in the base's motion: their warnings, and the correction of their baselines."""

from collections.abc import Iterator

import numpy as np

from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.numbers import listed
from wirerope_mj.content.panels import Chart, Curve, Panel
from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.motions import Record
from wirerope_mj.motions.records.record import records_in

_TEXTS = {
    "none": "no baseline correction",
    "rest": "baseline: the level at rest taken off",
    "mean": "baseline: the mean taken off",
    "velocity": "baseline: the constant taken off that leaves no final velocity",
    "highpass": "baseline: high-pass filter without phase",
}


def warnings_of(run: JudgedRun) -> Statement | None:
    """Return the warnings of the records that were played; None if there are none."""
    if not run.record_warnings:
        return None
    text = "Said of the measured record, on which every figure here rests:"
    return Statement(id="record-warnings", text=text, items=run.record_warnings, tone="unjudged")


def record_blocks(run: JudgedRun) -> Iterator[Block | None]:
    """Yield the warnings of the records in the base's motion, and the baseline correction of each."""
    yield warnings_of(run)
    for record in records_in(run.motion):
        yield record_chart(record)
        if record.baseline != "none":
            yield _correction(record)


def baseline_text(record: Record) -> str:
    """Return the baseline correction of a record, for instance "baseline: the mean taken off"."""
    text = _TEXTS[record.baseline]
    return text if record.highpass is None else f"{text}, {record.highpass:g} Hz"


def _correction(record: Record) -> Table:
    """Tabulate the ends of a record without its baseline correction and with it."""
    measured = record.as_measured
    axes = [axis for axis in range(3) if measured.samples[:, axis].any()]
    rows = []
    for axis in axes:
        for one, text in ((measured, "as measured"), (record, "as played")):
            velocity, displacement = ends(one)
            peak = float(abs(one.samples[:, axis]).max())
            rows.append(("xyz"[axis], text, peak, float(velocity[axis]), float(displacement[axis])))
    return Table(
        id=f"baseline-{record.path.name}",
        title="What the baseline correction changes",
        columns=(
            Column("axis", align="left"), Column("record", align="left"), Column("largest acceleration", "g"),
            Column("velocity at its end", "m/s"), Column("displacement at its end", "mm"),
        ),
        rows=rows,
    )  # fmt: skip


def record_chart(played: Record) -> Chart:
    """Draw acceleration, velocity and displacement of a record along its axes, without its correction and with it."""
    measured, corrected = played.as_measured, played.baseline != "none"
    axes = [axis for axis in range(3) if measured.samples[:, axis].any()] or [2]
    rows: list[list[Panel]] = []
    for number, (label, unit) in enumerate(
        (("acceleration [g]", "g"), ("velocity [m/s]", "m/s"), ("displ. [mm]", "mm"))
    ):
        row = []
        for axis in axes:
            curves = []
            for kind, (record, name) in enumerate(((played, "as played"), (measured, "as measured"))[: 1 + corrected]):
                values = (in_unit(record.samples, "g"), record.velocity, record.displacement)[number]
                y = values if isinstance(values, np.ndarray) else values(record.time)
                y = in_unit(y, "mm") if unit == "mm" else y
                curves.append(Curve(x=record.time, y=y[:, axis], name=name, kind=kind))
            row.append(
                Panel(
                    curves=curves,
                    ylabel=label if axis == axes[0] else "",
                    xlabel="time [s]" if unit == "mm" else "",
                    title="xyz"[axis] if number == 0 else "",
                    unit=unit,
                )
            )
        rows.append(row)
    along, text = listed(["xyz"[axis] for axis in axes]), baseline_text(played)
    velocity, displacement = ends(played)
    left = "; ".join(f"{velocity[n]:+.3g} m/s and {displacement[n]:+.3g} m along {'xyz'[n]}" for n in axes)
    how = "as measured and as it is played" if corrected else "as it is played"
    return Chart(
        id=f"record-{played.path.name}",
        rows=rows,
        height=95.0,
        caption=f"The whole record {played.path.name} along {along}, {how}, {text}. At its end {left}.",
        alt=f"Histories of {played.path.name} along {along}, {how}.",
    )


def ends(record: Record) -> tuple[np.ndarray, np.ndarray]:
    """Return velocity [m/s] and displacement [m] at the last sample, (3,) each; what rounding leaves of nothing is zero."""
    return record.velocity(record.end)[0].round(9) + 0.0, record.displacement(record.end)[0].round(9) + 0.0
