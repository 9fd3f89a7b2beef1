"""Contacts: whether stops were struck, and how hard."""

from wirerope_mj.criteria.verdict import CLEAR, STRUCK, TOUCHING, Verdict
from wirerope_mj.response import ContactPeak, Response

CONTACT = "contact"


def contact_verdicts(response: Response) -> tuple[Verdict, ...]:
    """Return what became of every pair of geoms that may touch, with its largest force [N]; () where none was recorded.

    No limit is stated for a contact: that a stop is struck is the finding, since the accelerations depend on its stiffness
    and damping from then on.
    """
    return tuple(_verdict(name, contact) for name, contact in (response.peaks.contacts or {}).items())


def _verdict(name: str, contact: ContactPeak) -> Verdict:
    return Verdict(
        criterion=CONTACT,
        subject=name,
        value=contact.force,
        limit=None,
        unit="N",
        time=contact.force_time,
        note=contact_words(contact),
        contact=STRUCK if contact.struck else TOUCHING if contact.touches else CLEAR,
    )


def contact_words(contact: ContactPeak) -> str:
    """Return when a pair touched first, how often, how deep and for how long; "" for one that never did."""
    if not contact.touches:
        return ""
    strikes = contact.touches - int(contact.from_start)
    begin = "touching from the start" if contact.from_start else f"first at {contact.first_touch:.4f} s"
    again = "again " if contact.from_start else ""
    often = f", struck {again}{'once' if strikes == 1 else f'{strikes} times'}" if strikes else ""
    return f"{begin}{often}, {1e3 * contact.duration:.3g} ms in all, {1e3 * contact.penetration:.3g} mm deep"
