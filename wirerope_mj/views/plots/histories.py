"""Histories and loops of a response as pictures."""

from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np

from wirerope_mj.assessment.criteria import MountPeak, body_peaks, mount_peaks
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.isolator.travel import RATINGS, SIDES
from wirerope_mj.views.plots.plain_figure import PlainFigure
from wirerope_mj.views.plots.report_image import short

_MOST = 3  # lines of bodies or mounts in one panel: more cannot be told apart
_LONG = 10_000  # samples from which loops are drawn around the largest deflection only
_AROUND = 300  # samples before and after it
_BASE, _LINES, _RATED = "0.55", ("#08519c", "#d95f0e", "#31a354"), "#b30000"


def save_histories(response: Response, path: str | Path, *, title: str = "") -> None:
    """Write a picture of accelerations along x, y, z, and of axial deflections and forces of the busiest mounts."""
    figure = PlainFigure(figsize=(11.0, 12.0), layout="constrained", dpi=110)
    panels = figure.subplots(5, 1, sharex=True)
    figure.suptitle("\n".join(wrap(title, 100)), fontsize=12, fontweight="bold")
    bodies = [row.name for row in body_peaks(response) if row.kind == "body"][:_MOST]
    for axis, panel in enumerate(panels[:3]):
        _line(panel, response.time, in_unit(response.base.acceleration[:, axis], "g"), "base", _BASE)
        for name, colour in zip(bodies, _LINES, strict=False):
            _line(panel, response.time, in_unit(response.bodies[name].acceleration[:, axis], "g"), name, colour)
        panel.set_ylabel(f"acceleration {'xyz'[axis]} [g]")
    mounts = mount_peaks(response)[:_MOST]
    for row, colour in zip(mounts, _LINES, strict=False):
        mount, axis = response.mounts[row.name], _governing(row)
        label = f"{row.name} {AXES[axis]}"
        _line(panels[3], response.time, in_unit(mount.deflection[:, axis], "mm"), label, colour)
        _line(panels[4], response.time, in_unit(mount.force[:, axis], "kN"), label, colour)
    if mounts:
        _rated(response, panels[3], mounts[0])
    panels[3].set_ylabel("deflection [mm]")
    panels[4].set_ylabel("force [kN]")
    panels[4].set_xlabel("time [s]")
    for panel in panels:
        panel.grid(color="0.92")
        panel.margins(x=0.0)
        if panel.get_legend_handles_labels()[0]:
            panel.legend(fontsize=8, loc="upper right", ncols=2)
    figure.savefig(path)


def save_mount_loops(response: Response, path: str | Path, *, title: str = "") -> None:
    """Write a picture of the force-deflection loops of the mount that uses most of its travel.

    Of a long response only what surrounds the largest deflection is drawn: thousands of loops would be one blot.
    """
    row = mount_peaks(response)[0]
    mount, part = response.mounts[row.name], slice(None)
    where = ""
    if response.time.size > _LONG:
        middle = int(np.searchsorted(response.time, response.peaks.mounts[row.name].deflection.time))
        part = slice(max(middle - _AROUND, 0), middle + _AROUND)
        where = f", {response.time[part][0]:.5g} to {response.time[part][-1]:.5g} s"
    deflection, force = in_unit(mount.deflection[part], "mm"), in_unit(mount.force[part], "kN")
    axes = [axis for axis in range(len(AXES)) if force[:, axis].any()] or [AXES.index("axial")]
    figure = PlainFigure(figsize=(1.0 + 4.4 * len(axes), 4.6), layout="constrained", dpi=110)
    figure.suptitle(f"{title}\n{row.name}, {row.isolator}{where}", fontsize=12, fontweight="bold")
    for axis, panel in zip(axes, np.atleast_1d(figure.subplots(1, len(axes))), strict=True):
        panel.plot(deflection[:, axis], force[:, axis], color=_LINES[0], lw=0.8)
        panel.plot(deflection[0, axis], force[0, axis], "o", color="0.2", ms=5, label="start")
        panel.set_title(AXES[axis])
        panel.set_xlabel("deflection [mm]")
        panel.set_ylabel("force [kN]")
        panel.grid(color="0.92")
        panel.legend(fontsize=8, loc="upper left")
    figure.savefig(path)


def _line(panel: Any, time: Any, values: Any, label: str, colour: str) -> None:
    panel.plot(time, values, color=colour, lw=0.9, label=short(label))


def _governing(row: MountPeak) -> int:
    """Return the axis in which the mount uses most of its travel; where nothing is judged, in which it moves most."""
    if not row.governing:
        return int(np.argmax(np.subtract(row.maximum, row.minimum)))
    return RATINGS[row.governing][0]


def _rated(response: Response, panel: Any, row: MountPeak) -> None:
    """Mark the rated travel of the busiest mount."""
    travel = next(mount.travel for mount in response.scene.mounts if mount.name == row.name)
    axis = AXES[_governing(row)]
    below, above = SIDES[axis]
    for limit, sign in ((below, -1.0), (above, 1.0)):
        if limit in travel:
            label = f"rated {limit}, {row.name}" if (limit, sign) != (below, 1.0) else None
            panel.axhline(sign * in_unit(travel[limit], "mm"), color=_RATED, ls="--", lw=1.0, label=label)
