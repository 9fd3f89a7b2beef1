"""Probable slips in tables that can be made into a model: units, points of reference, rows that stand twice."""

import math
import warnings
from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from wirerope_mj.engine.from_tables.layout import Layout, Mass, combine, why_impossible
from wirerope_mj.engine.from_tables.places import ANGLES
from wirerope_mj.engine.from_tables.sheet import Row
from wirerope_mj.foundation.errors import RecordWarning
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.mounts.vendor_parts import load_isolator

_DENSEST = 3e4  # kg/m^3: a third above osmium, the densest of all materials
_STEP = math.pi / 12.0  # 15 degrees, of which inclinations are multiples as a rule
_SAME = 1e-6  # within which a mass that is called otherwise is the sum of all others
_FRACTION = 0.3  # of a part's moments of inertia that its distance from the origin must make for them to tell the point
_CLOSED = 1e-4  # m: a stop that is nearer is not set with a feeler gauge
_SOFT = 0.1  # m: a stop that the weight presses in farther is none
# weights of the payload that press a stop in by 1 mm, and damping ratio of the whole payload on it, beyond which units are
# questioned: stops of models that ship have 0.7 to 5 and up to 0.3, hard plastic a hundred weights
_HARD, _DAMPED = 500.0, 2.0
_ASIDE, _LEAST = 1.5, 0.1  # distances of the mounts, at least [m], beyond which a stop stands aside
_TINY = 0.01  # of the distance of the mounts, within which a place in m that is read as mm stands at the origin
# heights of mounts over that distance that are none; a thousand times them, over the height of an isolator
_FLAT, _MID_HEIGHTS = 5e-3, (0.1, 10.0)
# reach of equipment beyond the box of its mounts, over their distance: across, downwards and upwards
_REACH = np.array([[0.25, 0.25, 1.0], [0.25, 0.25, 2.0]])
_AIR = 1.2  # kg/m^3, which no part that fills the box of its inertia is lighter than
_FAR = 8.0  # radii of gyration of a payload from its centre of mass, beyond which there is no point of it


def warn_of_masses(masses: Sequence[Mass]) -> None:
    """Warn of each probable slip in a table of masses, with file, row, column and remedy."""
    for text in (*_dense(masses), *_about_the_origin(masses), *_twice(masses)):
        warnings.warn(text, RecordWarning, stacklevel=3)


def warn_of_layout(layout: Layout) -> None:
    """Warn of each probable slip that shows where the rows and tables of a model are compared, with its place and remedy."""
    for text in (*_light(layout.masses), *_stops(layout), *_in_metres(layout), *_points(layout)):
        warnings.warn(text, RecordWarning, stacklevel=3)


def warn_of_radians(rows: Sequence[Row]) -> None:
    """Warn of a column of angles in degrees whose numbers are multiples of 15 degrees in radians."""
    for column in ANGLES:
        filled = [row for row in rows if row.has(column)]
        turns = [abs(row.number(column)) / row.factors[column] / _STEP for row in filled]
        written = any(turns) and filled[0].factors[column] != 1.0
        if written and all(turn < 24.5 and abs(turn - round(turn)) < 3e-4 for turn in turns):
            text = f'column "{column}" is in degrees, and its numbers, such as {filled[0].text(column)}, look like radians: '
            warnings.warn(f"{filled[0].location}: {text}write [rad] into the header.", RecordWarning, stacklevel=3)


def _dense(masses: Sequence[Mass]) -> Iterator[str]:
    """Yield a warning of each part that is denser than any material, by its mass and radius of gyration."""
    for mass in masses:
        properties = mass.properties
        radius = math.sqrt(max(0.5 * float(properties.inertia.trace()), 0.0) / properties.mass)
        if radius and properties.mass > _DENSEST * (math.sqrt(12.0) * radius) ** 3:
            yield (
                f'{mass.location}: "{short(mass.name)}" of {properties.mass:.4g} kg has a radius of gyration of '
                f"{1e3 * radius:.3g} mm: it is denser than any material. Check the units of its mass and of columns "
                '"ixx" to "izz", or "size_x" to "size_z".'
            )


