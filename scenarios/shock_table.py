"""How far does one catalogue mount with 50 kg on it deflect in a shock, and what acceleration reaches the mass?

The table gives a half-sine, or a sudden velocity, which is what a pulse much shorter than the mount's period amounts to.
"""

import wirerope_mj as wr


def scenario(
    *,
    level_g: float = 20.0,
    pulse_ms: float = 11.0,
    velocity: float | None = None,
    direction: str = "z",
    duration: float = 1.0,
    callback: str = "native",
) -> wr.Scenario:
    """Return the shock of one mass on one mount.

    Args:
        level_g: peak acceleration of the half-sine [g].
        pulse_ms: length of the half-sine [ms].
        velocity: sudden velocity of the table [m/s], instead of the half-sine.
        direction: axis of the shock: x (roll), y (shear) or z.
        duration: simulated time [s].
        callback: what makes the mount force: native or python.
    """
    if velocity is not None:
        motion: wr.VelocityStep | wr.HalfSine = wr.VelocityStep(velocity=velocity, direction=direction, start=0.05)
    else:
        peak = level_g * wr.STANDARD_GRAVITY
        motion = wr.HalfSine(peak=peak, duration=1e-3 * pulse_ms, direction=direction, start=0.05)
    return wr.Scenario(
        question=__doc__ or "",
        model="shock_table.xml",
        motion=motion,
        simulate={"duration": duration, "sample_rate": 2000.0, "callback": callback},
    )
