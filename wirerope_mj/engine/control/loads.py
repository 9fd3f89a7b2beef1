"""Forces and moments on the payload, from the stage table to MuJoCo's wrenches."""

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.mounts import add_force, stage_row
from wirerope_mj.foundation.jit import index, inlined


@inlined
def clear_loads(lay, i, xfrc):
    """Take the wrenches of the last pass off the bodies on which forces may act; those with mounts are cleared again."""
    j = i + index(lay[i + at.FORCES])
    for _ in range(index(lay[i + at.N_FORCES])):
        body = index(lay[j + 1])
        for c in range(6):
            xfrc[6 * body + c] = 0.0
        j += at.FORCE_COLUMNS


@inlined
def apply_loads(lay, i, u, w, time, site_xpos, site_xmat, xipos, xfrc):
    """Add the forces and moments of this instant, which act at sites and along their axes."""
    n_forces = index(lay[i + at.N_FORCES])
    if n_forces == 0 or u[w + at.STAGE_POINTS] == 0.0:
        return
    k = w + index(lay[i + at.USER_FORCES]) + 6 * n_forces * stage_row(u, w, time)
    j = i + index(lay[i + at.FORCES])
    for _ in range(n_forces):
        site, body = index(lay[j]), index(lay[j + 1])
        s, r = 3 * site, 9 * site
        fx, fy, fz = turned(site_xmat, r, u, k)
        tx, ty, tz = turned(site_xmat, r, u, k + 3)
        add_force(xfrc, body, xipos, site_xpos[s], site_xpos[s + 1], site_xpos[s + 2], fx, fy, fz)
        xfrc[6 * body + 3] += tx
        xfrc[6 * body + 4] += ty
        xfrc[6 * body + 5] += tz
        j += at.FORCE_COLUMNS
        k += 6


@inlined
def turned(matrix, r, vector, k):
    """Return R v, the matrix standing row by row from `r` on and the vector from `k` on."""
    x, y, z = vector[k], vector[k + 1], vector[k + 2]
    return (
        matrix[r] * x + matrix[r + 1] * y + matrix[r + 2] * z,
        matrix[r + 3] * x + matrix[r + 4] * y + matrix[r + 5] * z,
        matrix[r + 6] * x + matrix[r + 7] * y + matrix[r + 8] * z,
    )
