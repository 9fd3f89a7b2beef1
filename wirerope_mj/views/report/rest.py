"""The parts of a report about the system at rest: sag and loads of the mounts, and its modes."""

from collections.abc import Mapping

import numpy as np

from wirerope_mj.dynamics.modes import Modes
from wirerope_mj.engine.statics import Sag
from wirerope_mj.views.report.content import Block, Cell, Mark, Paragraph, Section, Table
from wirerope_mj.views.report.display import ABSENT, fixed, percent, shown, with_unit
from wirerope_mj.views.report.run import Absent, FinishedRun

_WORDS = {
    "virgin": "first loading, as after installation",
    "relaxed": "after long vibration, when friction carries nothing any more",
}
_BALANCED = 1e-4  # of the weight, below which nobody asks where the rest is
_FAR = 100.0  # times the weight from which the number says nothing more
_NOTE = (
    "Small cycles: the limit of vanishing amplitude; in a shock the mounts soften and the frequencies fall. Unloading and "
    "further loading: with the mounts' tangents in either direction from rest, which the first quarter cycle feels. Mass: "
    "share of the moving mass that takes part along each axis."
)


def statics_section(run: FinishedRun) -> Section:
    """Return sag and load of every mount and payload under gravity, on the first loading and relaxed."""
    title = "At rest under gravity"
    if not run.response.scene.mounts:
        return Section(title=title, blocks=())
    if not run.gravity:
        return Section(
            title=title, blocks=(Paragraph(text="The model has no gravity: the mounts carry nothing at rest."),)
        )
    if isinstance(run.statics, Absent):
        return Section(title=title, blocks=(Paragraph(text=run.statics.reason, tone="unjudged"),))
    sags = run.statics.sags
    blocks: list[Block] = [
        Paragraph(text=f"{history.capitalize()}: {reason}", tone="unjudged")
        for history, reason in run.statics.missing.items()
    ]
    blocks += [_loads(run, sags), _payloads(sags)]
    blocks += [Paragraph(text=_sum(history, sag)) for history, sag in sags.items()]
    return Section(title=title, blocks=tuple(blocks))


def _loads(run: FinishedRun, sags: Mapping[str, Sag]) -> Table:
    head = ["mount"]
    for history in sags:
        head += [
            f"{part}, {history} [{unit}]" for part, unit in (("axial sag", "mm"), ("carries", "kN"), ("of rating", "%"))
        ]
    rows = []
    for mount in run.response.scene.mounts:
        if not any(mount.name in sag.listed for sag in sags.values()):
            continue
        cells: list[Cell] = [mount.name]
        for sag in sags.values():
            load = sag.mounts[mount.name]
            cells += [shown(float(load.deflection[2]), "m"), shown(load.carries, "N"), _share(load.utilisation)]
        rows.append(tuple(cells))
    words = "; ".join(f"{history}: {_WORDS[history]}" for history in sags)
    return Table(
        caption="Sag and load of every mount",
        head=tuple(head),
        align="l" + "rrr" * len(sags),
        rows=tuple(rows),
        note="Sag along the mount's own axis, negative in compression. Carries: what the mount pushes up with. Of rating: the "
        f"axial load over the rated static load, which is one in compression. {words[:1].upper()}{words[1:]}.",
    )


def _payloads(sags: Mapping[str, Sag]) -> Table:
    rows = []
    for history, sag in sags.items():
        for name, payload in sag.payloads.items():
            moved = [fixed(1e3 * float(value), 2) for value in (*payload.displacement, *payload.rotation)]
            rows.append((name, history, *moved))
    axes = [f"along {axis} [mm]" for axis in "xyz"] + [f"about {axis} [mrad]" for axis in "xyz"]
    return Table(
        caption="Sag of the payload's centre of mass, and its tilt",
        head=("payload", "history", *axes),
        align="llrrrrrr",
        rows=tuple(rows),
    )


def _sum(history: str, sag: Sag) -> str:
    """Return a sentence on what carries the weight."""
    words = f"{history.capitalize()}: of {with_unit(sag.weight, 'N', digits=4)} of weight the mounts carry "
    words += with_unit(sag.on_mounts, "N", digits=4)
    for share, what in ((sag.on_contacts, "contacts"), (sag.elsewhere, "joints and their springs")):
        if abs(share) > _BALANCED * sag.weight:
            words += f", {what} {with_unit(share, 'N')}"
    return f"{words}."


def _share(share: float | None) -> Cell:
    """Return the share of the rated static load in per cent."""
    if share is None:
        return ABSENT
    text = fixed(100.0 * share, 0)
    return Mark(content=f"{text}, exceeded", tone="exceeded") if share > 1.0 else text


def modes_section(run: FinishedRun) -> Section:
    """Return the modes about the position of rest with words for their shapes, and the distance from tipping over."""
    blocks: list[Block] = []
    found = [history for history, modes in run.modes.items() if isinstance(modes, Modes)]
    for history, modes in run.modes.items():
        if isinstance(modes, Absent):
            blocks.append(Paragraph(text=modes.reason, tone="unjudged"))
            continue
        blocks += [_table(history, modes, noted=history == found[-1]), Paragraph(text=_stability(modes))]
    return Section(title="Modes", blocks=tuple(blocks))


def _table(history: str, modes: Modes, *, noted: bool) -> Table:
    rows = tuple(
        (
            str(number + 1),
            modes.descriptions[number],
            fixed(float(modes.frequencies[number]), 2),
            fixed(float(modes.unloading[number]), 2),
            fixed(float(modes.loading[number]), 2),
            *(percent(float(share)) for share in modes.participation[number]),
        )
        for number in range(modes.frequencies.size)
    )
    head = (
        "mode",
        "shape",
        "small cycles [Hz]",
        "unloading [Hz]",
        "further loading [Hz]",
        "mass x",
        "mass y",
        "mass z",
    )
    return Table(
        caption=f"Modes about the position of rest, {_WORDS[history]}",
        head=head,
        align="rlrrrrrr",
        rows=rows,
        note=_NOTE if noted else "",
    )


def _stability(modes: Modes) -> str:
    stability = modes.stability
    if not np.isfinite(stability.gravity_factor):
        return f"Against tipping over: {stability.word}."
    if stability.gravity_factor > _FAR:
        return f"Against tipping over: {stability.word}; it would take more than {_FAR:.0f} times the weight."
    return (
        f"Against tipping over: {stability.word}; it would take {fixed(stability.gravity_factor, 1)} times the weight."
    )
