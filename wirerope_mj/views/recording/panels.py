"""Panels of content over time as plots of the viewer: thinned curves, marked peaks, limits as levels, and lanes below them."""

from collections.abc import Sequence

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from wirerope_mj.content.events import NEAR
from wirerope_mj.content.histories import peak_text
from wirerope_mj.content.panels import BASE, OTHERS, Curve, Panel
from wirerope_mj.content.selection import Selection
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Booleans
from wirerope_mj.views.colours import DARK
from wirerope_mj.views.recording.drawn_runs import COLORS
from wirerope_mj.views.recording.mounts import CLOSED, changes, closed_at
from wirerope_mj.views.recording.paths import Stream, at, child, entity, known_letters
from wirerope_mj.views.recording.views import GROUND, Color, time_axis
from wirerope_mj.views.thin import is_dense, rows_of_extremes, rows_of_line

_FINE = 1 / 400  # of a panel's range that a line may be off: below a pixel
# Rows of what oscillates too often for a line: as many as pixels, which fill a band; fewer of the grey others.
_BAND_ROWS, _OTHER_ROWS = 1400, 300
_OTHERS = (104, 110, 118)  # Darker than a text must be, so that what is named stands in front
_COLUMNS = 90
_CORNERS = {"RightTop": (True, True), "RightBottom": (True, False), "LeftTop": (False, True), "LeftBottom": (False, False)}


