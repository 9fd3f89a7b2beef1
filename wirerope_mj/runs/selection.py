"""The equipment that isolators are selected for, and the model with the chosen part."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from wirerope_mj.engine.from_tables import mjcf_of
from wirerope_mj.engine.from_tables.layout import box_layout
from wirerope_mj.engine.from_tables.sheet import PURE, TEXT, read_sheet
from wirerope_mj.engine.simulation.stepper import falls_by_gravity
from wirerope_mj.engine.system import System, load_system
from wirerope_mj.engine.system.model_files import write_model
from wirerope_mj.engine.system.on_deck import with_part
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.atomic_files import atomic_folder, check_folder
from wirerope_mj.foundation.errors import ModelError, ModelWarning
from wirerope_mj.foundation.payload_limits import ON_MOUNTS, PayloadLimit
from wirerope_mj.foundation.resources import model_source
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import BOTTOM, bottom_stop
from wirerope_mj.mounts.vendor_parts import load_isolator, vendor_parts
from wirerope_mj.runs.job_file import load_job
from wirerope_mj.runs.new_model import KIND, marks
from wirerope_mj.runs.scenario_file import judged_by
from wirerope_mj.studies.catalogue import replaceable_mounts
from wirerope_mj.studies.measures import payload_bodies, payload_points
from wirerope_mj.studies.tried_part import TriedPart

_PLACED = "WR16-400"  # part of the box's mounts before every part takes their places


def equipment(
    model: str | None, cases: Mapping[str, BaseMotion], *, box: Entries | None = None,
    mounts: Sequence[str] = (), limits: Sequence[PayloadLimit] = (), fragility: float | None = None,
    travel: float | None = None,
) -> tuple[dict[str, System], dict[str, BaseMotion]]:  # fmt: skip
    """Load the equipment, once for each way of mounting it, with its limits, and the load cases.

    Args:
        model: path or name of a model, or file of a job, whose load cases and limits come before those that are given.
        cases: load cases by name.
        box: `mass` and `size` of `box_layout`, in place of a model.
        mounts: of the box, such as "4+2".
        limits: of the payload, in place of the model's.
        fragility: limit of the acceleration of each body of the payload [m/s^2].
        travel: clearance of each point both ways along each axis [m].

    Raises:
        ValueError: there is no load case, or an argument is out of range.
        ModelError: the model, the job or a limit is not what it must be.
    """
    combined = True
    if model is not None and model.endswith(".toml"):
        job = load_job(model)
        first = job.cases[0].scenario
        cases = {case.name: case.scenario.motion for case in job.cases} | dict(cases)
        named = {(limit.kind, limit.name) for limit in limits}
        limits = [*(limit for limit in first.limits if (limit.kind, limit.name) not in named), *limits]
        combined = first.combined_travel
        systems = {"": load_system(first.model_source(), isolators=first.isolators)}
    elif model is not None:
        systems = {"": load_system(model_source(model, folder=None, asker="a selection"))}
    else:
        systems = {text: _box_on(_PLACED, text, box or {}) for text in mounts}
    if not cases:
        raise ValueError('there must be at least one load case: say its motion, for instance --half-sine "15 g 11 ms z".')
    installed = {
        name
        for variant in systems.values()
        for name, mount in variant.mounts.items()
        if any(stop.rest for law in mount.isolator.axes.values() if law is not None for stop in law.stops)
    }
    if installed:
        warnings.warn(
            f"the gaps of {', '.join(sorted(installed))} are as installed at the sag of the model's own isolators, and stay "
            "there under every part: make the model anew with the chosen part by `wirerope new`, and judge that one.",
            ModelWarning, stacklevel=2,
        )  # fmt: skip
    judged = {}
    for name, system in systems.items():
        for case, motion in cases.items():
            if motion.up is not None and not falls_by_gravity(system, motion.up):
                raise ValueError(
                    f"load case {case!r} lands on another side than the one on which the model stands, and a selection turns "
                    "no model: drop it onto the bottom, and run other drops by `wirerope shock` on what was chosen."
                )
        if forces := [f"{limit.kind}/{limit.name}" for limit in (*system.limits, *limits) if limit.kind in ON_MOUNTS]:
            raise ModelError(f"a selection does not judge {forces[0]}: leave it out, and judge runs of what was chosen by it.")
        stated = {(limit.kind, limit.name): limit for limit in limits}
        if fragility is not None:
            for body in payload_bodies(system):
                stands = PayloadLimit(kind="acceleration", name=body, values=(fragility,))
                stated.setdefault(("acceleration", body), stands)
        if travel is not None:
            if not (points := payload_points(system)):
                raise ModelError("the model has no points to keep a `--travel`: give it sites called point/NAME.")
            for point in points:
                stated.setdefault(("clearance", point), PayloadLimit(kind="clearance", name=point, values=(travel,) * 3))
        judged[name] = judged_by(system, combined_travel=combined, limits=tuple(stated.values()))
    return judged, dict(cases)


def _box_on(name: str, mounts: str, box: Entries) -> System:
    """Build the box on mounts of a part, each with a stop where the part goes solid, if that is known."""
    part = next(candidate for candidate in vendor_parts() if candidate.name == name)
    isolator = load_isolator(part)
    stop = bottom_stop(isolator)
    layout = replace(box_layout(part, mounts=mounts, **box), bottoms={} if stop is None else {name: stop})
    stops = {} if stop is None else {f"{BOTTOM}{name}": stop}
    return load_system(mjcf_of(layout), isolators={name: isolator, **stops})


def read_prices(path: Path) -> dict[str, dict[str, float]]:
    """Read price and mass [kg] of one part, by its name, from a CSV or XLSX table with "name" and "price" or "mass [kg]".

    RecordError if the table is wrong; says file, row and column.
    """
    rows = read_sheet(path, kind="table of prices", needed={"name": TEXT}, further={"price": PURE, "mass": "mass"})
    return {row.text("name"): {key: row.number(key) for key in ("price", "mass") if row.has(key)} for row in rows}


def write_selected(chosen: TriedPart, folder: Path, *, box: Entries | None = None, force: bool = False) -> Path:
    """Write the model with a selected part and its limits into `folder`, and return the path of the model.

    The folder's last part is the model's name. With the `box` that `equipment` took a deck is drawn below the part's own
    height, and each mount has a stop where the part goes solid. RecordError if a folder is there that `force` does not
    replace; ModelError if the model names files of its own, so that no new text of it can be written.
    """
    system, isolator, name = chosen.system, chosen.isolator, folder.resolve().name
    if system is None or isolator is None:
        raise ModelError(f"{chosen.name} has no isolator: {chosen.reason}")
    check_folder(folder, force=force, kind=KIND, marks=marks(name))
    if box is not None:
        system = replace(_box_on(chosen.name, chosen.placement, box), limits=system.limits)
    bottoms = dict.fromkeys(system.bottoms.values(), f"{BOTTOM}{chosen.name}")
    stops = {
        bottoms.get(name, mount.isolator_name): mount.written for name, mount in system.mounts.items() if mount.isolator.is_stop
    }
    text = with_part(system, dict.fromkeys(replaceable_mounts(system), chosen.name) | bottoms)
    new_system = load_system(text, isolators=stops | {chosen.name: isolator})
    moved = [mount.position - new_system.mounts[key].position for key, mount in system.mounts.items()]
    if np.abs(moved).max() > 1e-9:
        raise ModelError("the mounts of this model do not stand where its own text says: write its model by hand.")
    with atomic_folder(folder, force=force, kind=KIND, marks=marks(name)) as temporary:
        write_model(new_system, temporary).rename(temporary / f"{name}.xml")
    return folder / f"{name}.xml"
