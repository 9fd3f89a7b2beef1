"""Measurements at the start of every step: kinematics of bodies and points, mounts, contacts and stops, peaks of all of them.

MuJoCo calls the sensor callback once per Runge-Kutta step, in the forward pass at the step's start, when positions,
velocities and accelerations belong to the same instant.

The memory of contacts and stops holds first touch, largest normal force, deepest point and work of each. Its first rows belong
to the pairs of geoms that the model declares, in their order; any other takes a row when it first touches, and pairs beyond the
last row share that one. Behind them every `Stop` among the mounts' laws, alone or in parallel with others, has a row, in the
order of mounts, axes and laws. Without any of them a step costs one comparison.
"""

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.mounts import elastic_motion, point_velocity, remove_overshoot
from wirerope_mj.engine.control.peaks import parabola_bounds, track_closing, track_touch, track_travel, track_vector
from wirerope_mj.engine.control.vectors import (
    column,
    cross,
    dot,
    grow,
    keep,
    minus,
    norm,
    plus,
    quaternion,
    rotated_back,
    rotated_by,
    swept,
    times,
    turned,
    vector,
)
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
    """Return the power absorbed by a contact [W], friction included."""
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
    """Return the memory's row of a pair of geoms, a free row if it has not touched before; further pairs share the last row."""
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
    track_touch(u, row, u[w + at.HISTORY], u[w + at.TIME_1], time, -distance, u[row + at.FORCE_NOW], power, True)


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
        rate = plus(rate, turned(site_xmat, 9 * s, elastic_motion(lay, i + shapes, qvel, 0)))
    if below:
        rate = minus(rate, turned(site_xmat, 9 * b, elastic_motion(lay, i + below, qvel, 0)))
    return dot(column(site_xmat, 9 * b, c), minus(rate, base))


@njit
def track_stops(lay, i, par, q, u, w, act, a, time, site_xpos, site_xmat, subtree_com, cvel, qvel):
    """Update the memory of all stops with the deflections of this step."""
    n_stops, row = index(lay[i + at.N_STOPS]), i + index(lay[i + at.STOPS])
    k, closing = w + index(lay[i + at.USER_STOPS]), w + index(lay[i + at.USER_CLOSINGS])
    if u[w + at.HISTORY] == 0.0:
        for c in range(at.CONTACT_MEMORY * n_stops):
            u[k + c] = 0.0
        for c in range(at.CLOSING_MEMORY * n_stops):
            u[closing + c] = 0.0
    for _ in range(n_stops):
        mount, c, p = index(lay[row + at.STOP_MOUNT]), index(lay[row + at.STOP_AXIS]), q + index(lay[row + at.STOP_PARAMETER])
        x = u[w + index(lay[i + at.USER_MOUNTS]) + 6 * mount + c]
        below, above = -x - par[p + BELOW], x - par[p + ABOVE]
        depth, m = max(below, above), i + index(lay[i + at.MOUNTS]) + at.MOUNT_COLUMNS * mount
        v = rate_along(lay, i, m, c, site_xpos, site_xmat, subtree_com, cvel, qvel)
        track_closing(u, k, closing, u[w + at.HISTORY], u[w + at.TIME_1], time, depth, -v if below > above else v)
        if depth > 0.0:
            z = row + at.STOP_STATE
            pull = stop_force(par, p, x, v, act[a + index(lay[z])] if lay[z] >= 0.0 else 0.0)
            if pull != 0.0:
                track_touch(u, k, u[w + at.HISTORY], u[w + at.TIME_1], time, depth, abs(pull), pull * v, True)
        row, k, closing = row + at.STOP_COLUMNS, k + at.CONTACT_MEMORY, closing + at.CLOSING_MEMORY


@inlined
def body_accelerations(lay, i, out, w, cdof, cdof_dot, qvel, qacc):
    """Write the spatial coordinate acceleration of every body, rotation first, about its tree's centre of mass."""
    tree = i + index(lay[i + at.TREE])
    for c in range(6):
        out[w + c] = 0.0
    for body in range(1, index(lay[i + at.N_TREE])):
        row = tree + at.TREE_COLUMNS * body
        parent, first, number = index(lay[row]), index(lay[row + 1]), index(lay[row + 2])
        for c in range(6):
            total = out[w + 6 * parent + c]
            for dof in range(first, first + number):
                total += cdof_dot[6 * dof + c] * qvel[dof] + cdof[6 * dof + c] * qacc[dof]
            out[w + 6 * body + c] = total


@inlined
def kinematics(out, o, point, orientations, k, body, root, subtree_com, cvel, cacc, w):
    """Write position, orientation, velocity, angular velocity, acceleration and angular acceleration of a point."""
    arm, rate, turn = minus(point, vector(subtree_com, 3 * root)), vector(cvel, 6 * body), vector(cacc, w + 6 * body)
    velocity = point_velocity(cvel, body, subtree_com, root, point)
    keep(out, o, point)
    for c in range(4):
        out[o + 3 + c] = orientations[k + c]
    keep(out, o + 7, velocity)
    keep(out, o + 10, rate)
    # The spatial acceleration is that of the velocity field at a fixed point; omega x v turns it into the particle's.
    keep(out, o + 13, swept(swept(vector(cacc, w + 6 * body + 3), turn, arm), rate, velocity))
    keep(out, o + 16, turn)


