"""Parts that meet a worksheet, with margins, and those that do not, with reasons."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from wirerope_mj.assessment.criteria.verdict import EXCEEDED, Criterion, Verdict, smallest_margin
from wirerope_mj.assessment.selection.worksheet import (
    IMPULSE,
    ISOLATION_RATIO,
    LONG,
    WORKSHEET_GRAVITY,
    Shock,
    Worksheet,
    mode_text,
    shock_of,
)
from wirerope_mj.foundation.arguments import integer
from wirerope_mj.foundation.summary import Brief
from wirerope_mj.mounts.vendor_parts.parts import ModeValues, VendorPart, vendor_parts

UNSTATED, NOT_GIVEN = "the vendor states none", "no limit given"
BY_VELOCITY = ("rated travel", "room", "acceleration")  # Criteria whose values come from the velocity change


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """One part under a worksheet."""

    part: VendorPart
    frequency: float  # of small vibration under the load [Hz], from the vibration stiffness
    shock_frequency: float  # from the shock stiffness along the shock [Hz]
    travel: float  # dynamic travel under the shock [m]
    acceleration: float  # of the payload [m/s^2]
    impulse: float  # shock frequency times length of the pulse [-]; below 0.25 the worksheet's rule holds
    verdicts: tuple[Verdict, ...]  # static load, vibration frequency, rated travel, room, acceleration, in this order

    @property
    def impulse_holds(self) -> bool:
        """True if the pulse is short enough to count by its velocity change; if not, its values are on the safe side."""
        return self.impulse < IMPULSE

    @property
    def margin(self) -> float:
        """Smallest margin of all that is judged; infinite if nothing is."""
        return smallest_margin(self.verdicts)

    def utilisation(self, criterion: str) -> float | None:
        """Return value over limit of a criterion, for instance "static load"; None = not judged."""
        return next(verdict.utilisation for verdict in self.verdicts if verdict.criterion == criterion)

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
    """A part that exceeds limits, or lacks stiffnesses."""

    part: VendorPart
    reasons: tuple[str, ...]  # one sentence each
    margin: float  # of the worst criterion [-], negative; NaN if values are missing or nothing could be judged
    # whether nothing but the velocity rule speaks against it, for a pulse that is far too long for that rule
    undecided: bool = False


@dataclass(frozen=True, kw_only=True, repr=False)
class PartSelection(Brief):
    """Parts of the tables that meet a worksheet, and those that do not."""

    worksheet: Worksheet  # what the mounts must do
    # parts that exceed no limit: those with every rating first; in each group the largest smallest margin first if a
    # fragility is given, and otherwise the part that passes on least, which is the softest that fits the travel:
    # margins of load and travel alone would put the stiffest and most oversized part first
    candidates: tuple[Candidate, ...]
    rejected: tuple[Rejected, ...]  # the others: what is undecided first, then the nearest


def select_isolators(
    *, mass: float, mounts: int, pulse: Shock | None = None, velocity: float | None = None, drop: float | None = None,
    rebound: float = 0.0, travel: float | None = None, fragility: float | None = None, disturbance: float | None = None,
    loading: str = "compression", direction: str | None = None, isolation_ratio: float = ISOLATION_RATIO,
    gravity: float = WORKSHEET_GRAVITY, loops: Sequence[int] = (), parts: Sequence[VendorPart] | None = None,
) -> PartSelection:  # fmt: skip
    """Return the catalogue parts that carry the load and keep their limits, by the vendors' worksheet.

    One of `pulse`, `velocity` and `drop` gives the shock. Limits that are not given are not judged.

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
        mass=mass, mounts=mounts, shock=shock_of(pulse, velocity, drop, rebound, gravity), travel=travel, fragility=fragility,
        disturbance=disturbance, loading=loading, direction=loading if direction is None else direction,
        isolation_ratio=isolation_ratio, gravity=gravity,
    )  # fmt: skip
    candidates, rejected = [], []
    for part in _variants(vendor_parts() if parts is None else parts, loops):
        judged = judge(part, worksheet)
        if isinstance(judged, Candidate):
            candidates.append(judged)
        else:
            rejected.append(judged)
    softest = worksheet.fragility is None
    return PartSelection(
        worksheet=worksheet,
        candidates=tuple(
            sorted(candidates, key=lambda one: (len(one.unrated) > 0, one.acceleration if softest else -one.margin))
        ),
        rejected=tuple(
            sorted(rejected, key=lambda one: (not one.undecided, -one.margin if math.isfinite(one.margin) else math.inf))
        ),
    )


