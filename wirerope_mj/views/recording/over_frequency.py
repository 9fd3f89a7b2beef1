"""What stands over frequency: accelerations of a sweep, with its frequency at the time cursor, or spectra of other runs."""

from typing import Any

import numpy as np

from wirerope_mj.content.judged_run import RunResult
from wirerope_mj.content.panels import BASE, Curve, Panel
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.ticks import linear_ticks, log_ticks
from wirerope_mj.views.colours import DARK, Color
from wirerope_mj.views.recording.frame import GROUND, HEIGHT, Plot, log_frame
from wirerope_mj.views.recording.letters import known_letters
from wirerope_mj.views.recording.now import cursor_rows
from wirerope_mj.views.recording.paths import at, child, entity

ROOT = "frequencies"

WIDTH = 320.0
"""Width of the frame, so that it fills its pane."""

_CURSOR: Color = (255, 255, 255)
_LIFT = 4.5
_LEGEND, _LINE = (
    (WIDTH + 46.0, 8.0),
    9.0,
)  # where the first text stands and how far the next is below it, in units of the view
_ASIDE = 92.0  # width of the legend


def log_over_frequency(rec: Any, run: RunResult, panel: Panel) -> None:
    """Log frame and curves of a panel over frequency; of a sweep the frequency at the time cursor besides."""
    plot, upright = _plot(panel), panel.log == "xy"
    across = log_ticks(*(10.0**end for end in plot.across))
    upward = log_ticks(*(10.0**end for end in plot.upward)) if upright else linear_ticks(*plot.upward)
    names = [f"{value:.5g}" for value in across], [f"{value:.4g}" for value in upward]
    path = entity(ROOT)
    log_frame(
        rec,
        path,
        plot,
        across=np.log10(across),
        upward=np.log10(upward) if upright else upward,
        names=names,
        lift=_LIFT,
    )
    data = child(path, "data")
    rec.log(data, plot.transform(), static=True)
    _log_curves(rec, data, panel, plot, upright=upright)
    _log_now(rec, data, run, plot)


def _log_curves(rec: Any, data: str, panel: Panel, plot: Plot, *, upright: bool) -> None:
    """Log the curves, the first in front, and the largest value of each."""
    import rerun as rr

    labels: list[tuple[str, Color]] = []
    for number, curve in enumerate(reversed(panel.curves)):
        inside = (curve.x > 0.0) & (np.log10(np.maximum(curve.x, 1e-300)) <= plot.across[1] + 1e-9)
        across, upward = np.log10(curve.x[inside]), _height(curve.y[inside], plot, upright=upright)
        color, order = _colour(curve), float(number)
        line = rr.LineStrips2D(
            [np.column_stack([across, upward])], colors=color, radii=rr.Radius.ui_points(1.0), draw_order=order
        )
        rec.log(child(data, curve.name), line, static=True)
        top = int(np.argmax(upward))
        text = f"{curve.name} {curve.y[inside][top]:.3g} {panel.unit} @ {curve.x[inside][top]:.4g} Hz"
        dot = {"colors": color, "radii": rr.Radius.ui_points(3.0), "draw_order": 20.0 + order}
        rec.log(child(data, curve.name, "peak"), rr.Points2D([[across[top], upward[top]]], **dot), static=True)
        labels.append((text, color))
    # Peaks often coincide: their texts stand in a column of their own.
    places = [[_LEGEND[0], _LEGEND[1] + _LINE * row] for row in range(len(labels))]
    texts, colors = zip(*reversed(labels), strict=True)
    legend = rr.Points2D(places, labels=texts, colors=colors, radii=rr.Radius.ui_points(0.0), show_labels=True)
    rec.log(entity(ROOT, "legend"), legend, static=True)


def _log_now(rec: Any, data: str, run: RunResult, plot: Plot) -> None:
    """Log the frequency of a sweep at the time cursor as an upright line."""
    import rerun as rr

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


def over_frequency_view(panel: Panel) -> Any:
    """Return the view of a panel over frequency."""
    import rerun.blueprint as rrb

    bounds = rrb.VisualBounds2D(x_range=[-16.0, WIDTH + _ASIDE], y_range=[-6.0, HEIGHT + 15.0])
    name = f"{panel.ylabel or panel.title}, over frequency [Hz]"
    return rrb.Spatial2DView(origin=entity(ROOT), name=known_letters(name), background=GROUND, visual_bounds=bounds)


def _plot(panel: Panel) -> Plot:
    """Return the ranges of a panel, logarithms where its axes are."""
    x = np.concatenate([curve.x for curve in panel.curves])
    y = np.concatenate([curve.y for curve in panel.curves])
    left, right = panel.xlim or (float(x.min()), float(x.max()))
    if panel.log == "xy":
        low, high = np.log10(panel.ylim or (float(y.min()), float(y.max())))
    else:
        low, high = panel.ylim or (0.0, 1.08 * float(y.max()))
    return Plot(across=(float(np.log10(left)), float(np.log10(right))), upward=(float(low), float(high)), width=WIDTH)


def _height(values: Array, plot: Plot, *, upright: bool) -> Array:
    """Return where values stand in a plot; what is below it at its lower end."""
    if not upright:
        return values
    return np.maximum(np.log10(np.maximum(values, 1e-300)), plot.upward[0])


def _colour(curve: Curve) -> Color:
    if isinstance(curve.kind, int):
        return DARK.series[curve.kind % len(DARK.series)]
    return DARK.base if curve.kind == BASE else DARK.others
