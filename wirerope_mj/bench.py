"""The virtual cyclic test rig: force-deflection loops of one law."""

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from wirerope_mj.errors import ConvergenceError
from wirerope_mj.laws import Law, Loop

CLOSURE = 1e-10
"""A loop is closed when its last force equals its first within this share of its force range."""

_FIRST_CYCLES = 4
_MOST_CYCLES = (
    4096  # 1.6 million points at the default 400 per cycle: a few seconds, and 16 times what catalogue fits take
)


def cyclic_test(
    law: Law,
    amplitudes: npt.ArrayLike,
    *,
    operating_point: float = 0.0,
    frequency: float = 1.0,
    cycles: int | None = None,
    points_per_cycle: int = 400,
) -> list[Loop]:
    """Return one loop for each amplitude: the last cycle of a sinusoidal test about the operating point.

    Each test starts unloaded, ramps to the operating point and goes on as operating_point + amplitude sin(2 pi f t).
    For a law that depends on the rate a lead-in cycle, not counted, keeps the start of the motion out of the loop.

    Args:
        law: the restoring-force law under test.
        amplitudes: deflection amplitudes [m], one or (n,), > 0.
        operating_point: mean deflection [m].
        frequency: of the sine [Hz]; without effect on a rate-independent law.
        cycles: cycles to run; None: until the loop closes to 1e-10 of its force range. The loop's `cycles` and
            `closure` say how it ended.
        points_per_cycle: samples per cycle, a multiple of 4 so that the turning points are samples.

    Raises:
        ValueError: an argument is out of its range.
        ConvergenceError: the loop has not closed after 4096 cycles.
    """
    sizes = np.atleast_1d(np.asarray(amplitudes, dtype=np.float64))
    if sizes.ndim != 1 or sizes.size == 0 or not np.isfinite(sizes).all() or (sizes <= 0.0).any():
        raise ValueError(f"`amplitudes` must be finite and > 0, got {amplitudes!r}.")
    if not math.isfinite(operating_point):
        raise ValueError(f"`operating_point` must be finite, got {operating_point}.")
    if not (math.isfinite(frequency) and frequency > 0.0):
        raise ValueError(f"`frequency` must be finite and > 0, got {frequency}.")
    if cycles is not None and cycles < 1:
        raise ValueError(f"`cycles` must be >= 1, got {cycles}.")
    if points_per_cycle < 4 or points_per_cycle % 4:
        raise ValueError(f"`points_per_cycle` must be a multiple of 4 and >= 4, got {points_per_cycle}.")
    return [_test_one(law, float(size), operating_point, frequency, cycles, points_per_cycle) for size in sizes]


def _test_one(
    law: Law, amplitude: float, operating_point: float, frequency: float, cycles: int | None, points: int
) -> Loop:
    """Return the loop of one amplitude."""
    if cycles is not None:
        return _run(law, amplitude, operating_point, frequency, cycles, points)[-1]
    # Laws hand out no state to go on from: the test is run again with four times the cycles, a third more work in all.
    count = _FIRST_CYCLES
    while True:
        loops = _run(law, amplitude, operating_point, frequency, count, points)
        for loop in loops:
            if loop.closure <= CLOSURE:
                return loop
        if count >= _MOST_CYCLES:
            raise ConvergenceError(
                f"the loop of {law.name} at an amplitude of {amplitude:.6g} m about {operating_point:.6g} m has not "
                f"closed after {count} cycles: its ends still differ by {loops[-1].closure:.2g} of its force range, "
                f"where {CLOSURE:.0e} counts as closed. The memory of the start fades slowly at small amplitudes: try "
                "a larger one, or say how many `cycles` to run."
            )
        count *= 4


def _run(law: Law, amplitude: float, operating_point: float, frequency: float, cycles: int, points: int) -> list[Loop]:
    """Return the loops of all cycles of one test."""
    # The quarters are mirrored so that every cycle repeats the same numbers: closure is then the law's, not rounding's.
    quarter = np.sin(2.0 * np.pi * np.arange(points // 4 + 1) / points)
    half = np.concatenate([quarter, quarter[-2::-1]])
    cycle = operating_point + amplitude * np.concatenate([half[:-1], -half[:-1]])
    lead = 0 if law.rate_independent else 1
    ramp = np.array([0.0]) if operating_point != 0.0 else np.empty(0)
    # One sample beyond the last cycle: the rate at its end is then found as at its start.
    path = np.concatenate([ramp, np.tile(cycle, lead + cycles), cycle[:2]])
    time = np.arange(path.size) / (frequency * points)
    trace = law.trace(path, time=time)
    first = ramp.size + lead * points
    return [_cut(trace, first + index * points, points, index + 1) for index in range(cycles)]


def _cut(trace: Loop, start: int, points: int, cycle: int) -> Loop:
    """Return one cycle of a trace as a loop that knows its number and how well it closes."""
    part = slice(start, start + points + 1)
    force = trace.force[part]
    return replace(
        trace,
        deflection=trace.deflection[part],
        force=force,
        hysteretic_state=trace.hysteretic_state[part],
        work=trace.work[part] - trace.work[start],
        cycles=cycle,
        closure=float(abs(force[-1] - force[0]) / np.ptp(force)),
    )
