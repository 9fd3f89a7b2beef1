"""Checks that a measured loop could be that of an isolator, which gives nothing away and pushes back."""

import numpy as np

from wirerope_mj.mounts.laws import Loop
from wirerope_mj.mounts.test_rig.noise import (
    area_in_noise,
    force_noise,
    has_cycle,
    is_noise,
    noise_text,
    stiffness_in_noise,
)

_THIN = 0.01  # of stroke times force range: an area that a lag by 1/80 of a radian takes away

_ROUNDING = 1e-9  # of the force, within which it stands still: a drift of the zero was taken out


def require_passive(loop: Loop, location: str, *, stop: bool = False) -> None:
    """Raise ValueError if a loop cannot be that of an isolator: no force, noise alone, a wrong sign, or energy given away.

    Args:
        loop: one cycle, or the mean of some.
        location: it stands, as text.
        stop: whether the device is a bump stop, which has no force within its gap.
    """
    if not stop:
        _require_force(loop, location)
    elif np.ptp(loop.force) <= _ROUNDING * np.abs(loop.force).max():
        return
    if loop.secant_stiffness < 0.0 and not stiffness_in_noise(loop):
        raise ValueError(
            f"{location}: the force falls where the deflection grows; both are positive in tension. It has {noise_text(loop)}."
        )
    if loop.dissipated_energy < 0.0 and not (_is_thin(loop) or area_in_noise(loop)):
        raise ValueError(
            f"{location}: the cycle gives {-loop.dissipated_energy:.3g} J away, and no isolator does. Is the order of the "
            f"samples that of time, and do both channels have the same filter? The force has {noise_text(loop)}."
        )


def _require_force(loop: Loop, location: str) -> None:
    """Raise ValueError if a loop holds no force but noise."""
    if np.ptp(loop.force) == 0.0:
        raise ValueError(f"{location}: the force never changes, it stands at {loop.force[0]:.6g} N.")
    if is_noise(loop.force[:-1], force_noise(loop)) or not has_cycle(loop.force[:-1]):
        raise ValueError(
            f"{location}: the force is {noise_text(loop)}: it does not follow the deflection of "
            f"+-{1e3 * loop.amplitude:.4g} mm. Was this channel connected, and is its range right? Leave the loop out, or "
            "measure more cycles of it."
        )


def require_area(loop: Loop, location: str) -> None:
    """Raise ValueError if the loop of a `require_passive` device shows no stiffness or no area.

    Args:
        loop: one cycle, or the mean of some.
        location: it stands, as text.
    """
    cycle = f"{location}: the cycle of +-{1e3 * loop.amplitude:.4g} mm"
    if loop.secant_stiffness < 0.0 or (loop.dissipated_energy <= 0.0 and area_in_noise(loop)):
        lack = "shows no stiffness" if loop.secant_stiffness < 0.0 else "encloses no area"
        raise ValueError(
            f"{cycle} {lack} beside its noise ({noise_text(loop)}); leave it out, or measure more cycles of it."
        )
    if loop.dissipated_energy <= 0.0:
        raise ValueError(
            f"{cycle} encloses no area: it gives {-loop.dissipated_energy:.3g} J away, so little that one channel lagging "
            "shortly behind the other does it. Leave it out, or give both channels the same filter."
        )


def _is_thin(loop: Loop) -> bool:
    """Return whether the area of a loop is small beside the rectangle about it."""
    return bool(abs(loop.dissipated_energy) < _THIN * np.ptp(loop.deflection) * np.ptp(loop.force))
