"""Memory of the stops among the mounts' laws, updated at every step: first touch, largest force, deepest point, work of each.

Every `Stop`, alone on an axis or in parallel with other laws, has a row of its own behind those of contacts, in the order of
mounts, axes and laws. A system without stops costs one comparison.
"""

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.contacts import touch
from wirerope_mj.engine.control.mounts import point_velocity
from wirerope_mj.foundation.jit import index, njit
from wirerope_mj.mounts.laws.kernels import PARALLEL, STOP
from wirerope_mj.mounts.laws.stop_kernels import ABOVE, BELOW, LOSS, stop_force


@njit
def rate_along(lay, m, c, site_xpos, site_xmat, subtree_com, cvel):
    """Return the rate of the deflection of the mount in row `m` along its axis `c` [m/s]."""
    s, r = 3 * index(lay[m]), 9 * index(lay[m + 1]) + c
    px, py, pz = site_xpos[s], site_xpos[s + 1], site_xpos[s + 2]
    ux, uy, uz = point_velocity(cvel, index(lay[m + 2]), subtree_com, index(lay[m + 4]), px, py, pz)
    bx, by, bz = point_velocity(cvel, index(lay[m + 3]), subtree_com, index(lay[m + 5]), px, py, pz)
    return site_xmat[r] * (ux - bx) + site_xmat[r + 3] * (uy - by) + site_xmat[r + 6] * (uz - bz)


@njit
def track_stops(lay, i, par, q, u, w, act, a, time, site_xpos, site_xmat, subtree_com, cvel):
    """Update the memory of all stops with the deflections of this step."""
    n_stops = index(lay[i + at.N_STOPS])
    if n_stops == 0:
        return
    row = w + index(lay[i + at.USER_STOPS])
    if u[w + at.HISTORY] == 0.0:
        for k in range(at.CONTACT_MEMORY * n_stops):
            u[row + k] = 0.0
    record = w + index(lay[i + at.USER_MOUNTS])
    m = i + index(lay[i + at.MOUNTS])
    axis = i + index(lay[i + at.AXES])
    for _ in range(index(lay[i + at.N_MOUNTS])):
        for c in range(3):
            law, first = lay[axis], q + index(lay[axis + 1])
            n_components = int(par[first]) if law == PARALLEL else 1 if law == STOP else 0
            for component in range(n_components):
                p, z, kind = first, a + index(lay[axis + 2]), law
                if law == PARALLEL:
                    entry = first + 1 + 3 * component
                    kind, p, z = par[entry], first + int(par[entry + 1]), z + int(par[entry + 2])
                if kind != STOP:
                    continue
                x = u[record + c]
                depth = max(-x - par[p + BELOW], x - par[p + ABOVE])
                if depth > 0.0:
                    v = rate_along(lay, m, c, site_xpos, site_xmat, subtree_com, cvel)
                    pull = stop_force(par, p, x, v, act[z] if par[p + LOSS] != 0.0 else 0.0)
                    if pull != 0.0:
                        u[row + at.FORCE_NOW] = 0.0
                        touch(u, w, row, time, depth, abs(pull), pull * v)
                row += at.CONTACT_MEMORY
            axis += at.AXIS_COLUMNS
        record += 6
        m += at.MOUNT_COLUMNS
