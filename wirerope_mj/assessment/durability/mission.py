"""A service life as a file: runs, and how often each of them happens."""

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

from wirerope_mj.assessment.between_samples import sample_rate
from wirerope_mj.assessment.criteria.ended import too_short
from wirerope_mj.assessment.criteria.sampled import STEADY, elements, steady_interval
from wirerope_mj.assessment.durability import mount_cycles
from wirerope_mj.assessment.durability.mounts import Quantity
from wirerope_mj.engine.response import Response, load_response
from wirerope_mj.foundation.arguments import one_of, positive
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import RecordError, why_unread
from wirerope_mj.foundation.toml_file import toml_content

# By how much damage may change with every other sample alone: that of all samples is known better than that.
DAMAGE_ERROR = 0.01
NEGLIGIBLE = 0.01  # Damage over that of the worst mount and axis below which it does not matter how well it is known
PER_PERIOD = 100  # Samples to a period of the mean frequency of a deflection that are asked for where there are too few
# Kinds of motions that go on for hours, or of which a part that was measured stands for them.
_LASTING = STEADY | {"random-vibration", "record", "force-table"}
_SHORTEST = 0.05  # Fraction of a stationary vibration that a run must hold for hours of it to be counted
_KEYS = ("exponent", "quantity", "constant", "stage")
_STAGE_KEYS = ("run", "repetitions", "hours")


@dataclass(frozen=True, kw_only=True)
class Stage:
    """A run's folder, and how often it happens in a service life: `repetitions`, or as often as fits into `hours`."""

    run: Path
    repetitions: float | None = None
    hours: float | None = None


@dataclass(frozen=True, kw_only=True)
class Mission:
    """A service life."""

    stages: tuple[Stage, ...]  # what happens in it
    exponent: float  # b of the fatigue curve N = C / A^b
    quantity: Quantity = "deflection"  # of the mounts that is counted
    constant: float | None = None  # C, in the quantity's SI unit to the power b; None: damage is relative


@dataclass(frozen=True, kw_only=True)
class MountDamage:
    """Damage of an axis of a mount over a service life: of each stage, and how many cycles that are."""

    mount: str
    axis: str
    stages: tuple[float, ...]
    cycles: float
    largest_range: float

    @property
    def total(self) -> float:
        """Miner's sum over all stages."""
        return sum(self.stages)


