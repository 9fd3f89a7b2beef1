"""Blocks on the simulated model: geometry, masses, mounts, and isolators with ratings and provenance."""

from collections.abc import Iterator, Sequence

import numpy as np

from wirerope_mj.content.blocks import Block, SceneView, Statement
from wirerope_mj.content.isolator import provenance_statement, ratings_table
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.numbers import fixed, several
from wirerope_mj.content.scene_outline import crowded_label, flexible_bodies, mount_axes, mount_labels, mount_position
from wirerope_mj.dynamics.modes import Modes
from wirerope_mj.engine.response.scene import SceneMount
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.tables import Column, Row, Table, left
from wirerope_mj.mounts.isolator import Isolator

_LEAST_SHOWN = 12  # Mounts and stops that are listed in any case


def model_blocks(run: JudgedRun) -> Iterator[Block | None]:
    """Yield scene, masses, mounts, and isolators with ratings and provenance."""
    scene = run.response.scene
    start = f"Model {run.model_file} with {mounts_and_stops(scene.mounts)}."
    if bends := " and ".join(body.name for body in scene.bodies if body.bends):
        start += f" What is called {bends} bends by its modes, and is drawn unbent."
    driven = f"The base {scene.base} is driven" if scene.base else "Nothing is driven"
    weight = f"gravity is {run.gravity:g} m/s²" if run.gravity else "there is no gravity"
    yield Statement(
        "model", f"{start} {driven}, {weight}. Coordinates are those of the model's world frame, z up."
    )  # fmt: skip
    if any(body.geoms for body in scene.bodies) or scene.mounts:
        caption = "The modelled, unloaded geometry"
        if scene.mounts:
            numbered = any(label != name for name, label in mount_labels(scene).items())
            caption += ", its mounts with their " + ("numbers (see the table)." if numbered else "names.")
            if crowded := crowded_label(scene):
                label, count = crowded
                caption += f' "{label}": {count} mounts behind each other.'
        if flexible := flexible_bodies(scene):
            caption = f"{caption.rstrip('.')}. Outlined in green: {' and '.join(flexible)}, flexible."
        yield SceneView(id="geometry", scene=scene, caption=caption)
    known = next((modes for modes in run.modes.values() if isinstance(modes, Modes)), None)
    if known is not None and known.payloads:
        payloads = known.payloads.items()
        yield Table(
            "masses", "What the mounts carry, its centre of mass at rest and its moments of inertia about that",
            (
                *left("payload"), Column("mass", "kg", 4), *(Column(axis, "m", "z.3f") for axis in "xyz"),
                *(Column(f"I{axis}{axis}", "kg m²", 4) for axis in "xyz"),
            ),
            [(name, payload.mass, *map(float, (*payload.centre, *payload.inertia))) for name, payload in payloads],
        )  # fmt: skip
    yield _mounts_table(run)
    devices = devices_of(run)
    if devices:
        yield ratings_table(devices)
        for device in devices:
            yield provenance_statement(device)


def model_facts(system: System) -> dict[str, str]:
    """Describe a model in texts by subject: isolators and positions of mounts, laws, masses.

    Two models that differ in a file differ in one of these, or in nothing that moves.
    """
    facts: dict[str, str] = {}

    def note(what: str, values: Array, scale: float, unit: str) -> None:
        facts[what] = f"{', '.join(f'{round(scale * x, 9) + 0.0:.6g}' for x in values.tolist())}{unit}"

    for name, mount in system.mounts.items():
        facts[name] = mount.isolator_name
        note(f"position of {name}", mount.position, 1e3, " mm")
        note(f"direction of {name}", mount.axes[:, 2], 1.0, "")
        facts |= {f"{mount.isolator_name}: {key}": text for key, text in _leaves(mount.written.to_dict())}
    model = system.model
    for body in np.flatnonzero(model.body_mass > 0.0).tolist():
        name = model.body(body).name or f"body {body}"
        note(f"mass of {name}", model.body_mass[[body]], 1.0, " kg")
        note(f"centre of mass of {name}", model.body_ipos[body], 1e3, " mm")
        note(f"inertia of {name}", model.body_inertia[body], 1.0, " kg m²")
    return facts


def _leaves(table: Entries, before: str = "") -> Iterator[tuple[str, str]]:
    """Yield names, such as "axial.laws[0].alpha", and texts of all values in a table."""
    for key, value in table.items():
        name = f"{before}{key}"
        if isinstance(value, dict):
            yield from _leaves(value, f"{name}.")
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            for number, entry in enumerate(value):
                yield from _leaves(entry, f"{name}[{number}].")
        else:
            yield name, f"{value:.6g}" if isinstance(value, float) else str(value)


def mounts_and_stops(mounts: Sequence[SceneMount]) -> str:
    """Write the numbers of mounts and stops, such as "24 mounts and 16 stops"."""
    stops = sum(mount.stop for mount in mounts)
    count = several(len(mounts) - stops, "mount") if len(mounts) > stops else "no mounts"
    return f"{count} and {several(stops, 'stop')}" if stops else count


def _mounts_table(run: JudgedRun) -> Table | None:
    """Tabulate isolator, bodies, position and axial direction of every mount as modelled; None without mounts."""
    scene = run.response.scene
    if not scene.mounts:
        return None
    labels = mount_labels(scene)
    numbered = any(label != name for name, label in labels.items())
    rows: list[Row] = []
    for mount in scene.mounts:
        direction = ", ".join(fixed(value, 2) for value in mount_axes(scene, mount)[:, 2])
        between = f"{mount.payload_body or 'world'} on {mount.base_body or 'world'}"
        names = (*([labels[mount.name]] if numbered else []), mount.name, mount.isolator, between)
        rows.append((*names, *map(float, mount_position(scene, mount)), direction))
    columns = [*left("mount", "isolator", "payload on base"), *(Column(axis, "m", "z.3f") for axis in "xyz")]
    return Table(
        "mount-places",
        "Mounts",
        [*([Column("no.")] if numbered else []), *columns, Column("axial direction")],
        rows,
        shown=max(len(scene.isolating), _LEAST_SHOWN),  # stops are the last, and alike
        note="Positions are the elastic centres at mid-height. Axial points from the base's bar to the payload's; tension "
        "is positive.",
    )


def devices_of(run: JudgedRun) -> list[Isolator]:
    """List the isolators of a run's mounts, as their files state them, each once."""
    devices: list[Isolator] = []
    for mount in run.response.scene.mounts:
        device = run.system.mounts[mount.name].written
        if device not in devices:
            devices.append(device)
    return devices
