"""Measurements at the start of every step: kinematics of bodies and points, mounts, and the peaks of all of them.

MuJoCo calls the sensor callback once per Runge-Kutta step, in the forward pass at the step's start, when positions,
velocities and accelerations belong to the same instant.
"""

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.contacts import track_stops, write_forces
from wirerope_mj.engine.control.mounts import bent, point_velocity, remove_overshoot
from wirerope_mj.engine.control.peaks import parabola_bounds, track_travel, track_vector
from wirerope_mj.engine.control.vectors import cross, grow, keep, minus, norm, plus, swept, times, turned, vector
from wirerope_mj.foundation.jit import index, inlined, njit


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
def kinematics(out, o, point, quaternion, k, body, root, subtree_com, cvel, cacc, w):
    """Write position, orientation, velocity, angular velocity, acceleration and angular acceleration of a point."""
    arm, rate, turn = minus(point, vector(subtree_com, 3 * root)), vector(cvel, 6 * body), vector(cacc, w + 6 * body)
    velocity = point_velocity(cvel, body, subtree_com, root, point)
    keep(out, o, point)
    for c in range(4):
        out[o + 3 + c] = quaternion[k + c]
    keep(out, o + 7, velocity)
    keep(out, o + 10, rate)
    # The spatial acceleration is that of the velocity field at a fixed point; omega x v turns it into the particle's.
    keep(out, o + 13, swept(swept(vector(cacc, w + 6 * body + 3), turn, arm), rate, velocity))
    keep(out, o + 16, turn)


@njit
def bend_point(lay, k, out, o, r, site_xmat, qpos, qvel, qacc):
    """Add to the kinematics of a point what the modes of its part add: e = Phi q turns and moves with the part.

    The velocity grows by e' + omega x e, the acceleration by e'' + 2 omega x e' + alpha x e + omega x (omega x e).
    """
    e = turned(site_xmat, r, bent(lay, k, qpos, 1))
    v = turned(site_xmat, r, bent(lay, k, qvel, 0))
    a = turned(site_xmat, r, bent(lay, k, qacc, 0))
    w, alpha = vector(out, o + 10), vector(out, o + 16)
    across = cross(w, e)
    grow(out, o, e)
    grow(out, o + 7, v)
    grow(out, o + 7, across)
    grow(out, o + 13, swept(swept(a, w, plus(times(2.0, v), across)), alpha, e))


@inlined
def track_peaks(lay, i, u, w, time, s, first):
    """Update all channels and travels with the values of this step; `s[first:]` are the system's sensor values."""
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
        if index(lay[row + 7]):
            bend_point(lay, i + index(lay[row + 7]), s, o, 9 * site, site_xmat, qpos, qvel, qacc)
        from_base = minus(vector(s, o), vector(xipos, 3 * index(lay[row + 3])))
        keep(s, o + at.RELATIVE, minus(from_base, vector(lay, row + 4)))
        o += at.POINT_VALUES
        row += at.POINT_COLUMNS
    axis = i + index(lay[i + at.AXES])
    for _ in range(index(lay[i + at.N_MOUNTS])):
        for c in range(at.MOUNT_VALUES):
            s[o + c] = u[record + c]
        o += at.MOUNT_VALUES
        record += 6
        for _axis in range(3):
            for k in range(index(lay[axis + 3])):
                s[o] = act[a + index(lay[axis + 2]) + k]
                o += 1
            axis += at.AXIS_COLUMNS
    write_forces(lay, i, u, w, time, s, o)
    if u[w + at.OBSERVING] != 0.0:
        track_peaks(lay, i, u, w, time, s, first)
