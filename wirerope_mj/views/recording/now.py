"""Values at the time cursor: a table of mounts and accelerations, and a plan of the mounts in colours of their utilisation."""

import numpy as np
import rerun as rr

from wirerope_mj.assessment.criteria.verdict import by_use
from wirerope_mj.content.events import at_cursor
from wirerope_mj.content.judged_run import RunResult
from wirerope_mj.content.selection import Selection
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.colours import DARK, Color
from wirerope_mj.views.markdown import markdown_blocks
from wirerope_mj.views.recording.paths import Rows, Stream, at, child, entity

CURSOR, PLAN = "cursor", "plan"
_ROWS, _PLAN_ROWS = 1000, 200  # instants of the table, and of the plan
_NAME = np.array([0.25, 0.09])  # room for a name, over the size of the plan
_STEP = 0.1  # step of the utilisation between two colours


def log_cursor(rec: Stream, run: RunResult) -> None:
    """Log the text with values of mounts and accelerations at the time cursor."""
    time = run.response.time
    rows = cursor_rows(time, run.selection, _ROWS)
    texts = [
        markdown_blocks(at_cursor(run, int(row), int(stop)))
        for row, stop in zip(rows, np.append(rows[1:], time.size), strict=True)
    ]
    rec.log(entity(CURSOR), rr.TextDocument.from_fields(media_type=rr.MediaType.MARKDOWN), static=True)
    rec.send_columns(entity(CURSOR), at(time[rows]), rr.TextDocument.columns(text=texts))


def cursor_rows(time: Array, selection: Selection, most: int = _PLAN_ROWS) -> Rows:
    """Choose `most` rows of samples evenly over the interval shown, and a quarter as many over the whole run."""
    within = np.linspace(*selection.window, most)
    outside = np.linspace(time[0], time[-1], most // 4)
    rows = np.searchsorted(time, np.concatenate([within, outside])).clip(0, time.size - 1)
    return np.unique(rows)


def heat(used: Array) -> Array:
    """Map utilisations (...) to colours (..., 3) from 0 to 255: the larger the bluer, red beyond 1; grey without one."""
    rounded = _STEP * np.round(np.nan_to_num(used) / _STEP)
    blue = np.stack([np.interp(rounded, (0.0, 1.0), ends) for ends in zip(DARK.frame, DARK.compared[0], strict=True)], axis=-1)
    colours = np.where((used > 1.0)[..., None], DARK.exceeded, blue)
    return np.where(np.isfinite(used)[..., None], colours, DARK.others).astype(np.uint8)


def mark_color(selection: Selection) -> Color:
    """Find the colour of the ring about the governing mount: red if it exceeds a limit."""
    worst = by_use(selection.verdicts).get(selection.governing or "")
    return DARK.exceeded if worst is not None and (worst.utilisation or 0.0) > 1.0 else DARK.limit


def used_by(selection: Selection, names: list[str]) -> Array:
    """Collect the utilisation of the limits of mounts at every sample, (n_t, n); NaN without limits."""
    courses = {used.subject: used.course for used in selection.used}
    first = next(iter(courses.values()), np.zeros(0))
    return np.column_stack([courses.get(name, np.full(first.size, np.nan)) for name in names])


def log_plan(rec: Stream, response: Response, selection: Selection) -> None:
    """Log a plan of the mounts on the base in colours of their utilisation, x to the right, y upwards."""
    mounts = response.scene.isolating
    if not mounts or not selection.used:
        return
    places = np.array([mount.base_point[:2] for mount in mounts]) * [1.0, -1.0]  # the view's y points down
    low, high = places.min(axis=0), places.max(axis=0)
    size = max(float(np.max(high - low)), 1e-3)
    rec.log(entity(PLAN), rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    corners = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]], [low[0], low[1]]]
    outline = rr.LineStrips2D([corners], colors=[DARK.others], radii=rr.Radius.ui_points(0.5), draw_order=-1.0)
    rec.log(entity(PLAN, "outline"), outline, static=True)
    rows = cursor_rows(response.time, selection)
    used = used_by(selection, [mount.name for mount in mounts])[rows]
    path = child(entity(PLAN), "mounts")
    rec.log(path, rr.Points2D.from_fields(positions=places, radii=0.022 * size, show_labels=False), static=True)
    spots: list[Array] = []  # of names, which hang below them: above their mount, or a line lower, if they would meet another
    for place in places:
        options = [place + [0.0, offset * size] for offset in (0.0, -0.14, 0.1)]
        free = (spot for spot in options if not any((np.abs(spot - other) < _NAME * size).all() for other in spots))
        spots.append(next(free, place))
    names = child(entity(PLAN), "names")
    look = {"positions": spots, "radii": rr.Radius.ui_points(0.0), "show_labels": True}
    rec.log(names, rr.Points2D.from_fields(**look), static=True)
    turn = np.linspace(0.0, 2.0 * np.pi, 33)[:, None]
    rings = [
        place + 0.05 * size * np.column_stack([np.cos(turn), np.sin(turn)])
        for mount, place in zip(mounts, places, strict=True)
        if mount.name == selection.governing
    ]
    ring = rr.LineStrips2D(rings, colors=[mark_color(selection)] * len(rings), radii=rr.Radius.ui_points(1.5))
    rec.log(entity(PLAN, "ring"), ring, static=True)
    labels = [
        mount.name if np.isnan(value) else f"{mount.name} {in_unit(float(value), '%'):.0f}"
        for row in used
        for mount, value in zip(mounts, row, strict=True)
    ]
    for below, columns in (
        (path, rr.Points2D.columns(colors=heat(used).reshape(-1, 3))),
        (names, rr.Points2D.columns(colors=heat(used).reshape(-1, 3), labels=labels)),
    ):
        rec.send_columns(below, at(response.time[rows]), columns.partition(np.full(rows.size, len(mounts))))


def plan_bounds(response: Response) -> tuple[list[float], list[float]]:
    """Find the ranges of the plan of the mounts, across and downwards [m], with a margin."""
    places = np.array([mount.base_point[:2] for mount in response.scene.isolating]) * [1.0, -1.0]
    low, high = places.min(axis=0), places.max(axis=0)
    room = 0.12 * max(float(np.max(high - low)), 1e-3)
    return [low[0] - room, high[0] + room], [low[1] - 1.5 * room, high[1] + 2.0 * room]  # for the names
