"""Checks of where a payload's mounts stand: what is the wrong way round, twice at one position, or far outside."""

from pathlib import Path

import numpy as np

from wirerope_mj.engine.from_tables.layout import Layout, Placed
from wirerope_mj.engine.from_tables.mass_properties import why_impossible
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError

_SAME = 1e-3  # closer than this no two mounts can stand [m]
_LEVEL = 0.1  # a mount whose direction rises less than this (6 degrees) counts as horizontal

# radii of gyration from the centre of mass: no machine's foot is so far out; a table in other units is a thousand
_FAR = 20.0


def check_places(layout: Layout, masses: Path) -> None:
    """Raise RecordError if the masses make no body, or a mount stands where none can."""
    payload = layout.payload
    if np.linalg.eigvalsh(payload.inertia)[0] <= 1e-9 * payload.inertia.trace() or why_impossible(payload.inertia):
        raise RecordError(
            f'{masses}: the masses together have no moment of inertia about some axis. Fill in columns "ixx", "iyy" '
            'and "izz" of at least one of them.'
        )
    radius = float(np.sqrt(0.5 * payload.inertia.trace() / payload.mass))
    for placed in (*layout.mounts, *layout.stops):
        _check_near(placed, payload.centre, radius)
    for mount in layout.mounts:
        _check_direction(mount, payload.centre)
    _check_apart(layout)


def _check_near(placed: Placed, centre: Array, radius: float) -> None:
    distance = float(np.linalg.norm(placed.position - centre))
    if distance > _FAR * radius:
        raise RecordError(
            f'{placed.location}: "{placed.name}" stands outside, {distance:.4g} m from the centre of mass of a payload whose '
            f'radius of gyration is {radius:.4g} m. Check columns "x", "y", "z" and their units in both tables.'
        )


def _check_direction(mount: Placed, centre: Array) -> None:
    """Raise RecordError if a mount's axial direction leads away from the payload: its two sides are swapped."""
    axial, towards = mount.axes[2], centre - mount.position
    level = abs(axial[2]) <= _LEVEL
    away = axial[:2] @ towards[:2] < -_SAME if level else axial[2] < 0.0 and towards[2] > _SAME
    if away:
        raise RecordError(
            f'{mount.location}: mount "{mount.name}" has its sites swapped: its direction leads from the base to the '
            "payload, and here it leads away from the payload's centre of mass. Turn the direction round."
        )


def _check_apart(layout: Layout) -> None:
    for n, mount in enumerate(layout.mounts):
        for other in layout.mounts[:n]:
            if np.linalg.norm(mount.position - other.position) < _SAME:
                raise RecordError(
                    f'{mount.location}: columns "x", "y", "z": mount "{mount.name}" stands where "{other.name}" stands '
                    f"({other.location})."
                )
