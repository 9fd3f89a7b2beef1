"""A measured record before and after its baseline correction, as a picture of a report."""

import numpy as np
from matplotlib.figure import Figure

from wirerope_mj.foundation.units import in_unit
from wirerope_mj.motions import Record
from wirerope_mj.views.plots.plain_figure import PlainFigure
from wirerope_mj.views.plots.report_image import COLOURS, WIDTH, dress, legend_above, line, report_style

_MEASURED, _PLAYED = COLOURS[1], COLOURS[0]


def record_figure(measured: Record, played: Record) -> Figure:
    """Return acceleration, velocity and displacement of a record along every axis with any, without its correction and with it.

    Args:
        measured: without the baseline correction.
        played: with it.
    """
    axes = [axis for axis in range(3) if measured.samples[:, axis].any()] or [2]
    with report_style():
        figure = PlainFigure(figsize=(WIDTH, 4.2), layout="constrained")
        panels = figure.subplots(3, len(axes), sharex=True, squeeze=False)
        for record, colour, label in ((measured, _MEASURED, "as measured"), (played, _PLAYED, "as played")):
            velocity, displacement = record.velocity(record.time), record.displacement(record.time)
            for column, axis in zip(panels.T, axes, strict=True):
                line(column[0], record.time, in_unit(record.samples[:, axis], "g"), label, colour)
                line(column[1], record.time, velocity[:, axis], label, colour)
                line(column[2], record.time, in_unit(displacement[:, axis], "mm"), label, colour)
        for row, name in zip(panels, ("acceleration\n[g]", "velocity\n[m/s]", "displacement\n[mm]"), strict=True):
            for panel in row:
                dress(panel, ylabel=name if panel is row[0] else "")
        for column, axis in zip(panels.T, axes, strict=True):
            column[0].set_title("xyz"[axis])
            column[-1].set_xlabel("time [s]")
        legend_above(figure, panels[0, 0])
    return figure


def ends(record: Record) -> tuple[np.ndarray, np.ndarray]:
    """Return velocity [m/s] and displacement [m] at the last sample, (3,) each; what rounding leaves of nothing is zero."""
    return record.velocity(record.end)[0].round(9) + 0.0, record.displacement(record.end)[0].round(9) + 0.0
