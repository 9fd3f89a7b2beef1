"""Following a branch of periodic motions in the frequency or the level of the base's sine."""

import math
from collections.abc import Sequence
from pathlib import Path

import mujoco

from wirerope_mj.dynamics.periodic.branch import Branch
from wirerope_mj.dynamics.periodic.growing import GrowingBranch
from wirerope_mj.dynamics.periodic.orbit import OrbitSearch, PeriodicOrbit
from wirerope_mj.dynamics.periodic.storage import branch_options
from wirerope_mj.engine.control.install import STATE
from wirerope_mj.engine.simulation.progress import share_bar
from wirerope_mj.engine.simulation.simulate import check_direction
from wirerope_mj.engine.statics import History
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import integer, nonzero, positive
from wirerope_mj.foundation.directions import checked_direction
from wirerope_mj.foundation.state import State
from wirerope_mj.motions import Sine


def periodic_orbit(
    system: System, *, frequency: float, acceleration: float, direction: str | Sequence[float], periods: int = 1,
    guess: State | None = None, history: History = "relaxed", accuracy: float = 1e-4, tolerance: float = 1e-8,
    smoothing: float | None = None,
) -> PeriodicOrbit:  # fmt: skip
    """Find the periodic motion of `system` under a sine of its base, by shooting on the engine's state.

    Newton's method closes the gap between the state at phase 0 and that some periods later; the columns of its matrix are
    integrated in parallel. The base is prescribed: it is neither among the unknowns nor among the multipliers. Without a guess
    the system is simulated for a while from its equilibrium, longer if Newton's method fails from there.

    Args:
        system: the system.
        frequency: of the base [Hz].
        acceleration: amplitude of the base's acceleration [m/s^2].
        direction: of the base, "x", "y", "z" or a vector.
        periods: number of the base's periods after which the motion is to repeat itself; above 1 for subharmonics.
        guess: state at phase 0 to start from, for instance that of a neighbouring motion.
        history: equilibrium about which the motion is looked for; vibration lets the hysteretic part of the load leak away,
            so that only the relaxed one belongs to a periodic motion of most laws.
        accuracy: error of the integration allowed, relative to the motion's ranges.
        tolerance: largest residual.
        smoothing: fraction of the mounts' largest velocity over which the laws are smoothed, for instance 0.01; None
            leaves them as they are.

    Raises:
        ValueError: an argument is out of range.
        ModelError: the base has no driven slide in this direction.
        ConvergenceError: no periodic motion was found; states the residual and what was tried.
        SimulationError: the motion leaves a mount's rated travel or the validity of its law.
    """
    sine = Sine(
        frequency=positive("frequency", frequency), acceleration=nonzero("acceleration", acceleration),
        direction=checked_direction(direction),
    )  # fmt: skip
    integer("periods", periods, least=1)
    check_direction(system, sine)
    size = mujoco.mj_stateSize(system.model, STATE)
    if guess is not None and not isinstance(guess, State):
        raise ValueError(f"`guess` must be a State, as `PeriodicOrbit.state` is one; got {type(guess).__name__}.")
    if guess is not None and guess.values.shape != (size,):
        raise ValueError(f"`guess` has {guess.values.size} values; a state of this system has {size}.")
    search = OrbitSearch(
        system, direction=sine.direction, history=history, accuracy=positive("accuracy", accuracy), smoothing=smoothing
    )
    search.require_budget(sine.frequency, periods, 1.0)
    with search.flow.ready():
        return search.find(sine.frequency, sine.amplitude, periods, guess=guess, tolerance=positive("tolerance", tolerance))


def follow_branch(
    system: System, *, start: float, stop: float, acceleration: float | None = None, frequency: float | None = None,
    direction: str | Sequence[float], payload: str, response_direction: str | Sequence[float] | None = None, periods: int = 1,
    guess: State | None = None, history: History = "relaxed", accuracy: float = 1e-4, tolerance: float = 1e-6,
    smoothing: float | None = None, largest_step: float = 0.02, smallest_step: float = 1e-5, most_points: int = 3000,
    out: str | Path | None = None, progress: bool = False,
) -> Branch:  # fmt: skip
    """Follow the branch of periodic motions of `system` from `start` to `stop`, around folds if there are any.

    With `acceleration` given, `start` and `stop` are frequencies [Hz]; with `frequency` given they are accelerations [m/s^2].
    The branch is followed by pseudo-arclength continuation; folds and changes of stability are located on the way.

    Args:
        system: the system.
        start: first value of the parameter that is followed.
        stop: last value; from the higher to the lower one is allowed.
        acceleration: amplitude of the base's acceleration [m/s^2], to follow the frequency.
        frequency: of the base [Hz], to follow the acceleration.
        direction: of the base, "x", "y", "z" or a vector.
        payload: body whose acceleration is the branch's amplitude.
        response_direction: along which it is taken; that of the base unless given.
        periods: of the base after which the motions repeat themselves; above 1 for subharmonics.
        guess: state at phase 0 at `start` to begin from, for instance `PeriodicOrbit.state`.
        history: equilibrium about which the motions are looked for.
        accuracy: error of the integration allowed, relative to the motions' ranges.
        tolerance: largest residual of a point, relative to its ranges.
        smoothing: fraction of the mounts' largest velocity over which the laws are smoothed, from point to point; None
            leaves them as they are.
        largest_step: largest relative change of the parameter between two points.
        smallest_step: smallest one before the branch is given up.
        most_points: points after which it ends.
        out: folder that keeps the points as they are found; a branch that was interrupted there is resumed.
        progress: whether a progress bar is shown on standard error.

    Returns:
        The branch; `complete` says whether it reached `stop`, `message` why it ended.

    Raises:
        ValueError: an argument is out of range.
        ConvergenceError: there is no periodic motion at the start; states the residual and what was tried.
        SimulationError: the motion at the start leaves a mount's rated travel or the validity of its law.
        RecordError: `out` holds the branch of another system or of other arguments.
    """
    options = branch_options(
        system, acceleration=acceleration, frequency=frequency, direction=direction, payload=payload,
        response_direction=response_direction, periods=integer("periods", periods, least=1), history=history,
        most_points=integer("most_points", most_points, least=1), start=start, stop=stop, largest_step=largest_step,
        smallest_step=smallest_step, tolerance=tolerance, accuracy=accuracy,
        smoothing=smoothing,
    )  # fmt: skip
    search = OrbitSearch(system, direction=options.direction, history=history, accuracy=options.accuracy, smoothing=smoothing)
    apart = abs(math.log(options.stop / options.start)) / options.largest_step
    search.require_budget(
        frequency or max(options.start, options.stop), options.periods, min(max(apart, 1.0), options.most_points)
    )
    with search.flow.ready(), share_bar("following", "Hz" if frequency is None else "m/s^2", enabled=progress) as update:
        return GrowingBranch(search, options, None if out is None else Path(out)).follow(guess, update)
