"""Selection of parts by the vendors' worksheet: load, shock and travel of a payload by the formulas of their sheets.

The response of a part in a model is computed by `wirerope_mj.studies.catalogue`.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from wirerope_mj.assessment.criteria.verdict import EXCEEDED, Criterion, Verdict, smallest_margin
from wirerope_mj.foundation.arguments import between, integer, positive
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.summary import Brief
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import VelocityStep, ranges
from wirerope_mj.motions.pulses import Pulse
from wirerope_mj.motions.registry import motion_from_words
from wirerope_mj.mounts.vendor_parts.parts import MODES, VendorPart, vendor_parts

# Acceleration of gravity of the vendors' sheets [m/s^2]: their printed digits need it, 0.03 % above the standard one.
WORKSHEET_GRAVITY = 9.81
ISOLATION_RATIO = 3.0  # Disturbing over natural frequency that the vendors ask for: it keeps out 80 % and more
# Natural frequency times length of a pulse up to which only its velocity change counts (the vendors' condition).
IMPULSE = 0.25
# Natural frequency times length of a pulse from which the rule is useless: there an undamped mass under a half-sine reaches
# 1.73 times the pulse's peak, and the rule gives 4 times.
LONG = 1.0
Shock = Pulse | VelocityStep


@dataclass(frozen=True, kw_only=True)
class Worksheet:
    """Requirements on the mounts of a payload, which share the weight equally below a central centre of mass.

    A pulse counts by its velocity change V alone. That is right within a few per cent while (natural frequency x length of the
    pulse) < 0.25; above it the worksheet is on the safe side: no pulse of one sign moves a linear undamped mass more than a
    sudden V.
    """

    mass: float  # of the payload [kg]
    mounts: int  # number of mounts that share it
    shock: Shock  # pulse or velocity step of the base
    travel: float | None = None  # room that the payload has [m]; None = not judged, as for the next two
    fragility: float | None = None  # acceleration that the payload stands [m/s^2]
    disturbance: float | None = None  # lowest disturbing frequency to be isolated [Hz]
    loading: str = "compression"  # mode in which the weight loads the mounts: compression, 45 or shear
    direction: str = "compression"  # mode in which the shock loads the mounts
    isolation_ratio: float = ISOLATION_RATIO  # least disturbing over natural frequency
    gravity: float = WORKSHEET_GRAVITY  # of the weight [m/s^2]

    def __post_init__(self) -> None:
        for name in ("mass", "isolation_ratio", "gravity", "travel", "fragility", "disturbance"):
            value = getattr(self, name)
            if value is not None and not ranges.SMALLEST <= positive(name, value) <= ranges.LARGEST:
                raise ValueError(f"`{name}` must be {ranges.SMALLEST:g} to {ranges.LARGEST:g} in SI units, got {value!r}.")
        integer("mounts", self.mounts, least=1)
        for name in ("loading", "direction"):
            mode = "shear" if getattr(self, name) == "roll" else getattr(self, name)
            if mode not in MODES:
                raise ValueError(f"`{name}` must be one of {', '.join(MODES)} or roll, got {mode!r}.")
            object.__setattr__(self, name, mode)

    @property
    def load(self) -> float:
        """Weight W on one mount [N]."""
        return self.mass * self.gravity / self.mounts

    @property
    def velocity(self) -> float:
        """Velocity change V of the shock [m/s]."""
        return abs(self.shock.velocity_change)

    @property
    def peak(self) -> float | None:
        """Acceleration of the pulse at its peak [m/s^2]; None for a velocity step, which has none."""
        return None if isinstance(self.shock, VelocityStep) else abs(self.shock.peak)

    @property
    def largest_frequency(self) -> float | None:
        """Natural frequency that isolates the disturbance [Hz], f_i / 3."""
        return None if self.disturbance is None else self.disturbance / self.isolation_ratio

    @property
    def largest_vibration_stiffness(self) -> float | None:
        """Largest vibration stiffness of one mount [N/m], Kv_max = W (2 pi f)^2 / g with f the `largest_frequency`."""
        frequency = self.largest_frequency
        return None if frequency is None else self.load * (2.0 * math.pi * frequency) ** 2 / self.gravity

    @property
    def smallest_travel(self) -> float | None:
        """Least travel D_min = V^2 / AT of a spring that transmits no more than the fragility AT [m]; V: velocity change."""
        return None if self.fragility is None else self.velocity**2 / self.fragility

    @property
    def largest_shock_stiffness(self) -> float | None:
        """Largest shock stiffness of one mount for the fragility AT [N/m], Ks_max = (W / g) (AT / V)^2."""
        return None if self.fragility is None else self.load / self.gravity * (self.fragility / self.velocity) ** 2

    def amplifies(self, acceleration: float) -> bool:
        """Check whether a transmitted acceleration [m/s^2] is above the pulse's peak."""
        return self.peak is not None and acceleration > self.peak

    def frequency(self, stiffness: float) -> float:
        """Natural frequency [Hz] on mounts of a stiffness [N/m] each, sqrt(K g / W) / 2 pi."""
        return math.sqrt(stiffness * self.gravity / self.load) / (2.0 * math.pi)

    def dynamic_travel(self, shock_stiffness: float) -> float:
        """Largest deflection under the shock [m], D = V / sqrt(Ks g / W) with the shock stiffness Ks [N/m]."""
        return self.velocity / (2.0 * math.pi * self.frequency(shock_stiffness))

    def acceleration(self, shock_stiffness: float) -> float:
        """Transmitted acceleration 2 pi f V [m/s^2], f the frequency on the shock stiffness [N/m]; in g the sheets' GT."""
        return 2.0 * math.pi * self.frequency(shock_stiffness) * self.velocity

    def impulse(self, shock_stiffness: float) -> float:
        """Natural frequency times length of the pulse [-]; 0 for a velocity step."""
        return self.frequency(shock_stiffness) * self.shock.duration