def _light(masses: Sequence[Mass]) -> Iterator[str]:
    """Yield a warning of each part that is lighter than the air in the box, filled evenly, that has its moments of inertia."""
    for mass in masses:
        moments = np.linalg.eigvalsh(mass.properties.inertia)
        sides = np.sqrt(np.maximum(6.0 * (moments.sum() - 2.0 * moments) / mass.properties.mass, 0.0))
        if mass.properties.mass < _AIR * float(sides.prod()):
            yield (
                f'{mass.location}: "{short(mass.name)}" of {mass.properties.mass:.4g} kg has the moments of inertia of a '
                f"box of {' x '.join(f'{side:.3g}' for side in sorted(sides))} m, and would be lighter than air: is its mass "
                'in t, or with a point for thousands, or are columns "ixx" to "izz", or "size_x" to "size_z", in other units?'
            )


def _about_the_origin(masses: Sequence[Mass]) -> Iterator[str]:
    """Yield a warning if the moments of all parts that are away from the origin can be about it.

    About the origin a part has at least m (d^2 1 - d d^T); about its own centre of mass it has as much only if it reaches
    beyond the origin in all directions. Products of inertia count where some are stated.
    """
    away = []
    for mass in masses:
        properties = mass.properties
        d = properties.centre
        moved = properties.mass * (d @ d * np.eye(3) - np.outer(d, d))
        if properties.inertia.any() and moved.trace() > _FRACTION * properties.inertia.trace():
            stated = not np.array_equal(properties.inertia, np.diag(np.diag(properties.inertia)))
            away.append((mass, properties.inertia - (moved if stated else np.diag(np.diag(moved)))))
    if away and all(np.linalg.eigvalsh(rest)[0] > 0.0 and not why_impossible(rest) for _, rest in away):
        first = away[0][0]
        yield (
            f'{first.location}: the moments of inertia of "{short(first.name)}" are so large that it would reach '
            "beyond the table's origin in all directions: are they about the origin? They must be about each part's own "
            "centre of mass."
        )


def _twice(masses: Sequence[Mass]) -> Iterator[str]:
    """Yield warnings of a last row that is the total of the others, and of parts that stand in the table twice."""
    last = masses[-1]  # where a total stands; another part may well weigh as much as the rest
    mass_of_others = sum(mass.properties.mass for mass in masses[:-1])
    if len(masses) > 2 and abs(last.properties.mass - mass_of_others) < _SAME * mass_of_others:
        yield (
            f'{last.location}: "{short(last.name)}" weighs what all others weigh together, {mass_of_others:.6g} kg: if it is '
            "their total, leave it out."
        )
    for one, other in combinations(masses, 2):
        same = one.properties.mass == other.properties.mass and (one.properties.centre == other.properties.centre).all()
        if same and (one.properties.inertia == other.properties.inertia).all():
            yield (
                f'{other.location}: "{short(other.name)}" has mass, centre of mass and inertia of "{short(one.name)}": if it '
                "is the same part, leave one out."
            )


