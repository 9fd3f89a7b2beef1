"""Panels of content as plots of the viewer, over time with marked peaks, limits and lanes below them, and over frequency."""

from collections.abc import Sequence

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from wirerope_mj.content.blocks import BASE, OTHERS, Curve, Panel
from wirerope_mj.content.events import NEAR
from wirerope_mj.content.histories import peak_text
from wirerope_mj.content.judged_run import RunResult
from wirerope_mj.content.selection import Selection, ranked_over_time
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array, Booleans
from wirerope_mj.foundation.ticks import linear_ticks, log_ticks
from wirerope_mj.views.colours import CURSOR, DARK, MOVING_LANE, NEAR_LANE, QUIET_LANE, RUNS, WITHIN_LANE, Color
from wirerope_mj.views.recording.now import cursor_rows
from wirerope_mj.views.recording.paths import Stream, at, child, entity, known_letters
from wirerope_mj.views.recording.scene import CLOSED, changes, closed_at
from wirerope_mj.views.recording.views import GROUND, HEIGHT, Plot, log_frame, time_axis, with_ticks
from wirerope_mj.views.thin import is_dense, rows_of_extremes, rows_of_line

_FINE = 1 / 400  # tolerance of a line, as a fraction of a panel's range: below a pixel
# Rows of a curve that is drawn as a band, as many as pixels; fewer rows of the grey others
_BAND_ROWS, _OTHER_ROWS = 1400, 300
_COLUMNS = 90
_BORDER = 52.0  # Height of the title and of the numbers of time of a plot [points]
_MOST_NAMES = 6  # entries of a legend
_NAME, _NAMES = 23.0, 250.0  # height of an entry of a legend, and width of a legend [points]
_EARLY = 1.5  # weight of what a legend on the left hides
_HALF_NUMBER = 9.0  # half the height of a number along an axis [points]
_CORNERS = {"RightTop": (True, True), "RightBottom": (True, False), "LeftTop": (False, True), "LeftBottom": (False, False)}


def log_panel(rec: Stream, path: str, panel: Panel, ends: tuple[float, float], *, every: bool) -> None:
    """Log the curves of a panel, the first in front, and its limits between the instants `ends` [s].

    The viewer draws entities in the order of their paths: the others, then named curves from the last to the first, each
    thinner than the one before, so that coinciding curves stay visible. The peak of the first is marked, or of `every` curve.
    """
    reach = max((float(np.ptp(curve.y)) for curve in panel.curves if curve.y.size), default=0.0)
    tolerance = _FINE * max(reach, 1e-9)
    others = [curve for curve in panel.curves if curve.kind == OTHERS]
    named = [curve for curve in panel.curves if curve.kind != OTHERS]
    if others:
        time, values, many = others[0].x, np.stack([curve.y for curve in others], axis=1), len(others)
        if is_dense(time, values, 3.0 * tolerance):
            rows = rows_of_extremes(values, _OTHER_ROWS * many)
        else:
            rows = rows_of_line(time, values, 3.0 * tolerance)
        names = [curve.name for curve in others]
        alike = {"colors": [DARK.faint] * many, "widths": [1.0] * many, "aggregation_policy": ["MinMax"] * many}
        rec.log(child(path, "0"), rr.SeriesLines(names=names, **alike), static=True)
        scalars = np.ascontiguousarray(values[rows])
        rec.send_columns(child(path, "0"), at(time[rows]), rr.Scalars.columns(scalars=scalars))
    step = min(0.6, 2.4 / max(len(named) - 1, 1))
    for rank, curve in enumerate(reversed(named), start=1):
        width = 1.0 if curve.kind == BASE else 1.5 + step * (len(named) - rank)
        below = child(path, str(rank), curve.name)
        x, y, dense = curve.x, curve.y[:, None], is_dense(curve.x, curve.y[:, None], tolerance)
        name = f"{peak_text(curve, panel)}{' (band)' if dense else ''}"
        rows = rows_of_extremes(y, _BAND_ROWS) if dense else rows_of_line(x, y, tolerance)
        # Otherwise the viewer averages the values within a pixel: a sweep would vanish.
        widths = 1.0 if dense else width
        line = rr.SeriesLines(names=name, colors=color_of(curve), widths=widths, aggregation_policy="MinMax")
        rec.log(below, line, static=True)
        rec.send_columns(below, at(x[rows]), rr.Scalars.columns(scalars=curve.y[rows]))
        if curve.peak is not None and (every or curve is named[0]):
            instant, value = curve.peak
            look = rr.SeriesPoints(names=name, markers="Diamond", marker_sizes=6.0, colors=color_of(curve))
            rec.log(child(below, "peak"), look, static=True)
            rec.send_columns(child(below, "peak"), at(instant), rr.Scalars.columns(scalars=[value]))
    texts = {}
    for name, level in panel.limits:
        sign, size = ("±", abs(level)) if (name, -level) in panel.limits else ("", level)
        texts[name, level] = f"{name} {sign}{size:.4g} {panel.unit}"
    if len(set(texts.values())) + len(named) + bool(others) > _MOST_NAMES:
        texts = dict.fromkeys(texts, "limits")
    for (name, level), text in texts.items():
        below = child(path, "limit", f"{level:+.4g}")
        rec.log(below, rr.SeriesLines(names=text, colors=DARK.of(panel.kind_of_limit(name)), widths=1.0), static=True)
        rec.send_columns(below, at(ends), rr.Scalars.columns(scalars=np.full(2, level)))


