"""Loops of all runs in one plot for each of the worst mounts: whole loops dimly, trails and cursors in the runs' colours."""

from dataclasses import dataclass, replace
from typing import Any

from wirerope_mj.views.recording.frame import LARGE, Plot
from wirerope_mj.views.recording.loops import Loop, log_loop_frame, log_trail, loop_path, loops_of, outlines
from wirerope_mj.views.recording.overlay_runs import OverlaidRun, Overlay
from wirerope_mj.views.recording.paths import child


@dataclass(frozen=True, kw_only=True)
class OverlaidLoops:
    """Loops of a mount in an axis: one plot, and the loop of every run that has the mount."""

    axis: str
    mount: str
    plot: Plot
    loops: tuple[tuple[OverlaidRun, Loop], ...]

    @property
    def path(self) -> str:
        """Entity of the plot."""
        return loop_path(self.axis, self.mount)

    def trail_path(self, run: OverlaidRun) -> str:
        """Return the entity of a run's trail."""
        return child(self.path, "data", run.name, "trail")


def overlaid_loops(overlay: Overlay, width: dict[str, float]) -> list[OverlaidLoops]:
    """Return the loops of the shared mounts that are shown; `width` is that of the plots of an axis."""
    found: dict[tuple[str, str], list[tuple[OverlaidRun, Loop]]] = {}
    for run in overlay.runs:
        for loop in loops_of(run.response, overlay.of_run(run)):
            found.setdefault((loop.axis, loop.mount), []).append((run, loop))
    return [
        OverlaidLoops(
            axis=axis,
            mount=mount,
            plot=_around([loop.plot for _, loop in found[axis, mount] if loop.plot is not None], width[axis]),
            loops=tuple(found[axis, mount]),
        )
        for axis in overlay.shared.axes
        for mount in overlay.shared.shown(axis)
        if (axis, mount) in found
    ]


def log_overlaid_loops(rec: Any, overlaid: list[OverlaidLoops]) -> None:
    """Log frames, loops, trails and cursors."""
    for entry in overlaid:
        mounts = [
            mount for run, _ in entry.loops for mount in run.response.scene.mounts if mount.name == entry.mount
        ]  # fmt: skip
        log_loop_frame(rec, entry.path, entry.plot, mounts, entry.axis, lift=LARGE)
        rec.log(child(entry.path, "data"), entry.plot.transform(), static=True)
        for order, (run, loop) in enumerate(entry.loops):
            below = child(entry.path, "data", run.name)
            rec.log(below, outlines([loop], [run.color], [run.name]), static=True)
            log_trail(rec, below, loop, run.color, cursor=run.color, order=order)


def _around(plots: list[Plot], width: float) -> Plot:
    """Return the plot that holds all others."""
    lows = [(plot.across[0], plot.upward[0]) for plot in plots]
    highs = [(plot.across[1], plot.upward[1]) for plot in plots]
    low, high = (min(x for x, _ in lows), min(y for _, y in lows)), (max(x for x, _ in highs), max(y for _, y in highs))
    return replace(plots[0], across=(low[0], high[0]), upward=(low[1], high[1]), width=width)