def _stops(layout: Layout) -> Iterator[str]:
    """Yield warnings of stops far from the mounts, of gaps, stiffness and damping that are probably in other units."""
    weight = combine([mass.properties for mass in layout.masses]).mass * STANDARD_GRAVITY
    places = np.array([mount.position for mount in layout.mounts])
    apart = max(float(np.linalg.norm(np.ptp(places, axis=0))), _LEAST)
    devices = [load_isolator(file) for file in layout.isolators.values()]
    height = max((device.geometry.height or 0.0 for device in devices if device.geometry), default=0.0) or math.inf
    for stop in layout.stops:
        away = float(np.linalg.norm(stop.position - places.mean(axis=0)))
        if away > _ASIDE * apart:
            yield (
                f'{stop.location}: stop "{stop.name}" stands {away:.4g} m from the middle of mounts that are {apart:.3g} m '
                'apart: check columns "x", "y", "z", their origin and units.'
            )
        if stop.law is None:
            continue
        gaps = [gap for gap in (stop.law.gap, stop.law.gap_up, stop.law.gap_across) if gap]
        if gaps and min(gaps) < _CLOSED:
            yield f'{stop.location}: stop "{stop.name}" has a gap of {1e3 * min(gaps):.2g} mm: is "gap" in other units?'
        if gaps and min(gaps) > height:
            yield (
                f'{stop.location}: stop "{stop.name}" has a gap of {1e3 * min(gaps):.4g} mm, and the mounts are '
                f'{1e3 * height:.4g} mm high at most, so that they are pressed flat before: is "gap" in other units?'
            )
        if 1e-3 * stop.law.stiffness > _HARD * weight:
            yield (
                f'{stop.location}: stop "{stop.name}" of {1e-3 * stop.law.stiffness:.4g} kN/m would give way to the '
                f'whole weight by {1e6 * weight / stop.law.stiffness:.2g} um, as no rubber does: is column "stiffness" '
                "in other units?"
            )
        ratio = stop.law.damping / (2.0 * math.sqrt(stop.law.stiffness * weight / STANDARD_GRAVITY))
        if ratio > _DAMPED:
            yield (
                f'{stop.location}: stop "{stop.name}" has {ratio:.3g} times the critical damping with the whole payload on it: '
                'is column "damping" in other units, such as N s/m?'
            )
        pressed = weight / len(layout.stops) / stop.law.stiffness
        if pressed > _SOFT:
            yield (
                f'{stop.location}: stop "{stop.name}" of {1e-3 * stop.law.stiffness:.4g} kN/m would give way by {pressed:.3g} '
                'm under its part of the weight: is column "stiffness" in other units, such as N/mm?'
            )


def _in_metres(layout: Layout) -> Iterator[str]:
    """Yield a warning of each part and point at the origin that a thousandfold place would put where equipment is.

    And of all mounts whose heights are none, and a thousandfold those of isolators. Where the origin is the centre of mass a
    part may well stand there.
    """
    places = np.array([mount.position for mount in layout.mounts])
    apart = float(np.linalg.norm(np.ptp(places, axis=0)))
    reach = np.array([places.min(axis=0) - _REACH[0] * apart, places.max(axis=0) + _REACH[1] * apart])
    centre = combine([mass.properties for mass in layout.masses]).centre
    looked_at = layout.masses if len(layout.masses) > 1 and float(np.linalg.norm(centre)) > 2.0 * _TINY * apart else ()
    for name, place, location in (
        *((mass.name, mass.properties.centre, mass.location) for mass in looked_at),
        *((point.name, point.position, point.location) for point in layout.points),
    ):
        far = float(np.linalg.norm(place))
        meant = 1e3 * place
        if 0.0 < far < _TINY * apart < 0.1 * 1e3 * far and (reach[0] <= meant).all() and (meant <= reach[1]).all():
            yield (
                f'{location}: "{short(name)}" stands within {1e3 * far:.3g} mm of the origin, and the mounts are {apart:.3g} m '
                'apart: are its "x", "y", "z" in m where the header says mm?'
            )
    heights = np.abs(places[:, 2])
    devices = [load_isolator(file) for file in layout.isolators.values()]
    high = max((device.geometry.height or 0.0 for device in devices if device.geometry), default=0.0)
    low = 1e3 * float(heights.min())
    if high and heights.all() and heights.max() < _FLAT * apart and _MID_HEIGHTS[0] * high < low < _MID_HEIGHTS[1] * high:
        yield (
            f'{layout.mounts[0].location}: "{short(layout.mounts[0].name)}" and all mounts stand within '
            f'{1e3 * heights.max():.3g} mm of z = 0, and are {apart:.3g} m apart: is column "z" in m where the header says mm?'
        )


def _points(layout: Layout) -> Iterator[str]:
    """Yield a warning of each point farther from a payload than any mast upon it."""
    whole = combine([mass.properties for mass in layout.masses])
    places = np.array([mount.position for mount in layout.mounts])
    radius = math.sqrt(0.5 * float(whole.inertia.trace()) / whole.mass)
    reach = max(_FAR * radius, 2.0 * float(np.linalg.norm(places - whole.centre, axis=1).max()))
    for point in layout.points:
        if (away := float(np.linalg.norm(point.position - whole.centre))) > reach:
            yield (
                f'{point.location}: "{short(point.name)}" stands {away:.3g} m from the centre of mass of equipment whose '
                f'radius of gyration is {radius:.3g} m: is one of its "x", "y", "z" a digit too long, or in another unit?'
            )
