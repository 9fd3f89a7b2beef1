"""Forces that the load cell or its amplifier cut off."""

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws import Loop
from wirerope_mj.mounts.test_rig.turning import rms_noise

_WIDE = 0.05  # of the stroke over which a force that still moves cannot stand at one value, even at 8 bits
_NARROW = 0.005  # the same where no other value comes back as often: no converter's step, for it would be one of many
_OFTEN = 4  # times that the extreme comes back where others come back once: more than cycles of a mean, and neighbours
_SURE = 8.0  # standard deviations of the deflection's noise, of which it moved on for sure
_END = 0.05  # of the stroke beside a turning point
_LEVEL = 0.03  # of the secant stiffness: less than noise and any spring beside rope leave, 1/60 of how rope turns back
# Slope over the secant stiffness that whatever is elastic exceeds, and standard errors by which a level branch stays below
# it: what has a slope that its noise hides is not known to be level.
_ELASTIC, _ERRORS = 0.5, 3.0


def require_unclipped(deflection: Array, force: Array, location: str, *, stop: bool = False) -> None:
    """Raise ValueError if samples stand at exactly the extreme force while the deflection moves on.

    Over a twentieth of the stroke nothing but saturation does that. Over less, steps of a converter do, but then every value
    comes back as often as the extreme.

    Args:
        deflection: of cycles that are like each other [m], (n_t,).
        force: of the same samples [N], (n_t,).
        location: they stand, as text.
        stop: whether the device is a bump stop, whose force stands still within its gap.
    """
    _, counts = np.unique(force, return_counts=True)
    usual = int(np.sort(counts)[-3]) if counts.size > 2 else 0  # either extreme apart
    for name, extreme in (("largest", force.max()), ("smallest", force.min())):
        at = force == extreme
        moved, stroke = float(np.ptp(deflection[at])), float(np.ptp(deflection))
        if stop and _is_open(deflection, force, extreme):
            continue
        alone = at.sum() >= _OFTEN * max(usual, 1) and moved > _SURE * rms_noise(deflection)
        if 3 < at.sum() < force.size and moved > (_NARROW if alone else _WIDE) * stroke:
            raise ValueError(
                f"{location}: {at.sum()} samples stand at exactly the {name} force, {extreme:.6g} N, over "
                f"{1e3 * moved:.3g} mm of deflection: the load cell or its amplifier was saturated. Leave the loop out."
            )


def require_falling(loop: Loop, location: str, *, stop: bool = False) -> None:
    """Raise ValueError if the force is level before a turning point and behind it: cut off, with noise behind.

    What yields falls at once when the deflection turns back, at its elastic stiffness. Where the true force is beyond what was
    recorded, it does not.

    Args:
        loop: mean of cycles.
        location: it stands, as text.
        stop: whether the device is a bump stop, whose force stands still within its gap.
    """
    for rising, name in ((True, "largest"), (False, "smallest")):
        (x, f), (x_back, f_back) = loop.branch(rising=rising), loop.branch(rising=not rising)
        if stop and _is_open(loop.deflection, loop.force, float(f_back[0])):
            continue
        if _level(loop, x[::-1], f[::-1]) and _level(loop, x_back, f_back):
            raise ValueError(
                f"{location}: at its {name} deflection the force stays at {f_back[0]:.5g} N, on the way there and back, "
                "where anything elastic falls at once: the load cell or its amplifier was saturated, or there is play in the "
                "rig. Leave the loop out."
            )


def is_level(loop: Loop) -> bool:
    """Return whether the force is level before a turning point: yielding, or cut off a little.

    Args:
        loop: one cycle.
    """
    branches = [loop.branch(rising=rising) for rising in (True, False)]
    return any(_level(loop, x[::-1], f[::-1]) for x, f in branches)


def _is_open(deflection: Array, force: Array, level: float) -> bool:
    """Return whether a force is the one of the unloaded device, that at the deflection nearest to zero."""
    distance = np.abs(deflection)
    near = distance <= distance.min() + _END * float(np.ptp(deflection))
    return bool(abs(level - np.median(force[near])) <= _END * float(np.ptp(force)))


def _level(loop: Loop, x: Array, f: Array) -> bool:
    """Return whether a branch is level beside the turning point that it begins at, for sure beside its noise."""
    near = np.abs(x - x[0]) <= _END * float(np.ptp(loop.deflection))
    if near.sum() < 3 or np.ptp(x[near]) == 0.0:
        return False
    slope, force = np.polyfit(x[near], f[near], 1)
    count, left = int(near.sum()), f[near] - force - slope * x[near]
    spread = max(float(np.linalg.norm(left)) / np.sqrt(count - 2), rms_noise(loop.force))
    error = spread / (np.sqrt(count) * float(x[near].std()))
    least = _ELASTIC * loop.secant_stiffness
    return bool(slope < _LEVEL * loop.secant_stiffness and slope + _ERRORS * error < least)
