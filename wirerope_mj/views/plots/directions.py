"""A measure of a study over the directions of its motion, as a map."""

from typing import Any

import numpy as np
import pyarrow as pa
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from wirerope_mj.content.panels import short
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.studies.results.directions import AZIMUTH, ELEVATION
from wirerope_mj.studies.results.measure import Measure, measure_of, values_of
from wirerope_mj.views.plots.plain_figure import PlainFigure
from wirerope_mj.views.plots.report_image import RATED, WIDTH, report_style


def directions_figure(table: pa.Table, measure: str) -> Figure:
    """Return a measure over the directions of the motion as a map of equal areas, with the largest and the limit marked."""
    azimuth, elevation = (np.asarray(table[name], dtype=np.float64) for name in (AZIMUTH, ELEVATION))
    shown = measure_of(measure)
    values = shown.factor * values_of(table, measure)
    height = np.sin(np.radians(elevation))  # so that equal areas of the picture are equal areas of the sphere
    with report_style():
        figure = PlainFigure(figsize=(WIDTH, 3.8), layout="constrained")
        panel = figure.subplots()
        grid = _grid(azimuth, elevation, values)
        if grid is None:
            drawn: Any = panel.scatter(azimuth, height, c=values, cmap="viridis", s=14)
        else:
            drawn = _field(panel, *grid, shown)
        label = f"{short(shown.text) if '/' in shown.name else shown.text} [{shown.unit}]"
        figure.colorbar(drawn, ax=panel, label=label, pad=0.01)
        if np.isfinite(values).any():
            top = int(np.nanargmax(values))
            for colour, width in (("white", 2.4), (RATED, 1.4)):
                panel.plot(azimuth[top], height[top], "o", ms=9, mfc="none", mec=colour, mew=width, clip_on=False)
            where = "" if abs(elevation[top]) == 90.0 else f"azimuth {azimuth[top]:.4g}°, "
            panel.set_title(
                f"largest: {values[top]:.3g} {shown.unit} at {where}elevation {elevation[top]:.4g}°", loc="left"
            )
        panel.set_xlabel("azimuth [°], 0 = along x, 90 = along y")
        panel.set_ylabel("elevation [°], 90 = up")
        panel.xaxis.set_major_locator(MultipleLocator(45.0))
        ticks = [-90, -60, -45, -30, -15, 0, 15, 30, 45, 60, 90]
        panel.set_yticks(np.sin(np.radians(ticks)), [f"{tick}".replace("-", "\N{MINUS SIGN}") for tick in ticks])
    return figure


def _grid(azimuth: Array, elevation: Array, values: Array) -> tuple[Array, Array, Array] | None:
    """Return azimuths, elevations and values (n_elevation, n_azimuth) of a grid around the sphere; None if there is none.

    A pole's one value stands under every azimuth, and what is at -180 is at 180, too.
    """
    along, up = np.unique(azimuth), np.unique(elevation)
    if min(along.size, up.size) < 2:
        return None
    grid = np.full((up.size, along.size), np.nan)
    there = np.zeros(grid.shape, dtype=bool)
    cells = np.searchsorted(up, elevation), np.searchsorted(along, azimuth)
    grid[cells], there[cells] = values, True
    for row in np.flatnonzero(np.abs(up) == 90.0):
        if there[row].any():
            grid[row, ~there[row]], there[row] = grid[row, there[row]][0], True
    if not there.all():
        return None
    if along[0] == -180.0 and along[-1] < 180.0:
        along, grid = np.append(along, 180.0), np.column_stack([grid, grid[:, 0]])
    return along, up, grid


def _field(panel: Any, along: Array, up: Array, grid: Array, shown: Measure) -> Any:
    """Draw a grid as cells around its directions, and the line where the limit is met."""
    beside = (along[:-1] + along[1:]) / 2.0
    between = np.sin(np.radians((up[:-1] + up[1:]) / 2.0))
    ends = np.sin(np.radians(up[[0, -1]]))
    columns = np.concatenate(([along[0]], beside, [along[-1]]))
    rows = np.concatenate(([ends[0]], between, [ends[1]]))
    drawn = panel.pcolormesh(columns, rows, grid, cmap="viridis", rasterized=True)
    if shown.limit is not None and np.isfinite(grid).all():
        limit = shown.factor * shown.limit
        if grid.min() < limit < grid.max():
            height = np.sin(np.radians(up))
            lines = panel.contour(along, height, grid, levels=[limit], colors=[RATED], linewidths=1.4)
            panel.clabel(lines, fmt=f"{limit:g} {shown.unit}".replace("%", "%%"), fontsize=7)
    return drawn
