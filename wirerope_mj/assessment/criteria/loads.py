"""Loads of mounts against their ratings, and contacts and stops of mounts: whether they were struck, and how hard."""

import math
from collections.abc import Sequence

import numpy as np

from wirerope_mj.assessment.criteria.sampled import read_start
from wirerope_mj.assessment.criteria.verdict import (
    CLEAR,
    CONTACT,
    RESTED,
    STATIC_LOAD,
    STOP,
    STRUCK,
    TOUCHING,
    Criterion,
    Verdict,
    payload_bodies,
)
from wirerope_mj.engine.response import ContactPeak, Response
from wirerope_mj.engine.statics import StaticTable
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import STANDARD_GRAVITY, duration_text, force_text, instant_text
from wirerope_mj.mounts.isolator.travel import static_load_unjudged

# Acceleration below which the first sample is taken for rest: an equilibrium leaves far less, a falling payload 1 g.
AT_STOPS = 0.01  # of the weight that stops may carry at rest: less is a stop that is just reached
_NAMED = 4  # stops that a sentence names
AT_REST = 1e-3 * STANDARD_GRAVITY


def starting_load_verdicts(response: Response) -> tuple[Verdict, ...]:
    """Judge the compression every mount carries at the start of the run against its rated static load.

    The rating holds for compression. A mount that hangs, or carries more across its axis than along it, is not judged, nor
    is a run that does not begin at rest in equilibrium.
    """
    moving = payload_bodies(response)
    start = [float(np.abs(read_start(response, f"bodies/{name}/acceleration/x", 3)).max()) for name in moving]
    unsettled = "" if max(start, default=0.0) < AT_REST else "the run does not begin at rest in equilibrium"
    return tuple(
        _static(
            Criterion(STATIC_LOAD), mount.name, read_start(response, f"mounts/{mount.name}/force/roll", 3), mount.static_load,
            "" if math.isnan(mount.static_load) else unsettled,
        )
        for mount in response.scene.isolating
    )  # fmt: skip


def static_load_verdicts(table: StaticTable) -> tuple[Verdict, ...]:
    """Judge the compression of every mount, history by history, as `starting_load_verdicts` does for a run.

    Not judged where no load is rated, where the mount hangs, and where it carries more across its axis than along it.
    """
    return tuple(
        _static(Criterion(STATIC_LOAD, sense=history), name, mount.force, mount.static_load)
        for history, sag in table.sags.items()
        for name, mount in sag.listed.items()
    )


def rested_verdicts(table: StaticTable) -> tuple[Verdict, ...]:
    """Judge for each history the share of the weight that stops or contacts carry at rest; () where none does.

    Isolation is short-circuited there: what the base does goes through them.
    """
    verdicts = []
    for history, sag in table.sags.items():
        pressed = {name: mount.on_stops for name, mount in sag.mounts.items() if mount.on_stops > 0.0}
        contacts = abs(sag.on_contacts)
        share = (sum(pressed.values()) + contacts) / sag.weight if sag.weight else 0.0
        if share > AT_STOPS:
            names = [*sorted(pressed, key=lambda name: -pressed[name]), *(["contacts"] if contacts > 0.0 else [])]
            some = ", ".join(names[:_NAMED]) + (f" and {len(names) - _NAMED} more" if len(names) > _NAMED else "")
            when = {"virgin": "on the first loading", "relaxed": "after long vibration"}[history]
            note = (
                f"isolation is short-circuited at rest, {when}: {some} {'carries' if len(names) == 1 else 'carry'} "
                f"{100.0 * share:.2g} % of the weight"
            )
            criterion = Criterion(RESTED, sense=history)
            verdicts.append(Verdict(criterion=criterion, subject=names[0], value=share, limit=AT_STOPS, unit="", note=note))
    return tuple(verdicts)


def missing_load_verdicts(table: StaticTable) -> tuple[Verdict, ...]:
    """Note for each history without an equilibrium that its static loads are not judged, and why."""
    return tuple(
        Verdict(
            criterion=Criterion(STATIC_LOAD, sense=history), subject="every mount", value=math.nan, limit=None, unit="N",
            note=reason.rstrip("."),
        )
        for history, reason in table.missing.items()
    )  # fmt: skip


def _static(
    criterion: Criterion, name: str, force: Sequence[float] | Array, rated: float | None, unjudged: str = ""
) -> Verdict:
    note = unjudged or static_load_unjudged(force, rated)
    compression = max(-float(force[2]), 0.0)
    limit = None if note else rated
    return Verdict(criterion=criterion, subject=name, value=compression, limit=limit, unit="N", note=note)


def contact_verdicts(response: Response) -> tuple[Verdict, ...]:
    """Say of every pair of geoms that may touch and of every stop what became of it, with the largest force [N].

    () where none was recorded. No limit is stated for a contact: that a stop is struck is the finding, since the
    accelerations depend on its stiffness and damping from then on.
    """
    return tuple(
        Verdict(
            criterion=STOP if contact.mount else CONTACT, subject=name, value=contact.force, limit=None, unit="N",
            time=contact.force_time, note=contact_text(contact),
            contact=STRUCK if contact.struck else TOUCHING if contact.touches else CLEAR,
        )
        for name, contact in (response.peaks.contacts or {}).items()
    )  # fmt: skip


def contact_text(contact: ContactPeak) -> str:
    """Say when a pair or a stop touched first, how often, how deep and for how long; "" for one that never did."""
    if not contact.touches:
        return ""
    strikes = contact.touches - int(contact.from_start)
    begin = "touching from the start" if contact.from_start else f"first at {contact.first_touch:.4f} s"
    again = "again " if contact.from_start else ""
    often = f", struck {again}{'once' if strikes == 1 else f'{strikes} times'}" if strikes else ""
    return f"{begin}{often}, {duration_text(contact.duration)} in all, {1e3 * contact.penetration:.3g} mm deep"


def closing_text(name: str, contact: ContactPeak) -> str:
    """Say when a stop of a mount closed first and its largest force, "stop s3 closed at 61.2 ms, up to 4.1 kN"."""
    when = instant_text(contact.first_touch or 0.0)
    return f"{contact.called(name)} closed at {when}, up to {force_text(contact.force)}"
