"""Masses and inertias of a robot's description (URDF), as MuJoCo reads it, every joint at zero."""

import warnings
from pathlib import Path
from xml.etree import ElementTree as ET

import mujoco
import numpy as np

from wirerope_mj.engine.from_tables.layout import MassProperties
from wirerope_mj.foundation.errors import RecordError, RecordWarning, why_unread
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.regular_files import regular

_FIXED = ("fixed", "")  # kinds of joints that cannot move


def read_urdf(path: Path) -> list[tuple[str, MassProperties]]:
    """Read names and mass properties of the links with a mass, in the frame of the root link [m, kg].

    Geometry, and with it meshes that may not be there, is not looked at. Products of inertia are those of the tensor, as URDF
    has them.

    Raises:
        RecordError: the file is no URDF, no link has a mass, or no body has the inertia of one.

    Warns:
        RecordWarning: it has joints that move; a payload is rigid.
    """
    try:
        root = ET.parse(regular(path)).getroot()
    except OSError as error:
        raise RecordError(f"{path}: the robot's description cannot be read: {why_unread(error)}") from None
    except ET.ParseError as error:
        raise RecordError(f"{path}: not valid XML: {short(str(error))}.") from None
    if root.tag != "robot" or root.find("link") is None:
        raise RecordError(
            f"{path}: the robot's description has no <robot> with <link>s; a file of xacro is first made into URDF: xacro "
            f"{path.name} > robot.urdf"
        )
    for link in root.iter("link"):
        for part in [part for part in link if part.tag != "inertial"]:
            link.remove(part)
    for extension in root.findall("mujoco"):
        root.remove(extension)
    ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", fusestatic="false", balanceinertia="false")
    try:
        model = mujoco.MjSpec.from_string(ET.tostring(root, encoding="unicode")).compile()
    except (ValueError, mujoco.FatalError) as error:
        raise RecordError(f"{path}: {' '.join(short(str(error), 300).split())}") from None
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    parts: list[tuple[str, MassProperties]] = []
    for body in np.flatnonzero(model.body_mass > 0.0).tolist():
        axes = data.ximat[body].reshape(3, 3)
        tensor = axes @ np.diag(model.body_inertia[body]) @ axes.T
        mass = MassProperties(float(model.body_mass[body]), data.xipos[body].copy(), 0.5 * (tensor + tensor.T))
        parts.append((model.body(body).name, mass))
    masses = {link.get("name", "?"): link.find("inertial/mass") for link in root.iter("link")}
    weights = {name: float(mass.get("value", "nan")) for name, mass in masses.items() if mass is not None}
    if wrong := [name for name, weight in weights.items() if not weight >= 0.0]:
        raise RecordError(f"{path}: the mass of link {short(wrong[0])!r} must be a number >= 0, got {weights[wrong[0]]:g}.")
    stated = sum(weights.values())
    if not parts or abs(sum(part.mass for _, part in parts) - stated) > 1e-9 * stated:
        raise RecordError(f"{path}: its links weigh {stated:g} kg, of which {sum(p.mass for _, p in parts):g} kg are read.")
    moving = [joint.get("name", "?") for joint in root.iterfind("joint") if joint.get("type", "") not in _FIXED]
    if moving:
        warnings.warn(
            f"{path}: its joints {short(', '.join(moving))} are held at 0: a payload is rigid. For another posture write a "
            "table of masses.",
            RecordWarning, stacklevel=2,
        )  # fmt: skip
    return parts
