"""All verdicts on a run, and the headline that sums them up in one sentence."""

from collections.abc import Sequence

from wirerope_mj.assessment.criteria.ended import GROWS, TOO_EARLY, require_over
from wirerope_mj.assessment.criteria.loads import (
    contact_verdicts,
    force_verdicts,
    missing_load_verdicts,
    rested_verdicts,
    starting_load_verdicts,
    static_load_verdicts,
)
from wirerope_mj.assessment.criteria.payload import NO_CLEARANCE, UNLIMITED, acceleration_verdicts, rattle_verdicts
from wirerope_mj.assessment.criteria.sampled import SAMPLED
from wirerope_mj.assessment.criteria.travel import bottoming_verdicts, travel_verdicts
from wirerope_mj.assessment.criteria.verdict import (
    BOTTOMING,
    BY_LIMITS,
    COMBINED,
    EXCEEDED,
    RATTLE_SPACE,
    RESTED,
    STATIC_LOAD,
    STOP,
    STRUCK,
    TRAVEL,
    WITHIN,
    Verdict,
    against_limit,
    most_amplified,
    most_used,
    used_text,
)
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.statics import StaticTable
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.mounts.isolator.travel import HANGS

FAIL, PASS, UNKNOWN = "FAIL", "PASS", "NOT JUDGED"  # Answers with which a headline begins
_SHOWN = 5  # verdicts that the text of `Verdicts` lists


def headline(verdicts: Sequence[Verdict]) -> str:
    """Sum up verdicts in a sentence: pass or fail, the most critical check, struck stops, and values that are not judged."""

    def several(count: int, thing: str) -> str:
        return f"{count} {thing}{'' if count == 1 else 's'}"

    early = next((row.note.partition("; ")[0] for row in verdicts if row.note.startswith(TOO_EARLY)), "")
    over, within = (sum(row.verdict == verdict for row in verdicts) for verdict in (EXCEEDED, WITHIN))
    judged = over + within
    part, missing = scope(verdicts)
    if over:
        answer = fail_text(f"{over} of {several(judged, 'check')} exceeded", verdicts)
    elif early:
        answer = f"{UNKNOWN}: {early}"
    elif judged:
        checks = "the only check is" if judged == 1 else f"all {judged} checks are"
        answer = f"{PASS}{part}: most critical {critical_text(verdicts)}; {checks} within limits"
    else:
        answer = f"{UNKNOWN}: no limit is stated for anything in this run"
    clauses = [answer, missing if judged and not early else "", amplified_text(verdicts)]
    for thing, does, outcomes in contacts(verdicts):
        if STRUCK in outcomes:
            clauses.append(f"{outcomes.count(STRUCK)} of {several(len(outcomes), thing)} {does}")
    left = len(verdicts) - judged - sum(bool(row.contact) for row in verdicts)
    if early and within:
        clauses.append(f"{several(within, 'check')} of the state at rest kept")
    elif judged and left:
        reasons = any(row.note.startswith((TOO_EARLY, SAMPLED)) or GROWS in row.note for row in verdicts if not row.contact)
        verb, why = ("is" if left == 1 else "are", "not judged") if reasons else ("has" if left == 1 else "have", "no limit")
        clauses.append(f"{several(left, 'value')} {verb} {why}")
    if grows := sum(row.note.startswith(GROWS) for row in verdicts):
        clauses.append(f"{grows} of them still {'grows' if grows == 1 else 'grow'} when the run ends: run longer")
    clauses.append(early if over else "")
    return "; ".join(clause for clause in clauses if clause) + "."


def contacts(verdicts: Sequence[Verdict]) -> list[tuple[str, str, list[str]]]:
    """List the contact outcomes of geom pairs, of stops, and of mounts that bottom: each kind's noun, verb and outcomes."""
    mounts = {f"bottom_{row.subject}" for row in verdicts if row.criterion == BOTTOMING}
    pairs, stops, solid = list[str](), list[str](), list[str]()
    for row in (row for row in verdicts if row.contact):
        (pairs if row.criterion != STOP else solid if row.subject in mounts else stops).append(row.contact)
    return [("contact pair", "struck", pairs), ("stop", "struck", stops), ("mount", "bottomed", solid)]