def read_mission(path: str | Path) -> Mission:
    """Return the service life of a TOML file; folders of runs stand relative to it.

    RecordError if the file cannot be read, or a key is missing, unknown or out of its range.
    """
    file = Path(path)
    try:
        return _mission(toml_content(file), file.parent)
    except OSError as error:
        raise RecordError(f"{file}: {why_unread(error)}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise RecordError(f"{file}: this is not TOML: {error}") from None
    except ValueError as error:
        raise RecordError(f"{file}: {error}") from None


def _mission(content: Entries, folder: Path) -> Mission:
    _require_known(content, _KEYS)
    stages = content.get("stage")
    if not isinstance(stages, list) or not stages or not all(isinstance(stage, dict) for stage in stages):
        raise ValueError("there must be a table [[stage]] for each run of the service life.")
    if "exponent" not in content:
        raise ValueError("`exponent` of the fatigue curve is missing.")
    quantity = content.get("quantity", "deflection")
    one_of("quantity", quantity, get_args(Quantity))
    constant = content.get("constant")
    return Mission(
        stages=tuple(_stage(stage, folder) for stage in stages), exponent=positive("exponent", content["exponent"]),
        quantity=quantity, constant=None if constant is None else positive("constant", constant),
    )  # fmt: skip


def _stage(content: Entries, folder: Path) -> Stage:
    _require_known(content, _STAGE_KEYS)
    run = content.get("run")
    if not isinstance(run, str):
        raise ValueError("a [[stage]] must say the folder of its `run`.")
    often = [key for key in ("repetitions", "hours") if key in content]
    if len(often) != 1:
        raise ValueError(f"the stage {run!r} must say either `repetitions` or `hours`.")
    return Stage(run=folder / run, **{often[0]: positive(often[0], content[often[0]])})


def _require_known(content: Entries, known: tuple[str, ...]) -> None:
    for key in content:
        if key not in known:
            raise ValueError(f"`{key}` is not known; known: {', '.join(known)}.")


def mission_damage(mission: Mission) -> list[MountDamage]:
    """Return the damage of every mount and axis over a service life, the largest first.

    RecordError if the folder of a stage holds no run, its samples are too few, or its mounts are not those of the first.
    """
    found: dict[tuple[str, str], list[tuple[float, float, float]]] = {}
    coarse: list[tuple[float, float, float, Stage, float]] = []
    for number, stage in enumerate(mission.stages):
        response = load_response(stage.run)
        kinds = {part.get("kind") for part in elements(response.motion)}
        if (early := too_short(response)) and not kinds <= STEADY | {"random-vibration"}:
            raise RecordError(f"{stage.run}: {early}. What it does to the mounts is not over.")
        start, end, length = _counted(response, stage)
        times = stage.repetitions if stage.hours is None else 3600.0 * stage.hours / length
        assert times is not None
        for one in mount_cycles(response, quantity=mission.quantity, start=start, end=end):
            row = found.setdefault((one.mount, one.axis), [])
            damage = times * one.cycles.damage(mission.exponent, mission.constant or 1.0)
            row.append((damage, times * one.cycles.total, float(one.cycles.ranges.max(initial=0.0))))
            error = one.damage_error(mission.exponent)
            if error > DAMAGE_ERROR:
                coarse.append((damage, error, one.frequency, stage, sample_rate(response.time)))
        if any(len(row) != number + 1 for row in found.values()):
            raise RecordError(f"{stage.run}: the mounts of this run are not those of {mission.stages[0].run}.")
    damages = [
        MountDamage(
            mount=mount, axis=axis, stages=tuple(row[0] for row in rows), cycles=sum(row[1] for row in rows),
            largest_range=max(row[2] for row in rows),
        )
        for (mount, axis), rows in found.items()
    ]  # fmt: skip
    worst = max((one.total for one in damages), default=0.0)
    for damage, error, frequency, stage, rate in sorted(coarse, key=lambda one: -one[0]):
        if damage >= NEGLIGIBLE * worst or math.isinf(error):
            enough = max(PER_PERIOD * frequency, 2.0 * rate)
            why = (
                f"with every other of them the damage changes by {100.0 * error:.2g} %, and it must not by more than "
                f"{100.0 * DAMAGE_ERROR:g} %"
                if math.isfinite(error)
                else f"the mean frequency is {frequency:.4g} Hz"
            )
            raise RecordError(
                f"{stage.run}: {rate:.4g} samples a second are too few to count cycles: {why}. Run it again with a "
                f"`sample_rate` of {float(f'{enough:.1e}'):g} Hz."
            )
    return sorted(damages, key=lambda one: -one.total)


def _counted(response: Response, stage: Stage) -> tuple[float, float, float]:
    """Return the instants between which the cycles of a stage are counted, and how long that is of its `hours` [s]."""
    # Hours are of what goes on: of random vibration its stationary part, neither rise nor fall nor what follows; of sines,
    # sweeps and records from their start to their end, with all that follows. Repetitions are of the whole run. RecordError if
    # hours are asked for of a shock, or of random vibration of which the run holds too little.
    first, last = float(response.time[0]), float(response.time[-1])
    if stage.hours is None:
        return first, last, last - first
    random, rises, falls = steady_interval(response.motion)
    if random:
        start, end = max(rises, first), min(falls, last)
        if end - start < _SHORTEST * (falls - rises):
            text = f"{stage.run}: it holds too little of the stationary vibration from {rises:.4g} to {falls:.4g} s."
            raise RecordError(text)
        return start, end, end - start
    if shocks := sorted({str(part.get("kind")) for part in elements(response.motion)} - _LASTING):
        raise RecordError(
            f"{stage.run}: `hours` are of what goes on, and a {shocks[0]} is over once it has happened: an hour of it would "
            "be shocks as close as the run is long. Say how often it happens, as `repetitions`."
        )
    times = [time for time, _ in response.events if first <= time <= last] or [first]
    over = response.numerics.motion_end
    end = over if math.isfinite(over) else times[-1] if times[-1] > times[0] else last
    return first, last, min(end, last) - times[0]
