"""A what-if: sliders, and what they do to a system and a motion. No file has them."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.content.numbers import several
from wirerope_mj.engine.flexible.panel import NAME
from wirerope_mj.engine.statics.payloads import payloads_of
from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.varied import moving_bodies, sprung_joints, varied
from wirerope_mj.foundation.arguments import finite
from wirerope_mj.foundation.plain_text import quoted
from wirerope_mj.foundation.units import significant
from wirerope_mj.motions import BaseMotion, Scaled, Turned
from wirerope_mj.mounts.isolator import Isolator

# Keys of the sliders; that of a stiffness is followed by what the model calls the isolator.
LEVEL, DIRECTION, MASS, DAMPING, STIFFNESS, DECK = "level", "direction", "mass", "damping", "stiffness/", "deck"
Values = Mapping[str, float]


@dataclass(frozen=True)
class Slider:
    """One quantity that can be changed."""

    key: str  # by which its value is handed over
    label: str  # what it is called
    note: str  # what it acts on, and what stays
    minimum: float
    maximum: float
    nominal: float = 1.0  # what leaves the scenario as it is
    unit: str = "×"  # of a factor on what the scenario has; "°" of an angle

    def text(self, value: float) -> str:
        return f"{value:.4g}°" if self.unit == "°" else f"×\N{NO-BREAK SPACE}{value:.4g}"


def sliders_of(system: System, motion: BaseMotion) -> tuple[Slider, ...]:
    """Return the sliders that have an effect on a system under a motion."""
    sliders = list[Slider]()
    if motion.up is None:  # a fall has the level of its height, and the direction of gravity
        sliders.append(Slider(LEVEL, "Base motion level", f"On {motion.description}.", 0.1, 2.0))
        drive = system.assembly.tables.drive
        reach = np.linalg.pinv(drive) @ drive  # projector onto what the slides span
        # The base follows any horizontal motion, and there is one; 1e-9: rounding of unit vectors, as simulations check it.
        follows = np.abs(reach[:2, :2] - np.eye(2)).max() < 1e-9
        if follows and not motion.rotates and np.abs(motion.directions[:, :2]).max(initial=0.0) > 1e-9:
            note = "Turns the motion about the vertical, from x towards y."
            sliders.append(Slider(DIRECTION, "Base motion direction", note, -180.0, 180.0, 0.0, "°"))
    if system.mounts:
        mass = sum(payload.mass for payload in payloads_of(system))
        note = f"On mass and inertia of all that the mounts carry, {significant(mass)} kg; its shape stays."
        sliders.append(Slider(MASS, "Payload mass", note, 0.5, 2.0))
    damped, undamped = False, list[str]()
    for group, mounts in groups_of(system).items():
        device = system.mounts[mounts[0]].written
        note = f"On all forces of {several(len(mounts), 'mount')}; their ratings stay."
        sliders.append(Slider(STIFFNESS + group, f"Stiffness of {device.name}", note, 0.5, 2.0))
        if any(law.damping_parameters for law in device.axes.values() if law is not None):
            damped = True
        else:
            undamped.append(device.name)
    if damped:
        note = "On rope friction and dampers of all mounts. Friction resists small deflections, too: they become stiffer."
        note += f" {', '.join(undamped)}: loss and stiffness are one law, which stays." if undamped else ""
        sliders.append(Slider(DAMPING, "Damping of all mounts", note, 0.33, 3.0))
    if (deck := sprung_joints(system.model).get(NAME)) is not None:
        note = f"On the {significant(deck)} Hz of the deck panel alone; its mass and damping ratio stay."
        sliders.append(Slider(DECK, "Deck frequency", note, 0.5, 2.0))
    return tuple(sliders)


def groups_of(system: System) -> dict[str, list[str]]:
    """Group the mounts by the name of their isolator in the model; stops are left out."""
    groups: dict[str, list[str]] = {}
    for name, mount in system.mounts.items():
        if not mount.written.is_stop:
            groups.setdefault(mount.isolator_name, []).append(name)
    return groups


def with_slider(sliders: Sequence[Slider], values: Values, key: object, value: object) -> Values:
    """Return values with that of a slider, limited to its range.

    ValueError if there is no such slider, or the value is no finite number.
    """
    slider = next((slider for slider in sliders if slider.key == key), None)
    if slider is None:
        raise ValueError(f"there is no slider {str(key)[:40]!r}; there are {', '.join(slider.key for slider in sliders)}.")
    try:
        number = finite(slider.key, float(value))  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"the value of {key!r} must be a finite number, got {quoted(value, 40)}.") from None
    return {**values, slider.key: min(max(number, slider.minimum), slider.maximum)}


def variant(system: System, motion: BaseMotion, values: Values) -> tuple[System, BaseMotion]:
    """Return system and motion at the sliders' values; the given system and motion if all values are nominal.

    ValueError if a factor takes a parameter out of its law's range; ModelError if the compiled model has no room for the
    change.
    """
    mass, damping = values.get(MASS, 1.0), values.get(DAMPING, 1.0)
    isolators: dict[str, Isolator] = {}
    for group, mounts in groups_of(system).items():
        stiffness = values.get(STIFFNESS + group, 1.0)
        for mount in mounts:
            written = system.mounts[mount].written
            changed = written if stiffness == 1.0 else written.scaled(stiffness)
            isolators[mount] = changed if damping == 1.0 else changed.with_damping(damping)
    ids = {body for payload in payloads_of(system) for body in payload.bodies} if mass != 1.0 else set()
    carried = [name for name in moving_bodies(system.model) if system.model.body(name).id in ids]
    tunings = {NAME: values[DECK]} if values.get(DECK, 1.0) != 1.0 else {}
    if carried or tunings or any(isolators[mount] is not system.mounts[mount].written for mount in isolators):
        system = varied(system, isolators=isolators, masses=dict.fromkeys(carried, mass), tunings=tunings)
    if angle := values.get(DIRECTION, 0.0):
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        motion = Turned(motion, rotation=[[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    if (level := values.get(LEVEL, 1.0)) != 1.0:
        motion = Scaled(motion, level)
    return system, motion


def frequency_ratio(values: Values) -> float:
    """Return the largest ratio of a natural frequency to the scenario's: root of stiffness over mass, >= 1."""
    stiffest = max((value for key, value in values.items() if key.startswith(STIFFNESS)), default=1.0)
    # Damping multiplies the friction, which is a part of the stiffness at small amplitudes, and a damper's rate itself.
    mounts = max(1.0, stiffest * max(1.0, values.get(DAMPING, 1.0)) ** 2 / values.get(MASS, 1.0)) ** 0.5
    return max(mounts, values.get(DECK, 1.0))
