"""Every part of a catalogue in the places of a model's mounts, under all load cases side by side, and ranked.

Time steps are halved until what is judged of each part is accurate enough, or exceeds a limit for certain.
"""

import math
import os
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace

import numpy as np

from wirerope_mj.assessment.criteria import rested_verdicts, stationary_verdicts
from wirerope_mj.assessment.criteria.sampled import elements, steady_interval
from wirerope_mj.assessment.criteria.verdict import SIGMA
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.simulation import BatchFailure, simulate_batch
from wirerope_mj.engine.simulation.engines import unsupported_run
from wirerope_mj.engine.simulation.stability import slowest_period
from wirerope_mj.engine.simulation.stepper import HISTORIES
from wirerope_mj.engine.statics import equilibrium, static_table
from wirerope_mj.engine.statics.find import settle_together
from wirerope_mj.engine.statics.payloads import payloads_of
from wirerope_mj.engine.system import System, load_system, with_rotation
from wirerope_mj.engine.system.varied import varied
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import Absent, ModelError, ModelWarning, WireRopeError
from wirerope_mj.foundation.lanes import WIDTH
from wirerope_mj.foundation.summary import Summarised
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import Isolator, bottom_in_place
from wirerope_mj.mounts.vendor_parts import catalogue as catalogue
from wirerope_mj.studies.measures import measures, needs_samples, payload_bodies, payload_points
from wirerope_mj.studies.needed_mount import NeededMount, needed_mount
from wirerope_mj.studies.room import NO_ROOM, limits_in_room
from wirerope_mj.studies.tried_part import CRITERIA, TriedPart

_LONGEST = 5e-4  # Step from which the halving begins [s]: a mode of 100 Hz has twenty of them in a period
LEVELS = 8  # steps that are tried, the last of them 4 microseconds
# fractions of the work that are done before the first and after each: finer ones are tried of fewer and fewer parts
PREPARED, DONE = 0.05, (0.27, 0.5, 0.75, 0.93, 0.98, 0.99, 0.995, 1.0)
_PATIENCE = 4  # halvings after which a part is given up if its run failed with every step
# Difference of two runs over the error of the finer: 3 at order 2, a little less at the order that is seen.
_FINER = 2.0
_CERTAIN = 5.0  # differences of two runs beyond a limit from which on it is exceeded for certain
_SWINGS = 6.0  # slowest periods after the motion: the largest peaks lie within them
_SAMPLES = 10.0  # ends of steps asked for [1/s]: peaks are those of every step, and fewer samples are faster
_RATE = 1000.0  # where samples judge what peaks do not [Hz]
_GREW = "a mount goes beyond where its law holds, or the motion grows without bound"
Progress = Callable[[float], None]


