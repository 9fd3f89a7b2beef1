"""Which one of the floating floor's mounts may fail without the others leaving their travel?

Each mount in turn carries nothing, and the floor stands on the rest before the shock strikes along three axes at once.
"""

import wirerope_mj as wr


def study(*, level_g: float = 15.0, direction: str = "xyz", duration: float = 0.6) -> wr.Study:
    """Return the study of failed mounts.

    Args:
        level_g: peak acceleration along each axis [g].
        direction: axes along which the deck is struck: x, y, z, xy, xyz, ...
        duration: simulated time [s].
    """
    if not direction or not set(direction) <= set("xyz"):
        raise ValueError(f"`direction` must name axes, such as xyz or z, got {direction!r}.")
    peak = level_g * wr.STANDARD_GRAVITY
    pulses = [wr.HalfSine(peak=peak, duration=0.011, direction=axis, start=0.02) for axis in direction]
    mounts = [f"m{number:02d}" for number in range(1, 17)] + [f"h{number}" for number in range(1, 5)]
    return wr.Study(
        model="floating_floor.xml",
        motion=sum(pulses[1:], start=pulses[0]),
        duration=duration,
        vary={"mount/*/failed": wr.Choice("", *mounts)},
        sampling="grid",
        accuracy=1e-3,
    )
