"""Design values of the Dynamic Design Analysis Method: acceleration of a mode by its weight, place, direction."""

import math
from dataclasses import dataclass
from typing import Literal

from wirerope_mj.foundation.arguments import one_of, positive
from wirerope_mj.foundation.units import STANDARD_GRAVITY

Ship = Literal["surface", "submarine"]
Location = Literal["hull", "deck", "shell"]
Direction = Literal["vertical", "athwartship", "fore-and-aft"]
Deformation = Literal["elastic", "elastic-plastic"]
KIP = 4448.2216152605  # A thousand pounds of force [N]
LEAST = 6.0 * STANDARD_GRAVITY  # Least design acceleration [m/s^2]
_INCH = 0.0254
# Coefficients a of A0 [g] and v of V0 [in/s], see `ddam_design_values`.
_LEVELS = {
    ("surface", "hull"): (20.0, 60.0), ("surface", "deck"): (10.0, 30.0), ("surface", "shell"): (40.0, 120.0),
    ("submarine", "hull"): (10.4, 20.0), ("submarine", "deck"): (5.2, 10.0), ("submarine", "shell"): (52.0, 100.0),
}  # fmt: skip
# Factors on A0 and V0 by direction, elastic.
_FACTORS: dict[tuple[str, str], dict[str, tuple[float, float]]] = {
    ("surface", "hull"): {"vertical": (1.0, 1.0), "athwartship": (0.4, 0.4), "fore-and-aft": (0.2, 0.2)},
    ("surface", "deck"): {"vertical": (1.0, 1.0), "athwartship": (0.4, 0.4), "fore-and-aft": (0.4, 0.4)},
    ("surface", "shell"): {"vertical": (1.0, 1.0), "athwartship": (0.2, 0.2), "fore-and-aft": (0.1, 0.1)},
    ("submarine", "hull"): {"vertical": (1.0, 1.0), "athwartship": (1.0, 1.0), "fore-and-aft": (0.4, 0.4)},
    ("submarine", "deck"): {"vertical": (1.0, 1.0), "athwartship": (2.0, 2.0), "fore-and-aft": (0.8, 0.8)},
    ("submarine", "shell"): {"vertical": (1.0, 1.0), "athwartship": (0.2, 0.2), "fore-and-aft": (0.08, 0.08)},
}


@dataclass(frozen=True, kw_only=True)
class DesignValues:
    """Shock design values of a mode."""

    weight: float  #: modal weight [N]
    #: reference_acceleration, reference_velocity: A0 [m/s^2] and V0 [m/s] of weight and location, times the direction's factor
    reference_acceleration: float
    reference_velocity: float
    acceleration: float  #: D = min(A, V w), at least 6 g [m/s^2]


def ddam_design_values(
    weight: float, frequency: float, *, location: Location, direction: Direction, ship: Ship = "surface",
    deformation: Deformation = "elastic",
) -> DesignValues:  # fmt: skip
    """Compute the design values of a mode after NRL memorandum 1396, the unclassified interim values of 1963.

    With the modal weight W in kip, A0 = a (37.5 + W)(12 + W)/(6 + W)^2 g and V0 = v (12 + W)/(6 + W) in/s on surface ships,
    A0 = a (480 + W)/(20 + W) g and V0 = v (480 + W)/(100 + W) in/s in submarines; a, v and the factors of the directions are
    those that finite-element programs document (Autodesk Simulation Mechanical, user-specified coefficients). They were not
    compared with T9070-AJ-DPC-120/3010: a design that has to meet it takes its numbers from there.

    Args:
        weight: modal weight, modal mass times g [N].
        frequency: of the mode [Hz].
        location: where the foundation stands: "hull", "deck" or "shell".
        direction: "vertical", "athwartship" or "fore-and-aft".
        ship: "surface" or "submarine".
        deformation: "elastic", or "elastic-plastic", for which the velocity is half; nothing is stated of shells then.

    Raises:
        ValueError: an argument is out of its range, or there are no values for it.
    """
    kip = positive("weight", weight, unit="N") / KIP
    omega = 2.0 * math.pi * positive("frequency", frequency, unit="Hz")
    one_of("ship", ship, ("surface", "submarine"))
    one_of("location", location, ("hull", "deck", "shell"))
    one_of("direction", direction, ("vertical", "athwartship", "fore-and-aft"))
    one_of("deformation", deformation, ("elastic", "elastic-plastic"))
    a, v = _LEVELS[ship, location]
    if ship == "surface":
        a, v = a * (37.5 + kip) * (12.0 + kip) / (6.0 + kip) ** 2, v * (12.0 + kip) / (6.0 + kip)
    else:
        a, v = a * (480.0 + kip) / (20.0 + kip), v * (480.0 + kip) / (100.0 + kip)
    a_factor, v_factor = _FACTORS[ship, location][direction]
    if deformation == "elastic-plastic":
        if location == "shell":
            raise ValueError("there are no elastic-plastic design values for equipment on shell plating.")
        v_factor *= 0.5
    acceleration, velocity = a_factor * a * STANDARD_GRAVITY, v_factor * v * _INCH
    design = max(min(acceleration, velocity * omega), LEAST)
    return DesignValues(weight=weight, reference_acceleration=acceleration, reference_velocity=velocity, acceleration=design)
