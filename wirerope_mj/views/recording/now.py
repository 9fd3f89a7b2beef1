"""Values at the time cursor: a table of mounts and accelerations, and a plan of the mounts in colours of their utilisation."""

import numpy as np
import rerun as rr

from wirerope_mj.content.events import at_cursor
from wirerope_mj.content.judged_run import RunResult
from wirerope_mj.content.selection import Selection
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.colours import DARK
from wirerope_mj.views.markdown import markdown_blocks
from wirerope_mj.views.recording.paths import Rows, Stream, at, child, entity

CURSOR, PLAN = "cursor", "plan"
_ROWS, _PLAN_ROWS = 1000, 200  # instants of the table, and of the plan
_STEP = 0.1  # step of the utilisation between two colours


def log_cursor(rec: Stream, run: RunResult) -> None:
    time = run.response.time
    rows = cursor_rows(time, run.selection, _ROWS)
    texts = [
        markdown_blocks(at_cursor(run, int(row), int(stop)))
        for row, stop in zip(rows, np.append(rows[1:], time.size), strict=True)
    ]
    rec.log(entity(CURSOR), rr.TextDocument.from_fields(media_type=rr.MediaType.MARKDOWN), static=True)
    rec.send_columns(entity(CURSOR), at(time[rows]), rr.TextDocument.columns(text=texts))


def cursor_rows(time: Array, selection: Selection, most: int = _PLAN_ROWS) -> Rows:
    """Choose rows evenly over the window, and a quarter as many over the whole run."""
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
    rec.log(path, rr.Points2D.from_fields(positions=places, radii=0.022 * size, show_labels=True), static=True)
    labels = [
        mount.name if np.isnan(value) else f"{mount.name} {in_unit(float(value), '%'):.0f}"
        for row in used
        for mount, value in zip(mounts, row, strict=True)
    ]
    columns = rr.Points2D.columns(colors=heat(used).reshape(-1, 3), labels=labels)
    rec.send_columns(path, at(response.time[rows]), columns.partition(np.full(rows.size, len(mounts))))


def plan_bounds(response: Response) -> tuple[list[float], list[float]]:
    """Find the ranges of the plan, across and downwards, with a margin."""
    places = np.array([mount.base_point[:2] for mount in response.scene.isolating]) * [1.0, -1.0]
    low, high = places.min(axis=0), places.max(axis=0)
    room = 0.12 * max(float(np.max(high - low)), 1e-3)
    return [low[0] - room, high[0] + room], [low[1] - room, high[1] + room]
