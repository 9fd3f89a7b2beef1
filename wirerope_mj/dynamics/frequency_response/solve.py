"""Computing a frequency response: every level by itself, branches first."""

from collections.abc import Callable
from pathlib import Path
from time import perf_counter

from wirerope_mj.dynamics.frequency_response.question import Question
from wirerope_mj.dynamics.frequency_response.result import FrequencyResponse, Level
from wirerope_mj.dynamics.periodic import Branch, follow_branch
from wirerope_mj.dynamics.sweep import FrequencySweep, frequency_sweep
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.errors import ConvergenceError, SimulationError
from wirerope_mj.motions import Sweep


def frequency_response(
    system: System,
    question: Question,
    *,
    name: str = "",
    report: Callable[[str], None] | None = None,
    keep: Path | None = None,
    progress: bool = False,
) -> FrequencyResponse:
    """Return the branches and envelopes that `question` asks for.

    Args:
        system: the system.
        question: what is asked.
        name: what the result is called.
        report: called with a few words before each part of the work.
        keep: folder that keeps the points of the branches as they are found, a folder for each level; what was interrupted
            there goes on.
        progress: whether bars are shown on standard error.

    Raises:
        ValueError: an argument is out of range.
        ModelError: the base has no driven slide in this direction.
        ConvergenceError: there is no periodic motion at the start of a level.
        SimulationError: a mount leaves its rated travel at the start, or the validity of its law.
        RecordError: `keep` holds the branches of another system or another question.
    """
    asked = question.checked(system)
    levels = []
    for acceleration in asked.accelerations:
        try:
            levels.append(_level(system, asked, acceleration, report or (lambda words: None), keep, progress))
        except (ConvergenceError, SimulationError) as error:
            raise type(error)(f"level {acceleration:.4g} m/s^2: {error}") from None
    return FrequencyResponse(system=system, name=name, question=asked, levels=tuple(levels))


def _level(
    system: System,
    asked: Question,
    acceleration: float,
    report: Callable[[str], None],
    keep: Path | None,
    progress: bool,
) -> Level:
    branch = up = down = None
    begun = perf_counter()
    if asked.method != "sweep":
        report(f"{acceleration:.4g} m/s^2: following periodic motions")
        branch = _branch(system, asked, acceleration, keep, progress)
    followed = perf_counter()
    if asked.method != "continuation":
        report(f"{acceleration:.4g} m/s^2: sweeping up and down")
        up, down = _sweeps(system, asked, acceleration, progress)
    return Level(
        acceleration=acceleration, branch=branch, up=up, down=down,
        branch_seconds=followed - begun, sweep_seconds=perf_counter() - followed,
    )  # fmt: skip


def _branch(system: System, asked: Question, acceleration: float, keep: Path | None, progress: bool) -> Branch:
    start, stop = asked.range
    assert asked.payload is not None
    return follow_branch(
        system, start=start, stop=stop, acceleration=acceleration, direction=asked.direction, payload=asked.payload,
        response_direction=asked.response_direction, periods=asked.periods, largest_step=asked.largest_step,
        smallest_step=asked.smallest_step, smoothing=asked.smoothing,
        out=None if keep is None else keep / f"{acceleration:.6g}_m_s2", progress=progress,
    )  # fmt: skip


def _sweeps(
    system: System, asked: Question, acceleration: float, progress: bool
) -> tuple[FrequencySweep, FrequencySweep]:
    """Return the sweep up, and the one down that goes on from its end."""
    low, high = asked.range
    assert asked.payload is not None
    assert asked.response_direction is not None
    initial, found = None, []
    for start, stop in ((low, high), (high, low)):
        sweep = Sweep(start=start, stop=stop, rate=asked.rate, acceleration=acceleration, direction=asked.direction)
        found.append(
            frequency_sweep(
                system,
                sweep,
                payload=asked.payload,
                response_direction=asked.response_direction,
                initial=initial,
                progress=progress,
            )  # fmt: skip
        )
        initial = found[-1].final_state
    return found[0], found[1]
