"""Checks for loops that no isolator has: noise alone, a force that falls or was clipped, energy given away."""

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws import Loop
from wirerope_mj.mounts.test_rig.turning import RecordedLoop, rms_noise

_SURE = 4.0  # standard errors: noise alone goes beyond once in 16 000
_NOISE_VARIANCE = 1.5  # variance of a series over that of its noise, below which noise is at least two thirds of what it shows
_PROBABILITY = 1e-4  # of noise to look like a cycle
_STRAIGHT = 1e-3  # of the force's range, within which a force that is a straight line over the deflection is a copy of it
_CYCLE_SHARE = 0.5  # fraction of the variance at one frequency that is a cycle, however few the samples
_VARIANCE_ERRORS = 6.0  # four standard errors of the variance of n samples, 4 sqrt(2 / n), rounded up


def is_noise(values: Array, noise: float) -> bool:
    """True if a series, (n,), is no more than noise of a standard deviation."""
    return bool(values.var() <= max(_NOISE_VARIANCE, 1.0 + _VARIANCE_ERRORS / np.sqrt(values.size)) * noise**2)


def has_cycle(force: Array) -> bool:
    """True if a force of one cycle [N], (n,), exceeds noise of its size at the cycle's frequency.

    Of n samples of white noise, the fraction r that one frequency has in their variance is exceeded with the probability
    (1 - r)^((n - 3) / 2), whatever the noise's size. The sample that repeats the first is left out.
    """
    first = np.abs(np.fft.rfft(force - force.mean())[1])
    fraction = 2.0 * first**2 / (force.size**2 * force.var())
    return bool(fraction > min(1.0 - _PROBABILITY ** (2.0 / (force.size - 3)), _CYCLE_SHARE))


def no_cycle_text(deflection: Array) -> str:
    noise = rms_noise(deflection)
    return (
        f"the deflection never changes by more than its noise, {1e3 * noise:.3g} mm, "
        f"{100.0 * min(noise / float(deflection.std()), 1.0):.3g} % of its rms value; there is no cycle."
    )


def force_noise(loop: Loop) -> float:
    """Estimate the standard deviation of the noise in a loop's forces [N].

    It is that from sample to sample, or what the averaged cycles differ by: noise of low frequency shows there alone.
    """
    return max(rms_noise(loop.force), loop.scatter if isinstance(loop, RecordedLoop) else 0.0)


def noise_text(loop: Loop) -> str:
    """Describe the noise of a loop's force, such as `noise of 12 N, 34 % of the force's rms value`."""
    noise, size = force_noise(loop), float(loop.force.std())
    return f"noise of {noise:.3g} N, {100.0 * min(noise / size, 1.0):.3g} % of the force's rms value"


def area_in_noise(loop: Loop) -> bool:
    """True if the area of a loop [J] is no larger than noise of force and deflection can make it.

    The area is the sum of f_i (x_i+1 - x_i-1) / 2, and of x_i (f_i-1 - f_i+1) / 2, over its samples: independent errors of f
    and x with the standard deviations s_f and s_x give its variance as s_f^2 sum dx_i^2 + s_x^2 sum df_i^2.
    """
    x, f = loop.deflection[:-1], loop.force[:-1]
    dx, df = (0.5 * (np.roll(values, -1) - np.roll(values, 1)) for values in (x, f))
    error = np.hypot(force_noise(loop) * np.linalg.norm(dx), rms_noise(loop.deflection) * np.linalg.norm(df))
    return bool(abs(loop.dissipated_energy) <= _SURE * error)


_WIDE = 0.05  # of the stroke over which a force that still moves cannot stand at one value, even at 8 bits
_NARROW = 0.005  # the same where no other value comes back as often: no converter's step, for it would be one of many
_REPEATS = 4  # times that the extreme comes back where others come back once: more than cycles of a mean, and neighbours
_MOVED_ON = 8.0  # standard deviations of the deflection's noise, of which it moved on for sure
_END = 0.05  # of the stroke beside a turning point
_LEVEL = 0.03  # of the secant stiffness: less than noise and any spring beside rope leave, 1/60 of how rope turns back
# Slope over the secant stiffness that whatever is elastic exceeds, and standard errors by which a level branch stays below
# it: what has a slope that its noise hides is not known to be level.
_ELASTIC, _ERRORS = 0.5, 3.0


def require_unclipped(deflection: Array, force: Array, location: str, *, stop: bool = False) -> None:
    """Raise ValueError if samples stand at exactly the extreme force while the deflection moves on.

    Over a twentieth of the stroke only saturation holds a force so. Over less, steps of a converter do, but then every value
    comes back as often as the extreme. A bump stop's force stands still within its gap. Deflections [m] and forces [N], (n_t,),
    are those of cycles like each other.
    """
    _, counts = np.unique(force, return_counts=True)
    usual = int(np.sort(counts)[-3]) if counts.size > 2 else 0  # either extreme apart
    for name, extreme in (("largest", force.max()), ("smallest", force.min())):
        at = force == extreme
        moved, stroke = float(np.ptp(deflection[at])), float(np.ptp(deflection))
        if stop and _is_open(deflection, force, extreme):
            continue
        alone = at.sum() >= _REPEATS * max(usual, 1) and moved > _MOVED_ON * rms_noise(deflection)
        if 3 < at.sum() < force.size and moved > (_NARROW if alone else _WIDE) * stroke:
            raise ValueError(
                f"{location}: {at.sum()} samples stand at exactly the {name} force, {extreme:.6g} N, over "
                f"{1e3 * moved:.3g} mm of deflection: the load cell or its amplifier was saturated. Leave the loop out."
            )


