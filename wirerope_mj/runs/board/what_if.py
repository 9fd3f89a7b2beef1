"""A what-if: sliders, and what they do to a system and a motion. No file has them."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

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


@dataclass(frozen=True, kw_only=True)
class Slider:
    """One quantity that can be changed."""

    key: str  # by which its value is handed over
    label: str  # what it is called
    unit: str  # "×" for a factor on what the scenario has, "°" for an angle
    # minimum, maximum: smallest and largest value
    minimum: float
    maximum: float
    nominal: float  # what leaves the scenario as it is
    note: str  # what it acts on, and what stays

    def text(self, value: float) -> str:
        return f"{value:.4g}°" if self.unit == "°" else f"×\N{NO-BREAK SPACE}{value:.4g}"


def sliders_of(system: System, motion: BaseMotion) -> tuple[Slider, ...]:
    """Return the sliders that have an effect on a system under a motion."""
    # A fall has the level of its height, and the direction of gravity.
    falls = motion.up is not None
    sliders = [] if falls else [_factor(LEVEL, "Base motion level", (0.1, 2.0), f"On {motion.description}.")]
    drive = system.assembly.tables.drive
    reach = np.linalg.pinv(drive) @ drive  # projector onto what the slides span
    # The base follows any horizontal motion, and there is one; 1e-9: rounding of unit vectors, as where simulations check it.
    if not (falls or motion.rotates) and np.abs(reach[:2, :2] - np.eye(2)).max() < 1e-9 < np.abs(motion.directions[:, :2]).max(
        initial=0.0
    ):
        sliders.append(Slider(
            key=DIRECTION, label="Base motion direction", unit="°", minimum=-180.0, maximum=180.0, nominal=0.0,
            note="Turns the motion about the vertical, from x towards y.",
        ))  # fmt: skip
    if system.mounts:
        mass = sum(payload.mass for payload in payloads_of(system))
        note = f"On mass and inertia of all that the mounts carry, {significant(mass)} kg; its shape stays."
        sliders.append(_factor(MASS, "Payload mass", (0.5, 2.0), note))
    groups = groups_of(system)
    for group, mounts in groups.items():
        device = system.mounts[mounts[0]].written.name
        note = f"On all forces of {len(mounts)} {'mounts' if len(mounts) > 1 else 'mount'}; their ratings stay."
        sliders.append(_factor(STIFFNESS + group, f"Stiffness of {device}", (0.5, 2.0), note))
    laws = {group: system.mounts[mounts[0]].written.axes.values() for group, mounts in groups.items()}
    damped = [group for group in groups if any(law.damping_parameters for law in laws[group] if law is not None)]
    if damped:
        undamped = [system.mounts[groups[group][0]].written.name for group in groups if group not in damped]
        note = "On rope friction and dampers of all mounts. Friction resists small deflections, too: they become stiffer."
        note += f" {', '.join(undamped)}: loss and stiffness are one law, which stays." if undamped else ""
        sliders.append(_factor(DAMPING, "Damping of all mounts", (0.33, 3.0), note))
    if (deck := sprung_joints(system.model).get(NAME)) is not None:
        note = f"On the {significant(deck)} Hz of the deck panel alone; its mass and damping ratio stay."
        sliders.append(_factor(DECK, "Deck frequency", (0.5, 2.0), note))
    return tuple(sliders)


def groups_of(system: System) -> dict[str, list[str]]:
    """Group the mounts by the name of their isolator in the model; stops are left out."""
    groups: dict[str, list[str]] = {}
    for name, mount in system.mounts.items():
        if not mount.written.is_stop:
            groups.setdefault(mount.isolator_name, []).append(name)
    return groups


def checked_values(sliders: Sequence[Slider], values: object) -> dict[str, float]:
    """Return a value for every slider: the given value limited to the slider's range, else the nominal value.

    ValueError if `values` is no table of finite numbers, or names what is no slider.
    """
    if not isinstance(values, Mapping):
        raise ValueError(f'the sliders\' values must be a table such as {{"level": 1.2}}, got {quoted(values, 40)}.')
    known = {slider.key: slider for slider in sliders}
    checked = {slider.key: slider.nominal for slider in sliders}
    for key, value in values.items():
        if key not in known:
            raise ValueError(f"there is no slider {str(key)[:40]!r}; there are {', '.join(known)}.")
        try:
            number = finite(key, value)
        except ValueError:
            raise ValueError(f"the value of {key!r} must be a finite number, got {quoted(value, 40)}.") from None
        checked[key] = min(max(number, known[key].minimum), known[key].maximum)
    return checked


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


def _factor(key: str, label: str, ends: tuple[float, float], note: str) -> Slider:
    return Slider(key=key, label=label, unit="×", minimum=ends[0], maximum=ends[1], nominal=1.0, note=note)
