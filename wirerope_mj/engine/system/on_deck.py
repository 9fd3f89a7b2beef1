"""A model put on a deck that bends, in place of the rigid one that it stands on."""

from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree as ET

import mujoco

from wirerope_mj.engine.flexible import Panel
from wirerope_mj.engine.flexible.panel import NAME, add_panel
from wirerope_mj.engine.system.named_files import named_files
from wirerope_mj.engine.system.system import System, load_system
from wirerope_mj.engine.system.varied import with_changes
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.mounts.isolator import Isolator


def load_on_deck(source: str | Path, panel: Panel | None, *, isolators: Mapping[str, Isolator] | None = None) -> System:
    """Load a model as `load_system` does, on a deck panel if one is given."""
    system = load_system(source, isolators=isolators)
    return system if panel is None else on_deck(system, panel)


def on_deck(system: System, panel: Panel) -> System:
    """Put a panel under all mounts of a system; its model is text then, which any MuJoCo loads.

    Raises:
        ModelError: the base is not driven, or the model has a panel already, or names files of its own.
    """
    text = deck_text(system, panel)
    return with_changes(load_system(text, isolators=system.isolators), system.changes)


def deck_text(system: System, panel: Panel) -> str:
    """Write the MJCF of a system with a panel between its base and all that stands on it."""
    if not system.assembly.subjects.driven:
        raise ModelError("a deck panel stands on a driven base, and the base of this model has no slides.")
    if mujoco.mj_name2id(system.model, mujoco.mjtObj.mjOBJ_BODY, NAME) >= 0:
        raise ModelError(f"the model has a body {NAME!r} already: change its joint, or rename it.")
    if system.path is not None and (named := [name for name, _ in named_files(system.path)]):
        raise ModelError(
            f"{system.path}: a deck panel makes a new text of the model, and this one names {named[0]!r}, a file beside it. "
            "Write the panel into the model: a body with a slide, stiffness and damping, between the base and the mounts."
        )
    with system.assembly.scratch.data(system.model) as data:
        mujoco.mj_kinematics(system.model, data)
        axes = data.body(system.base).xmat.reshape(3, 3).copy()
    root = ET.fromstring(system.mjcf, parser=ET.XMLParser(target=ET.TreeBuilder(insert_comments=True)))
    add_panel(root, panel, base=system.base, axes=axes, gravity=system.model.opt.gravity)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"