def judge(part: VendorPart, worksheet: Worksheet) -> Candidate | Rejected:
    """Return the values of one part by the worksheet, or why it does not meet it."""
    carried, struck = part.modes[worksheet.loading], part.modes[worksheet.direction]
    if carried.vibration is None or struck.shock is None:
        lacking = worksheet.loading if carried.vibration is None else worksheet.direction
        return Rejected(part=part, reasons=(f"the table has no stiffness {mode_text(lacking)}",), margin=math.nan)
    candidate = Candidate(
        part=part, frequency=worksheet.frequency(carried.vibration), shock_frequency=worksheet.frequency(struck.shock),
        travel=worksheet.dynamic_travel(struck.shock), acceleration=worksheet.acceleration(struck.shock),
        impulse=worksheet.impulse(struck.shock), verdicts=_verdicts(part.name, worksheet, carried, struck),
    )  # fmt: skip
    exceeded = [verdict for verdict in candidate.verdicts if verdict.verdict == EXCEEDED]
    if not exceeded:
        return candidate
    rule = candidate.impulse < LONG
    decided = [verdict for verdict in exceeded if rule or verdict.criterion not in BY_VELOCITY]
    reasons = tuple(_reason(verdict, worksheet.gravity) for verdict in decided)
    if not decided:
        reasons = (
            f"not judged: natural frequency x length of the pulse is {candidate.impulse:.3g}, far above {IMPULSE:g}: the rule "
            "of the velocity change does not hold",
        )
    margin = smallest_margin(decided) if decided else math.nan
    return Rejected(part=part, reasons=reasons, margin=margin, undecided=not decided)


def _verdicts(name: str, worksheet: Worksheet, carried: ModeValues, struck: ModeValues) -> tuple[Verdict, ...]:
    """Return the verdicts on a part whose stiffnesses are known."""
    assert carried.vibration is not None
    assert struck.shock is not None
    travel, acceleration = worksheet.dynamic_travel(struck.shock), worksheet.acceleration(struck.shock)
    frequency = worksheet.frequency(carried.vibration)

    def against(criterion: str, value: float, limit: float | None, unit: str, missing: str = NOT_GIVEN) -> Verdict:
        note = missing if limit is None else ""
        return Verdict(criterion=Criterion(criterion), subject=name, value=value, limit=limit, unit=unit, note=note)

    return (
        against("static load", worksheet.load, carried.static_load, "N", UNSTATED),
        against("natural frequency", frequency, worksheet.largest_frequency, "Hz"),
        against("rated travel", travel, struck.travel, "m", UNSTATED),
        against("room", travel, worksheet.travel, "m"),
        against("acceleration", acceleration, worksheet.fragility, "m/s^2"),
    )


def _reason(verdict: Verdict, gravity: float) -> str:
    """Return what a part exceeds and by how much."""
    scale, unit = {"m": (1e3, "mm"), "m/s^2": (1.0 / gravity, "g")}.get(verdict.unit, (1.0, verdict.unit))
    assert verdict.limit is not None
    return f"{verdict.criterion} {scale * verdict.value:.4g} {unit}, limit {scale * verdict.limit:.4g} {unit}"


def _variants(parts: Sequence[VendorPart], loops: Sequence[int]) -> list[VendorPart]:
    """Return the parts, and after each those with fewer loops."""
    counts = [integer("loops", number, least=1) for number in loops]
    variants = []
    for part in parts:
        fewer = [count for count in counts if part.loops is not None and count < part.loops]
        variants += [part, *(part.with_loops(count) for count in fewer)]
    return variants
