"""What stands over frequency: accelerations of a sweep, with its frequency at the time cursor, or spectra of other runs."""

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from wirerope_mj.content.histories import peak_text
from wirerope_mj.content.judged_run import RunResult
from wirerope_mj.content.panels import BASE, Curve, Panel
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.ticks import linear_ticks, log_ticks
from wirerope_mj.views.colours import DARK, Color
from wirerope_mj.views.recording.frame import GROUND, HEIGHT, Plot, log_frame
from wirerope_mj.views.recording.now import cursor_rows
from wirerope_mj.views.recording.paths import Stream, at, child, entity, known_letters

ROOT = "frequencies"
WIDTH = 320.0  # Width of the frame, so that it fills its pane
_CURSOR: Color = (255, 255, 255)
_LIFT = 4.5  # as `frame.LARGE`, for a wide view
_DASH = 5  # intervals of a curve in a dash, and in the gap behind it
_MOST_ROWS = 800  # of a curve: its view is hardly wider in pixels
# Where the first text stands, how far the next is below it, in the view's units.
_LEGEND, _LINE = (WIDTH + 46.0, 8.0), 9.0
_ASIDE = 92.0  # width of the legend


def log_over_frequency(rec: Stream, run: RunResult, panel: Panel, *, titled: bool = False) -> None:
    """Log frame and curves of a panel over frequency; of a sweep the frequency at the time cursor besides.

    Where the name of its view is that of several cases its title stands in the plot.
    """
    path = entity(ROOT)
    plot = log_frequency_panel(rec, path, panel, width=WIDTH, lift=_LIFT)
    _log_peaks(rec, child(path, "data"), panel, plot)
    _log_now(rec, child(path, "data"), run, plot)
    if titled:
        place = rr.Points2D(
            [[0.5 * WIDTH, -_LINE]], labels=[panel.ylabel or panel.title], colors=DARK.base, radii=rr.Radius.ui_points(0.0),
            show_labels=True,
        )  # fmt: skip
        rec.log(child(path, "title"), place, static=True)


def log_frequency_panel(rec: Stream, path: str, panel: Panel, *, width: float, lift: float) -> Plot:
    """Log frame, ticks and curves of a panel over frequency, the first in front, and return its plot.

    Curves of one name are one entity. Positions are logarithms along logarithmic axes.
    """
    plot, upright = _plot(panel, width), panel.log == "xy"
    across = log_ticks(*(10.0**end for end in plot.across))
    upward = log_ticks(*(10.0**end for end in plot.upward)) if upright else linear_ticks(*plot.upward)
    names = [f"{value:.5g}" for value in across], [f"{value:.4g}" for value in upward]
    heights = np.log10(upward) if upright else upward
    log_frame(rec, path, plot, across=np.log10(across), upward=heights, names=names, lift=lift)
    data = child(path, "data")
    rec.log(data, plot.transform(), static=True)
    named: dict[str, list[Curve]] = {}
    for curve in panel.curves:
        named.setdefault(curve.name, []).append(curve)
    for number, (name, curves) in enumerate(reversed(named.items())):
        lines = [_positions(curve, plot, upright=upright) for curve in curves]
        color = [*_colour(curves[0]), 120 if curves[0].weight < 1.0 else 255]
        look = {"colors": color, "draw_order": float(number), "show_labels": False}
        if curves[0].marks:
            radii = rr.Radius.ui_points(2.2 * curves[0].weight)
            drawn = rr.Points2D(np.concatenate(lines), labels=[name] * sum(map(len, lines)), radii=radii, **look)
        else:
            strips = [part for line in lines for part in (_dashes(line) if curves[0].dash == "dashed" else [line])]
            radii = rr.Radius.ui_points(curves[0].weight)
            drawn = rr.LineStrips2D(strips, labels=[name] * len(strips), radii=radii, **look)
        rec.log(child(data, name), drawn, static=True)
    return plot


def _dashes(line: Array) -> list[Array]:
    """Return every other few intervals of a line."""
    parts = [line[first : first + _DASH + 1] for first in range(0, len(line), 2 * _DASH)]
    return [part for part in parts if len(part) > 1]


