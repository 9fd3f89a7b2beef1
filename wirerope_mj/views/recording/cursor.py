"""What the largest mounts, bodies and the base do at the time cursor, as a table that changes with it."""

from typing import Any

import numpy as np

from wirerope_mj.content.selection import NAMED, Selection
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.plain_text import markdown
from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.recording.markdown_tables import markdown_table
from wirerope_mj.views.recording.paths import AXES, Rows, at, entity

PATH = ("cursor",)

_ROWS = 160
"""Instants at which the table is written anew: a few milliseconds of a shock apart."""


def log_cursor(rec: Any, response: Response, selection: Selection) -> None:
    """Log a text for every few samples of what follows from the event, and for some of the rest."""
    import rerun as rr

    rows = cursor_rows(response.time, selection)
    texts = [_text(response, selection, int(row)) for row in rows]
    rec.log(entity(*PATH), rr.TextDocument.from_fields(media_type=rr.MediaType.MARKDOWN), static=True)
    rec.send_columns(entity(*PATH), at(response.time[rows]), rr.TextDocument.columns(text=texts))


def cursor_rows(time: Array, selection: Selection) -> Rows:
    """Return the samples of which values are shown: most of them from where the event begins to where it is over."""
    within = np.linspace(*selection.window, _ROWS)
    outside = np.linspace(time[0], time[-1], _ROWS // 4)
    rows = np.searchsorted(time, np.concatenate([within, outside])).clip(0, time.size - 1)
    return np.unique(rows)


def _text(response: Response, selection: Selection, row: int) -> str:
    """Return the table of one sample."""
    courses = {one.subject: one.course for one in selection.used}
    columns = [Column("", align="left"), *(Column(f"{axis} [mm]") for axis in reversed(AXES))]
    columns += [*(Column(f"{axis} [kN]") for axis in reversed(AXES)), Column("used [%]")]
    rows = []
    for name in _mounts(selection):
        mount = response.mounts[name]
        values = [f"{in_unit(float(mount.deflection[row, axis]), 'mm'):.1f}" for axis in (2, 1, 0)]
        values += [f"{in_unit(float(mount.force[row, axis]), 'kN'):.2f}" for axis in (2, 1, 0)]
        used = f"{in_unit(float(courses[name][row]), '%'):.0f}" if name in courses else "not rated"
        rows.append((name, *values, used))
    parts = [f"**{response.time[row]:.4f} s** {_accelerations(response, selection, row)}"]
    if rows:
        parts.append(markdown_table(Table(title="", columns=columns, rows=rows)))
    return "\n\n".join(parts)


def _mounts(selection: Selection) -> list[str]:
    """Return the mounts that use most of their limits, then those that are deflected most."""
    names = [one.subject for one in selection.used if one.subject in selection.mounts]
    names += [name for axis in selection.axes[:1] for name in selection.leading["deflection", axis]]
    return list(dict.fromkeys(names))[:NAMED]


def _accelerations(response: Response, selection: Selection, row: int) -> str:
    parts = [("base", response.base.acceleration)]
    parts += [(name, response.bodies[name].acceleration) for name in selection.bodies[:1]]
    parts += [(name, response.points[name].acceleration) for name in selection.points[:1]]
    sizes = [f"{markdown(name)} {in_unit(float(np.linalg.norm(a[row])), 'g'):.2f} g" for name, a in parts]
    return "; ".join(sizes)
