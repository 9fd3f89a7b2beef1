"""Computing a frequency response: every level by itself, branches first."""

from collections.abc import Callable
from pathlib import Path
from time import perf_counter

from wirerope_mj.dynamics.frequency_response.result import FrequencyResponse, Level, ResponseOptions
from wirerope_mj.dynamics.periodic import follow_branch
from wirerope_mj.dynamics.periodic.storage import require_motion
from wirerope_mj.dynamics.sweep import FrequencySweep, frequency_sweep
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.errors import ConvergenceError, SimulationError
from wirerope_mj.motions import Sweep


def frequency_response(
    system: System, options: ResponseOptions, *, name: str = "", report: Callable[[str], None] | None = None,
    keep: Path | None = None, progress: bool = False,
) -> FrequencyResponse:  # fmt: skip
    """Return the branches and envelopes of a response at several levels.

    Args:
        system: the system.
        options: levels, method and range.
        name: what the result is called.
        report: called with a text before each step of the work.
        keep: folder that keeps the points of the branches as they are found, a folder for each level; what was interrupted
            there is resumed.
        progress: whether bars are shown on standard error.

    Raises:
        ValueError: an argument is out of range.
        ModelError: the base has no driven slide in this direction.
        ConvergenceError: there is no periodic motion at the start of a level.
        SimulationError: a mount leaves its rated travel at the start, or the validity of its law.
        RecordError: `keep` holds the branches of another system or of other options.
    """
    options = options.checked(system)
    levels = []
    for acceleration in options.accelerations:
        try:
            levels.append(_level(system, options, acceleration, report or (lambda text: None), keep, progress))
        except (ConvergenceError, SimulationError) as error:
            raise type(error)(f"level {acceleration:.4g} m/s^2: {error}") from None
    return FrequencyResponse(system=system, name=name, options=options, levels=tuple(levels))


def _level(
    system: System, options: ResponseOptions, acceleration: float, report: Callable[[str], None], keep: Path | None,
    progress: bool,
) -> Level:  # fmt: skip
    (start, stop), payload, along = options.range, options.payload, options.response_direction
    assert payload is not None
    assert along is not None
    branch, begun, sweeps, initial = None, perf_counter(), list[FrequencySweep](), None
    if options.method != "sweep":
        report(f"{acceleration:.4g} m/s^2: following periodic motions")
        branch = follow_branch(
            system, start=start, stop=stop, acceleration=acceleration, direction=options.direction, payload=payload,
            response_direction=along, periods=options.periods, largest_step=options.largest_step,
            smallest_step=options.smallest_step, smoothing=options.smoothing,
            out=None if keep is None else keep / f"{acceleration:.6g}_m_s2", progress=progress,
        )  # fmt: skip
    followed = perf_counter()
    if options.method != "continuation":
        report(f"{acceleration:.4g} m/s^2: sweeping up and down")
        for first, last in ((start, stop), (stop, start)):  # down from the final state of the one up
            sweep = Sweep(start=first, stop=last, rate=options.rate, acceleration=acceleration, direction=options.direction)
            swept = frequency_sweep(
                system, sweep, payload=payload, response_direction=along, initial=initial, progress=progress
            )
            require_motion(float(swept.amplitude.max(initial=0.0)), acceleration, payload, along)
            sweeps.append(swept)
            initial = swept.final_state
    up, down = sweeps or (None, None)
    return Level(
        acceleration=acceleration, branch=branch, up=up, down=down,
        branch_seconds=followed - begun, sweep_seconds=perf_counter() - followed,
    )  # fmt: skip
