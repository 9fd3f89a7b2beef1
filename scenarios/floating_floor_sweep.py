"""Where do the modes of the floating floor lie, and how much do they amplify, when the deck vibrates at constant acceleration?

The sweep rises slowly enough for every resonance to build up; the loops show how stiffness and damping change with amplitude.
"""

import wirerope_mj as wr


def scenario(
    *,
    level_g: float = 0.2,
    direction: str = "z",
    start_hz: float = 2.0,
    stop_hz: float = 30.0,
    rate: float = 2.0,
    duration: float | None = None,
    callback: str = "native",
) -> wr.Scenario:
    """Return the sweep of the floating floor.

    Args:
        level_g: acceleration amplitude of the deck [g].
        direction: axis along which the deck vibrates: x, y or z.
        start_hz: first frequency [Hz].
        stop_hz: last frequency [Hz]; below the first the sweep goes down.
        rate: sweep rate [octaves/min].
        duration: simulated time [s]; the whole sweep if it is not given.
        callback: what makes the mount forces: native or python.
    """
    acceleration = level_g * wr.STANDARD_GRAVITY
    sweep = wr.Sweep(start=start_hz, stop=stop_hz, rate=rate, acceleration=acceleration, direction=direction)
    return wr.Scenario(
        question=__doc__ or "",
        model="floating_floor.xml",
        motion=sweep,
        # Eight samples in the shortest period: peaks are taken from every step, not from the samples.
        simulate={
            "duration": sweep.duration if duration is None else duration,
            "sample_rate": 8.0 * max(start_hz, stop_hz),
            "callback": callback,
        },
    )
