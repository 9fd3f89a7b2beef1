"""At which frequency does 3.5 kg on one wire-rope isolator resonate on a shaker, and how does that depend on the level?

The rig of the thesis, section 3.4.2: the isolator softens as its wires slip, so the resonance falls as the level rises.
"""

import wirerope_mj as wr


def scenario(
    *,
    level_g: float = 0.5,
    start_hz: float = 5.0,
    stop_hz: float = 80.0,
    rate: float = 2.0,
    duration: float | None = None,
    callback: str = "native",
) -> wr.Scenario:
    """Return the sweep of one mass; the rig moves along z only.

    Args:
        level_g: acceleration amplitude of the table [g]; above 1 g the illustrative isolator says nothing.
        start_hz: first frequency [Hz].
        stop_hz: last frequency [Hz]; below the first the sweep goes down.
        rate: sweep rate [octaves/min].
        duration: simulated time [s]; the whole sweep if it is not given.
        callback: what makes the mount force: native or python.
    """
    if not 0.0 < level_g <= 1.0:
        raise ValueError(f"`level_g` must be above 0 and at most 1, for which the isolator was made, got {level_g}.")
    acceleration = level_g * wr.STANDARD_GRAVITY
    sweep = wr.Sweep(start=start_hz, stop=stop_hz, rate=rate, acceleration=acceleration, direction="z")
    return wr.Scenario(
        question=__doc__ or "",
        model="sdof_shaker.xml",
        motion=sweep,
        # Eight samples in the shortest period: peaks are taken from every step, not from the samples.
        simulate={
            "duration": sweep.duration if duration is None else duration,
            "sample_rate": 8.0 * max(start_hz, stop_hz),
            "callback": callback,
        },
    )
