"""Cycles of the mounts of a run, and damage over a service life: a file of runs and how often each of them happens."""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

import numpy as np

from wirerope_mj.assessment.criteria.ended import too_short
from wirerope_mj.assessment.criteria.sampled import STEADY, elements, parabolas, path, sample_rate, steady_interval
from wirerope_mj.assessment.durability.cycles import Cycles, rainflow_cycles
from wirerope_mj.engine.response import Response, load_response
from wirerope_mj.engine.response.scene import SceneMount
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import rotation_matrices
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.structure import Key, Place, Positive, structure
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.mounts.isolator import AXES

Quantity = Literal["deflection", "force"]
_LEAST_SAMPLES = 16  # Least samples for an error estimate from every other sample
# Least samples to a period of the mean frequency for it: of a steady vibration fewer may repeat themselves and look alike.
_LEAST_PER_PERIOD = 4.0

ROUNDING = 1e-8  # deflection that bodies far away leave where nothing bends [m]


@dataclass(frozen=True, kw_only=True)
class MountCycles:
    """Cycles of one axis of a mount: of its deflection [m] or its force [N]."""

    mount: str
    axis: str  # "roll", "shear" or "axial"
    cycles: Cycles  # from the turning points, also between the samples
    # cycles of all samples and of every other sample alone, even and odd ones, for the error by the sampling rate: of the
    # quantity and of the deflection; empty where samples are too few, in all or to a period
    coarser: tuple[tuple[Cycles, Cycles], ...] = field(default=(), compare=False, repr=False)
    frequency: float = 0.0  # mean frequency of the deflection, rms of its rate over 2 pi that of itself [Hz]

    def damage_error(self, exponent: float) -> float:
        """Compute the relative change of damage from all samples to every other sample; infinite where samples are too few.

        The error of the damage is about a third of it: errors fall with the square of the sampling rate at the least.
        """
        pairs = [(all_of.damage(exponent), half.damage(exponent)) for all_of, half in self.coarser]
        return max((abs(half / damage - 1.0) if damage else 0.0 for damage, half in pairs), default=math.inf)


def mount_cycles(
    response: Response, *, quantity: Quantity = "deflection", start: float = -math.inf, end: float = math.inf
) -> list[MountCycles]:
    """Count the cycles of every mount but stops along roll, shear and axial, in the order of the model.

    Turning points between the samples are those of cubics through the deflections and their rates, which follow from the motion
    of the bodies; of forces, those of parabolas. `MountCycles.damage_error` says whether the samples are enough for that.

    Args:
        response: of a run; of a long one each mount is read by itself.
        quantity: "deflection" or "force".
        start: instant from which on cycles are counted [s].
        end: instant up to which they are [s].

    Raises:
        ValueError: fewer than two samples lie between `start` and `end`.
    """
    one_of("quantity", quantity, ("deflection", "force"))
    rows = slice(*np.searchsorted(response.time, [start, end + 1e-9]))
    if response.time[rows].size < 2:
        raise ValueError(f"`start` and `end` must hold two samples between them, got {start!r} and {end!r} s.")
    spacing, cycles = 1.0 / sample_rate(response.time), []
    for mount in (mount for mount in response.scene.mounts if not mount.stop):
        rates = deflection_rates(response, mount)[rows]
        for number, axis in enumerate(AXES):
            deflection = response.column(f"mounts/{mount.name}/deflection/{axis}")[rows]
            rate, spread = rates[:, number], float(deflection.std())
            several = ((0, 1), (0, 2), (1, 2)) if deflection.size >= _LEAST_SAMPLES else ((0, 1),)
            turns = [[path(deflection[at::every], rate[at::every], every * spacing)[0] for at, every in several]]
            if quantity == "force":
                force = response.column(f"mounts/{mount.name}/force/{axis}")[rows]
                turns.append([parabolas(force[at::every]) for at, every in several])
            counted = [tuple(map(rainflow_cycles, each)) for each in turns]
            frequency = float(rate.std()) / (2.0 * math.pi * spread) if spread else 0.0
            enough = frequency * spacing * _LEAST_PER_PERIOD <= 1.0
            coarser = tuple((whole, half) for whole, *halves in counted for half in halves if enough)
            cycles.append(MountCycles(mount=mount.name, axis=axis, cycles=counted[-1][0], coarser=coarser, frequency=frequency))
    return cycles


def deflection_rates(response: Response, mount: SceneMount) -> Array:
    """Compute the rates of a mount's deflection along roll, shear and axial at the samples [m/s], (n_t, 3)."""
    place, velocity, _, _ = _point_motion(response, mount.payload_body, mount.payload_point)
    base, base_velocity, turn, spin = _point_motion(response, mount.base_body, mount.base_point)
    relative = velocity - base_velocity - np.cross(spin, place - base)
    rates, rigid = (np.einsum("...ij,...i->...j", turn @ mount.axes, vector) for vector in (relative, place - base))
    bent = response.mounts[mount.name].deflection - rigid  # what a flexible part adds, whose modes are no bodies
    if np.abs(bent).max(initial=0.0) > ROUNDING:
        rates += np.gradient(bent, response.time, axis=0)
    return np.asarray(rates)


