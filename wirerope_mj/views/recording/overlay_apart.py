"""Where and when the histories of runs lie farthest apart."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.recording.overlay_parts import Part, Run, has


@dataclass(frozen=True, kw_only=True)
class Apart:
    """Where two histories are farthest apart.

    Attributes:
        thing: part or mount.
        run: the other run; the histories are compared with those of the first.
        value: largest norm of the difference [m/s^2] or [m].
        time: its instant [s].
        share: of the first run's peak; NaN if that is zero.
    """

    thing: Part | str
    run: str
    value: float
    time: float
    share: float


def farthest_apart(runs: Sequence[Run], things: Iterable[Part | str]) -> tuple[Apart, ...]:
    """Return for each part and mount of the first run where every other run is farthest from it, the farthest first."""
    first, *others = runs
    found = []
    for thing in things:
        for run in others if has(first.response, thing) else ():
            if not has(run.response, thing):
                continue
            time, distance = difference(thing, first, run)
            if time.size:
                row = int(distance.argmax())
                size, peak = float(distance[row]), _peak(thing, first.response).value
                share = size / peak if peak else np.nan
                found.append(Apart(thing=thing, run=run.name, value=size, time=float(time[row]), share=share))
    return tuple(sorted(found, key=lambda apart: -np.nan_to_num(apart.share)))


def difference(thing: Part | str, first: Run, other: Run) -> tuple[Array, Array]:
    """Return how far two histories are apart: instants of the first that both have [s], and the norm of the difference.

    Accelerations [m/s^2] of a part, deflections [m] of a mount; the other run is taken linearly between its samples.
    """
    start, end = (pick(first.response.time[row], other.response.time[row]) for pick, row in ((max, 0), (min, -1)))
    time = first.response.time
    both = (time >= start) & (time <= end)
    time, values = time[both], _history(thing, first.response)[both]
    there, theirs = other.response.time, _history(thing, other.response)
    if np.array_equal(there, time):
        return time, np.linalg.norm(theirs - values, axis=1)
    between = np.column_stack([np.interp(time, there, theirs[:, axis]) for axis in range(3)])
    return time, np.linalg.norm(between - values, axis=1)


def _history(thing: Part | str, response: Response) -> Array:
    return response.mounts[thing].deflection if isinstance(thing, str) else thing.acceleration(response)


def _peak(thing: Part | str, response: Response) -> Peak:
    return response.peaks.mounts[thing].deflection if isinstance(thing, str) else thing.peak(response)