def scope(verdicts: Sequence[Verdict]) -> tuple[str, str]:
    """Name the judged parts of the system, such as " of the mounts", and the part not judged; "" each if all are judged."""
    rows = [row for row in verdicts if not row.contact]
    parts = {
        "mounts": [row for row in rows if row.criterion.kind in OF_MOUNTS],
        "payload": [row for row in rows if row.criterion.kind not in (*OF_MOUNTS, RATTLE_SPACE)],
        "rattle space": [row for row in rows if row.criterion.kind == RATTLE_SPACE],
    }
    judged = [part for part, members in parts.items() if any(row.verdict in (WITHIN, EXCEEDED) for row in members)]
    missing = [part for part in ("mounts", "payload") if parts[part] and part not in judged]
    mounts = {row.subject for row in parts["mounts"]}
    hanging = {row.subject for row in parts["mounts"] if row.note == HANGS}
    known = {row.subject for row in parts["mounts"] if row.verdict in (WITHIN, EXCEEDED)} - hanging
    some = "mounts" in judged and known != mounts
    of = f" of {f'{len(known)} of {len(mounts)} ' if some else 'the '}{' and '.join(judged)}"
    if not missing:
        return of if some else "", ""
    part, why = missing[-1], ": they hang, and ratings hold for compression" if hanging == mounts else ": nothing is rated"
    if part == "payload":
        stated = all(row.note.endswith((UNLIMITED, NO_CLEARANCE)) for row in parts[part])
        why = ": no limit stated" if stated else ""
    what = "acceleration of the payload" if part == "payload" and "rattle space" in judged else part
    return of, f"{what} not judged{why}"


def amplified_text(verdicts: Sequence[Verdict]) -> str:
    """Describe the largest amplification of the base's acceleration in a clause; "" if no acceleration is above the base's."""
    if (worst := most_amplified(verdicts)) is None:
        return ""
    subject, amplification = worst
    value, base = (f"{number / STANDARD_GRAVITY:.3g}" for number in (amplification.value, amplification.base))
    return f"amplification {amplification.ratio:.3g} at {subject} ({amplification.measure} {value} g, base {base} g)"


def fail_text(count: str, verdicts: Sequence[Verdict], where: str = "") -> str:
    """Describe a failure: weight on stops at rest first, the worst exceeded limit, and the count of them."""
    rested = max((row for row in verdicts if row.criterion.kind == RESTED), key=lambda row: row.value, default=None)
    if rested is None:
        return f"{FAIL}: {critical_text(verdicts)}{where}; {count}"
    rest = [row for row in verdicts if row.criterion.kind != RESTED]
    worst = f"; else most critical {critical_text(rest)}" if most_used(rest) is not None else ""
    return f"{FAIL}: {rested.note}; {count}{worst}"


def critical_text(verdicts: Sequence[Verdict]) -> str:
    """Describe the most critical check: "h4 travel in roll 41.2 mm, limit 40 mm (103 %) at 27.9 ms"."""
    worst = most_used(verdicts)
    assert worst is not None
    return against_limit(worst)


_RATED = (TRAVEL, STATIC_LOAD)
OF_MOUNTS = (RESTED, *_RATED, COMBINED.kind, BOTTOMING.kind, *BY_LIMITS)


class Verdicts(tuple[Verdict, ...]):
    """Verdicts that print as their headline and the largest utilisations."""

    def __repr__(self) -> str:
        judged = sorted((row for row in self if row.utilisation is not None), key=lambda row: -(row.utilisation or 0.0))
        lines = [f"  {row.criterion} of {row.subject}: {used_text(row.utilisation or 0.0)}" for row in judged[:_SHOWN]]
        return "\n".join([f"{len(self)} verdicts. {headline(self)}", *lines])


def judge(
    response: Response, limits: Sequence[PayloadLimit] | None = None, *, statics: StaticTable | None = None
) -> tuple[Verdict, ...]:
    """Judge accelerations, travels, bottoming, rattle space, static loads and contacts of a run.

    Of peaks that are not over when the run ends only those that already exceed their limits are judged.

    Args:
        response: of the run.
        limits: of the payload and of mounts; without them the model's own.
        statics: of the system; with it static loads are judged on the first loading and relaxed, last of all, and not those
            at the start of the run.
    """
    begin = require_over(
        response,
        (
            *acceleration_verdicts(response, limits), *travel_verdicts(response), *bottoming_verdicts(response),
            *rattle_verdicts(response, limits), *force_verdicts(response, limits),
        ),
    )  # fmt: skip
    contacts = require_over(response, contact_verdicts(response))
    if statics is None:
        return Verdicts((*begin, *starting_load_verdicts(response), *contacts))
    at_rest = (*rested_verdicts(statics), *static_load_verdicts(statics), *missing_load_verdicts(statics))
    return Verdicts((*begin, *contacts, *at_rest))
