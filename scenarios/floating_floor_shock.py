"""Does the floating floor keep its equipment below the deck's shock, and do its mounts stay within their travel?

A half-sine along every chosen axis at once strikes the deck while the floor stands settled on its mounts.
"""

import wirerope_mj as wr


def scenario(
    *,
    level_g: float = 9.0,
    direction: str = "xyz",
    pulse_ms: float = 11.0,
    duration: float = 2.0,
    callback: str = "native",
) -> wr.Scenario:
    """Return the shock of the floating floor.

    Args:
        level_g: peak acceleration along each axis [g]; 9 leaves a margin, 15 exceeds the travel of most mounts.
        direction: axes along which the deck is struck: x, y, z, xy, xyz, ...
        pulse_ms: length of the half-sine [ms].
        duration: simulated time [s].
        callback: what makes the mount forces: native or python.
    """
    if not direction or not set(direction) <= set("xyz"):
        raise ValueError(f"`direction` must name axes, such as xyz or z, got {direction!r}.")
    peak = level_g * wr.STANDARD_GRAVITY
    pulses = [wr.HalfSine(peak=peak, duration=1e-3 * pulse_ms, direction=axis, start=0.05) for axis in direction]
    return wr.Scenario(
        question=__doc__ or "",
        model="floating_floor.xml",
        motion=pulses[0] if len(pulses) == 1 else sum(pulses[1:], start=pulses[0]),
        simulate={"duration": duration, "sample_rate": 1000.0, "callback": callback},
    )
