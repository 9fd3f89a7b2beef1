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
    around = [step_deg * part for part in range(-2 * parts, 2 * parts)]
    up = [step_deg * part for part in range(-parts, parts + 1)]
    directions = [(azimuth, elevation) for elevation in up for azimuth in (around if abs(elevation) < 90.0 else [0.0])]
    return wr.Study(
        model="floating_floor.xml",
        motion=wr.HalfSine(peak=level_g * wr.STANDARD_GRAVITY, duration=0.011, direction="x", start=0.02),
        duration=duration,
        vary={
            "motion/azimuth": wr.Choice([azimuth for azimuth, _ in directions]),
            "motion/elevation": wr.Choice([elevation for _, elevation in directions]),
        },
        sampling="list",
        accuracy=1e-3,
    )
