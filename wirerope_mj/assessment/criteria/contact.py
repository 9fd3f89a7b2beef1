"""Contacts and stops of mounts: whether they were struck, and how hard."""

from wirerope_mj.assessment.criteria.criterion import CONTACT, STOP
from wirerope_mj.assessment.criteria.verdict import CLEAR, STRUCK, TOUCHING, Verdict
from wirerope_mj.engine.response import ContactPeak, Response


def contact_verdicts(response: Response) -> tuple[Verdict, ...]:
    """Return what became of every pair of geoms that may touch and of every stop, with the largest force [N].

    () where none was recorded. No limit is stated for a contact: that a stop is struck is the finding, since the
    accelerations depend on its stiffness and damping from then on.
    """
    return tuple(_verdict(name, contact) for name, contact in (response.peaks.contacts or {}).items())


def _verdict(name: str, contact: ContactPeak) -> Verdict:
    return Verdict(
        criterion=STOP if contact.mount else CONTACT,
        subject=name,
        value=contact.force,
        limit=None,
        unit="N",
        time=contact.force_time,
        note=contact_text(contact),
        contact=STRUCK if contact.struck else TOUCHING if contact.touches else CLEAR,
    )


def contact_text(contact: ContactPeak) -> str:
    """Return when a pair or a stop touched first, how often, how deep and for how long; "" for one that never did."""
    if not contact.touches:
        return ""
    strikes = contact.touches - int(contact.from_start)
    begin = "touching from the start" if contact.from_start else f"first at {contact.first_touch:.4f} s"
    again = "again " if contact.from_start else ""
    often = f", struck {again}{'once' if strikes == 1 else f'{strikes} times'}" if strikes else ""
    return f"{begin}{often}, {1e3 * contact.duration:.3g} ms in all, {1e3 * contact.penetration:.3g} mm deep"


def closing_text(name: str, contact: ContactPeak) -> str:
    """Return when a stop of a mount closed first and its largest force, "stop s3 closed at 61.2 ms, 4.1 kN"."""
    time = contact.first_touch or 0.0
    when = f"{1e3 * time:.1f} ms" if time < 1.0 else f"{time:.4f} s"
    return f"{contact.called(name)} closed at {when}, {1e-3 * contact.force:.3g} kN"
