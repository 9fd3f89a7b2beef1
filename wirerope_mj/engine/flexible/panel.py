"""A deck panel of one mode: a mass guided along the deck's normal on a spring and a damper, between base and mounts."""

import math
from dataclasses import dataclass
from xml.etree import ElementTree as ET

from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import Direction, checked_direction, unit_vector
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.quantities import parse_phrase

EXAMPLE = "10 Hz 800 kg 4 %"
NAME = "deck_panel"
_RANGES = {"frequency": (0.1, 2e3, "Hz"), "mass": (1e-3, 1e8, "kg")}  # from a table's leaf spring to a ship's double bottom
DAMPING = 0.02  # damping ratio where none is said: a welded deck with what is bolted to it


@dataclass(frozen=True, kw_only=True)
class Panel:
    """A deck panel under all mounts: one mass on a spring and a damper, from the figures of a deck's survey.

    Alone on the base it swings at `frequency`: k = m (2 pi f)^2, c = 2 zeta m 2 pi f. Its own weight is carried before it is
    drawn; what stands on it makes it sag.
    """

    frequency: float  # natural frequency alone [Hz]
    mass: float  # that moves [kg]
    damping: float = DAMPING  # damping ratio [-]
    direction: Direction = "z"  # along which it moves; "z", the deck's normal, unless said

    def __post_init__(self) -> None:
        for name, (low, high, unit) in _RANGES.items():
            value = positive(name, getattr(self, name), unit=unit)
            if not low <= value <= high:
                raise ValueError(f"the {name} of a deck panel is from {low:g} to {high:g} {unit}, got {value:.6g} {unit}.")
        if not 0.0 <= self.damping < 1.0:
            raise ValueError(f"`damping` of a panel is a ratio from 0 to below 1, got {self.damping:g}.")
        checked_direction(self.direction)

    @property
    def stiffness(self) -> float:
        """Stiffness [N/m]."""
        return self.mass * (2.0 * math.pi * self.frequency) ** 2

    @property
    def damper(self) -> float:
        """Damping coefficient [N s/m]."""
        return 4.0 * math.pi * self.damping * self.mass * self.frequency

    @property
    def description(self) -> str:
        """Phrase that `panel_of_phrase` parses into this panel."""
        along = self.direction if isinstance(self.direction, str) else ",".join(f"{c:g}" for c in self.direction)
        words = f"{self.frequency:.6g} Hz {self.mass:.6g} kg {100.0 * self.damping:.6g} %"
        return words if along == "z" else f"{words} {along}"


def panel_of_phrase(text: str) -> Panel:
    """Parse "10 Hz 800 kg 4 %": frequency of the panel alone, mass, damping ratio, and the direction unless it is z."""
    try:
        phrase = parse_phrase(text, words={})
        said = {name: len(phrase.quantities.get(name, ())) for name in ("frequency", "mass", "ratio")}
        unknown = [name for name in phrase.quantities if name not in said]
        if unknown or said["frequency"] != 1 or said["mass"] != 1 or said["ratio"] > 1 or len(phrase.directions) > 1:
            raise ValueError(
                "a deck has one frequency [Hz], one mass [kg], and perhaps one damping ratio [%] and one direction."
            )
        return Panel(
            frequency=phrase.one("frequency"), mass=phrase.one("mass"),
            damping=phrase.one("ratio") if said["ratio"] else DAMPING,
            direction=phrase.directions[0] if phrase.directions else "z",
        )  # fmt: skip
    except ValueError as error:
        raise ValueError(f'deck "{short(text)}": {error} Expected is a phrase such as "{EXAMPLE}".') from None


def add_panel(root: ET.Element, panel: Panel, *, base: str, axes: Array, gravity: Array) -> None:
    """Insert a panel between the driven body `base` of a model and all that stands on it, in place; gravity [m/s^2], (3,).

    The base keeps its driven slides; sites, geoms and bodies on it move to the panel, a body of its own on one more slide.
    `axes` are those of the base in the modelled geometry, as columns, world frame, (3, 3).

    Raises:
        ModelError: the base does not stand in this document.
    """
    body = next((element for element in root.iter("body") if element.get("name") == base), None)
    if body is None:
        raise ModelError(
            f"the driven base {base!r} does not stand as a <body> in the model's own file; a deck panel is put between it and "
            "the mounts. Write the body there instead of including or attaching it."
        )
    direction = unit_vector(panel.direction)
    along = " ".join(repr(float(value)) for value in axes.T @ direction)
    carried = [element for element in body if element.tag not in ("joint", "inertial", "freejoint")]
    inertial = body.find("inertial")
    inner = ET.Element("body", name=NAME)
    ET.SubElement(
        inner, "joint", name=NAME, type="slide", axis=along, stiffness=repr(panel.stiffness),
        damping=repr(panel.damper), springref=repr(-panel.mass * float(gravity @ direction) / panel.stiffness),
    )  # fmt: skip
    size = repr(panel.mass)
    ET.SubElement(inner, "inertial", pos="0 0 0", mass=size, diaginertia=f"{size} {size} {size}")
    for element in carried:
        body.remove(element)
        inner.append(element)
    if inertial is None:  # its geoms, which had its mass, are the panel's now; a drive's inertia outweighs any
        ET.SubElement(body, "inertial", pos="0 0 0", mass="1", diaginertia="1 1 1")
    body.append(inner)
    for exclude in root.iter("exclude"):
        for key in ("body1", "body2"):
            if exclude.get(key) == base:
                exclude.set(key, NAME)
    for keyframe in root.findall("keyframe"):  # of a state with one coordinate less
        root.remove(keyframe)
