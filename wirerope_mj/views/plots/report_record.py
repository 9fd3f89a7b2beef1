"""A measured record before and after its baseline correction, as a chart of a report."""

import numpy as np

from wirerope_mj.foundation.units import in_unit
from wirerope_mj.motions import Record
from wirerope_mj.views.curves import Curve, Panel
from wirerope_mj.views.plots.svg_chart import Chart


def record_chart(measured: Record, played: Record) -> Chart:
    """Return acceleration, velocity and displacement of a record along every axis with any, without its correction and with it.

    Args:
        measured: without the baseline correction.
        played: with it.
    """
    axes = [axis for axis in range(3) if measured.samples[:, axis].any()] or [2]
    rows: list[list[Panel]] = []
    for number, (label, unit) in enumerate(
        (("acceleration [g]", "g"), ("velocity [m/s]", "m/s"), ("displ. [mm]", "mm"))
    ):
        row = []
        for axis in axes:
            curves = []
            for kind, (record, name) in enumerate(((played, "as played"), (measured, "as measured"))):
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
    return Chart(rows=rows, height=95.0)


def ends(record: Record) -> tuple[np.ndarray, np.ndarray]:
    """Return velocity [m/s] and displacement [m] at the last sample, (3,) each; what rounding leaves of nothing is zero."""
    return record.velocity(record.end)[0].round(9) + 0.0, record.displacement(record.end)[0].round(9) + 0.0