def panel_view(
    path: str, panel: Panel, window: tuple[float, float], size: tuple[float, float], *, listed: bool = False
) -> rrb.TimeSeriesView:
    """View a panel over `window` [s] in a pane of a size [points], with its legend in the corner where it hides least.

    With `listed` title and range suit any load case: a file of several that is opened by its name shows all in one layout.
    """
    levels = np.concatenate([*(curve.y for curve in panel.curves), [level for _, level in panel.limits]])
    levels = np.append(levels[np.isfinite(levels)], 0.0)  # accelerations, deflections and forces are read from zero
    low, high = panel.ylim or (float(levels.min()), float(levels.max()))
    low, high = (low, high) if high > low else (-1.0, 1.0)
    room = 0.0 if panel.ylim else 0.04 * max(high - low, 1e-9)
    start = low if low >= 0.0 else low - room
    low, high = with_ticks(start, high + room, size[1] - _BORDER, from_low=low >= 0.0)
    edge = _HALF_NUMBER / (size[1] - _BORDER) * (high - low)  # for numbers at the ends
    low, high = low - edge, high + edge
    corner = getattr(rrb.Corner2D, emptiest_corner(panel, window, (low, high), size))
    return rrb.TimeSeriesView(
        origin=path, name=known_letters((panel.title or panel.ylabel).partition(":" if listed else "\n")[0]),
        axis_x=time_axis(window, size[0]), axis_y=None if listed else rrb.ScalarAxis(range=(low, high)),
        background=rrb.archetypes.PlotBackground(color=GROUND), plot_legend=rrb.PlotLegend(visible=True, corner=corner),
    )  # fmt: skip


def color_of(curve: Curve) -> Color:
    if isinstance(curve.kind, int):
        return RUNS[curve.kind % len(RUNS)]
    return DARK.of(curve.kind)


def emptiest_corner(panel: Panel, window: tuple[float, float], span: tuple[float, float], size: tuple[float, float]) -> str:
    """Find the corner in which a legend hides least of the curves of a panel that shows `span`, in a pane of a size [points].

    On the left, where the worst instant mostly is, curves count more.
    """
    across, (low, high) = np.linspace(*window, _COLUMNS), span
    names = {curve.name for curve in panel.curves} | {name for name, _ in panel.limits}
    high_part = min(_NAME * (len(names) + 0.5) / (size[1] - _BORDER), 1.0)
    columns = max(round(_COLUMNS * min(_NAMES / size[0], 1.0)), 1)
    hidden = {}
    for corner, (right, top) in _CORNERS.items():
        instants = across[-columns:] if right else across[:columns]
        hidden[corner] = 0.0
        for curve in panel.curves:
            values = np.interp(instants, curve.x, curve.y)
            heights = (values - low) / (high - low)
            covered = heights > 1.0 - high_part if top else heights < high_part
            hidden[corner] += (1.0 if right else _EARLY) * float(np.abs(values - np.median(curve.y))[covered].sum())
    return min(hidden, key=lambda corner: hidden[corner])


