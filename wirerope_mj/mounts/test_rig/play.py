"""Play (backlash) in a record: behind every reversal a way on which the force stands near zero, with stiffness on both sides.

On its way from one turning point to the next the force of a hysteretic device falls steeply at first and less and less
steeply later. Where a pin, a thread or a clamp has play, it is steep, flat while the play is crossed at no force, and steep
again. A spring that hardens is flat in its middle, too, but there at one deflection; play goes with the reversal.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.test_rig.turning import find_turning_points

# forces over half of their range at which a stroke is cut; a load cell's zero may stand aside by a third of it
_LEVELS = np.linspace(0.6, -0.6, 13)
_MIDDLE = slice(2, 10)  # cuts among which the flat way is looked for; steep ones are left on either side
_FLAT = 0.6  # of the stiffness on either side, up to which a way is flat; a hysteretic law has less behind than before
_ALIKE = 0.2  # of half of the force range, within which both senses have their flat way at one force
_SHARPER = 4  # times that the force is smoothed over fewer samples than the deflection: play may be short
_STROKE = 0.3  # of the longest, from which a stroke is looked at
_FEWEST = 3  # strokes that show it
_MOST_OF_THEM = 0.8


@dataclass(frozen=True, kw_only=True)
class Play:
    """Way on which the force stands near zero behind a reversal [m], and how many strokes show it."""

    width: float
    strokes: int


def play_in(time: Array, deflection: Array, force: Array) -> Play | None:
    """Return the play that deflection [m] and force [N] at instants [s], (n,) each, show, None if they show none."""
    if np.ptp(deflection) == 0.0 or np.ptp(force) == 0.0:
        return None
    trace = find_turning_points(deflection, time)
    smooth = scipy.ndimage.uniform_filter1d(force, max(1, trace.window // _SHARPER))
    smooth -= 0.5 * (smooth.max() + smooth.min())
    half = 0.5 * float(np.ptp(smooth))
    seen: dict[bool, list[tuple[float, float, float]]] = {True: [], False: []}
    looked_at = 0
    for first, last in zip(trace.turns[:-1], trace.turns[1:], strict=True):
        way = trace.smooth[first : last + 1]
        if abs(way[-1] - way[0]) < _STROKE * trace.strokes.max():
            continue
        upwards = bool(way[-1] > way[0])
        at = _crossings(way, (-1.0 if upwards else 1.0) * smooth[first : last + 1] / half)
        if at is None:
            continue
        looked_at += 1
        stiffness = -np.diff(_LEVELS) / np.maximum(np.abs(np.diff(at)), 1e-300)
        flat = _MIDDLE.start + int(np.argmin(stiffness[_MIDDLE]))
        beside = min(float(np.median(stiffness[:flat])), float(np.median(stiffness[flat + 1 :])))
        if stiffness[flat] < _FLAT * beside:
            slack = np.maximum(np.abs(np.diff(at)) * (1.0 - stiffness / beside), 0.0)
            level = 0.5 * float(_LEVELS[flat] + _LEVELS[flat + 1]) * (-1.0 if upwards else 1.0)
            seen[upwards].append((float(slack[_MIDDLE].sum()), 0.5 * float(at[flat] + at[flat + 1]), level))
    widths = np.array([width for each in seen.values() for width, _, _ in each])
    if widths.size < max(_FEWEST, _MOST_OF_THEM * looked_at) or not (seen[True] and seen[False]):
        return None
    apart = np.abs(np.diff([np.median(seen[side], axis=0) for side in (True, False)], axis=0))[0]
    # A spring that hardens is flat at one deflection, and with friction at two forces.
    if apart[1] < np.median(widths) or apart[2] > _ALIKE:
        return None
    return Play(width=float(np.median(widths)), strokes=int(widths.size))


def _crossings(way: Array, falling: Array) -> Array | None:
    """Return the deflections at which a force first falls below each of `_LEVELS` (13,), None if it does not pass them all."""
    if falling[: max(1, falling.size // 20)].max() < _LEVELS[0] or falling.min() > _LEVELS[-1]:
        return None
    begin = int(np.argmax(falling[: max(1, falling.size // 20)]))
    return np.array([way[begin + int(np.argmax(falling[begin:] < level))] for level in _LEVELS])
