"""The parts of a report about the system at rest: sag and loads of the mounts, and its modes."""

from collections.abc import Mapping

import numpy as np

from wirerope_mj.modes import Modes
from wirerope_mj.report.content import Block, Cell, Mark, Paragraph, Section, Table
from wirerope_mj.report.display import ABSENT, fixed, percent, shown
from wirerope_mj.report.run import Absent, FinishedRun
from wirerope_mj.statics import Equilibrium

_WORDS = {
    "virgin": "first loading, as after installation",
    "relaxed": "after long vibration, when friction carries nothing any more",
}
_FAR = 100.0  # times the weight from which the number says nothing more
_NOTE = (
    "Small cycles: the limit of vanishing amplitude; in a shock the mounts soften and the frequencies fall. Unloading and "
    "further loading: with the mounts' tangents in either direction from rest, which the first quarter cycle feels. Mass: "
    "share of the moving mass that takes part along each axis."
)


def statics_section(run: FinishedRun) -> Section:
    """Return sag and load of every mount under gravity, on the first loading and relaxed."""
    title = "At rest under gravity"
    if not run.response.scene.mounts:
        return Section(title=title, blocks=())
    if not run.gravity:
        return Section(
            title=title, blocks=(Paragraph(text="The model has no gravity: the mounts carry nothing at rest."),)
        )
    found = {history: rest for history, rest in run.rests.items() if isinstance(rest, Equilibrium)}
    blocks: list[Block] = [
        Paragraph(text=f"{history.capitalize()}: {rest.reason}", tone="unjudged")
        for history, rest in run.rests.items()
        if isinstance(rest, Absent)
    ]
    if found:
        blocks.append(_loads(run, found))
    return Section(title=title, blocks=tuple(blocks))


def _loads(run: FinishedRun, found: Mapping[str, Equilibrium]) -> Table:
    head = ["mount"]
    for history in found:
        head += [
            f"{part}, {history} [{unit}]" for part, unit in (("axial sag", "mm"), ("load", "kN"), ("of rating", "%"))
        ]
    rows = []
    for mount in run.response.scene.mounts:
        cells: list[Cell] = [mount.name]
        for rest in found.values():
            load = rest.mounts[mount.name]
            pressed = -float(load.force[2])
            cells += [
                shown(float(load.deflection[2]), "m"),
                shown(pressed, "N", digits=3),
                _share(pressed, mount.static_load),
            ]
        rows.append(tuple(cells))
    words = "; ".join(f"{history}: {_WORDS[history]}" for history in found)
    return Table(
        caption="Sag and load of every mount",
        head=tuple(head),
        align="l" + "rrr" * len(found),
        rows=tuple(rows),
        note=f"Sag along the mount's own axis, negative in compression; load positive in compression. {words[:1].upper()}"
        f"{words[1:]}. {ABSENT} under the rating: none is stated, or the mount hangs.",
    )


def _share(load: float, rated: float) -> Cell:
    """Return the share of the rated static load, which is one of compression, in per cent."""
    if not np.isfinite(rated) or load <= 0.0:
        return ABSENT
    share = load / rated
    text = fixed(100.0 * share, 0)
    return Mark(text=f"{text}, exceeded", tone="exceeded") if share > 1.0 else text


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
            modes.words[number],
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
