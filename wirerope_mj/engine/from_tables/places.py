"""Places of mounts, stops and points that rows of tables state: name, position and axes."""

import math

import numpy as np

from wirerope_mj.engine.from_tables.layout import axes_along
from wirerope_mj.engine.from_tables.sheet import PURE, TEXT, Row
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.plain_text import short

POSITION = {"name": TEXT, "x": "length", "y": "length", "z": "length"}
DIRECTION = dict.fromkeys(("direction_x", "direction_y", "direction_z", "bars_x", "bars_y", "bars_z"), PURE)
ANGLES = {"inclination": "angle", "azimuth": "angle"}


def site_name(row: Row) -> str:
    name = row.text("name")
    if "/" in name or any(character.isspace() for character in name):
        raise row.error(f'column "name": "{short(name)}" holds a space or "/", which names in a model cannot. Write "_".')
    return name


def position_of(row: Row) -> Array:
    return np.array(row.vector("x", "y", "z"))


def axes_of(row: Row) -> Array:
    """Return the axes of a mount from its direction, or inclination and azimuth; upright by default."""
    vector = [column for column in ("direction_x", "direction_y", "direction_z") if row.has(column)]
    angles = [column for column in ("inclination", "azimuth") if row.has(column)]
    if vector and angles:
        raise row.error(f'columns "{vector[0]}" and "{angles[0]}" both say the direction; leave one empty.')
    axial = np.array([0.0, 0.0, 1.0])
    if vector:
        axial = np.array(row.vector("direction_x", "direction_y", "direction_z"))
        if not axial.any():
            raise row.error('columns "direction_x" to "direction_z" are all zero.')
    elif angles:
        inclination, azimuth = row.number("inclination"), row.number("azimuth", 0.0)
        if not 0.0 <= inclination <= math.pi * (1.0 + 1e-12):
            raise row.error('column "inclination" must lie between 0 and 180 degrees.')
        flat = math.sin(inclination)
        axial = np.array([flat * math.cos(azimuth), flat * math.sin(azimuth), math.cos(inclination)])
    if not any(row.has(column) for column in ("bars_x", "bars_y", "bars_z")):
        return axes_along(axial)
    bars = np.array(row.vector("bars_x", "bars_y", "bars_z"))
    if np.linalg.norm(np.cross(bars, axial)) <= 1e-3 * np.linalg.norm(bars) * np.linalg.norm(axial):
        raise row.error('columns "bars_x" to "bars_z" are zero or along the direction, not across it.')
    return axes_along(axial, bars)
