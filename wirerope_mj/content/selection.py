"""Selection of what is shown of a response: the event, the mounts and the bodies that matter most."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from wirerope_mj.assessment.criteria import Verdict, acceleration_verdicts, body_peaks, judge, mount_peaks
from wirerope_mj.assessment.criteria.ended import Used, used_limits
from wirerope_mj.assessment.criteria.verdict import by_use
from wirerope_mj.content.blocks import MOUNTS, OTHERS, PAYLOADS
from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.engine.response.scene import SceneMount
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.isolator.travel import SIDES

MOST_LOOPS = 6  # loops of the governing axis with a view of their own: two rows of three can be read
MOST_OTHER_LOOPS = 3  # loops of each other axis; each costs some 40 kilobytes of the file
NAMED = 3  # lines of a graph with colours and names; the others are grey
MOST_CURVES = 3  # curves of bodies or mounts in one panel of a page: more cannot be distinguished
QUANTITIES = ("deflection", "force")  # Of mounts, as `MountResponse` calls them
COLOURS = 6  # runs, cases or levels of a chart that can be distinguished
_SETTLED = 0.1  # fraction of the largest swing within which deflections stay when the event is over


@dataclass(frozen=True, kw_only=True)
class Selection:
    """The event, mounts, bodies and points of a response that outputs show."""

    event: float  # instant of the first event of the motion [s]
    window: tuple[float, float]  # first and last instant of the response to it [s]
    utilisations: Array  # peak deflection over rated travel, (n_mounts, 3); NaN without a rating
    mounts: tuple[str, ...]  # names of the mounts that are no stops, in the order of `utilisations`
    ranked: dict[str, tuple[str, ...]]  # per axis the mounts that act in it, by utilisation of the rated travel
    # per quantity and axis the mounts that act in it, by peak
    leading: dict[tuple[str, str], tuple[str, ...]]
    # bodies, points: names of those on the mounts, by peak acceleration
    bodies: tuple[str, ...]
    points: tuple[str, ...]
    verdicts: tuple[Verdict, ...]  # on the run
    used: tuple[Used, ...]  # limits of subjects with their utilisation over time, in the order of `by_use`
    kinds: dict[str, str]  # kinds of curves of mounts, bodies and points by name, the same in every chart
    run_color: tuple[int, int, int] | None = None  # colour of all mounts, among several runs

    @property
    def axes(self) -> tuple[str, ...]:
        """The mount axes in which forces act, the most utilised first."""

        def urgency(axis: str) -> tuple[float, bool]:
            ratio = self.utilisation(self.ranked[axis][0], axis)
            return (0.0 if np.isnan(ratio) else round(ratio, 1)), axis == "axial"

        return tuple(sorted((axis for axis in self.ranked if self.ranked[axis]), key=urgency, reverse=True))

    @property
    def governing(self) -> str | None:
        """The most critical mount, else the mount with the largest travel; None without mounts."""
        used = [name for name in by_use(self.verdicts) if name in self.mounts]
        return used[0] if used else self.ranked[self.axes[0]][0] if self.axes else None

    def shown(self, axis: str) -> tuple[str, ...]:
        """Choose the mounts whose loops and histories in `axis` are drawn."""
        if not self.ranked[axis]:
            return ()
        return self.ranked[axis][: MOST_LOOPS if axis == self.axes[0] else MOST_OTHER_LOOPS]

    def among(self, mounts: Collection[str]) -> "Selection":
        """Leave only the given mounts in the ranking of every axis."""
        return replace(self, ranked={axis: tuple(n for n in names if n in mounts) for axis, names in self.ranked.items()})

    def utilisation(self, mount: str, axis: str) -> float:
        """Find peak deflection over rated travel; NaN without a rating."""
        return float(self.utilisations[self.mounts.index(mount), AXES.index(axis)])


def select(response: Response, verdicts: Sequence[Verdict] | None = None) -> Selection:
    """Choose event, mounts, bodies and points of a response to show; verdicts are those of `judge` by default."""

    def acting_mounts(axis: int) -> list[str]:
        return [name for name in mounts if response.mounts[name].force[:, axis].any()]

    def urgency(name: str, axis: int) -> tuple[float, float]:
        deflection, ratio = response.peaks.mounts[name].deflection, utilisations[mounts.index(name), axis]
        return (0.0 if np.isnan(ratio) else ratio), float(deflection.maximum[axis] - deflection.minimum[axis])

    def largest(name: str, quantity: str, axis: int) -> float:
        peak = getattr(response.peaks.mounts[name], quantity)
        return float(max(-peak.minimum[axis], peak.maximum[axis]))

    def by_size(peaks: dict[str, Peak]) -> tuple[str, ...]:
        return tuple(sorted(peaks, key=lambda name: peaks[name].value, reverse=True))

    verdicts = tuple(judge(response) if verdicts is None else verdicts)
    mounts = tuple(mount.name for mount in response.scene.isolating)
    rows = {row.name: [row.utilisation_along(axis) for axis in AXES] for row in mount_peaks(response)}
    utilisations = np.array([rows[name] for name in mounts], dtype=np.float64).reshape(-1, 3)  # None becomes NaN
    ranked, leading = {}, {}
    for number, axis in enumerate(AXES):
        ranked[axis] = tuple(sorted(acting_mounts(number), key=partial(urgency, axis=number), reverse=True))
        for quantity in QUANTITIES:
            order = partial(largest, quantity=quantity, axis=number)
            leading[quantity, axis] = tuple(sorted(ranked[axis], key=order, reverse=True))
    first, last = float(response.time[0]), float(response.time[-1])
    event = min(max(response.events[0][0] if response.events else first, first), last)
    end = event  # when the base and every mount have come to rest
    for history in (response.base.acceleration, *(m.deflection - m.deflection[-1] for m in response.mounts.values())):
        swing = np.abs(history).max(axis=1)
        moving = np.flatnonzero(swing > _SETTLED * swing.max())
        end = max(end, float(response.time[moving[-1]]) if moving.size else event)
    end = end if end > event else last
    fixed = {body.name for body in response.scene.bodies if body.on_base} | {response.scene.base}
    bodies = {name: peaks.acceleration for name, peaks in response.peaks.bodies.items() if name not in fixed}
    points = {name: peaks.acceleration for name, peaks in response.peaks.points.items()}
    used = tuple(used_limits(response, verdicts))
    critical, over_time = ([limit.subject for limit in rows[:NAMED]] for rows in (used, ranked_over_time(used)))
    of_mounts = [[name for name in names if name in mounts] for names in (critical, over_time)]
    of_mounts += [list(leading[quantity, axis][:NAMED]) for axis in AXES for quantity in QUANTITIES]
    of_payload = [worst_names(response), [name for name in (*critical, *over_time) if name not in mounts]]
    of_payload.append(list(by_size(bodies | points)[:NAMED]))
    return Selection(
        event=event, window=(max(first, event - 0.06 * (end - event)), end), utilisations=utilisations, mounts=mounts,
        ranked=ranked, leading=leading, bodies=by_size(bodies), points=by_size(points), verdicts=verdicts, used=used,
        kinds=assigned(of_mounts, MOUNTS) | assigned(of_payload, PAYLOADS),
    )  # fmt: skip


def ranked_over_time(used: Sequence[Used]) -> list[Used]:
    """Order limits by their largest utilisation during the run, the largest first; utilisation at rest does not count."""
    return sorted(used, key=lambda entry: -entry.largest)


def main_direction(response: Response) -> str:
    """Name the axis along which the base moves, "x", "y" or "z", or "total" for several axes."""
    moved = [axis for axis in range(3) if response.base.acceleration[:, axis].any()]
    return "xyz"[moved[0]] if len(moved) == 1 else "total"


def travel_limits(mount: SceneMount, axis: str) -> tuple[float, float]:
    """Find the lowest and highest rated deflection of an axis [m]; NaN without a rating."""
    below, above = SIDES[axis]
    return -mount.travel.get(below, np.nan), mount.travel.get(above, np.nan)


def kind_of(selection: Selection, name: str) -> str:
    """Find the kind (colour) of curves of a mount, body or point; without one, that of the most critical mount or body."""
    return selection.kinds.get(name, MOUNTS[0] if name in selection.mounts else PAYLOADS[0])


def or_other(name: str, kind: str, rank: int, count: int) -> tuple[str, str]:
    """Find name and kind of the curve of a rank, 0 the most critical, of `count`; from `NAMED` on it is one of the "others"."""
    left = count - NAMED
    return (name, kind) if rank < NAMED else (f"{left} other{'s' if left > 1 else ''}", OTHERS)


def assigned(groups: Sequence[Sequence[str]], kinds: Sequence[str]) -> dict[str, str]:
    """Assign kinds (colours) to names: to each the kind that its group, drawn in one chart, uses least, then least of all."""
    known: dict[str, str] = {}
    for group in groups:
        for name in group:
            if name not in known:
                in_group, in_use = [known[member] for member in group if member in known], list(known.values())
                known[name] = min(kinds, key=lambda kind: (in_group.count(kind), in_use.count(kind), kinds.index(kind)))
    return known


def worst_names(response: Response) -> list[str]:
    """Choose at most three bodies and points to draw; of those with equal peaks only the first.

    The largest utilisations of acceleration limits come first, then others with limits, then the largest accelerations.
    """
    names: list[str] = []
    peaks: list[tuple[float, ...]] = []
    used = dict.fromkeys((limit.name for limit in response.scene.limits), 0.0)
    for verdict in acceleration_verdicts(response):  # from the peaks alone: rattle space would take every sample
        if verdict.utilisation is not None:
            used[verdict.subject] = max(verdict.utilisation, used[verdict.subject])
    for row in sorted(body_peaks(response), key=lambda row: -used.get(row.name, -1.0)):  # else as they are: by size
        size = (row.value, *row.axes)
        alike = any(np.allclose(size, peak, rtol=1e-6, atol=1e-9) for peak in peaks)  # a point of a body that does not rotate
        if row.kind != "base" and not alike:
            names.append(row.name)
            peaks.append(size)
    return names[:MOST_CURVES]