def require_falling(loop: Loop, location: str, *, stop: bool = False) -> None:
    """Raise ValueError if the force is level before and behind a turning point: clipped, with noise added later.

    What yields falls at once when the deflection turns back, at its elastic stiffness. Where the true force is beyond what was
    recorded, it does not. A bump stop's force stands still within its gap.
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
    """True if the force of a cycle is level before a turning point: yielding, or slightly clipped."""
    branches = [loop.branch(rising=rising) for rising in (True, False)]
    return any(_level(loop, x[::-1], f[::-1]) for x, f in branches)


def _is_open(deflection: Array, force: Array, level: float) -> bool:
    """True if a force `level` is that of the unloaded device, found at the deflections nearest to zero."""
    distance = np.abs(deflection)
    unloaded = distance <= distance.min() + _END * float(np.ptp(deflection))
    return bool(abs(level - np.median(force[unloaded])) <= _END * float(np.ptp(force)))


def _level(loop: Loop, x: Array, f: Array) -> bool:
    """True if a branch is level beside the turning point that it begins at, beyond what its noise can hide."""
    near = np.abs(x - x[0]) <= _END * float(np.ptp(loop.deflection))
    if near.sum() < 3 or np.ptp(x[near]) == 0.0:
        return False
    slope, force = np.polyfit(x[near], f[near], 1)
    count, residual = int(near.sum()), f[near] - force - slope * x[near]
    spread = max(float(np.linalg.norm(residual)) / np.sqrt(count - 2), rms_noise(loop.force))
    error = spread / (np.sqrt(count) * float(x[near].std()))
    least = _ELASTIC * loop.secant_stiffness
    return bool(slope < _LEVEL * loop.secant_stiffness and slope + _ERRORS * error < least)


_THIN = 0.01  # of stroke times force range: an area that a lag by 1/80 of a radian takes away
_ROUNDING = 1e-9  # of the force, within which it stands still: a drift of the zero was taken out


def require_passive(loop: Loop, location: str, *, stop: bool = False) -> None:
    """Raise ValueError if a loop cannot be that of an isolator: no force, noise alone, a wrong sign, or energy given away.

    A bump stop has no force within its gap.
    """
    if not stop and np.ptp(loop.force) == 0.0:
        raise ValueError(f"{location}: the force never changes, it stands at {loop.force[0]:.6g} N.")
    if not stop and (is_noise(loop.force[:-1], force_noise(loop)) or not has_cycle(loop.force[:-1])):
        raise ValueError(
            f"{location}: the force is {noise_text(loop)}: it does not follow the deflection of "
            f"+-{1e3 * loop.amplitude:.4g} mm. Was this channel connected, and is its range right? Leave the loop out, or "
            "measure more cycles of it."
        )
    if stop and np.ptp(loop.force) <= _ROUNDING * np.abs(loop.force).max():
        return
    tips = abs(loop.secant_stiffness) * 2.0 * loop.amplitude  # by which the forces at the turning points differ
    if loop.secant_stiffness < 0.0 and tips > _SURE * np.sqrt(2.0) * force_noise(loop):
        raise ValueError(
            f"{location}: the force falls where the deflection grows; both are positive in tension. It has {noise_text(loop)}."
        )
    thin = abs(loop.dissipated_energy) < _THIN * np.ptp(loop.deflection) * np.ptp(loop.force)
    if loop.dissipated_energy < 0.0 and not (thin or area_in_noise(loop)):
        raise ValueError(
            f"{location}: the cycle gives {-loop.dissipated_energy:.3g} J away, and no isolator does. Are the columns of "
            "deflection and force swapped, is the order of the samples that of time, and do both channels have the same "
            f"filter? The force has {noise_text(loop)}."
        )


def require_area(loop: Loop, location: str) -> None:
    """Raise ValueError if a loop that has passed `require_passive` shows no stiffness or no area beside its noise."""
    cycle = f"{location}: the cycle of +-{1e3 * loop.amplitude:.4g} mm"
    straight = np.polynomial.Polynomial.fit(loop.deflection, loop.force, 1)
    if np.abs(loop.force - straight(loop.deflection)).max() < _STRAIGHT * float(np.ptp(loop.force)):
        raise ValueError(
            f"{cycle} has a force that is {loop.secant_stiffness:.4g} N/m times the deflection, without any loop, as no sensor "
            "of a wire rope shows: is it the channel of the deflection once more?"
        )
    if loop.secant_stiffness < 0.0 or (loop.dissipated_energy <= 0.0 and area_in_noise(loop)):
        lack = "shows no stiffness" if loop.secant_stiffness < 0.0 else "encloses no area"
        raise ValueError(f"{cycle} {lack} beside its noise ({noise_text(loop)}); leave it out, or measure more cycles of it.")
    if loop.dissipated_energy <= 0.0:
        raise ValueError(
            f"{cycle} encloses no area: it gives {-loop.dissipated_energy:.3g} J away, so little that one channel lagging "
            "shortly behind the other does it. Leave it out, or give both channels the same filter."
        )
