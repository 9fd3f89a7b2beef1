"""Every part of a catalogue in the places of a model's mounts, simulated under all load cases side by side, and ranked."""

import math
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from wirerope_mj.assessment.criteria import rested_verdicts
from wirerope_mj.engine.simulation.stability import slowest_period
from wirerope_mj.engine.simulation.stepper import HISTORIES
from wirerope_mj.engine.statics import equilibrium, static_table
from wirerope_mj.engine.statics.find import settle_together
from wirerope_mj.engine.statics.payloads import payloads_of
from wirerope_mj.engine.system import System, load_system
from wirerope_mj.engine.system.varied import varied
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.errors import ModelError, ModelWarning, WireRopeError
from wirerope_mj.foundation.summary import Summarised
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.vendor_parts import catalogue as catalogue
from wirerope_mj.studies.race import CRITERIA as CRITERIA
from wirerope_mj.studies.race import LEVELS, Race
from wirerope_mj.studies.race import TriedPart as TriedPart

_ACCURACY = 1e-3  # of the peaks: the figures are shown to three digits
_HOPELESS = 10.0  # times the rated static load from which on there is no equilibrium worth a search
Progress = Callable[[float], None]


def try_parts(
    system: System, parts: Mapping[str, Isolator], cases: Mapping[str, BaseMotion], *, initial: str = "settled",
    placement: str = "", accuracy: float = _ACCURACY, progress: Progress = lambda _: None,
) -> list[TriedPart]:  # fmt: skip
    """Simulate every part in the places of a model's mounts under every load case.

    Places are those of the payload's bars: where a part is higher or lower than the model's isolator, its mid-height
    moves along the mount's axis on the base's side, and the foundation with it. Stops stay as they are. Steps are halved
    until what is judged of a part keeps within `accuracy`, or is beyond a limit for certain. ValueError if `initial` is
    neither "settled" nor "relaxed", or a motion has no end; ModelError if no mount of the model carries an isolator.
    """
    if initial not in HISTORIES:
        raise ValueError(f"`initial` must be one of {', '.join(HISTORIES)}, got {initial!r}.")
    tried = [
        TriedPart(name=name, isolator=parts[name], system=on, placement=placement, mounts=len(replaced(system)), reason=why)
        for name, on, why in _systems(system, parts)
    ]
    with warnings.catch_warnings(action="ignore", category=ModelWarning):  # of parts that will not be chosen
        begun = _settled([one for one in tried if one.system is not None and not one.reason], initial)
    runs = {one.name: one for one in begun if not one.reason}
    race = Race(runs, cases, initial, accuracy)
    for level in range(LEVELS):
        race.run(level)
        progress((level + 1) / LEVELS)
    return [
        replace(one, measures=race.found.get(one.name, {}), reason=race.reasons.get(one.name, one.reason))
        for one in {one.name: one for one in (*tried, *begun)}.values()
    ]


def replaced(system: System) -> list[str]:
    """Return the mounts that a part would take the place of; ModelError if there is none."""
    mounts = [name for name, mount in system.mounts.items() if not mount.isolator.is_stop]
    if not mounts:
        raise ModelError("the model has no mounts but stops: there is no place for an isolator.")
    return mounts


def _systems(system: System, parts: Mapping[str, Isolator]) -> Iterator[tuple[str, System | None, str]]:
    """Yield name, system and "" of each part, or None and why there is none."""
    mounts = replaced(system)
    names = {system.mounts[name].isolator_name for name in mounts}
    weight = sum(one.mass for one in payloads_of(system)) * math.hypot(*system.model.opt.gravity)
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
        changes = {mount: isolator for mount in mounts}
        shifts = shifted(system, isolator)
        try:
            on = varied(base, isolators=changes, positions=shifts) if base is not None else None
        except ModelError:  # its laws are laid out otherwise than those of the last
            on = None
        if on is None:
            loaded = load_system(system.path or system.mjcf, isolators={**system.isolators, **dict.fromkeys(names, isolator)})
            base = replace(loaded, limits=system.limits, combined_travel=system.combined_travel)
            on = varied(base, positions=shifts)
        yield name, on, ""


def shifted(system: System, isolator: Isolator) -> dict[str, list[float]]:
    """Return by how much mid-heights move [m] where a part takes the place of a model's isolators, (3,) by mount."""
    shifts = {name: system.mounts[name].shift_for(isolator) for name in replaced(system)}
    return {name: shift for name, shift in shifts.items() if shift is not None}


