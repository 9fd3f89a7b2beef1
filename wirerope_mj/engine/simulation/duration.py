"""Default duration of the simulation of a base motion."""

import math

from wirerope_mj.engine.simulation.stability import slowest_period
from wirerope_mj.engine.system import System
from wirerope_mj.motions import BaseMotion, Sweep

RING_DOWN = 10.0
"""Periods of the slowest mode that are simulated after the motion: at a damping ratio of a tenth a five-hundredth is left."""


def duration_of(motion: BaseMotion, duration: float | None, system: System) -> float:
    """Return the simulated time [s]: as given, or until ten periods of the slowest mode after the motion, or a sweep's end.

    Raises:
        ValueError: the motion has no end, or begins after the simulation.
    """
    if duration is None:
        if not math.isfinite(motion.end):
            raise ValueError('this motion has no end: give `duration`, or say how long it lasts, as in "for 10 s".')
        # A sweep goes on at its last frequency, and is best cut there.
        sweeps = any(isinstance(part, Sweep) for part in motion.parts)
        duration = motion.end
        if not sweeps:
            duration = math.ceil(10.0 * (motion.end + RING_DOWN * slowest_period(system)) - 1e-6) / 10.0
    if motion.events and duration <= motion.events[0][0]:
        raise ValueError(
            f"`duration` {duration:g} ends the simulation before anything begins, at {motion.events[0][0]:g} s."
        )
    return duration