@njit
def bend_point(lay, k, out, o, r, site_xmat, qpos, qvel, qacc):
    """Add a part's modes to the kinematics of a point: e = Phi q turns and moves with the part.

    The velocity grows by e' + omega x e, the acceleration by e'' + 2 omega x e' + alpha x e + omega x (omega x e).
    """
    e = turned(site_xmat, r, elastic_motion(lay, k, qpos, 1))
    v = turned(site_xmat, r, elastic_motion(lay, k, qvel, 0))
    a = turned(site_xmat, r, elastic_motion(lay, k, qacc, 0))
    w, alpha = vector(out, o + 10), vector(out, o + 16)
    across = cross(w, e)
    grow(out, o, e)
    grow(out, o + 7, v)
    grow(out, o + 7, across)
    grow(out, o + 13, swept(swept(a, w, plus(times(2.0, v), across)), alpha, e))


@inlined
def track_peaks(lay, i, u, w, time, s, first):
    """Update the peaks of all tracked vectors and travels with this step; `s[first:]` are the system's sensor values."""
    event, history, t0, t1 = u[w + at.EVENT], u[w + at.HISTORY], u[w + at.TIME_2], u[w + at.TIME_1]
    bounds = parabola_bounds(event, history, t0, t1, time)
    channel, m = i + index(lay[i + at.CHANNELS]), w + index(lay[i + at.USER_CHANNELS])
    for _ in range(index(lay[i + at.N_CHANNELS])):
        j, before, last = first + index(lay[channel]), m + at.BEFORE, m + at.LAST
        norms = norm(vector(u, before)), norm(vector(u, last)), norm(vector(s, j))
        track_vector(u, m, before, last, s, j, norms, bounds, t0, t1, time)
        for c in range(3):
            u[before + c], u[last + c] = u[last + c], s[j + c]
        channel, m = channel + at.CHANNEL_COLUMNS, m + at.CHANNEL_MEMORY
    row, m, record = i + index(lay[i + at.MOUNTS]), w + index(lay[i + at.USER_TRAVELS]), w + index(lay[i + at.USER_MOUNTS])
    for _ in range(index(lay[i + at.N_MOUNTS])):
        track_travel(u, m, lay, row + at.TRAVEL, u, record, bounds, t0, t1, time)
        row, m, record = row + at.MOUNT_COLUMNS, m + at.TRAVEL_MEMORY, record + 6
    u[w + at.TIME_2], u[w + at.TIME_1] = t1, time
    u[w + at.HISTORY] = 1.0 if event != at.SMOOTH else min(history + 1.0, 2.0)
    u[w + at.EVENT] = at.SMOOTH


@inlined
def observe(
    lay, i, par, q, u, w, act, a, time, s, site_xpos, site_xquat, xipos, xquat, subtree_com, cvel, cdof, cdof_dot, qvel, qacc,
    site_xmat, qpos,
):  # fmt: skip
    """Write the system's sensor values of this instant and, while a simulation observes, update the peaks and stops."""
    remove_overshoot(lay, i, par, q, act, a)
    if u[w + at.OBSERVING] != 0.0:
        track_stops(lay, i, par, q, u, w, act, a, time, site_xpos, site_xmat, subtree_com, cvel, qvel)
    record, cacc = w + index(lay[i + at.USER_MOUNTS]), w + index(lay[i + at.USER_ACCELERATIONS])
    body_accelerations(lay, i, u, cacc, cdof, cdof_dot, qvel, qacc)
    first = index(lay[i + at.SENSOR])
    o = first
    row = i + index(lay[i + at.BODIES])
    for _ in range(index(lay[i + at.N_BODIES])):
        body, root = index(lay[row]), index(lay[row + 1])
        kinematics(s, o, vector(xipos, 3 * body), xquat, 4 * body, body, root, subtree_com, cvel, u, cacc)
        o += at.KINEMATICS
        row += at.BODY_COLUMNS
    row = i + index(lay[i + at.POINTS])
    for _ in range(index(lay[i + at.N_POINTS])):
        site, body, root = index(lay[row]), index(lay[row + 1]), index(lay[row + 2])
        kinematics(s, o, vector(site_xpos, 3 * site), site_xquat, 4 * site, body, root, subtree_com, cvel, u, cacc)
        if index(lay[row + at.POINT_SHAPES]):
            bend_point(lay, i + index(lay[row + at.POINT_SHAPES]), s, o, 9 * site, site_xmat, qpos, qvel, qacc)
        from_base = minus(vector(s, o), vector(xipos, 3 * index(lay[row + at.POINT_BASE])))
        if index(lay[i + at.BASE_MODELLED]):
            turn = rotated_back(quaternion(xquat, 4 * index(lay[row + at.POINT_BASE])), from_base)
            from_base = rotated_by(quaternion(lay, i + index(lay[i + at.BASE_MODELLED])), turn)
        keep(s, o + at.RELATIVE, minus(from_base, vector(lay, row + at.POINT_MODELLED)))
        o += at.POINT_VALUES
        row += at.POINT_COLUMNS
    axis = i + index(lay[i + at.AXES])
    for _ in range(index(lay[i + at.N_MOUNTS])):
        for c in range(at.MOUNT_VALUES):
            s[o + c] = u[record + c]
        o += at.MOUNT_VALUES
        record += 6
        for _axis in range(3):
            for k in range(index(lay[axis + at.LAW_STATES])):
                s[o] = act[a + index(lay[axis + at.FIRST_STATE]) + k]
                o += 1
            axis += at.AXIS_COLUMNS
    write_forces(lay, i, u, w, time, s, o)
    if u[w + at.OBSERVING] != 0.0:
        track_peaks(lay, i, u, w, time, s, first)