def _rested(system: System) -> str:
    """Say what stops and contacts carry at rest, on which no part isolates; "" where they carry nothing."""
    if not any(mount.isolator.stops for mount in system.mounts.values()) and not system.model.geom_contype.any():
        return ""
    rows = rested_verdicts(static_table(system))
    return max(rows, key=lambda row: row.value).note if rows else ""


def _settled(tried: Sequence[TriedPart], initial: str) -> list[TriedPart]:
    """Find the equilibria from which all begin; of a part without one the reason."""
    systems = sorted((one.system for one in tried if one.system), key=slowest_period)
    settle_together(systems, HISTORIES[initial])
    result = []
    for one in tried:
        try:
            assert one.system is not None
            equilibrium(one.system, history=HISTORIES[initial])
            result.append(replace(one, reason=_rested(one.system)))
        except WireRopeError as error:
            result.append(replace(one, reason=str(error)))
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

    @property
    def meeting(self) -> tuple[TriedPart, ...]:
        """Parts that keep every limit."""
        return tuple(one for one in self.tried if one.meets)

    def figure(self, one: TriedPart, by: str) -> float:
        """Return what a part is ranked by; price and mass are those of all mounts."""
        if by in ("price", "mass"):
            return one.mounts * self.stated.get(one.name, {}).get(by, math.nan)
        geometry = one.isolator.geometry if one.isolator else None
        height = geometry.height if geometry and geometry.height else math.nan
        figures = {"margin": one.governing[0], "acceleration": one.acceleration, "number": one.mounts, "height": height}
        return figures[by]

    def _summary(self) -> tuple[str, dict[str, str]]:
        shown = {one.name: f"{100.0 * one.governing[0]:.0f} % of {one.governing[1]}" for one in self.meeting}
        return f"{len(self.meeting)} of {len(self.tried)} parts keep every limit", shown


BY = ("margin", "acceleration", "number", "height", "price", "mass")


def select_parts(
    systems: Mapping[str, System], parts: Mapping[str, Isolator | str], cases: Mapping[str, BaseMotion], *,
    by: str | None = None, stated: Mapping[str, Mapping[str, float]] | None = None, initial: str = "settled",
    progress: Progress = lambda _: None,
) -> CatalogueSelection:  # fmt: skip
    """Simulate every part in the places of every model's mounts under every load case, and rank them.

    Args:
        systems: models with the limits that are judged, by what their mounts are called, such as "4+2".
        parts: isolators by name, or why a part has none; `catalogue` returns those of the vendors' tables.
        cases: base motions by the name of the load case.
        by: one of `BY`; by the margin, and without a limit of an acceleration by the acceleration, if it is not said.
        stated: "price" and "mass" of one part, by its name.
        initial: "settled", or "relaxed" as after long vibration.
        progress: takes the fraction of the work that is done.

    Raises:
        ValueError: an argument is out of range, or a motion has no end.
        ModelError: a model has no mounts but stops.
    """
    limited = all(any(one.kind == "acceleration" for one in system.limits) for system in systems.values())
    by = one_of("by", by or ("margin" if limited else "acceleration"), BY)
    for case, motion in cases.items():
        if not math.isfinite(motion.end):
            raise ValueError(f'load case {case!r} has no end: say how long it lasts, as in "for 10 s".')
    devices = {name: one for name, one in parts.items() if isinstance(one, Isolator)}
    tried = [TriedPart(name=name, reason=why) for name, why in parts.items() if isinstance(why, str)]
    for number, (placement, system) in enumerate(systems.items()):
        tried += try_parts(
            system, devices, cases, initial=initial, placement=placement,
            progress=lambda done, first=number: progress((first + done) / len(systems)),  # type: ignore[misc]
        )  # fmt: skip
    made = CatalogueSelection(tried=tuple(tried), cases=cases, by=by, stated=stated or {})

    def order(one: TriedPart) -> tuple[int, float, float]:
        used = one.governing[0]
        value = made.figure(one, by) if one.meets else used
        return (
            2 if one.reason else 0 if one.meets else 1,
            math.inf if math.isnan(value) else value,
            math.inf if math.isnan(used) else used,
        )

    return replace(made, tried=tuple(sorted(tried, key=order)))
