"""What a run shows over frequency, in one panel: accelerations of a sweep, or spectra of base and payload."""

from dataclasses import replace

from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.numbers import number
from wirerope_mj.content.panels import Chart, Panel, short
from wirerope_mj.content.payload import sweep_chart
from wirerope_mj.content.selection import main_direction
from wirerope_mj.content.spectra import densities_chart, shock_chart
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.motions import Sweep


def panel_over_frequency(run: JudgedRun) -> Panel | None:
    """Return what is drawn over frequency; None where there is nothing."""
    if isinstance(run.motion, Sweep):
        chart = sweep_chart(run, run.motion)
        ends = sorted((run.motion.start, run.motion.stop))
        return _with_peaks(replace(chart.rows[0][0], xlim=(ends[0], ends[1])))
    axis = main_direction(run.response)
    if run.spectra.densities:
        panel = _along(densities_chart(run), list(run.spectra.densities), axis)
        along = run.spectra.densities.get(axis, next(iter(run.spectra.densities.values())))
        rms = {short(name): in_unit(float(density.rms), "g") for name, density in along.items()}
        curves = [replace(curve, name=f"{curve.name}, {number(rms[curve.name])} g rms") for curve in panel.curves]
        return replace(panel, curves=curves)
    if isinstance(run.spectra.shock, Absent):
        return None
    return _with_peaks(_along(shock_chart(run), list(run.spectra.shock), axis))


def _with_peaks(panel: Panel) -> Panel:
    """Mark the largest value of each curve."""
    tops = [(curve, int(curve.y.argmax())) for curve in panel.curves]
    return replace(panel, curves=[replace(one, peak=(float(one.x[top]), float(one.y[top]))) for one, top in tops])


def _along(chart: Chart, axes: list[str], axis: str) -> Panel:
    """Return the panel of a chart along an axis, or its first; the label is that of the first alone."""
    row = chart.rows[0]
    panel = row[axes.index(axis) if axis in axes else 0]
    return replace(panel, ylabel=f"{row[0].ylabel} {panel.title}")
