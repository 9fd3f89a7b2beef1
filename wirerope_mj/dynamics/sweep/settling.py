"""Steady response to a sine, after its transient."""

from dataclasses import dataclass

import numpy as np

from wirerope_mj.dynamics.sweep.channels import Channels
from wirerope_mj.dynamics.sweep.cycles import Extremes, at_start, stepping
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import Sine

FEWEST = 16
"""Cycles before which nothing is judged: four in each quarter."""

LOOK_EVERY = 4
"""A look is taken whenever the cycles have grown by one part in this."""

IN_A_ROW = 2
"""Looks that must agree: a slow beat may stand still at one of them. Of 1500 transients with decays of 1e-3 to 1 per cycle and
beats of every length 0.6 % were still taken for settled too early, those that turn once within a decay and begin where they
stand still; the wait was 1.7 times the shortest possible."""

SMALL = 1e-3
"""Amplitudes smaller than this fraction of the largest are judged relative to that fraction."""

SLOWEST = 1e6
"""Blocks that a decay may still take. Steady amplitudes repeat within some 1e-12, which is then at most 1e-6."""


@dataclass(frozen=True, kw_only=True)
class Steady:
    """Motion of a system after many cycles of a sine.

    Attributes:
        minimum, maximum: extremes of every channel in the last cycle, or in the last quarter of them if it has not settled,
            (n_channels, 3).
        state: at the end of the last cycle.
        cycles: number of cycles.
        steps: number of steps.
        largest_step: largest of them [s].
        remaining: estimated distance of the amplitudes from their limits, relative to them.
        settled: whether that is within the tolerance.
    """

    minimum: Array
    maximum: Array
    state: State
    cycles: int
    steps: int
    largest_step: float
    remaining: float
    settled: bool


def settle(
    system: System, motion: Sine, start: State, *, timestep: float, settled: float, largest_cycles: int
) -> Steady:
    """Return the motion after as many cycles of a sine as the amplitudes of all bodies need to settle.

    Args:
        system: the system.
        motion: the sine.
        start: state from which it begins; the system is carried along with the base.
        timestep: largest step [s].
        settled: relative distance from the limit at which an amplitude counts as settled.
        largest_cycles: number of cycles after which the wait ends.
    """
    bodies = Channels.of(system).bodies
    chunks: list[Extremes] = []
    cycles, agreeing, remaining = 0, 0, np.inf
    with stepping(system, motion, at_start(system, motion, start), timestep) as stepped:
        while agreeing < IN_A_ROW and cycles < largest_cycles:
            more = min(cycles // LOOK_EVERY if cycles else FEWEST, largest_cycles - cycles)
            chunks.append(stepped.run(np.arange(cycles, cycles + more + 1) / motion.frequency))
            cycles += more
            amplitudes = np.concatenate([chunk.largest[:, bodies] for chunk in chunks])
            remaining = distance_to_limit(amplitudes.reshape(cycles, -1))
            agreeing = agreeing + 1 if remaining <= settled else 0
        state = stepped.finish()
    done = agreeing == IN_A_ROW
    judged = 1 if done else max(cycles // 4, 1)
    return Steady(
        minimum=np.concatenate([chunk.minimum for chunk in chunks])[-judged:].min(axis=0),
        maximum=np.concatenate([chunk.maximum for chunk in chunks])[-judged:].max(axis=0),
        state=state,
        cycles=cycles,
        steps=stepped.steps,
        largest_step=stepped.largest_step,
        remaining=remaining,
        settled=done,
    )


def distance_to_limit(amplitudes: Array) -> float:
    """Return how far the amplitudes of successive cycles, (n, m), still are from their limits, the largest relative distance.

    The cycles are cut into quarters, and the first, in which transients mix, is left out. If the means of the other three
    change by d1 and then by d2, an exponential that passes through them has d2 r / (1 - r) left to go, r = d2 / d1, however
    small d2 is. What beats about the mean in the last quarter is left too. Infinite with fewer than `FEWEST` cycles.
    """
    block = amplitudes.shape[0] // 4
    if 4 * block < FEWEST:
        return np.inf
    quarters = amplitudes[-3 * block :].reshape(3, block, -1)
    means = quarters.mean(axis=1)
    scale = np.maximum(means[2], SMALL * means[2].max())
    first, second = np.abs(np.diff(means, axis=0))
    going = np.minimum(second, first) / np.maximum(first - second, first / SLOWEST + 1e-300)  # r / (1 - r)
    going = np.where(second >= first, SLOWEST, np.minimum(going, SLOWEST))
    beating = 0.5 * np.ptp(quarters[2], axis=0)
    left = np.maximum(second * going, beating)
    return float(np.max(np.where(left > 0.0, left, 0.0) / np.where(scale > 0.0, scale, 1.0)))