def log_panel(rec: Stream, path: str, panel: Panel, ends: tuple[float, float], *, every: bool) -> None:
    """Log the curves of a panel, the first in front, and its limits between the instants `ends` [s].

    The viewer draws entities in the order of their paths: the others, then named curves from the last to the first, each
    thinner than the one before, so that what coincides is not hidden. The peak of the first is marked, or of `every` one.
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
        alike = {"colors": [_OTHERS] * many, "widths": [1.0] * many, "aggregation_policy": ["MinMax"] * many}
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
        # Without this the viewer averages what falls into one pixel: a sweep would vanish.
        widths = 1.0 if dense else width
        line = rr.SeriesLines(names=name, colors=color_of(curve), widths=widths, aggregation_policy="MinMax")
        rec.log(below, line, static=True)
        rec.send_columns(below, at(x[rows]), rr.Scalars.columns(scalars=curve.y[rows]))
        if curve.peak is not None and (every or curve is named[0]):
            instant, value = curve.peak
            look = rr.SeriesPoints(names=name, markers="Diamond", marker_sizes=6.0, colors=color_of(curve))
            rec.log(child(below, "peak"), look, static=True)
            rec.send_columns(child(below, "peak"), at(instant), rr.Scalars.columns(scalars=[value]))
    for name, level in panel.limits:
        below, text = child(path, "limit", f"{level:+.4g}"), f"{name} {level:.4g} {panel.unit}"
        rec.log(below, rr.SeriesLines(names=text, colors=DARK.limit, widths=1.0), static=True)
        rec.send_columns(below, at(ends), rr.Scalars.columns(scalars=np.full(2, level)))


def panel_view(path: str, panel: Panel, window: tuple[float, float]) -> rrb.TimeSeriesView:
    """View a panel over `window` [s], with its legend where it hides least."""
    corner = getattr(rrb.Corner2D, _emptiest_corner(panel, window))
    return rrb.TimeSeriesView(
        origin=path, name=known_letters(panel.title or panel.ylabel), axis_x=time_axis(window),
        background=rrb.archetypes.PlotBackground(color=GROUND), plot_legend=rrb.PlotLegend(visible=True, corner=corner),
    )  # fmt: skip


def color_of(curve: Curve) -> Color:
    if isinstance(curve.kind, int):
        return COLORS[curve.kind % len(COLORS)]
    return DARK.base if curve.kind == BASE else _OTHERS


def _emptiest_corner(panel: Panel, window: tuple[float, float]) -> str:
    levels = [level for _, level in panel.limits]
    low = min([float(curve.y.min()) for curve in panel.curves] + levels)
    high = max([float(curve.y.max()) for curve in panel.curves] + levels)
    across, upward = np.linspace(*window, _COLUMNS), max(high - low, 1e-12)
    hidden = {}
    for corner, (right, top) in _CORNERS.items():
        instants = across[-_COLUMNS // 3 :] if right else across[: _COLUMNS // 3]
        hidden[corner] = 0.0
        for curve in panel.curves:
            values = np.interp(instants, curve.x, curve.y)
            covered = (values - low) / upward > 0.3 if top else (values - low) / upward < 0.7
            hidden[corner] += float(np.abs(values - np.median(curve.y))[covered].sum())
    return min(hidden, key=lambda corner: hidden[corner])


_MOST = 2  # Lanes of what uses most of its limits: each is 40 points high
_LEGIBLE = 0.04  # Fraction of what is shown below which a state's name does not fit its lane
_QUIET, _MOVING, _NEAR = (58, 66, 76), (48, 84, 110), (150, 100, 10)
_USED = (("within", (34, 84, 50)), ("80", _NEAR), ("100", tuple(round(0.75 * part) for part in DARK.limit)))
_STOPS = (("open", _QUIET), ("stop", CLOSED))
_PHASES = (("at rest", _QUIET), ("moves", _NEAR), ("free", _MOVING))
# Entities at the root of a recording: a mount of such a name has its lane elsewhere.
_TAKEN = (
    "world", "histories", "loops", "events", "peaks", "scenario", "verdict", "verdicts", "cursor", "state", "plan", "ghosts",
    "frequencies",
)  # fmt: skip


def lane_paths(response: Response, selection: Selection) -> list[str]:
    stops = [_path("stops")] if _pressing(response) is not None else []
    return [_path("base"), *stops, *(_path(name) for name in _subjects(selection))]


def log_lanes(rec: Stream, response: Response, selection: Selection, shared: Selection) -> None:
    """Log the lanes of a run that is alone; `shared` says which, and until when they are seen."""
    end = shared.window[1]
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
    names = _subjects(shared)
    for used in selection.used:
        if used.subject in names:
            state = (used.course >= NEAR).astype(int) + (used.course > 1.0)
            _log_lane(rec, used.subject, [(float(response.time[row]), int(state[row])) for row in changes(state)], _USED, end)


def _subjects(selection: Selection) -> list[str]:
    near = [used.subject for used in selection.used if used.largest >= NEAR]
    return (near or [used.subject for used in selection.used[:1]])[:_MOST]


def _pressing(response: Response) -> Booleans | None:
    """Find whether any stop or declared pair presses at each sample, (n_t,); None without any."""
    pairs = [pair.force > 0.0 for pair in response.contacts.values()]
    stops = [closed_at(response, response.scene.stops)] if response.scene.stops else []
    return np.any([*pairs, *stops], axis=0) if pairs or stops else None


def _path(name: str) -> str:
    return entity("lanes", name) if name in _TAKEN else entity(name)


def _log_lane(
    rec: Stream, name: str, changes: list[tuple[float, int]], states: Sequence[tuple[str, Sequence[int]]], end: float
) -> None:
    """Log a lane, seen until `end` [s]; what is too short for its name shows its colour alone."""
    labels, colors = zip(*states, strict=True)
    blanks = [" " * (number + 1) for number in range(len(labels))]
    rec.log(_path(name), rr.StateConfiguration(values=[*labels, *blanks], colors=[*colors, *colors]), static=True)
    times, numbers = zip(*changes, strict=True)
    lasting = np.diff(np.append(times, max(end, times[-1])))
    shown = [labels[n] if long else blanks[n] for n, long in zip(numbers, lasting >= _LEGIBLE * end, strict=True)]
    rec.send_columns(_path(name), at(times), rr.StateChange.columns(state=shown))