class Race:
    """Simulations of parts under load cases, side by side, with ever shorter time steps, each half the last one."""

    def __init__(self, runs: Mapping[str, TriedPart], cases: Mapping[str, BaseMotion], initial: str, accuracy: float) -> None:
        self._systems = {name: run.system for name, run in runs.items() if run.system is not None}
        self._periods = {name: slowest_period(system) for name, system in self._systems.items()}
        self._cases, self._initial, self._accuracy = cases, initial, accuracy
        # Where random vibration is a motion's only part, 3-sigma accelerations are judged under it.
        steady = {case: steady_interval(motion.to_dict()) for case, motion in cases.items()}
        self._random = {case: alone and first > -math.inf for case, (alone, first, _) in steady.items()}
        self._left = [(case, name) for case in cases for name in sorted(self._systems, key=self._periods.__getitem__)]
        self.found: dict[str, dict[str, Mapping[str, float]]] = {name: {} for name in self._systems}
        self.reasons: dict[str, str] = {}

    def run(self, level: int, progress: Progress) -> None:
        """Simulate the remaining parts with a time step halved `level` times, and keep those whose error is still too large."""
        alike: dict[tuple[str, bytes], list[str]] = {}  # load case and layout; as many as share lanes are of like periods
        for case, name in self._left:
            alike.setdefault((case, self._systems[name].assembly.tables.layout.tobytes()), []).append(name)
        groups = [(case, names[k : k + WIDTH]) for (case, _), names in alike.items() for k in range(0, len(names), WIDTH)]
        begun = DONE[level - 1] if level else PREPARED
        outcomes: list[list[Mapping[str, float] | BatchFailure]] = []
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            for outcome in pool.map(lambda group: self._batch(group[0], group[1], _LONGEST / 2**level), groups):
                outcomes.append(outcome)
                progress(begun + (DONE[level] - begun) * len(outcomes) / len(groups))
        remaining, beyond = [], set()
        for (case, names), results in zip(groups, outcomes, strict=True):
            for name, result in zip(names, results, strict=True):
                before, label = self.found[name].get(case), f"{case}: "
                if isinstance(result, BatchFailure):
                    self.reasons[name] = label + (_GREW if result.message.startswith("the kernel") else result.message)
                    remaining += [(case, name)] if before is None and level < _PATIENCE else []
                    continue
                if self.reasons.get(name, "").startswith(label):
                    del self.reasons[name]
                system = self._systems[name]
                self.found[name][case] = now = result
                if now["static_load"] > 1.0:
                    beyond.add(name)
                elif before is None:
                    remaining.append((case, name))
                elif any(now[criterion] - 1.0 > _CERTAIN * abs(now[criterion] - before[criterion]) for criterion in CRITERIA):
                    beyond.add(name)  # whatever a finer step would say
                else:  # the largest relative difference of what is judged
                    accelerations = [f"acceleration/{body}" for body in (*payload_bodies(system), *payload_points(system))]
                    pairs = np.array([(before[k], now[k]) for k in (*CRITERIA, *accelerations) if not math.isnan(now[k])])
                    error = np.abs(pairs[:, 0] - pairs[:, 1]) / np.maximum(np.abs(pairs).max(axis=1), 1e-12)
                    remaining += [(case, name)] if error.max() > _FINER * self._accuracy else []
        for name in beyond:  # whatever failed of it at such steps
            self.reasons.pop(name, None)
        self._left = [(case, name) for case, name in remaining if name not in beyond]

    def _batch(self, case: str, names: Sequence[str], step: float) -> list[Mapping[str, float] | BatchFailure]:
        """Simulate parts side by side and return their measures; responses are not kept."""
        systems, motion, random = [self._systems[name] for name in names], self._cases[case], self._random[case]
        samples = needs_samples(systems[0])
        rate = _RATE if samples or random else _SAMPLES
        if random:  # up to half of it densities are known
            rate = max(rate, *(2.0 * float(part["psd"][-1][0]) for part in elements(motion.to_dict())))
        kernel = not unsupported_run(systems[0], motion)
        initial = self._initial if motion.up is None else motion.initial
        results = simulate_batch(
            systems, motion, duration=motion.end + _SWINGS * max(self._periods[name] for name in names), timestep=step,
            initial=initial, sample_rate=rate, threads=1, engine="kernel" if kernel else "auto",
            responses=samples or random, judged=False,
        )  # fmt: skip
        found: list[Mapping[str, float] | BatchFailure] = []
        for system, result in zip(systems, results, strict=True):
            if isinstance(result, BatchFailure):
                found.append(result)
                continue
            response = result.response
            own = measures(system, result.peaks, result.initial_state, response if samples else None)
            found.append(own | sigma_measures(response if random else None))
        return found


def sigma_measures(response: Response | None) -> dict[str, float]:
    """Judge a response's 3-sigma accelerations; return the largest utilisation and the largest acceleration [m/s^2].

    NaN without a response or a limit, or where the run is too short.
    """
    try:
        verdicts = () if response is None else stationary_verdicts(response)
    except ValueError:
        verdicts = ()
    rows = [row for row in verdicts if row.criterion.kind == SIGMA]
    used = [row.utilisation for row in rows if row.utilisation is not None]
    return {"sigma": max(used, default=math.nan), "three_sigma": max((row.value for row in rows), default=math.nan)}


_ACCURACY = 1e-3  # of the peaks: the figures are shown to three digits
_HOPELESS = 10.0  # times the rated static load from which on there is no equilibrium worth a search


