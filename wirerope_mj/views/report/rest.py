"""The parts of a report about the system at rest: sag and loads of the mounts, and its modes."""

from collections.abc import Mapping

from wirerope_mj.dynamics.modes import Modes
from wirerope_mj.engine.statics import Sag
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.display import fixed, with_unit
from wirerope_mj.views.report.content import Block, Paragraph, Section
from wirerope_mj.views.report.run import FinishedRun

_HISTORIES = {
    "virgin": "first loading, as after installation",
    "relaxed": "after long vibration, when friction carries nothing any more",
}
_BALANCED = 1e-4  # of the weight, below which nobody asks where the rest is
_NOTE = (
    "Small cycles: the limit of vanishing amplitude; in a shock the mounts soften and the frequencies fall. Unloading and "
    "further loading: with the mounts' tangents in either direction from rest, which the first quarter cycle feels. Mass: "
    "fraction that takes part of the mass that can move along each axis."
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
    columns = [Column("mount", align="left")]
    for history in sags:
        for heading, unit, form in (("axial sag", "mm", 3), ("carries", "kN", 3), ("of rating", "%", "z.0f")):
            columns.append(Column(f"{heading}, {history}", unit, form))
    rows = []
    for mount in run.response.scene.mounts:
        if not any(mount.name in sag.listed for sag in sags.values()):
            continue
        cells: list[Cell] = [mount.name]
        for sag in sags.values():
            load = sag.mounts[mount.name]
            cells += [float(load.deflection[2]), load.carries, _ratio(load.utilisation)]
        rows.append(tuple(cells))
    histories = "; ".join(f"{history}: {_HISTORIES[history]}" for history in sags)
    return Table(
        title="Sag and load of every mount",
        columns=columns,
        rows=rows,
        note="Sag along the mount's own axis, negative in compression. Carries: what the mount pushes up with. Of rating: the "
        f"axial load over the rated static load, which is one in compression. {histories[:1].upper()}{histories[1:]}.",
    )


def _payloads(sags: Mapping[str, Sag]) -> Table:
    rows: list[Row] = [
        (name, history, *map(float, (*payload.displacement, *payload.rotation)))
        for history, sag in sags.items()
        for name, payload in sag.payloads.items()
    ]
    axes = [Column(f"along {axis}", "mm", "z.2f") for axis in "xyz"]
    axes += [Column(f"about {axis}", "mrad", "z.2f") for axis in "xyz"]
    names = Column("payload", align="left"), Column("history", align="left")
    return Table(title="Sag of the payload's centre of mass, and its tilt", columns=(*names, *axes), rows=rows)


def _sum(history: str, sag: Sag) -> str:
    """Return a sentence on what carries the weight."""
    text = f"{history.capitalize()}: of {with_unit(sag.weight, 'N', digits=4)} of weight the mounts carry "
    text += with_unit(sag.on_mounts, "N", digits=4)
    for load, what in ((sag.on_contacts, "contacts"), (sag.elsewhere, "joints and their springs")):
        if abs(load) > _BALANCED * sag.weight:
            text += f", {what} {with_unit(load, 'N')}"
    return f"{text}."


def _ratio(ratio: float | None) -> Cell:
    """Return a load over the rated static load, marked where it is exceeded."""
    if ratio is None or ratio <= 1.0:
        return ratio
    return Mark(f"{fixed(in_unit(ratio, '%'), 0)}, exceeded", "exceeded")


def modes_section(run: FinishedRun) -> Section:
    """Return the modes about the position of rest with descriptions of their shapes, and the distance from tipping over."""
    blocks: list[Block] = []
    histories = [history for history, modes in run.modes.items() if isinstance(modes, Modes)]
    for history, modes in run.modes.items():
        if isinstance(modes, Absent):
            blocks.append(Paragraph(text=modes.reason, tone="unjudged"))
            continue
        blocks += [
            _table(history, modes, noted=history == histories[-1]),
            Paragraph(text=f"Against tipping over: {modes.stability.description}"),
        ]
    return Section(title="Modes", blocks=tuple(blocks))


def _table(history: str, modes: Modes, *, noted: bool) -> Table:
    rows: list[Row] = [
        (
            str(number + 1),
            modes.descriptions[number],
            *(float(values[number]) for values in (modes.frequencies, modes.unloading, modes.loading)),
            *(f"{fixed(in_unit(float(ratio), '%'), 0)} %" for ratio in modes.participation[number]),
        )
        for number in range(modes.frequencies.size)
    ]
    frequencies = [Column(heading, "Hz", "z.2f") for heading in ("small cycles", "unloading", "further loading")]
    return Table(
        title=f"Modes about the position of rest, {_HISTORIES[history]}",
        columns=(
            Column("mode"), Column("shape", align="left"), *frequencies, *(Column(f"mass {axis}") for axis in "xyz"),
        ),
        rows=rows,
        note=_NOTE if noted else "",
    )  # fmt: skip
