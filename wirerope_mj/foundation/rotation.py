"""Rotation matrices of orientations."""

import numpy as np

from wirerope_mj.foundation.arrays import Array


def rotation_matrices(quaternion: Array) -> Array:
    """Return the rotation matrices (..., 3, 3) of unit quaternions (..., 4), w first."""
    w, x, y, z = np.moveaxis(quaternion, -1, 0)
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    matrices = np.empty((*np.shape(w), 3, 3))
    for i, row in enumerate(rows):
        for j, element in enumerate(row):
            matrices[..., i, j] = element
    return matrices
