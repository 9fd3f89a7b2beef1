"""From which direction does a shock of one strength do the floating floor's mounts the most harm?

A half-sine comes from everywhere on the sphere: azimuth from forward (x) to port (y), elevation from down to up.
"""

import wirerope_mj as wr


def study(*, level_g: float = 20.0, step_deg: float = 15.0, duration: float = 0.6) -> wr.Study:
    """Return the sweep of directions.

    Args:
        level_g: peak acceleration along the direction [g].
        step_deg: angle between neighbouring directions [deg]; it must divide 90.
        duration: simulated time [s].
    """
    if not 0.0 < step_deg <= 90.0 or 90.0 % step_deg:
        raise ValueError(f"`step_deg` must divide 90, got {step_deg:g}.")
    parts = round(90.0 / step_deg)
    return wr.Study(
        model="floating_floor.xml",
        motion=wr.HalfSine(peak=level_g * wr.STANDARD_GRAVITY, duration=0.011, direction="x", start=0.02),
        duration=duration,
        vary={
            "motion/azimuth": wr.Uniform(-180.0, 180.0, points=4 * parts + 1),
            "motion/elevation": wr.Uniform(-90.0, 90.0, points=2 * parts + 1),
        },
        sampling="grid",
        accuracy=1e-3,
    )
