"""What a model's numbers and joints must be, and the message about a model that MuJoCo refuses."""

import re
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np

from wirerope_mj.engine.system.named_files import model_trees
from wirerope_mj.foundation.arrays import Array, ArrayLike, Integers
from wirerope_mj.foundation.errors import ModelError

# beginnings of the names of a model's arrays, and the element; of several numbers that are not finite the first is named
_ELEMENTS = {"site": "site", "jnt": "joint", "geom": "geom", "body": "body", "eq": "equality"}
# attributes from which others are computed: they are named before those
_WRITTEN = ("pos", "quat", "axis", "size", "mass")
# smallest eigenvalue of a matrix whose diagonal is scaled to 1: dependent joints leave rounding, 1e-16. Slides 1e-6 rad apart
# and a body on a joint of its own with 1e-11 of the mass that it carries still pass.
REGULAR = 1e-12
_REMEDY = "every number of a model must be finite, with a finite square. Correct it there, or what it is computed from."
_LEAD = re.compile(r"^(?:XML Error: |Error: |Schema violation: )+")
_ELEMENT = re.compile(r" ?Element (?:name )?'([^']*)'(?:, id -?\d+)?(?:, line (\d+))?")

# parts of MuJoCo's messages, and what to do about each; the first that a message holds counts
_REMEDIES = (
    ("opening file", "Put the file there, or correct its name; it is looked for from the model's folder on."),
    (
        "inertia must",
        "No body has such moments: fullinertia is xx yy zz xy xz yz of the tensor about the centre of mass, xy = -sum x y dm.",
    ),
    ("mjMINVAL", "Give this body mass: a geom, or an <inertial>."),
    ("decoder", "Export or copy this file again."),
    (
        "repeated name",
        "Give each element of a kind its own name; body/NAME, point/NAME, mount/NAME and wirerope/... are added to each model.",
    ),
    ("model type", "An MJCF file begins with <mujoco>."),
    ("not found", "Name one that the model has, or add it."),
    ("unknown", "Name one that the model has, or add it."),
    ("unrecognized name", "Name one that the model has, or add it."),
)
LARGEST = 1e150  # number whose square is finite, too
HEAVIEST = 1e5  # gravity [m/s^2] beyond any centrifuge, for which equilibria take minutes
_ELSEWHERE = "What each element may hold: https://mujoco.readthedocs.io/en/stable/XMLreference.html."


def check_written(text: str, path: Path | None) -> None:
    """Raise ModelError if a number in the model's text is NaN, which MuJoCo takes as not stated."""
    if "nan" not in text.lower() and "<include" not in text:
        return
    try:
        trees = [ElementTree.fromstring(text)] if path is None else [tree for tree, _ in model_trees(path)]
    except (ElementTree.ParseError, ModelError):
        return  # MuJoCo says what it cannot read
    names = {element.get("name") for tree in trees for element in tree.iter()}  # something may be called nan
    for element in (element for tree in trees for element in tree.iter()):
        for key, value in element.attrib.items():
            if "nan" in value.lower().split() and value not in names:
                named = f"{element.tag} {element.get('name')!r}" if element.get("name") else f"<{element.tag}>"
                raise ModelError(f"{named}: its `{key}` is {value!r}; {_REMEDY}")


def check_numbers(model: mujoco.MjModel) -> None:
    """Raise ModelError if a number of the compiled model is not finite; names the element and its attribute."""
    for name in ("gravity", "wind", "magnetic", "timestep", "density", "viscosity"):
        if not (np.abs(getattr(model.opt, name)) < LARGEST).all():
            raise ModelError(f"<option>: `{name}` is {_format(getattr(model.opt, name))}; {_REMEDY}")
    if not np.linalg.norm(model.opt.gravity) <= HEAVIEST:
        raise ModelError(
            f"<option>: `gravity` is {_format(model.opt.gravity)} m/s^2, beyond {HEAVIEST:g}; take 0 0 -9.80665, or that of a "
            "centrifuge."
        )
    for name in _float_arrays():
        values = getattr(model, name)
        too_large = ~(np.abs(values.astype(np.float64)) < LARGEST)
        if too_large.any():
            kind, _, attribute = name.partition("_")
            row, element = int(np.argwhere(too_large)[0][0]), _ELEMENTS.get(kind, kind)
            numbered = f"number {row}"
            if len(values) == getattr(model, f"n{kind}", -1) and hasattr(model, element):  # one row for each element
                numbered = repr(getattr(model, element)(row).name)
            raise ModelError(f"{element} {numbered}: its `{attribute}` is {_format(values[row])}; {_REMEDY}")