def mode_text(mode: str) -> str:
    return "at 45 degrees" if mode == "45" else f"in {mode}"


_EXAMPLES = '"15 g 11 ms half-sine", "20 g 11 ms sawtooth", "10 g 18 ms trapezoid" or "2 m/s"'


def shock_of(pulse: Shock | None, velocity: float | None, drop: float | None, rebound: float, gravity: float) -> Shock:
    """Return the one shock given; a drop from height h with rebound e changes the velocity by (1 + e) sqrt(2 g h)."""
    given = [value for value in (pulse, velocity, drop) if value is not None]
    if len(given) != 1:
        raise ValueError(f"give one shock: `pulse`, `velocity` or `drop`; got {len(given)}.")
    between("rebound", rebound, 0.0, 1.0)
    if rebound and drop is None:
        raise ValueError("`rebound` belongs to `drop`; a `pulse` or a `velocity` is the whole velocity change.")
    if pulse is not None:
        if not isinstance(pulse, Shock):
            raise ValueError(
                "`pulse` must be a half-sine, sawtooth, trapezoid or velocity step: the worksheet counts by velocity changes."
            )
        return pulse
    if drop is not None:
        velocity = (1.0 + rebound) * math.sqrt(2.0 * gravity * ranges.level("drop", positive("drop", drop, unit="m")))
    return VelocityStep(velocity=positive("velocity", velocity, unit="m/s"), direction="z")


def shock_from_text(text: str) -> Shock:
    """Parse the shock in a text such as `15 g 11 ms half-sine` or `2 m/s`; 1 g is the worksheet's 9.81 m/s^2.

    ValueError if the text is no pulse and no velocity.
    """
    shock = motion_from_words(text)
    if not isinstance(shock, Shock):
        raise ValueError(f"a worksheet's shock is one pulse or a velocity, such as {_EXAMPLES}; got {short(text)!r}.")
    if isinstance(shock, VelocityStep):
        return shock
    return replace(shock, peak=shock.peak * WORKSHEET_GRAVITY / STANDARD_GRAVITY)


UNSTATED, NOT_GIVEN = "the vendor states none", "no limit given"
BY_VELOCITY = ("rated travel", "room", "acceleration")  # Criteria whose values come from the velocity change


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """A part that meets a worksheet: its natural frequencies, travel, acceleration and verdicts."""

    part: VendorPart
    frequency: float  # natural frequency of small vibration under the load [Hz], from the vibration stiffness
    shock_frequency: float  # natural frequency from the shock stiffness along the shock [Hz]
    travel: float  # dynamic travel under the shock [m]
    acceleration: float  # of the payload [m/s^2]
    impulse: float  # shock frequency times length of the pulse [-]; below 0.25 the worksheet's rule holds
    verdicts: tuple[Verdict, ...]  # static load, vibration frequency, rated travel, room, acceleration, in this order

    @property
    def impulse_holds(self) -> bool:
        """True if the pulse is short enough for the velocity-change rule; if not, the values are on the safe side."""
        return self.impulse < IMPULSE

    @property
    def margin(self) -> float:
        """Smallest margin of all judged criteria; infinite if no criterion is judged."""
        return smallest_margin(self.verdicts)

    def utilisation(self, criterion: str) -> float | None:
        """Look up value over limit of a criterion, such as "static load"; None = not judged."""
        return next(verdict.utilisation for verdict in self.verdicts if verdict.criterion == criterion)

    @property
    def governing(self) -> Verdict | None:
        """The verdict with the smallest margin; None if nothing is judged."""
        judged = [verdict for verdict in self.verdicts if verdict.margin is not None]
        return min(judged, key=lambda verdict: verdict.margin or 0.0) if judged else None

    @property
    def unrated(self) -> tuple[str, ...]:
        """Criteria for which the vendor states no limit: these are not judged, which is not the same as within."""
        return tuple(verdict.criterion for verdict in self.verdicts if verdict.note == UNSTATED)


