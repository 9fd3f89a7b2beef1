"""Memory of contacts and stops, updated at every step: first touch, largest normal force, deepest point, work of each.

The first rows of the tracker's memory belong to the pairs of geoms that the model declares, in their order; any other takes a
row when it first touches, and pairs beyond the last row share that one. Behind them every `Stop` among the mounts' laws, alone
or in parallel with others, has a row, in the order of mounts, axes and laws. Without any of them a step costs one comparison.
"""

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.mounts import bent, point_velocity
from wirerope_mj.engine.control.peaks import touch
from wirerope_mj.engine.control.vectors import column, dot, minus, plus, turned, vector
from wirerope_mj.foundation.jit import index, inlined, njit
from wirerope_mj.mounts.laws.stop_kernels import ABOVE, BELOW, stop_force

# mjCNSTR_CONTACT_FRICTIONLESS and _PYRAMIDAL: how the forces of a contact stand in efc_force, else as of an elliptic cone
FRICTIONLESS, PYRAMIDAL = 5, 6


@njit
def normal_force(force, address, kind, dimension):
    """Return the normal force of a contact [N]: with a pyramidal cone the sum over its edges, else the first entry."""
    if kind != PYRAMIDAL:
        return force[address]
    total = 0.0
    for edge in range(2 * (dimension - 1)):
        total += force[address + edge]
    return total


@njit
def absorbed_power(force, rate, address, kind, dimension):
    """Return the power that a contact takes up from what meets in it, friction included [W]."""
    rows = 2 * (dimension - 1) if kind == PYRAMIDAL else 1 if kind == FRICTIONLESS else dimension
    total = 0.0
    for row in range(rows):
        total -= force[address + row] * rate[address + row]
    return total


@inlined
def pair_number(one, other):
    """Return one number for two geoms in any order; MuJoCo calls a flexible body -1."""
    return (min(one, other) + 1.0) * at.MOST_GEOMS + max(one, other) + 1.0


@inlined
def begin_contacts(lay, i, u, w, n_contacts):
    """Prepare the memory for the contacts of a step: empty at the first one, without forces of this step at the others."""
    n_rows = int(lay[i + at.N_CONTACTS])
    first = u[w + at.HISTORY] == 0.0
    if n_rows == 0 or (n_contacts == 0 and not first):
        return
    m = w + int(lay[i + at.USER_CONTACTS])
    for row in range(n_rows):
        if first:
            for c in range(at.CONTACT_MEMORY):
                u[m + at.CONTACT_MEMORY * row + c] = 0.0
            geoms = i + int(lay[i + at.PAIRS]) + at.PAIR_COLUMNS * row
            declared = row < lay[i + at.N_PAIRS]
            u[m + at.CONTACT_MEMORY * row + at.GEOMS] = pair_number(lay[geoms], lay[geoms + 1]) if declared else at.FREE
        u[m + at.CONTACT_MEMORY * row + at.FORCE_NOW] = 0.0


@njit
def contact_row(u, m, n_rows, one, other):
    """Return the row of a pair of geoms, a free one if it has not touched before; the last one is shared."""
    pair = pair_number(one, other)
    for row in range(n_rows):
        k = m + at.CONTACT_MEMORY * row
        if u[k + at.GEOMS] == at.FREE:
            u[k + at.GEOMS] = pair
        if u[k + at.GEOMS] == pair:
            return k
    k = m + at.CONTACT_MEMORY * (n_rows - 1)
    u[k + at.GEOMS] = at.SEVERAL
    return k


@njit
def track_contact(lay, i, u, w, time, one, other, distance, force, power):
    """Update the memory of a pair of geoms with one contact point: distance [m], negative inside, force [N], power [W]."""
    if distance >= 0.0 and force <= 0.0:  # within a margin, but not pressed
        return
    row = contact_row(u, w + int(lay[i + at.USER_CONTACTS]), int(lay[i + at.N_CONTACTS]), one, other)
    u[row + at.FORCE_NOW] += force
    touch(u, row, u[w + at.HISTORY], u[w + at.TIME_1], time, -distance, u[row + at.FORCE_NOW], power, True)


@inlined
def write_forces(lay, i, u, w, time, s, o):
    """Write the normal force of every declared pair at this instant to the sensor values from `o` on [N]."""
    m = w + index(lay[i + at.USER_CONTACTS])
    for pair in range(index(lay[i + at.N_PAIRS])):
        k = m + at.CONTACT_MEMORY * pair
        touching = u[k + at.TOUCHES] > 0.0 and u[k + at.LAST_TOUCH] == time
        s[o + pair] = u[k + at.FORCE_NOW] if touching else 0.0


@njit
def rate_along(lay, i, m, c, site_xpos, site_xmat, subtree_com, cvel, qvel):
    """Return the rate of the deflection of the mount in row `m` along its axis `c` [m/s]."""
    s, b = index(lay[m + at.PAYLOAD_SITE]), index(lay[m + at.BASE_SITE])
    point = vector(site_xpos, 3 * s)
    rate = point_velocity(cvel, index(lay[m + at.PAYLOAD]), subtree_com, index(lay[m + at.PAYLOAD_ROOT]), point)
    base = point_velocity(cvel, index(lay[m + at.BASE]), subtree_com, index(lay[m + at.BASE_ROOT]), point)
    shapes, below = index(lay[m + at.SHAPES]), index(lay[m + at.SHAPES + 1])
    if shapes:
        rate = plus(rate, turned(site_xmat, 9 * s, bent(lay, i + shapes, qvel, 0)))
    if below:
        rate = minus(rate, turned(site_xmat, 9 * b, bent(lay, i + below, qvel, 0)))
    return dot(column(site_xmat, 9 * b, c), minus(rate, base))


@njit
def track_stops(lay, i, par, q, u, w, act, a, time, site_xpos, site_xmat, subtree_com, cvel, qvel):
    """Update the memory of all stops with the deflections of this step."""
    n_stops, row = index(lay[i + at.N_STOPS]), i + index(lay[i + at.STOPS])
    k = w + index(lay[i + at.USER_STOPS])
    if u[w + at.HISTORY] == 0.0:
        for c in range(at.CONTACT_MEMORY * n_stops):
            u[k + c] = 0.0
    for _ in range(n_stops):
        mount, c, p = index(lay[row]), index(lay[row + 1]), q + index(lay[row + 2])
        x = u[w + index(lay[i + at.USER_MOUNTS]) + 6 * mount + c]
        depth = max(-x - par[p + BELOW], x - par[p + ABOVE])
        if depth > 0.0:
            m = i + index(lay[i + at.MOUNTS]) + at.MOUNT_COLUMNS * mount
            v = rate_along(lay, i, m, c, site_xpos, site_xmat, subtree_com, cvel, qvel)
            pull = stop_force(par, p, x, v, act[a + index(lay[row + 3])] if lay[row + 3] >= 0.0 else 0.0)
            if pull != 0.0:
                touch(u, k, u[w + at.HISTORY], u[w + at.TIME_1], time, depth, abs(pull), pull * v, True)
        row, k = row + at.STOP_COLUMNS, k + at.CONTACT_MEMORY
