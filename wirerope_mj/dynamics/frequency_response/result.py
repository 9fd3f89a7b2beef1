"""A frequency response: its options, a branch and sweeps at each level, and its tables in Parquet files."""

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter
from typing import Literal

import numpy as np

from wirerope_mj.dynamics.periodic import Branch, follow_branch, periodic_orbit
from wirerope_mj.dynamics.periodic.storage import check_steps, require_motion
from wirerope_mj.dynamics.sweep import FrequencySweep, frequency_sweep
from wirerope_mj.engine.simulation.simulate import check_direction
from wirerope_mj.engine.simulation.stability import eigenvalues
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import integer, one_of, positive
from wirerope_mj.foundation.arrays import AnyArray
from wirerope_mj.foundation.directions import Direction, checked_direction, direction_text, unit_vector
from wirerope_mj.foundation.errors import ConvergenceError, ModelError, SimulationError
from wirerope_mj.foundation.parquet_files import write_columns
from wirerope_mj.motions import Sine, Sweep
from wirerope_mj.mounts.isolator import AXES

Method = Literal["sweep", "continuation", "both"]
# Default range: from a quarter of the lowest natural frequency, where the superharmonic resonances of order 2 and 3 lie
# above, to twice the highest, where every mount isolates.
BELOW, ABOVE = 4.0, 2.0
# Widest range over the lowest and the highest natural frequency: beyond it the payload follows its base within 1e-4, or rests
# within 1e-4 of it, so that rounding makes the steps of a branch ever smaller.
BEYOND = 100.0
# Natural frequencies below this fraction of the highest belong to motions without a mount's stiffness [-].
STILL = 1e-3
# Parts of the way to the end of the range, at which a start is tried in place of one that has no periodic motion.
OTHER_STARTS = (0.02, 0.1, 0.3)
BRANCHES, SWEEPS = "branches.parquet", "sweeps.parquet"


@dataclass(frozen=True, kw_only=True)
class ResponseOptions:
    """Levels, method and range of a frequency response; `checked` fills in defaults."""

    accelerations: tuple[float, ...]  # levels of the base's acceleration [m/s^2]
    method: Method = "continuation"  # "continuation", "sweep" or "both"
    direction: Direction = "z"
    payload: str | None = None  # body whose acceleration is the amplitude; None: the first payload
    response_direction: Direction | None = None  # direction of that acceleration; None: that of the base
    # start, stop: range [Hz]; None: from the system's natural frequencies
    start: float | None = None
    stop: float | None = None
    rate: float = 1.0  # of the sweeps [octaves/min]
    periods: int = 1  # number of the base's periods after which the motions repeat themselves
    # largest_step, smallest_step: of the continuation, relative to the frequency
    largest_step: float = 0.02
    smallest_step: float = 1e-5
    # fraction of the mounts' largest velocity over which the continuation smooths the laws; None: as they are
    smoothing: float | None = None
    range_from: str = "given"  # origin of the range as text; set by `checked`

    def checked(self, system: System) -> "ResponseOptions":
        """Check the options and fill in the payload, response direction and range if they are None.

        Raises:
            ValueError: a level, the range, a step, the payload or a direction is not valid.
            ModelError: the base is not driven in this direction, or nothing is mounted on it.
        """
        levels = tuple(positive("acceleration", level) for level in self.accelerations)
        if not levels or len(set(levels)) < len(levels):
            raise ValueError(f"`acceleration` must be one or several different levels, got {list(levels)}.")
        direction = checked_direction(self.direction)
        along = direction
        if self.response_direction is not None:
            along = checked_direction(self.response_direction, "response_direction")
        if self.method != "continuation" and np.count_nonzero(unit_vector(along)) > 1:
            raise ValueError(
                f"`response_direction` must lie along x, y or z for sweeps, whose envelopes are kept along these axes; got "
                f"{direction_text(along)}. Follow the motions only: method continuation."
            )
        check_direction(system, Sine(frequency=1.0, acceleration=1.0, direction=direction))
        if not system.payloads:
            raise ModelError("the model has no payload: no mount carries a body.")
        payload = one_of("payload", self.payload or system.payloads[0], system.payloads)
        start, stop, range_from = _range(system, self.start, self.stop)
        periods = integer("periods", self.periods, least=1)
        if self.method == "sweep" and (self.smoothing is not None or periods != 1):
            raise ValueError("`smoothing` and `periods` belong to the continuation: a sweep has neither. Leave them out.")
        largest, smallest = positive("largest_step", self.largest_step), positive("smallest_step", self.smallest_step)
        check_steps(smallest, largest)
        return ResponseOptions(
            accelerations=tuple(sorted(levels)), method=self.method, direction=direction,
            payload=payload, response_direction=along, start=start, stop=stop,
            rate=positive("rate", self.rate), periods=periods, largest_step=largest, smallest_step=smallest,
            smoothing=None if self.smoothing is None else positive("smoothing", self.smoothing), range_from=range_from,
        )  # fmt: skip

    @property
    def range(self) -> tuple[float, float]:
        assert self.start is not None
        assert self.stop is not None
        return self.start, self.stop


