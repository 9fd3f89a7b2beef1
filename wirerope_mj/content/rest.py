"""The system at rest: sag and loads of mounts and payloads, and its modes."""

from collections.abc import Iterator, Mapping

from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.numbers import fixed, with_unit
from wirerope_mj.dynamics.modes import Modes
from wirerope_mj.engine.statics import Sag
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table
from wirerope_mj.foundation.units import in_unit

_HISTORIES = {
    "virgin": "first loading, as after installation",
    "relaxed": "after long vibration (friction relaxed)",
}
_BALANCED = 1e-4  # of the weight, below which nobody asks where the rest is
_NOTE = (
    "Small amplitudes: the limit as the amplitude vanishes; in a shock the mounts soften and the frequencies fall. Unloading "
    "and further loading: with the mounts' tangents in either direction from rest, which the first quarter cycle feels. Mass: "
    "fraction that takes part of the mass that can move along each axis."
)


def statics_blocks(run: JudgedRun) -> Iterator[Block]:
    """Yield sag and load of every mount and payload under gravity, on the first loading and relaxed."""
    if not run.response.scene.mounts:
        return
    if not run.gravity:
        yield Statement(id="statics", text="The model has no gravity: the mounts carry nothing at rest.")
        return
    if isinstance(run.statics, Absent):
        yield Statement(id="statics", text=run.statics.reason, tone="unjudged")
        return
    sags = run.statics.sags
    for history, reason in run.statics.missing.items():
        yield Statement(id=f"statics-{history}", text=f"{history.capitalize()}: {reason}", tone="unjudged")
    yield _loads(run, sags)
    yield _payloads(sags)
    for history, sag in sags.items():
        yield Statement(id=f"weight-{history}", text=_sum(history, sag))


def _loads(run: JudgedRun, sags: Mapping[str, Sag]) -> Table:
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
        id="sag",
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
    return Table(
        id="payload-sag", title="Sag of the payload's centre of mass, and its tilt", columns=(*names, *axes), rows=rows
    )


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


def modes_blocks(run: JudgedRun) -> Iterator[Block]:
    """Yield the modes about the equilibria with descriptions of their shapes, and the margin of stability."""
    histories = [history for history, modes in run.modes.items() if isinstance(modes, Modes)]
    for history, modes in run.modes.items():
        if isinstance(modes, Absent):
            yield Statement(id=f"modes-{history}", text=modes.reason, tone="unjudged")
            continue
        yield _table(history, modes, noted=history == histories[-1])
        yield Statement(id=f"stability-{history}", text=f"Stability: {modes.stability.description}")


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
    frequencies = [Column(heading, "Hz", "z.2f") for heading in ("small amplitudes", "unloading", "further loading")]
    return Table(
        id=f"modes-{history}",
        title=f"Modes about the equilibrium, {_HISTORIES[history]}",
        columns=(
            Column("mode"), Column("shape", align="left"), *frequencies, *(Column(f"mass {axis}") for axis in "xyz"),
        ),
        rows=rows,
        note=_NOTE if noted else "",
    )  # fmt: skip
