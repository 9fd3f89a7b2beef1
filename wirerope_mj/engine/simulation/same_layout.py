"""Systems of one layout: what must be equal in all of them, and what each may have for itself."""

from collections.abc import Sequence
from functools import cache

import mujoco
import numpy as np
import numpy.typing as npt
from mujoco.batch import MODEL_FIELDS, Batch

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.errors import ModelError

# beginnings of the names of fields that only name, describe or draw
_WORDS = ("name", "text", "tuple", "tex_", "skin_", "vis_")
_STEP = "opt.timestep"  # the option that belongs to the grid and not to a system


def check_same_layout(systems: Sequence[System]) -> None:
    """Raise ModelError if one of the systems differs from the first in more than numbers of its model."""
    first = systems[0]
    sizes = _sizes_of(first.model)
    fixed = {name: getattr(first.model, name).tobytes() for name in _fixed()}
    for number, system in _distinct(systems):
        differs = [name for name, size in _sizes_of(system.model).items() if sizes[name] != size]
        differs += [name for name, content in fixed.items() if getattr(system.model, name).tobytes() != content]
        here, there = system.assembly, first.assembly
        parts = ("userdata", "activation", "sensor", "subjects")
        differs += [part for part in parts if getattr(here, part) != getattr(there, part)]
        differs += ["mounts"] if list(system.mounts) != list(first.mounts) else []
        differs += ["drive"] if not np.array_equal(here.tables.drive, there.tables.drive) else []
        if differs:
            raise ModelError(
                f"`systems[{number}]` has another layout than `systems[0]` ({', '.join(differs)} differ): the systems of a "
                "batch have the same bodies, joints, geoms, mounts and internal states. Give each layout a batch of its own."
            )


def expand_differences(batch: Batch, systems: Sequence[System]) -> None:
    """Give every simulation of a batch the numbers of its own system's model where they differ from the batch's model."""
    fields = [field for field in _expandable() if _content(batch.model, field).size]
    shared = {field: _content(batch.model, field).tobytes() for field in fields}
    own: dict[int, list[tuple[str, npt.NDArray[np.generic]]]] = {id(systems[0]): []}
    for _, system in _distinct(systems):
        contents = ((field, _content(system.model, field)) for field in fields)
        own[id(system)] = [(field, content) for field, content in contents if content.tobytes() != shared[field]]
    for number, system in enumerate(systems):
        for field, content in own[id(system)]:
            rows = batch.expand(field)
            rows[number] = content[: rows.shape[1]] if rows.ndim > 1 else content  # the batch shares what is a mesh's


def _distinct(systems: Sequence[System]) -> list[tuple[int, System]]:
    """Return the systems that are not the first object, each once, with their numbers."""
    numbers = {id(system): number for number, system in reversed(list(enumerate(systems)))}
    return [(number, systems[number]) for number in sorted(numbers.values()) if number]


def _content(model: mujoco.MjModel, field: str) -> npt.NDArray[np.generic]:
    return np.asarray(getattr(model.opt, field[4:]) if field.startswith("opt.") else getattr(model, field))


def _sizes_of(model: mujoco.MjModel) -> dict[str, int]:
    return {name: getattr(model, name) for name in _sizes()}


@cache
def _sizes() -> tuple[str, ...]:
    """Return the names of a model's counts; those of names, paths and texts may differ."""
    may_differ = ("nnames", "nnames_map", "npaths", "ntextdata", "nbuffer", "ntex", "ntexdata")
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    counts = (name for name in dir(model) if name.startswith("n") and isinstance(getattr(model, name), int))
    return tuple(name for name in counts if name not in may_differ)


@cache
def _expandable() -> tuple[str, ...]:
    """Return the names of the fields that act and of which every simulation of a batch may have its own."""
    return tuple(
        sorted(f for f in MODEL_FIELDS if f != _STEP and not f.startswith(_WORDS) and not f.endswith("pathadr"))
    )


@cache
def _fixed() -> tuple[str, ...]:
    """Return the names of the arrays that act and that all simulations of a batch share."""
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    arrays = (name for name in dir(model) if isinstance(getattr(model, name), np.ndarray))
    kept = (name for name in arrays if name not in MODEL_FIELDS and not name.startswith((*_WORDS, "_", "bvh_")))
    return tuple(name for name in kept if not name.endswith("pathadr"))
