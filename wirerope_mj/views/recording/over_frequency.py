"""What stands over frequency: accelerations of a sweep, with its frequency at the time cursor, or spectra of other runs."""

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from wirerope_mj.content.histories import peak_text
from wirerope_mj.content.judged_run import RunResult
from wirerope_mj.content.panels import BASE, Curve, Panel
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.ticks import linear_ticks, log_ticks
from wirerope_mj.motions import Sweep
from wirerope_mj.views.colours import DARK, Color
from wirerope_mj.views.recording.now import cursor_rows
from wirerope_mj.views.recording.paths import Stream, at, child, entity, known_letters
from wirerope_mj.views.recording.views import GROUND, HEIGHT, Plot, log_frame

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
    data, hidden = child(path, "data"), rr.Radius.ui_points(0.0)
    for number, curve in enumerate(panel.curves):
        if curve.peak is not None:
            spot = np.log10(curve.peak[0]), _height(np.array(curve.peak[1]), plot, upright=panel.log == "xy")
            dot = {"colors": _colour(curve), "radii": rr.Radius.ui_points(3.0), "draw_order": 30.0 - number}
            rec.log(child(data, curve.name, "peak"), rr.Points2D([spot], **dot), static=True)
    # the peaks' texts in a column, as peaks often coincide
    labels, colors = [peak_text(curve, panel) for curve in panel.curves], [_colour(curve) for curve in panel.curves]
    places = [[_LEGEND[0], _LEGEND[1] + _LINE * row] for row in range(len(labels))]
    legend = rr.Points2D(places, labels=labels, colors=colors, radii=hidden, show_labels=True)
    rec.log(entity(ROOT, "legend"), legend, static=True)
    if run.sweep is not None:
        _log_now(rec, data, run, run.sweep, plot)
    if titled:
        place, labels = [[0.5 * WIDTH, -_LINE]], [panel.ylabel or panel.title]
        title = rr.Points2D(place, labels=labels, colors=DARK.base, radii=hidden, show_labels=True)
        rec.log(child(path, "title"), title, static=True)


def log_frequency_panel(rec: Stream, path: str, panel: Panel, *, width: float, lift: float) -> Plot:
    """Log frame, ticks and curves of a panel over frequency, the first in front, and return its plot.

    Curves of one name are one entity. Positions are logarithms along logarithmic axes.
    """
    upright = panel.log == "xy"
    x, y = (np.concatenate([getattr(curve, part) for curve in panel.curves]) for part in "xy")
    left, right = np.log10(panel.xlim or (float(x.min()), float(x.max())))
    low, high = panel.ylim or ((float(y.min()) if upright else 0.0), (1.0 if upright else 1.08) * float(y.max()))
    ends = (float(np.log10(low)), float(np.log10(high))) if upright else (float(low), float(high))
    plot = Plot(across=(float(left), float(right)), upward=ends, width=width)
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
        lines = []
        for curve in curves:  # as far as the plot reaches
            inside = (curve.x > 0.0) & (np.log10(np.maximum(curve.x, 1e-300)) <= plot.across[1] + 1e-9)
            line = np.column_stack([np.log10(curve.x[inside]), _height(curve.y[inside], plot, upright=upright)])
            some = np.unique(np.linspace(0, len(line) - 1, min(len(line), _MOST_ROWS)).round().astype(int))
            lines.append(line[some])
        color = [*_colour(curves[0]), 120 if curves[0].weight < 1.0 else 255]
        look = {"colors": color, "draw_order": float(number), "show_labels": False}
        if curves[0].marks:
            radii = rr.Radius.ui_points(2.2 * curves[0].weight)
            drawn = rr.Points2D(np.concatenate(lines), labels=[name] * sum(map(len, lines)), radii=radii, **look)
        else:
            strips = lines
            if curves[0].dash == "dashed":  # every other few intervals
                parts = [line[first : first + _DASH + 1] for line in lines for first in range(0, len(line), 2 * _DASH)]
                strips = [part for part in parts if len(part) > 1]
            radii = rr.Radius.ui_points(curves[0].weight)
            drawn = rr.LineStrips2D(strips, labels=[name] * len(strips), radii=radii, **look)
        rec.log(child(data, name), drawn, static=True)
    return plot


def _log_now(rec: Stream, data: str, run: RunResult, sweep: Sweep, plot: Plot) -> None:
    """Log the frequency of a sweep at the time cursor as an upright line."""
    time = run.response.time[cursor_rows(run.response.time, run.selection)]
    frequency = sweep.frequency(time)
    across, (low, high) = np.clip(np.log10(frequency), *plot.across), plot.upward
    dot = {"colors": _CURSOR, "radii": rr.Radius.ui_points(4.0), "draw_order": 50.0, "show_labels": True}
    rec.log(child(data, "now"), rr.Points2D.from_fields(**dot), static=True)
    spots, labels = np.column_stack([across, np.full(time.size, high)]), [f"{value:.4g} Hz" for value in frequency]
    rec.send_columns(child(data, "now"), at(time), rr.Points2D.columns(positions=spots, labels=labels))
    look = {"colors": _CURSOR, "radii": rr.Radius.ui_points(0.7), "draw_order": 40.0}
    rec.log(child(data, "cursor"), rr.LineStrips2D.from_fields(**look), static=True)
    strips = [[[x, low], [x, high]] for x in across]
    rec.send_columns(child(data, "cursor"), at(time), rr.LineStrips2D.columns(strips=strips))


def over_frequency_view(panel: Panel, *, narrow: bool = False) -> rrb.Spatial2DView:
    aside = (1.4 if narrow else 1.0) * _ASIDE
    bounds = rrb.VisualBounds2D(x_range=[-16.0, WIDTH + aside], y_range=[-6.0, HEIGHT + 15.0])
    name = f"{panel.ylabel or panel.title}, over frequency [Hz]"
    return rrb.Spatial2DView(origin=entity(ROOT), name=known_letters(name), background=GROUND, visual_bounds=bounds)


def _height(values: Array, plot: Plot, *, upright: bool) -> Array:
    if not upright:
        return values
    return np.maximum(np.log10(np.maximum(values, 1e-300)), plot.upward[0])


def _colour(curve: Curve) -> Color:
    if isinstance(curve.kind, int):
        return DARK.series[curve.kind % len(DARK.series)]
    return DARK.base if curve.kind == BASE else DARK.others