_MOST_LANES = 1  # lanes of the largest utilisations: the panel above shows all
_LEGIBLE = 0.04  # fraction of the interval shown, below which the name of a state does not fit
_USED = (("within", WITHIN_LANE), ("80", NEAR_LANE), ("100", tuple(round(0.75 * part) for part in DARK.exceeded)))
_STOPS = (("open", QUIET_LANE), ("stop", CLOSED))
_PHASES = (("at rest", QUIET_LANE), ("moves", NEAR_LANE), ("free", MOVING_LANE))
# Entities at the root of a recording; a mount of such a name has its lane below "lanes"
_RESERVED = (
    "world", "histories", "loops", "events", "peaks", "scenario", "verdict", "verdicts", "cursor", "state", "plan", "ghosts",
    "frequencies",
)  # fmt: skip


def lane_paths(response: Response, selection: Selection) -> list[str]:
    """List the entities of the lanes that `log_lanes` logs."""
    stops = [_lane_path("stops")] if _pressing(response) is not None else []
    return [_lane_path("base"), *stops, *(_lane_path(name) for name in _lane_subjects(selection))]


def log_lanes(rec: Stream, response: Response, selection: Selection) -> None:
    """Log the lanes (states over time) of a run: phase of the base's motion, stops pressed, use of the worst limit."""
    end = selection.window[1]
    start = float(response.time[0])
    phases = [(start, 1 if response.base.acceleration.any() else 0)]
    if response.events:
        first, last = response.events[0][0], response.events[-1][0]
        phases = [(start, 0)] * (first > start) + [(max(first, start), 1)]
        if not response.base.acceleration[response.time > last + 1e-9].any():
            phases.append((last, 2))
        phases = [phase for phase in phases if response.reaches(phase[0])]
    _log_lane(rec, "base", phases, _PHASES, end)
    closed = _pressing(response)
    if closed is not None:
        _log_lane(rec, "stops", [(float(response.time[row]), int(closed[row])) for row in changes(closed)], _STOPS, end)
    names = _lane_subjects(selection)
    for used in selection.used:
        if used.subject in names:
            state = (used.course >= NEAR).astype(int) + (used.course > 1.0)
            _log_lane(rec, used.subject, [(float(response.time[row]), int(state[row])) for row in changes(state)], _USED, end)


def _lane_subjects(selection: Selection) -> list[str]:
    return [used.subject for used in ranked_over_time(selection.used)[:_MOST_LANES]]


def _pressing(response: Response) -> Booleans | None:
    """Find whether any stop or declared pair presses at each sample, (n_t,); None without stops and pairs."""
    pairs = [pair.force > 0.0 for pair in response.contacts.values()]
    stops = [closed_at(response, response.scene.stops)] if response.scene.stops else []
    return np.any([*pairs, *stops], axis=0) if pairs or stops else None


def _lane_path(name: str) -> str:
    return entity("lanes", name) if name in _RESERVED else entity(name)


def _log_lane(
    rec: Stream, name: str, changes: list[tuple[float, int]], states: Sequence[tuple[str, Sequence[int]]], end: float
) -> None:
    """Log a lane of `changes`, instant [s] and number of a state, up to `end` [s]; short states show only their colour."""
    labels, colors = zip(*states, strict=True)
    blanks = [" " * (number + 1) for number in range(len(labels))]
    rec.log(_lane_path(name), rr.StateConfiguration(values=[*labels, *blanks], colors=[*colors, *colors]), static=True)
    times, numbers = zip(*changes, strict=True)
    lasting = np.diff(np.append(times, max(end, times[-1])))
    shown = [labels[n] if long else blanks[n] for n, long in zip(numbers, lasting >= _LEGIBLE * end, strict=True)]
    rec.send_columns(_lane_path(name), at(times), rr.StateChange.columns(state=shown))


ROOT = "frequencies"
WIDTH = 430.0  # Width of the frame, so that it fills its pane
_MOST_TICKS = 9  # numbers of a logarithmic axis upwards; of more only powers of ten
_LIFT = 4.5  # as `frame.LARGE`, for a wide view
_DASH = 5  # intervals of a curve in a dash, and in the gap behind it
_MOST_ROWS = 800  # of a curve: its view is hardly wider in pixels
# Where the first text stands, how far the next is below it, in the view's units.
_LEGEND, _LINE = (WIDTH + 76.0, 8.0), 11.5
_LEGEND_WIDTH = 150.0  # width of the legend


