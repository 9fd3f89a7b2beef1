"""The one sentence that answers whether a run keeps its limits, the same in every output."""

from collections.abc import Sequence

from wirerope_mj.assessment.criteria.criterion import STOP
from wirerope_mj.assessment.criteria.ended import GROWS, TOO_EARLY
from wirerope_mj.assessment.criteria.verdict import EXCEEDED, STRUCK, WITHIN, Verdict

_SHOWN = 5


def headline(verdicts: Sequence[Verdict]) -> str:
    """Return the answer in one sentence: how many limits are exceeded, how many stops are struck, how much is not judged."""
    early = next((row.note.partition("; ")[0] for row in verdicts if row.note.startswith(TOO_EARLY)), "")
    over, within = (sum(row.verdict == verdict for row in verdicts) for verdict in (EXCEEDED, WITHIN))
    judged, contacts = over + within, sum(bool(row.contact) for row in verdicts)
    if over:
        # "of" the judged, so that it is not read as a share of everything
        answer = f"Exceeded: {over} of {_several(judged, 'limit')}"
    elif early:
        answer = f"Not judged: {early}"
    elif judged:
        answer = f"Within {'its limit' if judged == 1 else f'all {judged} limits'}"
    else:
        answer = "Nothing is judged: no limit is stated for anything in this run"
    clauses = [answer]
    for thing, of_mounts in (("contact pair", False), ("stop", True)):
        outcomes = [row.contact for row in verdicts if row.contact and (row.criterion == STOP) is of_mounts]
        if STRUCK in outcomes:
            clauses.append(f"{outcomes.count(STRUCK)} of {_several(len(outcomes), thing)} struck")
    left = len(verdicts) - judged - contacts
    if early and within:
        clauses.append(f"{_several(within, 'limit')} of the state at rest kept")
    elif judged and left:
        clauses.append(f"{_several(left, 'figure')} {'is' if left == 1 else 'are'} not judged")
    grows = sum(row.note.startswith(GROWS) for row in verdicts)
    if grows:
        clauses.append(f"{grows} of them still {'grows' if grows == 1 else 'grow'} when the run ends: run longer")
    if early and over:
        clauses.append(early)
    return f"{'; '.join(clauses)}."


class Verdicts(tuple[Verdict, ...]):
    """Verdicts whose text is the answer, and those that are nearest to their limits or beyond."""

    def __repr__(self) -> str:
        judged = sorted((row for row in self if row.utilisation is not None), key=lambda row: -(row.utilisation or 0.0))
        lines = [
            f"  {row.criterion} of {row.subject}: {100.0 * (row.utilisation or 0.0):.0f} %" for row in judged[:_SHOWN]
        ]
        return "\n".join([f"{len(self)} verdicts. {headline(self)}", *lines])


def _several(count: int, thing: str) -> str:
    return f"{count} {thing}{'' if count == 1 else 's'}"
