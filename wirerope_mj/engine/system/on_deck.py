"""A model's text rewritten: on a deck or with a body that bends, with another part in its mounts' places, turned in gravity."""

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree as ET

import mujoco
import numpy as np

from wirerope_mj.engine.flexible import Deck, FlexiblePart, deck_of
from wirerope_mj.engine.flexible.panel import NAME, add_panel
from wirerope_mj.engine.flexible.part import add_part
from wirerope_mj.engine.system.named_files import named_files
from wirerope_mj.engine.system.system import System, load_system
from wirerope_mj.engine.system.tables import TURNS
from wirerope_mj.engine.system.varied import with_changes
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import checked_direction, unit_vector
from wirerope_mj.foundation.errors import ModelError, ModelWarning
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.mounts.isolator import Isolator


def load_on_deck(source: str | Path, deck: Deck | None, *, isolators: Mapping[str, Isolator] | None = None) -> System:
    """Load a system from an MJCF model, and put a flexible deck under its mounts if one is given."""
    system = load_system(source, isolators=isolators)
    return system if deck is None else on_deck(system, deck)


def on_deck(system: System, deck: Deck | str) -> System:
    """Put a flexible deck under all mounts of a system, whose model becomes a text that any MuJoCo loads.

    Args:
        system: the system.
        deck: a panel of one mode, or a part fixed to the base by its modes, with a point at every mount; a text says a panel,
            "10 Hz 800 kg 4 %" for its frequency alone, mass and damping ratio, or names a part's folder.

    Raises:
        ModelError: the base is not driven, or the model has such a deck already, or names files of its own, or no point of
            the part is at a mount's site.
    """
    return _as_written(system, deck_text(system, deck_of(deck) if isinstance(deck, str) else deck))


def with_flexible(system: System, part: FlexiblePart, *, body: str) -> System:
    """Make a body of a system flexible by the modes of a part, in the body's own axes: free-free modes for equipment.

    Raises:
        ModelError: there is no such body, or it bends already, or no point of the part is at a mount's site.
    """
    return _as_written(system, _text_of(system, part, body=body, name=body))


GRAVITY_ERROR = 1e-3  # from the standard one [m/s^2] up to which gravity of a model is the earth's


def has_deck(system: System) -> bool:
    """Tell whether a flexible deck stands under the mounts of a system: a panel, or modes of the base."""
    panel = mujoco.mj_name2id(system.model, mujoco.mjtObj.mjOBJ_BODY, NAME) >= 0
    return panel or any(mode.part == system.base for mode in system.assembly.subjects.modes)


def with_gravity(system: System, *, up: Sequence[float] | Array) -> System:
    """Turn standard gravity in the axes of a system, as if it stood on another side; its model becomes text.

    Args:
        system: the system.
        up: vector against gravity, (3,).

    Raises:
        ValueError: the vector is zero or not finite.
        ModelError: the model names files of its own, has a deck or a body that bends, which is laid out for its gravity, or
            another gravity than the earth's.
    """
    gravity = 0.0 - STANDARD_GRAVITY * unit_vector(checked_direction(up, "up"))
    magnitude = float(np.linalg.norm(system.model.opt.gravity))
    if abs(magnitude - STANDARD_GRAVITY) > GRAVITY_ERROR:
        raise ModelError(f"gravity of this model is {magnitude:.4g} m/s^2: it is turned where it is {STANDARD_GRAVITY:g}.")
    if system.assembly.subjects.modes or has_deck(system):
        raise ModelError("gravity is not turned where a deck or a body bends: they are laid out for the gravity of the model.")
    root = model_root(system)
    for option in root.findall("option") or [ET.SubElement(root, "option")]:
        option.set("gravity", " ".join(repr(value) for value in gravity.tolist()))
    return _as_written(system, xml_text(root))