def _positions(curve: Curve, plot: Plot, *, upright: bool) -> Array:
    """Return where a curve runs, as far as its plot reaches."""
    inside = (curve.x > 0.0) & (np.log10(np.maximum(curve.x, 1e-300)) <= plot.across[1] + 1e-9)
    line = np.column_stack([np.log10(curve.x[inside]), _height(curve.y[inside], plot, upright=upright)])
    return line[np.unique(np.linspace(0, len(line) - 1, min(len(line), _MOST_ROWS)).round().astype(int))]


def _log_peaks(rec: Stream, data: str, panel: Panel, plot: Plot) -> None:
    """Log the largest value of each curve, and their texts in a column, as peaks often coincide."""
    for number, curve in enumerate(panel.curves):
        if curve.peak is not None:
            spot = np.log10(curve.peak[0]), _height(np.array(curve.peak[1]), plot, upright=panel.log == "xy")
            dot = {"colors": _colour(curve), "radii": rr.Radius.ui_points(3.0), "draw_order": 30.0 - number}
            rec.log(child(data, curve.name, "peak"), rr.Points2D([spot], **dot), static=True)
    labels = [peak_text(curve, panel) for curve in panel.curves]
    places = [[_LEGEND[0], _LEGEND[1] + _LINE * row] for row in range(len(labels))]
    colors = [_colour(curve) for curve in panel.curves]
    legend = rr.Points2D(places, labels=labels, colors=colors, radii=rr.Radius.ui_points(0.0), show_labels=True)
    rec.log(entity(ROOT, "legend"), legend, static=True)


def _log_now(rec: Stream, data: str, run: RunResult, plot: Plot) -> None:
    """Log the frequency of a sweep at the time cursor as an upright line."""
    if run.sweep is None:
        return
    time = run.response.time
    time = time[cursor_rows(time, run.selection)]
    frequency = run.sweep.frequency(time)
    here = np.clip(np.log10(frequency), *plot.across)
    low, high = plot.upward
    spots = np.column_stack([here, np.full(time.size, high)])
    dot = {"colors": _CURSOR, "radii": rr.Radius.ui_points(4.0), "draw_order": 50.0, "show_labels": True}
    rec.log(child(data, "now"), rr.Points2D.from_fields(**dot), static=True)
    labels = [f"{value:.4g} Hz" for value in frequency]
    times = at(time)
    rec.send_columns(child(data, "now"), times, rr.Points2D.columns(positions=spots, labels=labels))
    look = {"colors": _CURSOR, "radii": rr.Radius.ui_points(0.7), "draw_order": 40.0}
    rec.log(child(data, "cursor"), rr.LineStrips2D.from_fields(**look), static=True)
    strips = [[[x, low], [x, high]] for x in here]
    rec.send_columns(child(data, "cursor"), times, rr.LineStrips2D.columns(strips=strips))


def over_frequency_view(panel: Panel, *, narrow: bool = False) -> rrb.Spatial2DView:
    """Return the view of a panel over frequency; the letters of its legend take more of a narrow one."""
    aside = (1.4 if narrow else 1.0) * _ASIDE
    bounds = rrb.VisualBounds2D(x_range=[-16.0, WIDTH + aside], y_range=[-6.0, HEIGHT + 15.0])
    name = f"{panel.ylabel or panel.title}, over frequency [Hz]"
    return rrb.Spatial2DView(origin=entity(ROOT), name=known_letters(name), background=GROUND, visual_bounds=bounds)


def _plot(panel: Panel, width: float) -> Plot:
    """Return the ranges of a panel, logarithms where its axes are."""
    x = np.concatenate([curve.x for curve in panel.curves])
    y = np.concatenate([curve.y for curve in panel.curves])
    left, right = panel.xlim or (float(x.min()), float(x.max()))
    if panel.log == "xy":
        low, high = np.log10(panel.ylim or (float(y.min()), float(y.max())))
    else:
        low, high = panel.ylim or (0.0, 1.08 * float(y.max()))
    return Plot(across=(float(np.log10(left)), float(np.log10(right))), upward=(float(low), float(high)), width=width)


def _height(values: Array, plot: Plot, *, upright: bool) -> Array:
    """Return where values stand in a plot; what is below it at its lower end."""
    if not upright:
        return values
    return np.maximum(np.log10(np.maximum(values, 1e-300)), plot.upward[0])


def _colour(curve: Curve) -> Color:
    if isinstance(curve.kind, int):
        return DARK.series[curve.kind % len(DARK.series)]
    return DARK.base if curve.kind == BASE else DARK.others
