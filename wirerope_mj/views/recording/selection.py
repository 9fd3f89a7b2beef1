"""Selection of what is shown of a response: the event, the mounts and the bodies that matter most."""

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.assessment.criteria import mount_peaks
from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.engine.response.scene import SceneMount
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.isolator.travel import SIDES
from wirerope_mj.views.recording.paths import AXES, AXIAL

MOST_LOOPS = 9
"""Loops of the governing axis that get a view of their own: three rows of three are the smallest that can be read."""

MOST_OTHER_LOOPS = 4
"""The same for the other axes; each costs some 40 kilobytes of the file."""

MOST_BODIES = 3
MOST_POINTS = 3

_SETTLED = 0.1
"""The event is over when deflections stay within this fraction of their largest swing."""

_PALETTE = (
    (78, 155, 230), (255, 159, 64), (76, 194, 107), (242, 84, 91), (176, 140, 240), (205, 145, 110),
    (242, 140, 208), (190, 200, 80), (60, 200, 216), (150, 170, 190), (240, 200, 90), (120, 220, 180),
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Selection:
    """Selection of what is shown.

    Attributes:
        event: instant of the first event of the motion [s].
        window: first and last instant of what follows from it [s].
        utilisations: peak deflection over rated travel, (n_mounts, 3); NaN where nothing is rated.
        mounts: names of the mounts that are no stops, in the order of `utilisations`.
        ranked: per axis the mounts that act in it, largest fraction of the rated travel first.
        bodies, points: names whose accelerations are shown, largest peak first.
        colors: of mounts by name.
    """

    event: float
    window: tuple[float, float]
    utilisations: Array
    mounts: tuple[str, ...]
    ranked: dict[str, tuple[str, ...]]
    bodies: tuple[str, ...]
    points: tuple[str, ...]
    colors: dict[str, tuple[int, int, int]]

    @property
    def axes(self) -> tuple[str, ...]:
        """Axes in which any mount acts: the governing one first, and axial first where utilisations are equal to a tenth."""
        return tuple(sorted((axis for axis in self.ranked if self.ranked[axis]), key=self._urgency, reverse=True))

    @property
    def governing(self) -> str | None:
        """Mount with the largest fraction of its rated travel in the governing axis; None without mounts."""
        return self.ranked[self.axes[0]][0] if self.axes else None

    def shown(self, axis: str) -> tuple[str, ...]:
        """Return the mounts whose loop and histories in `axis` are drawn."""
        if not self.ranked[axis]:
            return ()
        return self.ranked[axis][: MOST_LOOPS if axis == self.axes[0] else MOST_OTHER_LOOPS]

    def among(self, mounts: Collection[str]) -> "Selection":
        """Return the selection without other mounts."""
        return replace(
            self, ranked={axis: tuple(n for n in names if n in mounts) for axis, names in self.ranked.items()}
        )

    def utilisation(self, mount: str, axis: str) -> float:
        """Return peak deflection over rated travel, NaN if nothing is rated."""
        return float(self.utilisations[self.mounts.index(mount), AXES.index(axis)])

    def _urgency(self, axis: str) -> tuple[float, bool]:
        ratio = self.utilisation(self.ranked[axis][0], axis)
        return (0.0 if np.isnan(ratio) else round(ratio, 1)), axis == AXES[AXIAL]


def select(response: Response) -> Selection:
    """Return what is shown of `response`."""
    mounts = tuple(mount.name for mount in response.scene.isolating)
    used = {row.name: [row.utilisation_along(axis) for axis in AXES] for row in mount_peaks(response)}
    utilisations = np.array([used[name] for name in mounts], dtype=np.float64).reshape(-1, 3)  # None becomes NaN
    ranked = {axis: _ranked(response, mounts, utilisations, number) for number, axis in enumerate(AXES)}
    first, last = float(response.time[0]), float(response.time[-1])
    event = min(max(response.events[0][0] if response.events else first, first), last)
    fixed = {body.name for body in response.scene.bodies if body.on_base} | {response.scene.base}
    bodies = {name: peaks.acceleration for name, peaks in response.peaks.bodies.items() if name not in fixed}
    points = {name: peaks.acceleration for name, peaks in response.peaks.points.items()}
    return Selection(
        event=event,
        window=_window(response, event, last),
        utilisations=utilisations,
        mounts=mounts,
        ranked=ranked,
        bodies=_largest(bodies, MOST_BODIES),
        points=_largest(points, MOST_POINTS),
        colors={name: _PALETTE[number % len(_PALETTE)] for number, name in enumerate(mounts)},
    )


def travel_limits(mount: SceneMount, axis: str) -> tuple[float, float]:
    """Return the lowest and highest rated deflection of an axis [m]; NaN where none is rated."""
    below, above = SIDES[axis]
    return -mount.travel.get(below, np.nan), mount.travel.get(above, np.nan)


def _ranked(response: Response, mounts: tuple[str, ...], utilisations: Array, axis: int) -> tuple[str, ...]:
    """Return the mounts that act in an axis: by utilisation of the rated travel, then by the deflection itself."""

    def order(number: int) -> tuple[float, float]:
        deflection = response.peaks.mounts[mounts[number]].deflection
        ratio = utilisations[number, axis]
        return (0.0 if np.isnan(ratio) else ratio), float(deflection.maximum[axis] - deflection.minimum[axis])

    acting = [n for n, name in enumerate(mounts) if response.mounts[name].force[:, axis].any()]
    return tuple(mounts[n] for n in sorted(acting, key=order, reverse=True))


def _largest(peaks: dict[str, Peak], most: int) -> tuple[str, ...]:
    return tuple(sorted(peaks, key=lambda name: peaks[name].value, reverse=True)[:most])


def _window(response: Response, event: float, last: float) -> tuple[float, float]:
    """Return from just before the event to when every mount has come to rest."""
    end = event
    for mount in response.mounts.values():
        swing = np.abs(mount.deflection - mount.deflection[-1]).max(axis=1)
        moving = np.flatnonzero(swing > _SETTLED * swing.max())
        end = max(end, float(response.time[moving[-1]]) if moving.size else event)
    end = end if end > event else last
    return max(float(response.time[0]), event - 0.06 * (end - event)), end