def with_rotation(system: System) -> System:
    """Give the base hinges for roll, pitch and yaw, driven like its slides; the model becomes text.

    Without a motion that rotates the base nothing changes. A system whose base has them is returned as it is.

    Raises:
        ModelError: the model names files of its own, has a deck that bends, a base that is not driven along x, y and z or has
            other joints, or a payload that does not float.
    """
    if system.assembly.tables.rotates:
        return system
    if has_deck(system):
        raise ModelError("a deck that bends does not rotate: leave it out, or the rotation.")
    model, base = system.model, int(system.assembly.subjects.base)
    slides, joints = len(system.assembly.subjects.driven), int(model.body_jntnum[base]) if base else 0
    if slides != 3 or joints != 3:
        raise ModelError(
            f"a base that rotates has three slides and no other joint; {system.base or 'the world'!r} has {slides} slides "
            f"among {joints} joints. Write the slides x, y and z into its body."
        )
    for name in system.payloads:
        body = model.body(name).id
        if body != base and model.jnt_type[model.body_jntadr[body]] != mujoco.mjtJoint.mjJNT_FREE:
            raise ModelError(
                f"the body {name!r} moves by joints of its own in the world and would not turn with the base {system.base!r}: "
                "give it a <freejoint/>."
            )
    with system.assembly.scratch.data(model) as data:
        mujoco.mj_kinematics(model, data)
        axes = data.xmat[base].reshape(3, 3).copy()
    root = model_root(system)
    bodies = [body for body in root.iter("body") if body.get("name") == system.base]
    if len(bodies) != 1:
        raise ModelError(f"the base {system.base!r} does not stand in the model's own text: write its hinges by hand.")
    last = max(number for number, element in enumerate(bodies[0]) if element.tag == "joint")
    for number, (name, axis) in enumerate(zip(reversed(TURNS), axes[::-1], strict=True)):
        hinge = ET.Element("joint", name=name, type="hinge", pos="0 0 0", axis=" ".join(repr(c) for c in axis.tolist()))
        bodies[0].insert(last + 1 + number, hinge)
    return _as_written(system, xml_text(root))


def _as_written(system: System, text: str) -> System:
    return with_changes(load_system(text, isolators=system.isolators), system.changes)


def deck_text(system: System, deck: Deck) -> str:
    """Write the MJCF of a system on a deck."""
    if not system.assembly.subjects.driven:
        raise ModelError("a deck that bends stands on a driven base, and the base of this model has no slides.")
    if isinstance(deck, FlexiblePart):
        return _text_of(system, deck, body=system.base, name=system.base)
    if mujoco.mj_name2id(system.model, mujoco.mjtObj.mjOBJ_BODY, NAME) >= 0:
        raise ModelError(f"the model has a body {NAME!r} already: change its joint, or rename it.")
    carried = sum(float(system.model.body_subtreemass[system.model.body(name).id]) for name in system.payloads)
    doubts = []  # about the units
    if 0.0 < deck.damping < _UNDAMPED:
        doubts.append(
            f"no deck is damped so little; damping is said in per cent of the critical: was {100.0 * deck.damping:.2g} the "
            f"ratio? Then say {1e4 * deck.damping:.3g} %."
        )
    if deck.mass < _LIGHT * carried:
        doubts.append(
            f"what stands on it has {carried:.4g} kg: is its mass of {deck.mass:.4g} kg in t? Say the unit, such as 0.8 t."
        )
    for doubt in doubts:
        warnings.warn(f'deck "{deck.description}": {doubt}', ModelWarning, stacklevel=2)
    root = model_root(system)
    with system.assembly.scratch.data(system.model) as data:
        mujoco.mj_kinematics(system.model, data)
        axes = data.body(system.base).xmat.reshape(3, 3).copy()
    add_panel(root, deck, base=system.base, axes=axes, gravity=system.model.opt.gravity)
    return xml_text(root)


# damping ratio below which no built deck is, a bare weld being above; mass over what it carries: a deck in t said as kg has a
# thousandth of its usual tenth to eightfold
_UNDAMPED, _LIGHT = 1e-3, 0.008


