"""Selection of what is shown of a response: the event, the mounts and the bodies that matter most."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.assessment.criteria import Verdict, acceleration_verdicts, body_peaks, judge, mount_peaks
from wirerope_mj.assessment.criteria.ended import Used, used_limits
from wirerope_mj.assessment.criteria.verdict import by_use
from wirerope_mj.content.panels import OTHERS
from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.engine.response.scene import SceneMount
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.isolator.travel import SIDES

MOST_LOOPS = 6  # Loops of the governing axis that get a view of their own: two rows of three can be read
MOST_OTHER_LOOPS = 3  # The same for the other axes; each costs some 40 kilobytes of the file
NAMED = 3  # Lines of a graph that have colours and names: the largest. The others are grey.
MOST = 3  # Lines of bodies or mounts in one panel of a page: more cannot be told apart
QUANTITIES = ("deflection", "force")  # Of mounts, as `MountResponse` calls them
COLOURS = 6  # Lines that can be told apart: numbers of colours in the tables of the views
_SETTLED = 0.1  # The event is over when deflections stay within this fraction of their largest swing


@dataclass(frozen=True, kw_only=True)
class Selection:
    """Selection of what is shown."""

    event: float  # instant of the first event of the motion [s]
    window: tuple[float, float]  # first and last instant of what follows from it [s]
    utilisations: Array  # peak deflection over rated travel, (n_mounts, 3); NaN where nothing is rated
    mounts: tuple[str, ...]  # names of the mounts that are no stops, in the order of `utilisations`
    ranked: dict[str, tuple[str, ...]]  # per axis the mounts that act in it, largest fraction of the rated travel first
    # per quantity and axis the mounts that act in it, largest peak of the quantity first
    leading: dict[tuple[str, str], tuple[str, ...]]
    # bodies, points: names of what rides on the base, largest peak acceleration first
    bodies: tuple[str, ...]
    points: tuple[str, ...]
    verdicts: tuple[Verdict, ...]  # on the run
    used: tuple[Used, ...]  # what has limits that it uses more or less of over time, in the order of `by_use`
    numbers: dict[str, int]  # in the table of colours, of mounts, bodies and points by name
    run_color: tuple[int, int, int] | None = None  # of all mounts, among several runs

    @property
    def axes(self) -> tuple[str, ...]:
        """Axes in which any mount acts: the governing one first, and axial first where utilisations are equal to a tenth."""
        return tuple(sorted((axis for axis in self.ranked if self.ranked[axis]), key=self._urgency, reverse=True))

    @property
    def governing(self) -> str | None:
        """The most critical mount, or else that with the most travel in the governing axis; None without mounts."""
        used = [name for name in by_use(self.verdicts) if name in self.mounts]
        return used[0] if used else self.ranked[self.axes[0]][0] if self.axes else None

    def shown(self, axis: str) -> tuple[str, ...]:
        """Return the mounts whose loop and histories in `axis` are drawn."""
        if not self.ranked[axis]:
            return ()
        return self.ranked[axis][: MOST_LOOPS if axis == self.axes[0] else MOST_OTHER_LOOPS]

    def among(self, mounts: Collection[str]) -> "Selection":
        """Return the selection without other mounts."""
        return replace(self, ranked={axis: tuple(n for n in names if n in mounts) for axis, names in self.ranked.items()})

    def utilisation(self, mount: str, axis: str) -> float:
        """Return peak deflection over rated travel, NaN if nothing is rated."""
        return float(self.utilisations[self.mounts.index(mount), AXES.index(axis)])

    def _urgency(self, axis: str) -> tuple[float, bool]:
        ratio = self.utilisation(self.ranked[axis][0], axis)
        return (0.0 if np.isnan(ratio) else round(ratio, 1)), axis == "axial"


def select(response: Response, verdicts: Sequence[Verdict] | None = None) -> Selection:
    """Return what is shown of `response`; without verdicts those that `judge` returns."""
    verdicts = tuple(judge(response) if verdicts is None else verdicts)
    mounts = tuple(mount.name for mount in response.scene.isolating)
    rows = {row.name: [row.utilisation_along(axis) for axis in AXES] for row in mount_peaks(response)}
    utilisations = np.array([rows[name] for name in mounts], dtype=np.float64).reshape(-1, 3)  # None becomes NaN
    ranked = {axis: _ranked(response, mounts, utilisations, number) for number, axis in enumerate(AXES)}
    first, last = float(response.time[0]), float(response.time[-1])
    event = min(max(response.events[0][0] if response.events else first, first), last)
    fixed = {body.name for body in response.scene.bodies if body.on_base} | {response.scene.base}
    bodies = {name: peaks.acceleration for name, peaks in response.peaks.bodies.items() if name not in fixed}
    points = {name: peaks.acceleration for name, peaks in response.peaks.points.items()}
    used = tuple(used_limits(response, verdicts))
    leading = {(quantity, axis): _leading(response, quantity, axis, ranked[axis]) for axis in AXES for quantity in QUANTITIES}
    groups = [[one.subject for one in used[:NAMED]], *(names[:NAMED] for names in leading.values())]
    groups.append(_largest(bodies | points)[:NAMED])
    return Selection(
        event=event, window=_window(response, event, last), utilisations=utilisations, mounts=mounts, ranked=ranked,
        leading=leading, bodies=_largest(bodies), points=_largest(points), verdicts=verdicts, used=used,
        numbers=numbered(groups),
    )  # fmt: skip


def main_direction(response: Response) -> str:
    """Return the axis along which the base moves, "x", "y" or "z", or "total" where it moves along several."""
    moved = [axis for axis in range(3) if response.base.acceleration[:, axis].any()]
    return "xyz"[moved[0]] if len(moved) == 1 else "total"


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


def _leading(response: Response, quantity: str, axis: str, acting: tuple[str, ...]) -> tuple[str, ...]:
    """Return the mounts that act in an axis, largest peak of a quantity first."""

    def size(name: str) -> float:
        peak, number = getattr(response.peaks.mounts[name], quantity), AXES.index(axis)
        return float(max(-peak.minimum[number], peak.maximum[number]))

    return tuple(sorted(acting, key=size, reverse=True))


def _largest(peaks: dict[str, Peak]) -> tuple[str, ...]:
    return tuple(sorted(peaks, key=lambda name: peaks[name].value, reverse=True))


def _window(response: Response, event: float, last: float) -> tuple[float, float]:
    """Return from just before the event to when the base and every mount have come to rest."""
    end = event
    swings = [mount.deflection - mount.deflection[-1] for mount in response.mounts.values()]
    for history in (response.base.acceleration, *swings):
        swing = np.abs(history).max(axis=1)
        moving = np.flatnonzero(swing > _SETTLED * swing.max())
        end = max(end, float(response.time[moving[-1]]) if moving.size else event)
    end = end if end > event else last
    return max(float(response.time[0]), event - 0.06 * (end - event)), end


def kind_of(selection: Selection, name: str, other: int | str = OTHERS) -> int | str:
    """Return the number of the colour that a mount, a body or a point has in every output."""
    return selection.numbers.get(name, other)


def or_other(name: str, kind: int | str, rank: int, count: int) -> tuple[str, int | str]:
    """Return name and colour of a curve among `count`, those of all others together from `NAMED` on."""
    left = count - NAMED
    return (name, kind) if rank < NAMED else (f"{left} other{'s' if left > 1 else ''}", OTHERS)


def numbered(groups: Sequence[Sequence[str]]) -> dict[str, int]:
    """Return a number of a colour for every name, first come, first served; those of one group differ if there are enough."""
    numbers: dict[str, int] = {}
    count = COLOURS
    for group in groups:
        for name in group:
            if name not in numbers:
                here = [numbers[other] for other in group if other in numbers]
                taken = list(numbers.values())
                numbers[name] = min(range(count), key=lambda n: (here.count(n), taken.count(n), n))
    return numbers


def worst_names(response: Response) -> list[str]:
    """Return the bodies and points to draw, three at most; of those that move alike, the first.

    First those that are nearest to their limits of acceleration, then others with limits, then the largest accelerations.
    """
    names: list[str] = []
    peaks: list[tuple[float, ...]] = []
    used = dict.fromkeys((limit.name for limit in response.scene.limits), 0.0)
    for verdict in acceleration_verdicts(response):  # from the peaks alone: rattle space would take every sample
        if verdict.utilisation is not None:
            used[verdict.subject] = max(verdict.utilisation, used[verdict.subject])
    for row in sorted(body_peaks(response), key=lambda row: -used.get(row.name, -1.0)):  # else as they are: by size
        size = (row.value, *row.axes)
        alike = any(np.allclose(size, other, rtol=1e-6, atol=1e-9) for other in peaks)  # a point of what cannot turn
        if row.kind != "base" and not alike:
            names.append(row.name)
            peaks.append(size)
    return names[:MOST]