def try_parts(
    system: System, parts: Mapping[str, Isolator], cases: Mapping[str, BaseMotion], *, initial: str = "settled",
    placement: str = "", accuracy: float = _ACCURACY, room: Array | None = None, progress: Progress = lambda _: None,
) -> list[TriedPart]:  # fmt: skip
    """Simulate every part in place of a model's mounts under every load case.

    Places are those of the payload's bars: where a part is higher or lower than the model's isolator, its mid-height
    moves along the mount's axis on the base's side, and the foundation with it. Stops stay as they are. Steps are halved
    until what is judged of a part keeps within `accuracy`, or is beyond a limit for certain. In a `room`, a box of sizes
    along x, y and z (3,) [m], points of the payload must stay clear of its walls (`limits_in_room`). ValueError if `initial`
    is neither "settled" nor "relaxed", or a motion has no end; ModelError if no mount of the model carries an isolator.
    """
    if initial not in HISTORIES:
        raise ValueError(f"`initial` must be one of {', '.join(HISTORIES)}, got {initial!r}.")
    if any(motion.rotates for motion in cases.values()):
        system = replace(with_rotation(system), limits=system.limits, combined_travel=system.combined_travel)
    mounts = len(replaceable_mounts(system))
    tried = [
        TriedPart(name=name, isolator=parts[name], system=on, placement=placement, mounts=mounts, reason=why)
        for name, on, why in _systems(system, parts, room)
    ]
    with warnings.catch_warnings(action="ignore", category=ModelWarning):  # of parts that will not be chosen
        begun = _find_equilibria([part for part in tried if part.system is not None and not part.reason], initial)
    runs = {part.name: part for part in begun if not part.reason}
    progress(PREPARED)
    race = Race(runs, cases, initial, accuracy)
    for level in range(LEVELS):
        race.run(level, progress)
    return [
        replace(part, measures=race.found.get(part.name, {}), reason=race.reasons.get(part.name, part.reason))
        for part in {part.name: part for part in (*tried, *begun)}.values()
    ]


def replaceable_mounts(system: System) -> list[str]:
    """List the mounts that a part may replace, all but stops; ModelError if there is none."""
    mounts = [name for name, mount in system.mounts.items() if not mount.isolator.is_stop]
    if not mounts:
        raise ModelError("the model has no mounts but stops: there is no place for an isolator.")
    return mounts


def _systems(
    system: System, parts: Mapping[str, Isolator], room: Array | None = None
) -> Iterator[tuple[str, System | None, str]]:
    """Yield name, system and "" of each part; None and a reason in place of a system that cannot be built."""
    mounts = replaceable_mounts(system)
    weight = sum(payload.mass for payload in payloads_of(system)) * math.hypot(*system.model.opt.gravity)
    base: System | None = None
    for name, isolator in parts.items():
        rated = (isolator.limits.static_load or math.inf) * len(mounts)
        if weight > _HOPELESS * rated:
            yield name, None, f"the weight is {weight / rated:.3g} times what its mounts are rated for"
            continue
        lacking = [axis for axis, law in isolator.axes.items() if law is None and axis not in isolator.free]
        if lacking:
            yield name, None, f"its table states nothing in {' and '.join(lacking)}"
            continue
        changes = replacements(system, isolator)
        shifts = mount_shifts(system, changes)
        try:
            on = varied(base, isolators=changes, positions=shifts) if base is not None else None
        except ModelError:  # its laws are laid out otherwise than those of the last
            on = None
        if on is None:
            placed = {system.mounts[mount].isolator_name: device for mount, device in changes.items()}
            loaded = load_system(system.path or system.mjcf, isolators={**system.isolators, **placed})
            base = replace(loaded, limits=system.limits, combined_travel=system.combined_travel)
            on = varied(base, positions=shifts)
        try:
            yield name, on if room is None else replace(on, limits=limits_in_room(on, room)), ""
        except ModelError as error:
            if not str(error).startswith(NO_ROOM):
                raise
            yield name, None, str(error)


def replacements(system: System, isolator: Isolator) -> dict[str, Isolator]:
    """Return the isolators, by mount, with which a part replaces a model's: the part itself, and stops where it goes solid."""
    stops = system.bottoms.values()
    placed = {name: bottom_in_place(system.mounts[name].written, isolator) for name in stops}
    return dict.fromkeys(replaceable_mounts(system), isolator) | placed


def mount_shifts(system: System, placed: Mapping[str, Isolator]) -> dict[str, list[float]]:
    """Return the shifts of mid-heights [m] when other isolators replace those of a model, (3,) by mount."""
    shifts = {name: system.mounts[name].shift_for(isolator) for name, isolator in placed.items()}
    return {name: shift for name, shift in shifts.items() if shift is not None}


def _find_equilibria(tried: Sequence[TriedPart], initial: str) -> list[TriedPart]:
    """Find the equilibria at which simulations start; a part without one gets the reason."""
    systems = sorted((part.system for part in tried if part.system), key=slowest_period)
    settle_together(systems, HISTORIES[initial])
    result = []
    for part in tried:
        try:
            assert part.system is not None
            equilibrium(part.system, history=HISTORIES[initial])
            reason = ""  # what stops and contacts carry at rest, on which no part isolates
            if any(mount.isolator.stops for mount in part.system.mounts.values()) or part.system.model.geom_contype.any():
                carried = rested_verdicts(static_table(part.system))
                reason = max(carried, key=lambda row: row.value).note if carried else ""
            result.append(replace(part, reason=reason))
        except WireRopeError as error:
            result.append(replace(part, reason=str(error)))
    return result


