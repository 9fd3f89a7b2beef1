"""Directions of a study's motion as points on the sphere: how much of it each stands for."""

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from wirerope_mj.study.engines.compute import DONE

Array = npt.NDArray[np.float64]

AZIMUTH, ELEVATION = "motion/azimuth", "motion/elevation"


def sphere_areas(azimuth: Array, elevation: Array) -> Array:
    """Return the share of the sphere's area that each direction stands for, (n,), 1 in all.

    Directions of one elevation share the belt that reaches halfway to their neighbours, sin(upper) - sin(lower) of its area
    2 pi (Archimedes), equally: points of equal angle crowd at the poles, where a circle of latitude is short. A direction
    that stands there twice, as a pole under every azimuth, counts once.

    Args:
        azimuth: [deg], (n,), equally spaced on each elevation.
        elevation: [deg], (n,).
    """
    rings, ring = np.unique(elevation, return_inverse=True)
    edges = np.radians(np.concatenate(([-90.0], (rings[:-1] + rings[1:]) / 2.0, [90.0])))
    belts = np.diff(np.sin(edges)) / 2.0
    around = np.where(np.abs(elevation) == 90.0, 0.0, np.mod(azimuth, 360.0))
    _, same, times = np.unique(np.stack([ring, around]), axis=1, return_inverse=True, return_counts=True)
    once = 1.0 / times[same.ravel()]
    return np.asarray(belts[ring] * once / np.bincount(ring, weights=once)[ring], dtype=np.float64)


def share_of_directions(table: pa.Table, inputs: list[str], values: Array, limit: float) -> float | None:
    """Return the share of all directions in which a limit is exceeded, by area on the sphere.

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
