"""Measurements at the start of every step: kinematics of bodies and points, mounts, and the peaks of all of them.

MuJoCo calls the sensor callback once per Runge-Kutta step, in the forward pass at the step's start, when positions,
velocities and accelerations belong to the same instant. The peaks are refined by the parabola through the three steps
around an extreme; a parabola is never drawn across a corner of the base motion.
"""

import math

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.contacts import write_forces
from wirerope_mj.engine.control.mounts import bent, turned
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


@njit
def parabola_extreme(t0, y0, t1, y1, t2, y2):
    """Return instant and value of the extreme of the parabola through three points whose middle one is extreme.

    An extreme of exactly zero stays: it belongs to a stop that lets go, whose force rests at zero behind a corner, and a
    parabola across the corner would let it pull.
    """
    left, right = (y1 - y0) / (t1 - t0), (y2 - y1) / (t2 - t1)
    curvature = (right - left) / (t2 - t0)
    if curvature == 0.0 or y1 == 0.0:
        return t1, y1
    time = 0.5 * (t0 + t1 - left / curvature)
    return time, y0 + (time - t0) * (left + curvature * (time - t1))


@inlined
def track_component(u, m, c, history, t0, t1, t2, y2):
    """Update the extremes of one component with its newest value `y2`."""
    if history == 0:
        u[m + at.LOW + c], u[m + at.LOW_TIME + c], u[m + at.HIGH + c], u[m + at.HIGH_TIME + c] = y2, t2, y2, t2
        return
    if y2 > u[m + at.HIGH + c]:
        u[m + at.HIGH + c], u[m + at.HIGH_TIME + c] = y2, t2
    if y2 < u[m + at.LOW + c]:
        u[m + at.LOW + c], u[m + at.LOW_TIME + c] = y2, t2
    if history < 2:
        return
    y0, y1 = u[m + at.BEFORE + c], u[m + at.LAST + c]
    if y1 >= y0 and y1 >= y2:
        time, value = parabola_extreme(t0, y0, t1, y1, t2, y2)
        if value > u[m + at.HIGH + c]:
            u[m + at.HIGH + c], u[m + at.HIGH_TIME + c] = value, time
    elif y1 <= y0 and y1 <= y2:
        time, value = parabola_extreme(t0, y0, t1, y1, t2, y2)
        if value < u[m + at.LOW + c]:
            u[m + at.LOW + c], u[m + at.LOW_TIME + c] = value, time


@inlined
def norm_at(u, m, first):
    """Return the norm of one of the channel's remembered vectors."""
    return math.sqrt(u[m + first] ** 2 + u[m + first + 1] ** 2 + u[m + first + 2] ** 2)


@inlined
def track_norm(u, m, history, t0, t1, t2, s, j):
    """Update the peak of the norm with the newest vector `s[j:j + 3]`."""
    y2 = math.sqrt(s[j] ** 2 + s[j + 1] ** 2 + s[j + 2] ** 2)
    if history == 0 or y2 > u[m + at.PEAK]:
        u[m + at.PEAK], u[m + at.PEAK_TIME] = y2, t2
        for c in range(3):
            u[m + at.PEAK_VECTOR + c] = s[j + c]
    if history < 2:
        return
    y0, y1 = norm_at(u, m, at.BEFORE), norm_at(u, m, at.LAST)
    if y1 < y0 or y1 < y2:
        return
    time, value = parabola_extreme(t0, y0, t1, y1, t2, y2)
    if value > u[m + at.PEAK]:
        u[m + at.PEAK], u[m + at.PEAK_TIME] = value, time
        for c in range(3):
            v0, v1, v2 = u[m + at.BEFORE + c], u[m + at.LAST + c], s[j + c]
            left = (v1 - v0) / (t1 - t0)
            curvature = ((v2 - v1) / (t2 - t1) - left) / (t2 - t0)
            u[m + at.PEAK_VECTOR + c] = v0 + (time - t0) * (left + curvature * (time - t1))


@inlined
def track_travels(lay, i, u, w, history, t0, t1, t2):
    """Update the travel of every mount along all axes at once: the sum of (deflection / rated)^2.

    An instant is not judged while the mount moves along its axis in the way that is not rated.
    """
    row = i + index(lay[i + at.MOUNTS])
    m, record = w + index(lay[i + at.USER_TRAVELS]), w + index(lay[i + at.USER_MOUNTS])
    for _ in range(index(lay[i + at.N_MOUNTS])):
        roll, shear, axial = u[record], u[record + 1], u[record + 2]
        along = lay[row + at.TRAVEL + 2] if axial < 0.0 else lay[row + at.TRAVEL + 3]
        y2 = lay[row + at.TRAVEL] * roll * roll + lay[row + at.TRAVEL + 1] * shear * shear + along * axial * axial
        judged = axial == 0.0 or along > 0.0
        if history == 0:
            u[m + at.FARTHEST], u[m + at.FARTHEST_TIME] = y2, t2
            u[m + at.JUDGED], u[m + at.JUDGED_TIME] = y2 if judged else -1.0, t2
        if y2 > u[m + at.FARTHEST]:
            u[m + at.FARTHEST], u[m + at.FARTHEST_TIME] = y2, t2
        if judged and y2 > u[m + at.JUDGED]:
            u[m + at.JUDGED], u[m + at.JUDGED_TIME] = y2, t2
        y0, y1 = u[m + at.TRAVEL_BEFORE], u[m + at.TRAVEL_LAST]
        if history == 2 and y1 >= y0 and y1 >= y2:
            time, value = parabola_extreme(t0, y0, t1, y1, t2, y2)
            if value > u[m + at.FARTHEST]:
                u[m + at.FARTHEST], u[m + at.FARTHEST_TIME] = value, time
            if u[m + at.WAS_JUDGED] != 0.0 and value > u[m + at.JUDGED]:
                u[m + at.JUDGED], u[m + at.JUDGED_TIME] = value, time
        u[m + at.TRAVEL_BEFORE], u[m + at.TRAVEL_LAST], u[m + at.WAS_JUDGED] = y1, y2, 1.0 if judged else 0.0
        row, m, record = row + at.MOUNT_COLUMNS, m + at.TRAVEL_MEMORY, record + 6


@inlined
def track_peaks(lay, i, u, w, time, s, first):
    """Update all channels with the values of this step; `s[first:]` are the system's sensor values."""
    event, history = u[w + at.EVENT], int(u[w + at.HISTORY])
    if event == at.JUMP and history > 1:
        history = 1  # what follows a jump is compared with what was, but no parabola is drawn to it
    t0, t1 = u[w + at.TIME_2], u[w + at.TIME_1]
    n_channels = index(lay[i + at.N_CHANNELS])
    channel = i + index(lay[i + at.CHANNELS])
    m = w + index(lay[i + at.USER_CHANNELS])
    for _ in range(n_channels):
        j = first + index(lay[channel])
        for c in range(3):
            track_component(u, m, c, history, t0, t1, time, s[j + c])
        track_norm(u, m, history, t0, t1, time, s, j)
        for c in range(3):
            u[m + at.BEFORE + c] = u[m + at.LAST + c]
            u[m + at.LAST + c] = s[j + c]
        channel += at.CHANNEL_COLUMNS
        m += at.CHANNEL_MEMORY
    track_travels(lay, i, u, w, history, t0, t1, time)
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
