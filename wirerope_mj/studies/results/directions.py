"""Directions of a study's motion as points on the sphere: the area that each stands for."""

import numpy as np
import pyarrow as pa

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.studies.engines.compute import DONE

AZIMUTH, ELEVATION = "motion/azimuth", "motion/elevation"
_GAP = 1.5  # Ratio to all other gaps between azimuths above which nobody looked into a gap


def sphere_areas(azimuth: Array, elevation: Array) -> Array:
    """Return the fraction of the sphere that each direction stands for, of the part that the directions span, (n,), 1 in all.

    Directions of one elevation share a belt that reaches halfway to their neighbours above and below, sin(upper) - sin(lower)
    of the sphere's area 2 pi (Archimedes), and along it what lies halfway to their neighbours: points of equal angle crowd at
    the poles, where a circle of latitude is short. The first and the last elevation have no belt beyond themselves, and of a
    fan that does not go around, the first and the last azimuth none: nobody looked there. A direction that stands there
    twice, as a pole under every azimuth, counts once.

    Args:
        azimuth: [deg], (n,).
        elevation: [deg], (n,).
    """
    rings, ring = np.unique(elevation, return_inverse=True)
    edges = np.radians(np.concatenate((rings[:1], (rings[:-1] + rings[1:]) / 2.0, rings[-1:])))
    belts = np.diff(np.sin(edges)) if rings.size > 1 else np.ones(1)
    around = np.where(np.abs(elevation) == 90.0, 0.0, np.mod(azimuth, 360.0))
    areas, widths = np.zeros(azimuth.size), np.zeros(rings.size)
    for k in range(rings.size):
        on = np.flatnonzero(ring == k)
        angles, same, times = np.unique(around[on], return_inverse=True, return_counts=True)
        fractions, widths[k] = _arcs(angles)
        areas[on] = (fractions / times)[same.ravel()]
    # One direction stands for as much of its circle as the others of theirs: so a pole.
    widths = np.where(widths == 0.0, widths.max() or 1.0, widths)
    areas *= (belts * widths)[ring]
    return np.asarray(areas / areas.sum(), dtype=np.float64)


def _arcs(angles: Array) -> tuple[Array, float]:
    """Return the fraction of its circle's part that each of some angles [deg] stands for, and how wide that part is [deg].

    They go around unless there is a gap wider than all others by half: then they are a fan.
    """
    if angles.size < 2:
        return np.ones(angles.size), 0.0
    gaps = np.diff(np.append(angles, angles[0] + 360.0))  # behind each angle
    widest = int(np.argmax(gaps))
    others = np.delete(gaps, widest)
    fan = bool(gaps[widest] > _GAP * others.max())
    if fan:
        gaps[widest] = 0.0
    width = float(gaps.sum())
    return (gaps + np.roll(gaps, 1)) / 2.0 / width, width


def whole_sphere(table: pa.Table) -> bool:
    """Return whether the directions of a study go all around and from pole to pole."""
    azimuth, elevation = (np.asarray(table[name], dtype=np.float64) for name in (AZIMUTH, ELEVATION))
    if (elevation.min(), elevation.max()) != (-90.0, 90.0):
        return False
    between = [np.unique(np.mod(azimuth[elevation == one], 360.0)) for one in np.unique(elevation) if abs(one) < 90.0]
    return bool(between) and all(_arcs(ring)[1] > 360.0 - 1e-6 for ring in between)


def directions_text(table: pa.Table) -> str:
    """Return of which directions a fraction is: all, or those that a study spans."""
    return "all directions" if whole_sphere(table) else "the directions looked at"


def fraction_of_directions(table: pa.Table, inputs: list[str], values: Array, limit: float) -> float | None:
    """Return the fraction of the directions that a study spans in which a limit is exceeded, by area on the sphere.

    Args:
        table: of a study.
        inputs: what was sampled in it.
        values: of a measure, (n,).
        limit: of the measure.

    Returns:
        None if something else than the direction varies. Directions that failed or are not judged do not count.
    """
    if set(inputs) != {AZIMUTH, ELEVATION}:
        return None
    azimuth, elevation = (np.asarray(table[name], dtype=np.float64) for name in (AZIMUTH, ELEVATION))
    areas = np.where((np.asarray(table["status"]) == DONE) & np.isfinite(values), sphere_areas(azimuth, elevation), 0.0)
    whole = float(areas.sum())
    return float(areas[values > limit].sum()) / whole if whole > 0.0 else None
