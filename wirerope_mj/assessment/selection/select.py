"""Parts that meet a worksheet, with margins, and those that do not, with reasons."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from wirerope_mj.assessment.criteria.verdict import EXCEEDED, Verdict
from wirerope_mj.assessment.selection.worksheet import (
    IMPULSE,
    ISOLATION_RATIO,
    LONG,
    WORKSHEET_GRAVITY,
    Shock,
    Worksheet,
)
from wirerope_mj.motions import VelocityStep
from wirerope_mj.mounts.vendor_parts.parts import ModeValues, VendorPart, vendor_parts

UNSTATED = "the vendor states none"

BY_VELOCITY = ("rated travel", "room", "acceleration")
"""Criteria whose values come from the velocity change."""


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """One part under a worksheet.

    Attributes:
        part: the part.
        load_share: load of one mount over the rated one; None = not rated.
        frequency: of small vibration under the load [Hz], from the vibration stiffness.
        shock_frequency: from the shock stiffness along the shock [Hz].
        travel: dynamic travel under the shock [m].
        acceleration: of the payload [m/s^2].
        impulse: shock frequency times length of the pulse [-]; below 0.25 the worksheet's rule holds.
        verdicts: static load, vibration frequency, rated travel, room, acceleration, in this order.
    """

    part: VendorPart
    load_share: float | None
    frequency: float
    shock_frequency: float
    travel: float
    acceleration: float
    impulse: float
    verdicts: tuple[Verdict, ...]

    @property
    def impulse_holds(self) -> bool:
        """Whether the pulse is short enough to count by its velocity change; if not, the figures are on the safe side."""
        return self.impulse < IMPULSE

    @property
    def margin(self) -> float:
        """Smallest margin of all that is judged; infinite if nothing is."""
        return min((verdict.margin for verdict in self.verdicts if verdict.margin is not None), default=math.inf)

    @property
    def governing(self) -> Verdict | None:
        """The verdict with the smallest margin; None if nothing is judged."""
        judged = [verdict for verdict in self.verdicts if verdict.margin is not None]
        return min(judged, key=lambda verdict: verdict.margin or 0.0) if judged else None

    @property
    def unrated(self) -> tuple[str, ...]:
        """Criteria for which the vendor states no limit: not judged, which is not the same as met."""
        return tuple(verdict.criterion for verdict in self.verdicts if verdict.note == UNSTATED)


@dataclass(frozen=True, kw_only=True)
class Rejected:
    """A part that does not do: which limits it exceeds, or which figures it lacks.

    Attributes:
        part: the part.
        reasons: one sentence each.
        margin: of the worst criterion [-], negative; NaN if figures are missing or nothing could be judged.
        undecided: whether nothing but the velocity rule speaks against it, for a pulse that is far too long for that rule.
    """

    part: VendorPart
    reasons: tuple[str, ...]
    margin: float
    undecided: bool = False


@dataclass(frozen=True, kw_only=True)
class Selection:
    """What a worksheet leaves of the tables.

    Attributes:
        worksheet: what was asked.
        candidates: parts that exceed no limit: those with every rating first; in each group the largest smallest margin first
            if a fragility is given, and otherwise the part that passes on least, which is the softest that fits the travel:
            margins of load and travel alone would put the stiffest and most oversized part first.
        rejected: the others: what is undecided first, then the nearest.
    """

    worksheet: Worksheet
    candidates: tuple[Candidate, ...]
    rejected: tuple[Rejected, ...]


def select_isolators(
    *,
    mass: float,
    mounts: int,
    pulse: Shock | None = None,
    velocity: float | None = None,
    drop: float | None = None,
    rebound: float = 0.0,
    travel: float | None = None,
    fragility: float | None = None,
    disturbance: float | None = None,
    loading: str = "compression",
    direction: str | None = None,
    isolation_ratio: float = ISOLATION_RATIO,
    gravity: float = WORKSHEET_GRAVITY,
    loops: Sequence[int] = (),
    parts: Sequence[VendorPart] | None = None,
) -> Selection:
    """Return the catalogue parts that carry the load and keep their limits, by the vendors' worksheet.

    One of `pulse`, `velocity` and `drop` says the shock. Limits that are not given are not judged.

    Args:
        mass: of the payload [kg], its centre of mass in the middle of the mounts.
        mounts: number of mounts that share it.
        pulse: half-sine, sawtooth, trapezoid or velocity step; it counts by its velocity change, whatever its direction.
        velocity: sudden velocity of the base [m/s].
        drop: height from which the base falls onto a stop [m].
        rebound: velocity after that fall over the one before it.
        travel: room that the payload has to move [m].
        fragility: acceleration that the payload stands [m/s^2].
        disturbance: lowest disturbing frequency that must be isolated [Hz].
        loading: mode in which the weight loads the mounts: compression, 45 (degrees), shear or roll.
        direction: mode in which the shock does; that of the weight by default.
        isolation_ratio: disturbing over natural frequency.
        gravity: [m/s^2]; the vendors' sheets take 9.81.
        loops: also try the parts with so many loops, for instance (4, 6).
        parts: to choose among; all that ship by default.

    Raises:
        ValueError: an argument is out of range, or there is not exactly one shock.
    """
    worksheet = Worksheet(
        mass=mass,
        mounts=mounts,
        shock=_shock(pulse, velocity, drop, rebound, gravity),
        travel=travel,
        fragility=fragility,
        disturbance=disturbance,
        loading=loading,
        direction=loading if direction is None else direction,
        isolation_ratio=isolation_ratio,
        gravity=gravity,
    )
    candidates, rejected = [], []
    for part in _variants(vendor_parts() if parts is None else parts, loops):
        answer = judge(part, worksheet)
        if isinstance(answer, Candidate):
            candidates.append(answer)
        else:
            rejected.append(answer)
    return Selection(
        worksheet=worksheet,
        candidates=tuple(sorted(candidates, key=lambda found: (len(found.unrated) > 0, _rank(found, worksheet)))),
        rejected=tuple(
            sorted(
                rejected,
                key=lambda found: (not found.undecided, -found.margin if math.isfinite(found.margin) else math.inf),
            )
        ),
    )


def _rank(found: Candidate, worksheet: Worksheet) -> float:
    """Return what candidates are ordered by, the smallest first."""
    return found.acceleration if worksheet.fragility is None else -found.margin


def judge(part: VendorPart, worksheet: Worksheet) -> Candidate | Rejected:
    """Return what the worksheet says of one part."""
    carried, struck = part.modes[worksheet.loading], part.modes[worksheet.direction]
    if carried.vibration is None or struck.shock is None:
        lacking = worksheet.loading if carried.vibration is None else worksheet.direction
        words = "at 45 degrees" if lacking == "45" else f"in {lacking}"
        return Rejected(part=part, reasons=(f"the table has no stiffness {words}",), margin=math.nan)
    found = Candidate(
        part=part,
        load_share=None if carried.static_load is None else worksheet.load / carried.static_load,
        frequency=worksheet.frequency(carried.vibration),
        shock_frequency=worksheet.frequency(struck.shock),
        travel=worksheet.dynamic_travel(struck.shock),
        acceleration=worksheet.acceleration(struck.shock),
        impulse=worksheet.impulse(struck.shock),
        verdicts=_verdicts(part.name, worksheet, carried, struck),
    )
    exceeded = [verdict for verdict in found.verdicts if verdict.verdict == EXCEEDED]
    if not exceeded:
        return found
    rule = found.impulse < LONG
    decided = [verdict for verdict in exceeded if rule or verdict.criterion not in BY_VELOCITY]
    reasons = tuple(_reason(verdict, worksheet.gravity) for verdict in decided)
    if not decided:
        reasons = (
            f"not judged: natural frequency x length of the pulse is {found.impulse:.3g}, far above {IMPULSE:g}: the rule of "
            "the velocity change does not hold",
        )
    margins = [verdict.margin for verdict in decided if verdict.margin is not None]
    return Rejected(part=part, reasons=reasons, margin=min(margins, default=math.nan), undecided=not decided)


def _verdicts(name: str, worksheet: Worksheet, carried: ModeValues, struck: ModeValues) -> tuple[Verdict, ...]:
    """Return the verdicts on a part whose stiffnesses are known."""
    assert carried.vibration is not None
    assert struck.shock is not None
    travel, acceleration = worksheet.dynamic_travel(struck.shock), worksheet.acceleration(struck.shock)
    frequency = worksheet.frequency(carried.vibration)

    def rating(criterion: str, value: float, limit: float | None, unit: str) -> Verdict:
        note = UNSTATED if limit is None else ""
        return Verdict(criterion=criterion, subject=name, value=value, limit=limit, unit=unit, note=note)

    def wish(criterion: str, value: float, limit: float | None, unit: str) -> Verdict:
        note = "no limit given" if limit is None else ""
        return Verdict(criterion=criterion, subject=name, value=value, limit=limit, unit=unit, note=note)

    return (
        rating("static load", worksheet.load, carried.static_load, "N"),
        wish("natural frequency", frequency, worksheet.largest_frequency, "Hz"),
        rating("rated travel", travel, struck.travel, "m"),
        wish("room", travel, worksheet.travel, "m"),
        wish("acceleration", acceleration, worksheet.fragility, "m/s^2"),
    )


def _reason(verdict: Verdict, gravity: float) -> str:
    """Return in words what a part exceeds."""
    scale, unit = {"m": (1e3, "mm"), "m/s^2": (1.0 / gravity, "g")}.get(verdict.unit, (1.0, verdict.unit))
    assert verdict.limit is not None
    return f"{verdict.criterion} {scale * verdict.value:.4g} {unit}, limit {scale * verdict.limit:.4g} {unit}"


def _shock(pulse: Shock | None, velocity: float | None, drop: float | None, rebound: float, gravity: float) -> Shock:
    """Return the one shock that was given; a fall from h with rebound e changes the velocity by (1 + e) sqrt(2 g h)."""
    given = [value for value in (pulse, velocity, drop) if value is not None]
    if len(given) != 1:
        raise ValueError(f"give one shock: `pulse`, `velocity` or `drop`; got {len(given)}.")
    if pulse is not None:
        if not isinstance(pulse, Shock):
            raise ValueError(
                "`pulse` must be a half-sine, sawtooth, trapezoid or velocity step: the worksheet counts by velocity changes."
            )
        return pulse
    name, value = ("velocity", velocity) if velocity is not None else ("drop", drop)
    if value is None or not (math.isfinite(value) and value > 0.0):
        raise ValueError(f"`{name}` must be a finite number > 0, got {value!r}.")
    if not (math.isfinite(rebound) and 0.0 <= rebound <= 1.0):
        raise ValueError(f"`rebound` must lie between 0 and 1, got {rebound!r}.")
    if rebound and drop is None:
        raise ValueError("`rebound` belongs to `drop`; a `velocity` is the whole velocity change.")
    speed = value if velocity is not None else (1.0 + rebound) * math.sqrt(2.0 * gravity * value)
    return VelocityStep(velocity=speed, direction="z")


def _variants(parts: Sequence[VendorPart], loops: Sequence[int]) -> list[VendorPart]:
    """Return the parts, and after each those with fewer loops."""
    for number in loops:
        if isinstance(number, bool) or not isinstance(number, int) or number < 1:
            raise ValueError(f"`loops` must be integers >= 1, got {number!r}.")
    found = []
    for part in parts:
        fewer = [number for number in loops if part.loops is not None and number < part.loops]
        found += [part, *(part.with_loops(number) for number in fewer)]
    return found
