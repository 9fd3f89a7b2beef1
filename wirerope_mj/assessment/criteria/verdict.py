"""A value against its limit, and the criterion: a kind, an axis and a sense, as the text that outputs and files write."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.foundation.summary import json_values
from wirerope_mj.foundation.units import force_unit, instant_text, shown_in, significant

ACCELERATION: Final = "acceleration"
RATTLE_SPACE: Final = "rattle space"
TRAVEL: Final = "travel"
RMS: Final = "rms acceleration"
SIGMA: Final = "3-sigma acceleration"
LARGEST: Final = "largest acceleration"
AMPLIFIED = 1.005  # Ratio to the base above which an amplification is reported: less would print as 1.00
LOAD: Final = "load"
STOP_FORCE: Final = "stop force"
STOP_GAP: Final = "stop gap"
CLOSING_SPEED: Final = "closing speed"
BY_LIMITS: Final = (LOAD, STOP_FORCE, CLOSING_SPEED, STOP_GAP)  # Criteria of mounts whose limits are stated beside ratings
STATIC_LOAD: Final = "static load in compression"
RESTED: Final = "weight on stops"


class Criterion(str):
    """Kind, axis and sense of a limit, as the text "acceleration along z" or "travel in compression", which it equals."""

    kind: str  # ACCELERATION, RATTLE_SPACE, TRAVEL, STATIC_LOAD, or the name of any other criterion
    axis: str  # "x", "y" or "z"; "" for the size of a vector, or none
    # "+" or "-" along an axis, a rating of `mounts.isolator.travel` for a travel, a history for a static load
    sense: str

    def __new__(cls, kind: str, *, axis: str = "", sense: str = "") -> "Criterion":
        """Compose the text: "acceleration along z", "rattle space along -x", "travel in roll", "static load .., relaxed"."""
        text = f"{kind} along {sense}{axis}" if axis else kind
        if sense and not axis:
            text += f"{' in ' if kind == TRAVEL else ', '}{sense}"
        criterion = super().__new__(cls, text)
        criterion.kind, criterion.axis, criterion.sense = kind, axis, sense
        return criterion

    def __reduce__(self) -> tuple[object, ...]:
        return partial(Criterion, self.kind, axis=self.axis, sense=self.sense), ()


COMBINED: Final = Criterion("travel combined")
BOTTOMING: Final = Criterion("bottoming")
CONTACT: Final = Criterion("contact")
STOP: Final = Criterion("stop")

WITHIN, EXCEEDED, NOT_JUDGED = "within", "exceeded", "not judged"
# Verdicts on contact pairs and stops, which have no limit: a struck stop is a finding in itself.
STRUCK, TOUCHING, CLEAR = "struck", "touching from the start", "not touched"


@dataclass(frozen=True, kw_only=True)
class Amplification:
    """Acceleration of the payload and of the base by the same measure."""

    measure: str  #: "peak", or "rms along z"
    value: float  #: of the payload [m/s^2]
    base: float  #: of the base [m/s^2], > 0

    @property
    def ratio(self) -> float:
        """Value over the base's: above 1 the mounts amplify."""
        return self.value / self.base


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """A value against its limit by one criterion; without a limit, or without a value, nothing is judged."""

    criterion: Criterion  #: what is judged, for instance "acceleration along z" or "travel in compression"
    subject: str  #: name of the judged body, point or mount
    value: float  #: value that was reached, in `unit`; NaN if it is not known
    limit: float | None  #: value that is allowed, in `unit`; None if no limit is stated
    unit: str  #: SI unit of both, "" for a ratio
    time: float | None = None  #: instant at which the value was reached [s]; None if it has none
    note: str = ""  #: why it is not judged, or how the value was found
    contact: str = ""  #: STRUCK, TOUCHING, CLEAR or NOT_JUDGED for a contact pair; "" for everything else
    #: amplification of the base's acceleration under a shock or random vibration; None for other criteria
    amplification: Amplification | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.criterion, Criterion):  # a criterion of a caller's own, as text
            object.__setattr__(self, "criterion", Criterion(self.criterion))
        if self.limit is not None and not 0.0 < self.limit < math.inf:
            raise ValueError(f"`limit` must be a finite number > 0 or None, got {self.limit!r}.")

    @property
    def utilisation(self) -> float | None:
        """Value over limit; None = not judged, or weight on stops, whose limit is but a threshold for any weight there."""
        return None if self.criterion.kind == RESTED else self._ratio

    @property
    def _ratio(self) -> float | None:
        return None if self.limit is None or math.isnan(self.value) else self.value / self.limit

    @property
    def margin(self) -> float | None:
        """Limit over value minus one, negative where it is exceeded; None = not judged; infinite where the value is zero."""
        used = self.utilisation
        if used is None:
            return None
        return 1.0 / used - 1.0 if used > 0.0 else math.inf

    @property
    def verdict(self) -> str:
        """One of "within", "exceeded" and "not judged", or the outcome of a contact pair; a value at its limit is within."""
        if self.contact:
            return self.contact
        if self._ratio is None:
            return NOT_JUDGED
        return WITHIN if self._ratio <= 1.0 else EXCEEDED

    def to_dict(self) -> Entries:
        """Write the verdict as plain values; unknown and non-finite values are None."""
        return {
            "criterion": str(self.criterion), "subject": self.subject, "value": json_values(self.value),
            "limit": self.limit, "unit": self.unit, "time_s": self.time, "margin": json_values(self.margin),
            "verdict": self.verdict, "note": self.note,
        }  # fmt: skip