def _range(system: System, start: float | None, stop: float | None) -> tuple[float, float, str]:
    """Check the range [Hz] or choose it from the natural frequencies; returns also its origin as text."""
    values, source = np.abs(np.imag(eigenvalues(system))) / (2.0 * math.pi), "given"
    # on unloaded mounts, where they are stiffest; each appears with both signs of its imaginary part
    natural = sorted(values[values > STILL * values.max(initial=0.0)].tolist())[::2]
    if start is None or stop is None:
        if not natural:
            raise ModelError("the system has no natural frequency that a range could be taken from; give `start` and `stop`.")
        several = f" to {natural[-1]:.3g}" if len(natural) > 1 else ""
        source = f"from the system's natural frequencies of {natural[0]:.3g}{several} Hz on its unloaded mounts"
        start = float(f"{natural[0] / BELOW:.2g}") if start is None else start
        stop = float(f"{natural[-1] * ABOVE:.2g}") if stop is None else stop
    low, high = positive("start", start), positive("stop", stop)
    if low >= high:
        raise ValueError(f"`stop` must be above `start`, got {low:g} to {high:g} Hz; sweeps go up and then down again.")
    if natural and not natural[0] / BEYOND <= low < high <= natural[-1] * BEYOND:
        raise ValueError(
            f"`start` and `stop` must lie between {natural[0] / BEYOND:.3g} and {natural[-1] * BEYOND:.3g} Hz, {BEYOND:.0f} "
            f"times beyond the system's natural frequencies, got {low:g} to {high:g} Hz. Take a narrower range."
        )
    return low, high, source


@dataclass(frozen=True, kw_only=True)
class Level:
    """The response to one level of the base's acceleration."""

    acceleration: float  # amplitude of the base's acceleration [m/s^2]
    branch: Branch | None = None  # periodic motions over frequency; None if the method is "sweep"
    # up, down: envelopes of a sweep up and of one down from its final state; None if the method is "continuation"
    up: FrequencySweep | None = None
    down: FrequencySweep | None = None
    # branch_seconds, sweep_seconds: their computing times
    branch_seconds: float = 0.0
    sweep_seconds: float = 0.0

    @property
    def sweeps(self) -> dict[str, FrequencySweep]:
        return {direction: sweep for direction, sweep in (("up", self.up), ("down", self.down)) if sweep is not None}

    def transmissibility(self, amplitude: float) -> float:
        return amplitude / self.acceleration

    @property
    def complete(self) -> bool:
        """True if the branch, if there is one, reached the end of the range."""
        return self.branch is None or self.branch.complete


@dataclass(frozen=True, kw_only=True)
class FrequencyResponse:
    """The response of a system to sines of its base over a range of frequencies, at one level or several, lowest first."""

    system: System = field(repr=False)
    name: str
    options: ResponseOptions
    levels: tuple[Level, ...]

    @property
    def complete(self) -> bool:
        """True if every branch reached the end of the range."""
        return all(level.complete for level in self.levels)

    @property
    def branches(self) -> tuple[Branch, ...]:
        """Branches of all levels that have one."""
        return tuple(level.branch for level in self.levels if level.branch is not None)