def _point_motion(response: Response, body: str, point: Array) -> tuple[Array, Array, Array, Array]:
    """Compute position and velocity of a body's point, the body's axes and its angular velocity, at the samples."""
    if body in response.bodies:
        moved = response.bodies[body]
        turn, spin = rotation_matrices(moved.orientation), moved.angular_velocity
        arm = turn @ point
        return moved.position + arm, moved.velocity + np.cross(spin, arm), turn, spin
    still, zero = next((part for part in response.scene.bodies if part.name == body), None), np.zeros(3)
    if still is None:  # the world
        return point, zero, np.eye(3), zero
    turn = rotation_matrices(still.orientation)
    return still.position + turn @ point, zero, turn, zero


# Largest relative change of damage from all samples to every other sample; the error of the damage is smaller.
DAMAGE_ERROR = 0.01
NEGLIGIBLE = 0.01  # Damage over that of the worst mount and axis below which its error does not matter
PER_PERIOD = 100  # Samples to a period of the mean frequency that a message asks for where there are too few
# Kinds of motions that go on for hours, or of which a measured part stands for hours.
_LASTING = STEADY | {"random-vibration", "record", "force-table"}
_SHORTEST = 0.05  # Fraction of a stationary vibration that a run must hold for hours of it to be counted


@dataclass(frozen=True, kw_only=True)
class Stage:
    """A run's folder, and how often it happens in a service life: `repetitions`, or as often as fits into `hours`."""

    run: Path  #: folder of a run
    repetitions: Positive | None = None
    hours: Positive | None = None

    def __post_init__(self) -> None:
        if (self.repetitions is None) == (self.hours is None):
            raise ValueError(f"the stage {str(self.run)!r} must say either `repetitions` or `hours`.")


@dataclass(frozen=True, kw_only=True)
class Mission:
    """A service life."""

    stages: Annotated[tuple[Stage, ...], Key("stage")] = ()  # runs that happen in it
    exponent: Positive  # b of the fatigue curve N = C / A^b
    quantity: Quantity = "deflection"  # of the mounts that is counted
    constant: Positive | None = None  # C, in the quantity's SI unit to the power b; None: damage is relative

    def __post_init__(self) -> None:
        if not self.stages:
            raise ValueError("there must be a table [[stage]] for each run of the service life.")


@dataclass(frozen=True, kw_only=True)
class MountDamage:
    """Damage of an axis of a mount over a service life, by stage (repeated run), its number of cycles and largest range."""

    mount: str
    axis: str
    stages: tuple[float, ...]
    cycles: float
    largest_range: float

    @property
    def total(self) -> float:
        return sum(self.stages)


def read_mission(path: str | Path) -> Mission:
    """Return the service life of a TOML file; folders of runs stand relative to it.

    RecordError if the file cannot be read, or a key is missing, unknown or out of its range.
    """
    path = Path(path)
    return structure(Mission, read_toml(path, "service life", RecordError), Place(path, error=RecordError))


def mission_damage(mission: Mission) -> list[MountDamage]:
    """Sum the damage of every mount and axis over a service life, the largest first.

    RecordError if the folder of a stage holds no run, its samples are too few, or its mounts are not those of the first.
    """
    by_axis: dict[tuple[str, str], list[tuple[float, float, float]]] = {}
    coarse: list[tuple[float, float, float, Stage, float]] = []
    for number, stage in enumerate(mission.stages):
        response = load_response(stage.run)
        kinds = {part.get("kind") for part in elements(response.motion)}
        if (early := too_short(response)) and not kinds <= STEADY | {"random-vibration"}:
            raise RecordError(f"{stage.run}: {early}. What it does to the mounts is not over.")
        start, end, length = _counted_interval(response, stage)
        times = stage.repetitions if stage.hours is None else 3600.0 * stage.hours / length
        assert times is not None
        for counted in mount_cycles(response, quantity=mission.quantity, start=start, end=end):
            damage = times * counted.cycles.damage(mission.exponent, mission.constant or 1.0)
            row = (damage, times * counted.cycles.total, float(counted.cycles.ranges.max(initial=0.0)))
            by_axis.setdefault((counted.mount, counted.axis), []).append(row)
            error = counted.damage_error(mission.exponent)
            if error > DAMAGE_ERROR:
                coarse.append((damage, error, counted.frequency, stage, sample_rate(response.time)))
        if any(len(rows) != number + 1 for rows in by_axis.values()):
            raise RecordError(f"{stage.run}: the mounts of this run are not those of {mission.stages[0].run}.")
    if not np.isfinite([row for rows in by_axis.values() for row in rows]).all():
        raise ValueError(
            "the damage is too large for a number: check `exponent`, `constant`, and `repetitions` or `hours` of each stage."
        )
    damages = [
        MountDamage(
            mount=mount, axis=axis, stages=tuple(row[0] for row in rows), cycles=sum(row[1] for row in rows),
            largest_range=max(row[2] for row in rows),
        )
        for (mount, axis), rows in by_axis.items()
    ]  # fmt: skip
    worst = max((row.total for row in damages), default=0.0)
    for damage, error, frequency, stage, rate in sorted(coarse, key=lambda row: -row[0]):
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
    return sorted(damages, key=lambda row: -row.total)


def _counted_interval(response: Response, stage: Stage) -> tuple[float, float, float]:
    """Find the instants between which a stage's cycles are counted, and the length that its `hours` are divided by [s]."""
    # Hours are of a lasting motion: of random vibration its stationary part, without rise, fall and decay; of sines, sweeps and
    # records from their start to their end, with the decay counted. Repetitions are of the whole run. RecordError if hours are
    # asked for of a shock, or of random vibration of which the run holds too little.
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