def criterion_text(criterion: Criterion) -> str:
    """Name a criterion in sentences; files keep "travel combined", as they began with it."""
    return "combined travel" if criterion == COMBINED else str(criterion)


def against_limit(row: Verdict) -> str:
    """Write a value against its limit: "rack 10.2 g, limit 10 g (102 %) at 27.9 ms"; a ratio as its percentage."""
    what = row.subject if row.criterion == ACCELERATION else f"{row.subject} {criterion_text(row.criterion)}"
    used = used_text(row.utilisation or 0.0)
    no_instant = {STATIC_LOAD: " at rest", RMS: " over the run", SIGMA: " over the run"}
    at = no_instant.get(row.criterion.kind, "") if row.time is None else f" at {instant_text(row.time)}"
    if not row.unit:
        return f"{what} {used}{at}"
    value, limit, unit = value_and_limit(row)
    return f"{what} {value} {unit}, limit {limit} {unit} ({used}){at}"


def used_text(utilisation: float) -> str:
    """Write a utilisation in per cent, with as many decimals as it takes to tell it from 100 %: "88 %", "100.3 %"."""
    texts = [f"{100.0 * utilisation:.{decimals}f}" for decimals in range(7)]
    return f"{next((text for text in texts if float(text) != 100.0), '100')} %"


def value_and_limit(row: Verdict) -> tuple[str, str, str]:
    """Write a judged value and its limit in the one unit that suits both, and that unit."""
    unit, factor = shown_in(row.unit)
    limit = row.limit or 0.0
    if row.unit == "N" and force_unit(max(abs(row.value), limit)) == "N":
        unit, factor = "N", 1.0
    return significant(factor * row.value), f"{factor * limit:.4g}", unit


def largest_each(verdicts: Iterable[Verdict]) -> list[Verdict]:
    """Keep the verdict with the largest value for each criterion and subject, such as of a body and a point of one name."""
    largest: dict[tuple[str, str], Verdict] = {}
    for row in verdicts:
        key = row.criterion, row.subject
        if key not in largest or row.value > largest[key].value:
            largest[key] = row
    return list(largest.values())


def most_used(verdicts: Iterable[Verdict]) -> Verdict | None:
    """Find the verdict with the largest utilisation; None if no verdict is judged."""
    return next(iter(by_use(verdicts).values()), None)


def by_use(verdicts: Iterable[Verdict]) -> dict[str, Verdict]:
    """Find the verdict with the largest utilisation of every judged subject, the largest first.

    This is the order in which the most critical mounts, bodies and points are named and drawn.
    """
    judged = [row for row in verdicts if row.utilisation is not None]
    first: dict[str, Verdict] = {}
    for row in sorted(judged, key=lambda row: row.utilisation or 0.0, reverse=True):
        first.setdefault(row.subject, row)
    return first


def most_amplified(verdicts: Iterable[Verdict]) -> tuple[str, Amplification] | None:
    """Find the subject with the largest amplification of the base's acceleration; None if there is no amplification."""
    amplified = [(row.subject, row.amplification) for row in verdicts if row.amplification is not None]
    worst = max(amplified, key=lambda pair: pair[1].ratio, default=None)
    return worst if worst is not None and worst[1].ratio > AMPLIFIED else None


def smallest_margin(verdicts: Iterable[Verdict]) -> float:
    return min((verdict.margin for verdict in verdicts if verdict.margin is not None), default=math.inf)


def payload_bodies(response: Response) -> list[str]:
    """Name the bodies that move and are not fixed to the base, in the order of the scene."""
    return [body.name for body in response.scene.bodies if body.moves and not body.on_base]


def limits_by_name(
    response: Response, limits: Sequence[PayloadLimit] | None, kind: str, known: Sequence[str], others: Sequence[str] = ()
) -> dict[str, PayloadLimit]:
    """Choose the limits of one kind, the given or else the model's, by the name of the body, point or mount limited.

    ValueError, which lists the `known` names, if a limit names none of these and none of `others`.
    """
    chosen = [limit for limit in (response.scene.limits if limits is None else limits) if limit.kind == kind]
    for limit in chosen:
        if limit.name not in known and limit.name not in others:
            names = ", ".join(known) or "none"
            raise ValueError(f"`limits` name {limit.name!r}, which has no {kind} here. There are: {names}.")
    return {limit.name: limit for limit in chosen}
