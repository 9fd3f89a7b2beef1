"""Verdicts in a few sentences: payload and mounts against their limits, and what nobody judges."""

from wirerope_mj.assessment.criteria import (
    EXCEEDED,
    NOT_JUDGED,
    Verdict,
    acceleration_verdicts,
    bottoming_verdicts,
    closing_words,
    rattle_verdicts,
    travel_verdicts,
)
from wirerope_mj.assessment.criteria.travel import COMBINED
from wirerope_mj.assessment.verdicts.peaks import mount_peaks
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.units import shown_in
from wirerope_mj.mounts.isolator.travel import RATINGS

_NAMED = 4  # contact pairs that a sentence names


def verdict_lines(response: Response) -> list[str]:
    """Return the verdicts in a few sentences: payload and worst mount against their limits, and what is not judged."""
    return _payload_lines(response) + _travel_lines(response) + contact_lines(response)


def contact_lines(response: Response) -> list[str]:
    """Return which pair of geoms was struck hardest and how many others were, which stops closed, and what touches always."""
    known = response.peaks.contacts or {}
    contacts = {name: contact for name, contact in known.items() if not contact.mount}
    lines, struck = [], [name for name in response.peaks.struck if name in contacts]
    if struck:
        first, hardest = contacts[struck[0]], max(struck, key=lambda name: contacts[name].force)
        lines.append(
            f"Struck: {_listed(struck)}; first {struck[0]} at {first.first_touch:.4f} s, hardest {hardest} with "
            f"{1e-3 * contacts[hardest].force:.3g} kN. Accelerations are uncertain from the first touch on."
        )
    elif contacts and not any(contact.touches for contact in contacts.values()):
        lines.append(f"No stop is struck: {len(contacts)} pair{'s' if len(contacts) > 1 else ''} may touch, none did.")
    lines += _stop_lines(response, len(known) - len(contacts))
    resting = [contact.called(name) for name, contact in known.items() if contact.from_start and not contact.struck]
    if resting:
        lines.append(f"Touching from the start: {_listed(resting)}.")
    return lines


def _stop_lines(response: Response, n_stops: int) -> list[str]:
    """Return which stops of mounts closed, the first one first, or that none of them did."""
    contacts = response.peaks.contacts or {}
    closed = [name for name in response.peaks.struck if contacts[name].mount]
    if closed:
        words = _listed([closing_words(name, contacts[name]) for name in closed], "; ")
        return [f"{words[0].upper()}{words[1:]}. From then on accelerations depend on what the stops are made of."]
    if n_stops and not any(contact.touches for contact in contacts.values() if contact.mount):
        return [f"No stop closes: {'there is one' if n_stops == 1 else f'there are {n_stops}'}."]
    return []


def _listed(names: list[str], between: str = ", ") -> str:
    """Return some names and how many more there are."""
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return between.join(names[:_NAMED]) + more


def _payload_lines(response: Response) -> list[str]:
    """Return what exceeds the payload's limits, or comes nearest to them, and what has no limit."""
    found = (*acceleration_verdicts(response), *rattle_verdicts(response))
    judged = sorted((row for row in found if row.share is not None), key=lambda row: row.share or 0.0, reverse=True)
    over = [row for row in judged if row.verdict == EXCEEDED]
    lines = [f"Exceeded: {_words(row)}." for row in over]
    if judged and not over:
        lines.append(f"Payload within its limits; nearest is {_words(judged[0])}.")
    unjudged = [
        word
        for word in ("acceleration", "rattle space")
        if not any(row.criterion.startswith(word) and row.verdict != NOT_JUDGED for row in found)
    ]
    if unjudged and found:
        lines.append(f"Not judged, because the model states no limit: {' and '.join(unjudged)} of the payload.")
    return lines


def _words(row: Verdict) -> str:
    unit, factor = shown_in(row.unit)
    reached = f"{factor * row.value:.3g} of {factor * (row.limit or 0.0):.3g} {unit}"
    return f"{row.criterion} of {row.subject}, {reached} ({100.0 * (row.share or 0.0):.0f} %)"


def _travel_lines(response: Response) -> list[str]:
    """Return what the worst mount uses of its rated travel, which mounts exceed it, and which are not judged."""
    mounts = mount_peaks(response)
    judged = [row for row in mounts if row.share is not None]
    lines = []
    if judged:
        worst = judged[0]
        axis = max(RATINGS, key=lambda name: worst.shares[name] or 0.0)
        lines.append(f"{worst.name} uses most of its rated travel: {100 * (worst.share or 0.0):.0f} % in {axis}.")
        over = {rating: [row.name for row in judged if (row.shares[rating] or 0.0) > 1.0] for rating in RATINGS}
        words = [f"in {rating} by {', '.join(names)}" for rating, names in over.items() if names]
        lines.append(
            f"Rated travel exceeded {'; '.join(words)}." if words else "No mount exceeds a rated travel along one axis."
        )
        lines += _combined_line(response)
    flat = [row.subject for row in bottoming_verdicts(response) if row.verdict == EXCEEDED]
    if flat:
        lines.append(
            f"Pressed beyond their own height, which cannot be: {', '.join(flat)}. A stop is missing in the model."
        )
    untensioned = bool(judged) and all(row.shares["tension"] is None for row in judged)
    unjudged = ["tension of every mount"] if untensioned else []
    unjudged += [row.name for row in mounts if row.share is None]
    if unjudged:
        lines.append(f"Not judged, because no travel is rated: {', '.join(unjudged)}.")
    return lines


def _combined_line(response: Response) -> list[str]:
    """Return which mounts come to more than their ratings with all axes taken together."""
    rows = [row for row in travel_verdicts(response) if row.criterion == COMBINED and row.verdict == EXCEEDED]
    if not rows:
        return []
    worst = max(rows, key=lambda row: row.value)
    names = ", ".join(row.subject for row in rows)
    return [
        f"All axes together leave the ellipsoid through the rated travels at {names}; farthest at {worst.subject}: "
        f"{100.0 * worst.value:.0f} %."
    ]
