"""Computing a frequency response: every level by itself, branches first."""

from collections.abc import Callable
from pathlib import Path
from time import perf_counter

from wirerope_mj.dynamics.frequency_response.result import FrequencyResponse, Level, ResponseOptions
from wirerope_mj.dynamics.periodic import Branch, follow_branch
from wirerope_mj.dynamics.periodic.storage import require_motion
from wirerope_mj.dynamics.sweep import FrequencySweep, frequency_sweep
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.errors import ConvergenceError, SimulationError
from wirerope_mj.motions import Sweep


def frequency_response(
    system: System,
    options: ResponseOptions,
    *,
    name: str = "",
    report: Callable[[str], None] | None = None,
    keep: Path | None = None,
    progress: bool = False,
) -> FrequencyResponse:
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
    system: System,
    options: ResponseOptions,
    acceleration: float,
    report: Callable[[str], None],
    keep: Path | None,
    progress: bool,
) -> Level:
    branch = up = down = None
    begun = perf_counter()
    if options.method != "sweep":
        report(f"{acceleration:.4g} m/s^2: following periodic motions")
        branch = _branch(system, options, acceleration, keep, progress)
    followed = perf_counter()
    if options.method != "continuation":
        report(f"{acceleration:.4g} m/s^2: sweeping up and down")
        up, down = _sweeps(system, options, acceleration, progress)
    return Level(
        acceleration=acceleration, branch=branch, up=up, down=down,
        branch_seconds=followed - begun, sweep_seconds=perf_counter() - followed,
    )  # fmt: skip


def _branch(system: System, options: ResponseOptions, acceleration: float, keep: Path | None, progress: bool) -> Branch:
    start, stop = options.range
    assert options.payload is not None
    return follow_branch(
        system, start=start, stop=stop, acceleration=acceleration, direction=options.direction, payload=options.payload,
        response_direction=options.response_direction, periods=options.periods, largest_step=options.largest_step,
        smallest_step=options.smallest_step, smoothing=options.smoothing,
        out=None if keep is None else keep / f"{acceleration:.6g}_m_s2", progress=progress,
    )  # fmt: skip


def _sweeps(
    system: System, options: ResponseOptions, acceleration: float, progress: bool
) -> tuple[FrequencySweep, FrequencySweep]:
    """Return the sweep up, and the one down from its final state."""
    low, high = options.range
    assert options.payload is not None
    assert options.response_direction is not None
    initial, sweeps = None, []
    for start, stop in ((low, high), (high, low)):
        sweep = Sweep(start=start, stop=stop, rate=options.rate, acceleration=acceleration, direction=options.direction)
        sweeps.append(
            frequency_sweep(
                system,
                sweep,
                payload=options.payload,
                response_direction=options.response_direction,
                initial=initial,
                progress=progress,
            )  # fmt: skip
        )
        largest = float(sweeps[-1].amplitude.max(initial=0.0))
        require_motion(largest, acceleration, options.payload, options.response_direction)
        initial = sweeps[-1].final_state
    return sweeps[0], sweeps[1]