@cache
def _float_arrays() -> tuple[str, ...]:
    """Return the names of a model's arrays of floating-point numbers, those of `_ELEMENTS` first."""
    empty = mujoco.MjModel.from_xml_string("<mujoco/>")
    public = [name for name in dir(empty) if not name.startswith("_")]
    arrays = [name for name in public if getattr(getattr(empty, name), "dtype", None) in (np.float64, np.float32)]
    order = {kind: number for number, kind in enumerate(_ELEMENTS)}

    def rank(name: str) -> tuple[bool, int]:
        kind, _, attribute = name.partition("_")
        return attribute not in _WRITTEN, order.get(kind, len(order))

    return tuple(sorted(arrays, key=rank))


def _format(values: ArrayLike) -> str:
    """Format numbers as a model file has them, whatever NumPy's print settings are."""
    return " ".join(f"{value:g}" for value in np.atleast_1d(values))


def check_joints(model: mujoco.MjModel) -> None:
    """Raise ModelError if joints do not move in independent directions, so that forces do not determine accelerations."""
    endless = np.abs(np.linalg.norm(model.jnt_axis, axis=1) - 1.0) > 1e-6  # what is too large to be made a unit vector
    if endless.any():
        joint = model.joint(int(np.argmax(endless)))
        raise ModelError(f"joint {joint.name!r}: its `axis` gives no direction ({joint.axis}); write a unit vector.")
    data, mass = mujoco.MjData(model), np.zeros((model.nv, model.nv))
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    for body in np.flatnonzero(model.body_dofnum > 1):  # MuJoCo takes those of a simple body for independent
        first = int(model.body_dofadr[body])
        dofs = np.arange(first, first + int(model.body_dofnum[body]))
        motions = data.cdof[dofs] / np.linalg.norm(data.cdof[dofs], axis=1, keepdims=True)
        _check_independent(model, dofs, motions @ motions.T)
    mujoco.mj_makeM(model, data)
    mujoco.mj_fullM(model, data, mass)
    size = np.sqrt(np.diag(mass))
    _check_independent(model, np.arange(model.nv), mass / np.outer(size, size))


def _check_independent(model: mujoco.MjModel, dofs: Integers, matrix: Array) -> None:
    """Raise ModelError if a symmetric matrix over velocity coordinates is not positive definite; names their joints."""
    values, shapes = np.linalg.eigh(matrix)
    if not values.size or values[0] > REGULAR:
        return
    moved = dofs[np.abs(shapes[:, 0]) > 1e-3]  # of a unit vector: the others take no part
    joints = sorted({int(joint) for joint in model.dof_jntid[moved]})
    names = [model.joint(joint).name or f"number {joint}" for joint in joints]
    bodies = sorted({model.body(int(model.jnt_bodyid[joint])).name for joint in joints})
    raise ModelError(
        f"the joints {names} of {bodies} do not move in independent directions: what one does the others undo. Turn the axis "
        "of one of them, or remove it."
    )


def refusal_message(reason: str, text: str) -> str:
    """Word the message for an MJCF text that MuJoCo refused, with the remedy that belongs to its `reason`."""
    reason = " ".join(reason.split())
    if "XML parse error" in reason:
        location = "a file that it includes"
        try:
            ElementTree.fromstring(text)
        except ElementTree.ParseError as error:
            location = f"line {error.position[0]}, column {error.position[1] + 1}"
        return (
            f"MuJoCo cannot compile the model: {location} is not well-formed XML. Write & as &amp; and < as &lt;, close every "
            "element, and give no attribute twice."
        )
    element = _ELEMENT.search(reason)
    name, line = element.groups() if element else ("", None)
    included = " of it or of a file that it includes" if "<include" in text else ""
    location = ", ".join(filter(None, [name and f"element {name!r}", line and f"line {line}{included}"]))
    problem = _LEAD.sub("", _ELEMENT.sub("", reason)).rstrip(". ").replace("mjMINVAL", f"{mujoco.mjMINVAL:g} kg and kg m^2")
    remedy = next((remedy for key, remedy in _REMEDIES if key in reason), _ELSEWHERE)
    return f"MuJoCo cannot compile the model: {': '.join(filter(None, [location, problem]))}. {remedy}"