@dataclass(frozen=True, kw_only=True)
class Rejected:
    """A part that exceeds limits, or lacks stiffnesses."""

    part: VendorPart
    reasons: tuple[str, ...]  # one sentence each
    margin: float  # of the worst criterion [-], negative; NaN if values are missing or nothing could be judged
    # whether it exceeds limits by the velocity-change rule alone, for a pulse far too long for that rule
    undecided: bool = False


@dataclass(frozen=True, kw_only=True, repr=False)
class PartSelection(Brief):
    """Parts of the tables that meet a worksheet, and those that do not."""

    worksheet: Worksheet  # requirements on the mounts
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
    """Choose the catalogue parts that carry the load and keep their limits, by the vendors' worksheet.

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
    counts, judged = [integer("loops", number, least=1) for number in loops], []
    for part in vendor_parts() if parts is None else parts:
        fewer = [count for count in counts if part.loops is not None and count < part.loops]
        judged += [judge(variant, worksheet) for variant in (part, *(part.with_loops(count) for count in fewer))]
    candidates = [row for row in judged if isinstance(row, Candidate)]
    rejected = [row for row in judged if isinstance(row, Rejected)]
    softest = worksheet.fragility is None
    candidates.sort(key=lambda row: (len(row.unrated) > 0, row.acceleration if softest else -row.margin))
    rejected.sort(key=lambda row: (not row.undecided, -row.margin if math.isfinite(row.margin) else math.inf))
    return PartSelection(worksheet=worksheet, candidates=tuple(candidates), rejected=tuple(rejected))


def judge(part: VendorPart, worksheet: Worksheet) -> Candidate | Rejected:
    """Judge one part by the worksheet: a candidate with verdicts, or a rejected part with reasons."""
    static_mode, shock_mode, gravity = part.modes[worksheet.loading], part.modes[worksheet.direction], worksheet.gravity
    if static_mode.vibration is None or shock_mode.shock is None:
        lacking = worksheet.loading if static_mode.vibration is None else worksheet.direction
        return Rejected(part=part, reasons=(f"the table has no stiffness {mode_text(lacking)}",), margin=math.nan)
    frequency, travel = worksheet.frequency(static_mode.vibration), worksheet.dynamic_travel(shock_mode.shock)
    acceleration, impulse = worksheet.acceleration(shock_mode.shock), worksheet.impulse(shock_mode.shock)
    rows = (
        ("static load", worksheet.load, static_mode.static_load, "N", UNSTATED),
        ("natural frequency", frequency, worksheet.largest_frequency, "Hz", NOT_GIVEN),
        ("rated travel", travel, shock_mode.travel, "m", UNSTATED),
        ("room", travel, worksheet.travel, "m", NOT_GIVEN),
        ("acceleration", acceleration, worksheet.fragility, "m/s^2", NOT_GIVEN),
    )
    verdicts = tuple(
        Verdict(
            criterion=Criterion(criterion), subject=part.name, value=value, limit=limit, unit=unit,
            note=missing if limit is None else "",
        )
        for criterion, value, limit, unit, missing in rows
    )  # fmt: skip
    exceeded = [verdict for verdict in verdicts if verdict.verdict == EXCEEDED]
    if not exceeded:
        return Candidate(
            part=part, frequency=frequency, shock_frequency=worksheet.frequency(shock_mode.shock), travel=travel,
            acceleration=acceleration, impulse=impulse, verdicts=verdicts,
        )  # fmt: skip
    decided = [verdict for verdict in exceeded if impulse < LONG or verdict.criterion not in BY_VELOCITY]
    if not decided:
        reason = (
            f"not judged: natural frequency x length of the pulse is {impulse:.3g}, far above {IMPULSE:g}: the rule "
            "of the velocity change does not hold"
        )
        return Rejected(part=part, reasons=(reason,), margin=math.nan, undecided=True)
    reasons = []
    for verdict in decided:
        scale, unit = {"m": (1e3, "mm"), "m/s^2": (1.0 / gravity, "g")}.get(verdict.unit, (1.0, verdict.unit))
        limit = scale * (verdict.limit or 0.0)
        reasons.append(f"{verdict.criterion} {scale * verdict.value:.4g} {unit}, limit {limit:.4g} {unit}")
    return Rejected(part=part, reasons=tuple(reasons), margin=smallest_margin(decided))