@dataclass(frozen=True, kw_only=True, repr=False)
class CatalogueSelection(Summarised):
    """Parts of a catalogue that were simulated, ranked."""

    # those that keep every limit by `by`, then the nearest to their limits, then those without figures
    tried: tuple[TriedPart, ...]
    cases: Mapping[str, BaseMotion]  # base motions by the name of the load case
    by: str  # what they are ranked by, one of `BY`
    # "price" and "mass" of one part, by the part's name, as a table of one's own states them
    stated: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    room: Array | None = None  # sizes along x, y and z in which equipment and mounts must stay [m], (3,)
    # what a mount of stiffness, load and travel would do under these limits, or why none would
    needed: NeededMount | Absent = field(default=Absent(reason=""), repr=False)

    @property
    def meeting(self) -> tuple[TriedPart, ...]:
        """Parts that keep every limit."""
        return tuple(part for part in self.tried if part.meets)

    def figure(self, part: TriedPart, by: str) -> float:
        """Return the figure by which a part is ranked; price and mass are those of all mounts."""
        if by in ("price", "mass"):
            return part.mounts * self.stated.get(part.name, {}).get(by, math.nan)
        geometry = part.isolator.geometry if part.isolator else None
        height = geometry.height if geometry and geometry.height else math.nan
        figures = {"margin": part.governing[0], "acceleration": part.acceleration, "number": part.mounts, "height": height}
        return figures[by]

    def rank(self, part: TriedPart) -> tuple[int, tuple[float, ...]]:
        """Return the key by which `tried` is sorted: parts that keep every limit come first, those not computed last."""
        used = part.governing[0]
        figures = (self.figure(part, self.by) if part.meets else used, used)
        return 2 if part.reason else 0 if part.meets else 1, tuple(math.inf if math.isnan(each) else each for each in figures)

    def _summary(self) -> tuple[str, dict[str, str]]:
        shown = {part.name: f"{100.0 * part.governing[0]:.0f} % of {part.governing[1]}" for part in self.meeting}
        return f"{len(self.meeting)} of {len(self.tried)} parts keep every limit", shown


BY = ("margin", "acceleration", "number", "height", "price", "mass")


def select_parts(
    systems: Mapping[str, System], parts: Mapping[str, Isolator | str], cases: Mapping[str, BaseMotion], *,
    by: str | None = None, stated: Mapping[str, Mapping[str, float]] | None = None, initial: str = "settled",
    room: Array | None = None, progress: Progress = lambda _: None,
) -> CatalogueSelection:  # fmt: skip
    """Simulate every part in place of every model's mounts under every load case, and rank the parts.

    Args:
        systems: models with the limits that are judged, by what their mounts are called, such as "4+2".
        parts: isolators by name, or why a part has none; `catalogue` returns those of the vendors' tables.
        cases: base motions by the name of the load case.
        by: one of `BY`; by the margin, and without a limit of an acceleration by the acceleration, if it is not said.
        stated: "price" and "mass" of one part, by its name.
        initial: "settled", or "relaxed" as after long vibration.
        room: sizes of a box along x, y and z in which equipment and mounts must stay [m], (3,); None for none.
        progress: takes the fraction of the work that is done.

    Raises:
        ValueError: an argument is out of range, or a motion has no end.
        ModelError: a model has no mounts but stops.
    """
    limited = all(any(limit.kind == "acceleration" for limit in system.limits) for system in systems.values())
    by = one_of("by", by or ("margin" if limited else "acceleration"), BY)
    for case, motion in cases.items():
        if not math.isfinite(motion.end):
            raise ValueError(f'load case {case!r} has no end: say how long it lasts, as in "for 10 s".')
    devices = {name: part for name, part in parts.items() if isinstance(part, Isolator)}
    tried = [TriedPart(name=name, reason=why) for name, why in parts.items() if isinstance(why, str)]
    for number, (placement, system) in enumerate(systems.items()):
        tried += try_parts(
            system, devices, cases, initial=initial, placement=placement, room=room,
            progress=lambda done, first=number: progress((first + done) / len(systems)),  # type: ignore[misc]
        )  # fmt: skip
    selection = CatalogueSelection(tried=tuple(tried), cases=cases, by=by, stated=stated or {}, room=room)
    if not selection.meeting:
        first = next((part.system for part in tried if part.system is not None), next(iter(systems.values())))
        selection = replace(selection, needed=needed_mount(first, len(replaceable_mounts(first)), cases))
    return replace(selection, tried=tuple(sorted(tried, key=selection.rank)))
