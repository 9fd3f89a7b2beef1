"""Measurements at the start of every step: kinematics of bodies and points, mounts, and the peaks of all of them.

MuJoCo calls the sensor callback once per Runge-Kutta step, in the forward pass at the step's start, when positions,
velocities and accelerations belong to the same instant.
"""

import math

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.contacts import write_forces
from wirerope_mj.engine.control.mounts import bent, turned
from wirerope_mj.engine.control.peaks import parabola_bounds, track_travel, track_vector
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
def kinematics(out, o, point, p, quaternion, k, body, root, subtree_com, cvel, cacc, w):
    """Write position, orientation, velocity, angular velocity, acceleration and angular acceleration of a point."""
    v, g, r = 6 * body, w + 6 * body, 3 * root
    rx, ry, rz = point[p] - subtree_com[r], point[p + 1] - subtree_com[r + 1], point[p + 2] - subtree_com[r + 2]
    wx, wy, wz = cvel[v], cvel[v + 1], cvel[v + 2]
    ax, ay, az = cacc[g], cacc[g + 1], cacc[g + 2]
    vx, vy, vz = cvel[v + 3] + wy * rz - wz * ry, cvel[v + 4] + wz * rx - wx * rz, cvel[v + 5] + wx * ry - wy * rx
    for c in range(3):
        out[o + c] = point[p + c]
        out[o + 10 + c] = cvel[v + c]
        out[o + 16 + c] = cacc[g + c]
    for c in range(4):
        out[o + 3 + c] = quaternion[k + c]
    out[o + 7], out[o + 8], out[o + 9] = vx, vy, vz
    # The spatial acceleration is that of the velocity field at a fixed point; omega x v turns it into the particle's.
    out[o + 13] = cacc[g + 3] + ay * rz - az * ry + wy * vz - wz * vy
    out[o + 14] = cacc[g + 4] + az * rx - ax * rz + wz * vx - wx * vz
    out[o + 15] = cacc[g + 5] + ax * ry - ay * rx + wx * vy - wy * vx


@njit
def bend_point(lay, k, out, o, r, site_xmat, qpos, qvel, qacc):
    """Add to the kinematics of a point what the modes of its part add: e = Phi q turns and moves with the part.

    The velocity grows by e' + omega x e, the acceleration by e'' + 2 omega x e' + alpha x e + omega x (omega x e).
    """
    ex, ey, ez = turned(site_xmat, r, bent(lay, k, qpos, 1))
    vx, vy, vz = turned(site_xmat, r, bent(lay, k, qvel, 0))
    ax, ay, az = turned(site_xmat, r, bent(lay, k, qacc, 0))
    wx, wy, wz, bx, by, bz = out[o + 10], out[o + 11], out[o + 12], out[o + 16], out[o + 17], out[o + 18]
    cx, cy, cz = wy * ez - wz * ey, wz * ex - wx * ez, wx * ey - wy * ex
    ux, uy, uz = 2.0 * vx + cx, 2.0 * vy + cy, 2.0 * vz + cz
    out[o], out[o + 1], out[o + 2] = out[o] + ex, out[o + 1] + ey, out[o + 2] + ez
    out[o + 7], out[o + 8], out[o + 9] = out[o + 7] + vx + cx, out[o + 8] + vy + cy, out[o + 9] + vz + cz
    out[o + 13] += ax + wy * uz - wz * uy + by * ez - bz * ey
    out[o + 14] += ay + wz * ux - wx * uz + bz * ex - bx * ez
    out[o + 15] += az + wx * uy - wy * ux + bx * ey - by * ex


@inlined
def norm(a, i):
    """Return the norm of the vector `a[i:i + 3]`."""
    return math.sqrt(a[i] * a[i] + a[i + 1] * a[i + 1] + a[i + 2] * a[i + 2])


@inlined
def track_peaks(lay, i, u, w, time, s, first):
    """Update all channels and travels with the values of this step; `s[first:]` are the system's sensor values."""
    event, history, t0, t1 = u[w + at.EVENT], u[w + at.HISTORY], u[w + at.TIME_2], u[w + at.TIME_1]
    bounds = parabola_bounds(event, history, t0, t1, time)
    channel, m = i + index(lay[i + at.CHANNELS]), w + index(lay[i + at.USER_CHANNELS])
    for _ in range(index(lay[i + at.N_CHANNELS])):
        j, before, last = first + index(lay[channel]), m + at.BEFORE, m + at.LAST
        track_vector(u, m, before, last, s, j, (norm(u, before), norm(u, last), norm(s, j)), bounds, t0, t1, time)
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
    lay, i, u, w, act, a, time, s, site_xpos, site_xquat, xipos, xquat, subtree_com, cvel, cdof, cdof_dot, qvel, qacc,
    site_xmat, qpos,
):  # fmt: skip
    """Write the system's sensor values of this instant and, while a simulation observes, update the peaks."""
    record, cacc = w + index(lay[i + at.USER_MOUNTS]), w + index(lay[i + at.USER_ACCELERATIONS])
    body_accelerations(lay, i, u, cacc, cdof, cdof_dot, qvel, qacc)
    first = index(lay[i + at.SENSOR])
    o = first
    row = i + index(lay[i + at.BODIES])
    for _ in range(index(lay[i + at.N_BODIES])):
        body, root = index(lay[row]), index(lay[row + 1])
        kinematics(s, o, xipos, 3 * body, xquat, 4 * body, body, root, subtree_com, cvel, u, cacc)
        o += at.KINEMATICS
        row += at.BODY_COLUMNS
    row = i + index(lay[i + at.POINTS])
    for _ in range(index(lay[i + at.N_POINTS])):
        site, body, root = index(lay[row]), index(lay[row + 1]), index(lay[row + 2])
        kinematics(s, o, site_xpos, 3 * site, site_xquat, 4 * site, body, root, subtree_com, cvel, u, cacc)
        if index(lay[row + 7]):
            bend_point(lay, i + index(lay[row + 7]), s, o, 9 * site, site_xmat, qpos, qvel, qacc)
        base = 3 * index(lay[row + 3])
        for c in range(3):
            s[o + at.RELATIVE + c] = s[o + c] - xipos[base + c] - lay[row + 4 + c]
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