def log_over_frequency(rec: Stream, run: RunResult, panel: Panel, *, listed: bool = False) -> None:
    """Log frame and curves of a panel over frequency, `listed` with its title; for a sweep also the frequency at the cursor."""
    path = entity(ROOT)
    plot = log_frequency_panel(rec, path, panel, width=WIDTH, lift=_LIFT)
    data, hidden = child(path, "data"), rr.Radius.ui_points(0.0)
    for number, curve in enumerate(panel.curves):
        if curve.peak is not None:
            spot = np.log10(curve.peak[0]), _plot_heights(np.array(curve.peak[1]), plot, upright=panel.log == "xy")
            dot = {"colors": _colour(curve), "radii": rr.Radius.ui_points(3.0), "draw_order": 30.0 - number}
            rec.log(child(data, curve.name, "peak"), rr.Points2D([spot], **dot), static=True)
    # the peaks' texts in a column, as peaks often coincide
    labels, colors = [peak_text(curve, panel) for curve in panel.curves], [_colour(curve) for curve in panel.curves]
    labels, colors = (
        [(panel.ylabel or panel.title).replace("peak acceleration ", "")] * listed + labels,
        [DARK.text] * listed + colors,
    )
    places = [[_LEGEND[0], _LEGEND[1] + _LINE * row] for row in range(len(labels))]
    legend = rr.Points2D(places, labels=labels, colors=colors, radii=hidden, show_labels=True)
    rec.log(entity(ROOT, "legend"), legend, static=True)
    if run.sweep is not None:
        # the frequency of a sweep at the time cursor, as an upright line
        time = run.response.time[cursor_rows(run.response.time, run.selection)]
        frequency = run.sweep.frequency(time)
        across, (low, high) = np.clip(np.log10(frequency), *plot.across), plot.upward
        look = {"colors": CURSOR, "radii": rr.Radius.ui_points(4.0), "draw_order": 50.0, "show_labels": True}
        rec.log(child(data, "now"), rr.Points2D.from_fields(**look), static=True)
        spots, texts = np.column_stack([across, np.full(time.size, high)]), [f"{value:.4g} Hz" for value in frequency]
        rec.send_columns(child(data, "now"), at(time), rr.Points2D.columns(positions=spots, labels=texts))
        look = {"colors": CURSOR, "radii": rr.Radius.ui_points(0.7), "draw_order": 40.0}
        rec.log(child(data, "cursor"), rr.LineStrips2D.from_fields(**look), static=True)
        strips = [[[x, low], [x, high]] for x in across]
        rec.send_columns(child(data, "cursor"), at(time), rr.LineStrips2D.columns(strips=strips))


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
    if upright and len(upward) > _MOST_TICKS and (decades := upward[np.log10(upward) % 1.0 == 0.0]).size > 2:
        upward = decades
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
            line = np.column_stack([np.log10(curve.x[inside]), _plot_heights(curve.y[inside], plot, upright=upright)])
            rows = np.unique(np.linspace(0, len(line) - 1, min(len(line), _MOST_ROWS)).round().astype(int))
            lines.append(line[rows])
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


def over_frequency_view(panel: Panel, *, listed: bool = False) -> rrb.Spatial2DView:
    """Show a panel over frequency as a drawing, since the viewer's own plots run over time; it has a short name if `listed`."""
    bounds = rrb.VisualBounds2D(x_range=[-16.0, WIDTH + _LEGEND_WIDTH], y_range=[-6.0, HEIGHT + 15.0])
    name = "Over frequency [Hz]" if listed else f"{panel.ylabel or panel.title}, over frequency [Hz]"
    return rrb.Spatial2DView(origin=entity(ROOT), name=known_letters(name), background=GROUND, visual_bounds=bounds)


def _plot_heights(values: Array, plot: Plot, *, upright: bool) -> Array:
    """Map values to heights in a plot: logarithms, not below its range, if its axes are logarithmic."""
    if not upright:
        return values
    return np.maximum(np.log10(np.maximum(values, 1e-300)), plot.upward[0])


def _colour(curve: Curve) -> Color:
    return DARK.others if curve.kind == OTHERS else DARK.of(curve.kind)
