"""Up to which shock level do the floating floor's mounts stay within their travel, and how does the floor's acceleration grow?

The mounts' friction and stiffening make neither grow as the level does. Levels (motion/level) are in g.
"""

import wirerope_mj as wr


def study(
    *, low_g: float = 2.0, high_g: float = 30.0, levels: int = 29, direction: str = "xyz", duration: float = 0.6
) -> wr.Study:
    """Return the sweep of levels.

    Args:
        low_g: lowest peak acceleration along each axis [g].
        high_g: highest one [g].
        levels: how many, equally spaced.
        direction: axes along which the deck is struck: x, y, z, xy, xyz, ...
        duration: simulated time [s].
    """
    if not direction or not set(direction) <= set("xyz"):
        raise ValueError(f"`direction` must name axes, such as xyz or z, got {direction!r}.")
    # At 1 g, so that levels are in g.
    pulses = [wr.HalfSine(peak=wr.STANDARD_GRAVITY, duration=0.011, direction=axis, start=0.02) for axis in direction]
    return wr.Study(
        model="floating_floor.xml",
        motion=sum(pulses[1:], start=pulses[0]),
        duration=duration,
        vary={"motion/level": wr.Uniform(low_g, high_g, points=levels)},
        sampling="grid",
        accuracy=1e-3,
    )
