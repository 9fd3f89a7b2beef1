"""What a recording draws over frequency: accelerations of a sweep, or spectra along the axis of the largest motion."""

from dataclasses import replace

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.motions import BaseMotion, Sweep
from wirerope_mj.runs.run_spectra import RunSpectra
from wirerope_mj.views.curves import Panel
from wirerope_mj.views.plots.report_motion import moving_axes
from wirerope_mj.views.plots.report_response import sweep_chart
from wirerope_mj.views.plots.report_spectra import densities_chart, payload_spectra_chart
from wirerope_mj.views.plots.svg_chart import Chart
from wirerope_mj.views.report import worst_names
from wirerope_mj.views.selection import Selection, main_direction


def panel_over_frequency(
    motion: BaseMotion, response: Response, selection: Selection, spectra: RunSpectra
) -> Panel | None:
    """Return what is drawn over frequency; None where there is nothing."""
    if isinstance(motion, Sweep):
        chart = sweep_chart(response, worst_names(response), motion.frequency(response.time), moving_axes(response))
        ends = sorted((motion.start, motion.stop))
        return replace(chart.rows[0][0], xlim=(ends[0], ends[1]))
    axis = main_direction(response)
    if spectra.densities:
        return _along(densities_chart(spectra.densities, selection), list(spectra.densities), axis)
    if isinstance(spectra.shock, Absent):
        return None
    return _along(payload_spectra_chart(spectra.shock, selection), list(spectra.shock), axis)


def _along(chart: Chart, axes: list[str], axis: str) -> Panel:
    """Return the panel of a chart along an axis, or its first; the label is that of the first alone."""
    row = chart.rows[0]
    panel = row[axes.index(axis) if axis in axes else 0]
    return replace(panel, ylabel=f"{row[0].ylabel} {panel.title}")