def save_tables(result: FrequencyResponse, folder: Path) -> None:
    """Write the tables of branches and sweeps into `folder`; SI units, float64."""
    tables: dict[str, list[dict[str, AnyArray]]] = {BRANCHES: [], SWEEPS: []}
    width = max((branch.floquet_multipliers.shape[1] for branch in result.branches), default=0)
    same = ("frequency", "acceleration", "amplitude", "transmissibility", "stable", "neutral", "residual", "steps")
    for number, level in enumerate(result.levels):
        if (branch := level.branch) is not None:
            n = branch.frequency.size
            multipliers = np.full((n, width), complex(np.nan, np.nan))
            multipliers[:, : branch.floquet_multipliers.shape[1]] = branch.floquet_multipliers
            events = np.full(n, "", dtype=object)
            for event in branch.bifurcations:
                events[event.index] = event.description
            columns: dict[str, AnyArray] = {
                "level": np.full(n, number), "point": np.arange(n), **{name: getattr(branch, name) for name in same},
                "smoothing_width": branch.smoothing_width, "bifurcation": events,
            }  # fmt: skip
            for i, values in enumerate(multipliers.T, start=1):
                columns |= {f"multiplier_{i}/re": values.real, f"multiplier_{i}/im": values.imag}
            columns |= {f"unknown/{i}": branch.unknowns[:, i] for i in range(branch.unknowns.shape[1])}
            tables[BRANCHES].append(columns)
        for direction, sweep in level.sweeps.items():
            n = sweep.frequency.size
            columns = {
                "level": np.full(n, number), "way": np.array([direction] * n, dtype=object), "frequency": sweep.frequency,
                "acceleration": np.full(n, level.acceleration), "base_amplitude": sweep.base_amplitude,
                "amplitude": sweep.amplitude, "transmissibility": sweep.transmissibility,
            }  # fmt: skip
            for body, envelope in sweep.envelopes.items():
                columns |= {f"bodies/{body}/acceleration/{c}": envelope.acceleration[:, i] for i, c in enumerate("xyz")}
            for name, mount in sweep.mounts.items():
                for extreme, values in (("lowest", mount.minimum), ("highest", mount.maximum)):
                    columns |= {f"mounts/{name}/{extreme}/{c}": values[:, i] for i, c in enumerate(AXES)}
            tables[SWEEPS].append(columns)
    for file, parts in tables.items():
        if parts:
            write_columns(folder / file, {name: np.concatenate([part[name] for part in parts]) for name in parts[0]})


def frequency_response(
    system: System, options: ResponseOptions, *, name: str = "", report: Callable[[str], None] | None = None,
    keep: Path | None = None, progress: bool = False,
) -> FrequencyResponse:  # fmt: skip
    """Compute branches of periodic motions and envelopes of sweeps at several levels of the base's acceleration.

    Args:
        system: the system.
        options: levels, method and range.
        name: name of the result.
        report: called with a text before each step of the work.
        keep: folder that keeps the points of the branches as they are found, a folder for each level; an interrupted branch
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
        except SimulationError as error:
            raise SimulationError(f"level {acceleration:.4g} m/s^2: {error}") from None
        except ConvergenceError as error:
            tried = [options.range[0] + part * (options.range[1] - options.range[0]) for part in OTHER_STARTS]
            beside = f"None was found at {' and '.join(f'{frequency:.6g}' for frequency in tried)} Hz either."
            for frequency in tried:
                with suppress(ConvergenceError, SimulationError):
                    periodic_orbit(
                        system, frequency=frequency, acceleration=acceleration, direction=options.direction,
                        periods=options.periods, smoothing=options.smoothing,
                    )  # fmt: skip
                    beside = (
                        f"At {frequency:.6g} Hz there is a periodic motion, found here: --start {frequency:.6g} begins with it."
                    )
                    break
            raise ConvergenceError(f"level {acceleration:.4g} m/s^2: {error} {beside}") from None
    return FrequencyResponse(system=system, name=name, options=options, levels=tuple(levels))


def _level(
    system: System, options: ResponseOptions, acceleration: float, report: Callable[[str], None], keep: Path | None,
    progress: bool,
) -> Level:  # fmt: skip
    """Compute the branch and the sweeps up and down of one level [m/s^2], by the options' method."""
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
