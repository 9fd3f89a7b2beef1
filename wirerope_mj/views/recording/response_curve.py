"""The frequency response in the recording: curves of all levels on logarithmic axesand the motions on them."""

from typing import Any

import numpy as np

from wirerope_mj.dynamics.frequency_response.curve import BranchCurve
from wirerope_mj.dynamics.frequency_response.summary import LevelSummary
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.ticks import log_ticks
from wirerope_mj.views.recording.along import at_points
from wirerope_mj.views.recording.animation import Animation, Strip
from wirerope_mj.views.recording.frame import LARGE, Color, Plot, log_frame
from wirerope_mj.views.recording.paths import child, entity

PATH = "response"

WIDTH = 225.0
"""Width of the frame, so that it fills its pane."""

_COLORS: tuple[Color, ...] = (
    (78, 155, 230), (255, 159, 64), (76, 194, 107), (190, 120, 230), (242, 84, 91), (150, 160, 170), (60, 200, 216),
    (205, 165, 90),
)  # fmt: skip
_EVENT = (255, 255, 255)
_DASH = 5
"""Points of the curve in a dash of an unstable motion, and in the gap behind it."""

_ENVELOPE_ROWS = 800
"""Rows of a sweep's envelope that are drawn: its view is hardly wider in pixels."""


def level_color(number: int) -> Color:
    """Return the colour of a level."""
    return _COLORS[number % len(_COLORS)]


def log_response(rec: Any, findings: list[LevelSummary], animation: Animation, strips: list[Strip]) -> None:
    """Log frame, curves, their bifurcations, and the motion of every level."""
    import rerun as rr

    plot = _plot(findings)
    _log_axes(rec, plot)
    data = child(entity(PATH), "data")
    rec.log(data, plot.transform(), static=True)
    for number, summary in enumerate(findings):
        _log_level(rec, child(data, f"level_{number + 1}"), summary, level_color(number))
    _log_events(rec, child(data, "events"), findings)
    for strip in strips:
        path = child(data, "here", f"level_{strip.number + 1}")
        look = rr.Points2D.from_fields(
            colors=level_color(strip.number), radii=rr.Radius.ui_points(7.0), draw_order=60.0, show_labels=False
        )
        rec.log(path, look, static=True)
        positions = np.column_stack([np.log10(strip.frequency), np.log10(strip.amplitude)])
        columns = rr.Points2D.columns(positions=positions, labels=[_label(strip, int(point)) for point in strip.points])
        rec.send_columns(path, at_points(animation, strip), columns)


def _label(strip: Strip, point: int) -> str:
    """Return the text about a motion when the mouse is over its marker."""
    branch = strip.branch
    state = "stable" if branch.stable[point] else "unstable"
    return f"{strip.level:.4g} m/s²: {branch.frequency[point]:.5g} Hz, {branch.amplitude[point]:.4g} m/s², {state}"


def _plot(findings: list[LevelSummary]) -> Plot:
    """Return ranges that hold all curves, in logarithms."""
    curves = [(summary.curve.frequency, summary.curve.amplitude) for summary in findings if summary.curve is not None]
    curves += [(s.frequency, s.amplitude) for summary in findings for s in summary.level.sweeps.values()]
    ranges = []
    for part in range(2):
        values = np.log10(np.concatenate([curve[part] for curve in curves]))
        room = 0.04 * max(float(np.ptp(values)), 0.02)
        ranges.append((float(values.min()) - room, float(values.max()) + room))
    return Plot(across=ranges[0], upward=ranges[1], width=WIDTH)


def _log_axes(rec: Any, plot: Plot) -> None:
    across = log_ticks(10.0 ** plot.across[0], 10.0 ** plot.across[1])
    upward = log_ticks(10.0 ** plot.upward[0], 10.0 ** plot.upward[1])
    names = [f"{value:.5g}" for value in across], [f"{value:.5g}" for value in upward]
    log_frame(rec, entity(PATH), plot, across=np.log10(across), upward=np.log10(upward), names=names, lift=LARGE)


def _log_level(rec: Any, path: str, summary: LevelSummary, color: Color) -> None:
    import rerun as rr

    name = f"{summary.level.acceleration:.4g} m/s^2"
    for direction, sweep in summary.level.sweeps.items():
        rows = np.unique(np.linspace(0, sweep.frequency.size - 1, _ENVELOPE_ROWS).round().astype(int))
        line = np.log10(np.column_stack([sweep.frequency, sweep.amplitude])[rows])
        look = {"colors": [*color, 110], "radii": rr.Radius.ui_points(0.7), "labels": [f"{name}, sweep {direction}"]}
        rec.log(child(path, f"sweep_{direction}"), rr.LineStrips2D([line], show_labels=False, **look), static=True)
    if summary.curve is None:
        return
    for state, strips in zip(("stable", "unstable"), _strips(summary.curve), strict=True):
        if strips:
            look = {"colors": color, "radii": rr.Radius.ui_points(1.5 if state == "stable" else 1.1)}
            lines = rr.LineStrips2D(strips, labels=[f"{name}, {state}"] * len(strips), show_labels=False, **look)
            rec.log(child(path, state), lines, static=True)


def _strips(curve: BranchCurve) -> tuple[list[Array], list[Array]]:
    """Return the lines of stable motions, and the dashes of those that are not."""
    line = np.log10(np.column_stack([curve.frequency, curve.amplitude]))
    changes = [0, *(np.flatnonzero(np.diff(curve.stable)) + 1).tolist(), curve.stable.size]
    stable, dashes = [], []
    for first, stop in zip(changes[:-1], changes[1:], strict=True):
        part = line[first : stop + 1]
        if part.shape[0] < 2:
            continue
        if curve.stable[first]:
            stable.append(part)
        else:
            parts = [part[i : i + _DASH + 1] for i in range(0, part.shape[0], 2 * _DASH)]
            dashes += [dash for dash in parts if dash.shape[0] > 1]
    return stable, dashes


def _log_events(rec: Any, path: str, findings: list[LevelSummary]) -> None:
    """Mark folds and changes of stability, described when the mouse is over them."""
    import rerun as rr

    events = [event for summary in findings if summary.level.branch for event in summary.level.branch.bifurcations]
    if events:
        positions = np.log10([[event.frequency, event.amplitude] for event in events])
        marks = rr.Points2D(
            positions, labels=[event.description for event in events], show_labels=False, colors=_EVENT,
            radii=rr.Radius.ui_points(4.0), draw_order=40.0,
        )  # fmt: skip
        rec.log(path, marks, static=True)