def _text_of(system: System, part: FlexiblePart, *, body: str, name: str) -> str:
    """Write the MJCF of a system with a flexible body; the mounts' sites on it are at points of the part."""
    model = system.model
    number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, body)
    if number < 0:
        raise ModelError(f"there is no body {body!r}. Bodies of this model: {list(system.assembly.subjects.body_names)}.")
    if any(mode.part == name for mode in system.assembly.subjects.modes):
        raise ModelError(f"the body {body!r} bends already.")
    sites: dict[str, str] = {}
    subjects = system.assembly.subjects
    with system.assembly.scratch.data(model) as data:
        mujoco.mj_kinematics(model, data)
        for site in dict.fromkeys([*system.assembly.tables.sites.ravel().tolist(), *subjects.points, *subjects.forces]):
            if model.body_weldid[model.site_bodyid[site]] != number:
                continue
            place = (data.site_xpos[site] - data.body(body).xpos) @ data.body(body).xmat.reshape(3, 3)
            try:
                sites[model.site(site).name] = part.nearest(place)
            except ValueError as error:
                raise ModelError(f"site {model.site(site).name!r} on {body!r}: {error}") from None
    root = model_root(system)
    add_part(root, part, name=name, body=body, sites=sites, gravity=model.opt.gravity)
    return xml_text(root)


def model_root(system: System) -> ET.Element:
    """Parse the model as written; ModelError if it names files beside it, which the new text would not find."""
    if system.path is not None and (named := [name for name, _ in named_files(system.path)]):
        raise ModelError(
            f"{system.path}: this makes a new text of the model, and the model names {named[0]!r}, a file beside it, which "
            "the new text would not find. Write what it says into the model itself."
        )
    return ET.fromstring(system.mjcf, parser=ET.XMLParser(target=ET.TreeBuilder(insert_comments=True)))


def xml_text(root: ET.Element) -> str:
    """Format a parsed model as indented XML."""
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def with_part(system: System, names: Mapping[str, str]) -> str:
    """Write the MJCF of a variant in which some mounts have their isolators as isolators/NAME.toml, by `names` of the mounts.

    A ModelError if the model names files beside it, or attaches parts whose sites do not stand in its own text.
    """
    plain = load_system(system.path or system.mjcf, isolators=system.isolators)
    root, model, before = model_root(system), system.model, plain.model
    custom = root.find("custom")
    sites = {site.get("name", ""): site for site in root.iter("site")}
    tuples = {element.get("name", ""): element for element in root.iter("tuple")}
    moved = set()
    for mount, name in names.items():
        for site in (system.mounts[mount].payload_site, system.mounts[mount].base_site):
            shift = model.site(site).pos - before.site(site).pos
            if site not in sites or f"mount/{mount}" not in tuples or custom is None:
                raise ModelError(f"mount {mount!r} does not stand in the model's own text: write its model by hand.")
            if site in moved:  # a stop stands at its mount's sites
                continue
            moved.add(site)
            place = [float(coordinate) for coordinate in sites[site].get("pos", "0 0 0").split()] + shift
            sites[site].set("pos", " ".join(f"{coordinate + 0.0:.12g}" for coordinate in place))
        for element in tuples[f"mount/{mount}"].iter("element"):
            if element.get("objtype") == "text":
                element.set("objname", f"isolator/{name}")
    assert custom is not None
    used = {element.get("objname") for element in root.iter("element")}
    for text in [element for element in custom.findall("text") if element.get("name", "").startswith("isolator/")]:
        if text.get("name") not in used or text.get("name", "").removeprefix("isolator/") in names.values():
            custom.remove(text)
    for name in dict.fromkeys(names.values()):
        ET.SubElement(custom, "text", name=f"isolator/{name}", data=f"isolators/{name}.toml")
    for limit in system.limits:
        key = f"limit/{limit.kind}/{limit.name}"
        for old in [element for element in custom.findall("numeric") if element.get("name") == key]:
            custom.remove(old)
        ET.SubElement(custom, "numeric", name=key, data=" ".join(f"{value:.12g}" for value in limit.values))
    return xml_text(root)
