"""Does an 850 kg rack on six mounts and four stabilisers survive a 20 g, 11 ms sawtooth within the travel of its mounts?

A terminal-peak sawtooth strikes deck and bulkhead together while the rack stands settled.
"""

import wirerope_mj as wr


def scenario(
    *,
    level_g: float = 20.0,
    direction: str = "z",
    pulse_ms: float = 11.0,
    duration: float = 1.5,
    callback: str = "native",
) -> wr.Scenario:
    """Return the shock of the rack.

    Args:
        level_g: peak acceleration of the sawtooth [g].
        direction: axis of the shock: x (front to back), y (sideways) or z.
        pulse_ms: length of the sawtooth [ms].
        duration: simulated time [s].
        callback: what makes the mount forces: native or python.
    """
    peak = level_g * wr.STANDARD_GRAVITY
    return wr.Scenario(
        question=__doc__ or "",
        model="cabinet.xml",
        motion=wr.Sawtooth(peak=peak, duration=1e-3 * pulse_ms, direction=direction, start=0.05),
        simulate={"duration": duration, "sample_rate": 1000.0, "callback": callback},
    )
