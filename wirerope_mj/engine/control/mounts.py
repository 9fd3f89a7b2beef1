"""The forces of all mounts and the drive of the base, for one forward pass of MuJoCo.

Each mount's kinematics come from what the engine has already computed: with R the axes of the base site and p the payload
site's point,

    d = R^T (p - p_b)        rate = R^T [v_payload(p) - v_base(p)],   v_body(p) = v_com + omega x (p - com)

so that a rotating base is seen as the mount sees it. The restoring force R F acts on both bodies at p, which balances momentum
and angular momentum.

A site on a flexible part has Phi q and Phi q' besides, in its own axes, with the modal coordinates q of that part (see
`wirerope_mj.engine.flexible`): p and p_b are where the bent part has them, and its modes take Phi^T f of the force there.

A mount that resists turning adds opposite torques, from a potential of the relative orientation. With e = (e0, e) the unit
quaternion that turns the payload's site, in the base site's axes, from the modelled geometry, and K = diag(roll, shear, axial):

    U = 2 e.K e        torque on the payload = -2 (e0 K e + e x K e)

For a turn theta about one axis that is U = K (1 - cos theta) and K sin theta. Both are the same for e and -e, so that
orientations need no branch. The torque is -dU for a small turn dtheta of the payload, which changes e by
(-e.dtheta, e0 dtheta + dtheta x e) / 2; a turn of the base changes it by the opposite, and takes the reaction.
"""

from wirerope_mj.engine.control import layout as at
from wirerope_mj.foundation.jit import index, inlined, njit
from wirerope_mj.mounts.laws.plane_brackets import WITH_ANOTHER, on_brackets
from wirerope_mj.mounts.laws.plane_kernels import RATE_NUMBERS, biaxial_rates, loop_force
from wirerope_mj.mounts.laws.registry import MASING, PARALLEL, evaluate, hold_slips

AXIAL = 2  # index of the axial axis


@njit
def product(a0, a1, a2, a3, b0, b1, b2, b3):
    """Return the product of two quaternions."""
    return (
        a0 * b0 - a1 * b1 - a2 * b2 - a3 * b3, a0 * b1 + a1 * b0 + a2 * b3 - a3 * b2,
        a0 * b2 - a1 * b3 + a2 * b0 + a3 * b1, a0 * b3 + a1 * b2 - a2 * b1 + a3 * b0,
    )  # fmt: skip


@njit
def resists_turning(lay, m):
    """Return whether the mount in row `m` of the layout has a rotational stiffness."""
    return lay[m + at.TURNING] != 0.0 or lay[m + at.TURNING + 1] != 0.0 or lay[m + at.TURNING + 2] != 0.0


@njit
def turned_by(lay, m, site_xquat):
    """Return the turn of the payload's site since the modelled geometry as a unit quaternion in the base site's axes."""
    p, b, r = 4 * int(lay[m]), 4 * int(lay[m + 1]), m + at.MODELLED
    e0, e1, e2, e3 = product(
        site_xquat[b], -site_xquat[b + 1], -site_xquat[b + 2], -site_xquat[b + 3],
        site_xquat[p], site_xquat[p + 1], site_xquat[p + 2], site_xquat[p + 3],
    )  # fmt: skip
    return product(e0, e1, e2, e3, lay[r], -lay[r + 1], -lay[r + 2], -lay[r + 3])


@njit
def righting_torque(lay, m, site_xquat):
    """Return the torque [N m] of the mount in row `m` on its payload, in the base site's axes."""
    e0, e1, e2, e3 = turned_by(lay, m, site_xquat)
    k = m + at.TURNING
    return righting(e0, e1, e2, e3, lay[k], lay[k + 1], lay[k + 2])


@njit
def righting(e0, e1, e2, e3, roll, shear, axial):
    """Return the torque [N m] of rotational stiffnesses that are turned by a unit quaternion."""
    k1, k2, k3 = roll * e1, shear * e2, axial * e3
    return (-2.0 * (e0 * k1 + e2 * k3 - e3 * k2), -2.0 * (e0 * k2 + e3 * k1 - e1 * k3), -2.0 * (e0 * k3 + e1 * k2 - e2 * k1))


@inlined
def stage_row(u, w, time):
    """Return the row of the stage tables that belongs to an instant."""
    n_points = int(u[w + at.STAGE_POINTS])
    row = 0
    if n_points > 0:
        row = int(round((time - u[w + at.STAGE_START]) * u[w + at.STAGE_RATE]))
        row = min(max(row, 0), n_points - 1)
    return row


@inlined
def drive_base(lay, i, u, w, time, qfrc_applied, qfrc_bias, qfrc_passive):
    """Give the base's slides the acceleration that stands in the stage table for this instant."""
    n_points = int(u[w + at.STAGE_POINTS])
    table = w + at.STAGES + 3 * stage_row(u, w, time)
    j = i + index(lay[i + at.DRIVEN])
    for _ in range(index(lay[i + at.N_DRIVEN])):
        dof = index(lay[j])
        acceleration = 0.0
        if n_points > 0:
            acceleration = lay[j + 2] * u[table] + lay[j + 3] * u[table + 1] + lay[j + 4] * u[table + 2]
        # The bias carries gravity, so that the base does not sink; contacts and mounts act on 1e10 kg.
        qfrc_applied[dof] = lay[j + 1] * acceleration + qfrc_bias[dof] - qfrc_passive[dof]
        j += at.DRIVEN_COLUMNS
    j = i + index(lay[i + at.MODES])
    for _ in range(index(lay[i + at.N_MODES])):  # -Gamma a of the base
        total = 0.0
        if n_points > 0:
            total = lay[j + 1] * u[table] + lay[j + 2] * u[table + 1] + lay[j + 3] * u[table + 2]
        qfrc_applied[index(lay[j])] = -total
        j += at.MODE_COLUMNS


@inlined
def point_velocity(cvel, body, subtree_com, root, px, py, pz):
    """Return the velocity [m/s] of the point p that moves with `body`."""
    b, r = 6 * body, 3 * root
    rx, ry, rz = px - subtree_com[r], py - subtree_com[r + 1], pz - subtree_com[r + 2]
    wx, wy, wz = cvel[b], cvel[b + 1], cvel[b + 2]
    return (
        cvel[b + 3] + wy * rz - wz * ry, cvel[b + 4] + wz * rx - wx * rz, cvel[b + 5] + wx * ry - wy * rx,
    )  # fmt: skip


@inlined
def add_force(xfrc, body, xipos, px, py, pz, fx, fy, fz):
    """Add the force f acting at the point p to the wrench about the body's centre of mass."""
    x, b = 6 * body, 3 * body
    rx, ry, rz = px - xipos[b], py - xipos[b + 1], pz - xipos[b + 2]
    xfrc[x] += fx
    xfrc[x + 1] += fy
    xfrc[x + 2] += fz
    xfrc[x + 3] += ry * fz - rz * fy
    xfrc[x + 4] += rz * fx - rx * fz
    xfrc[x + 5] += rx * fy - ry * fx


@inlined
def coupled_forces(law, axial, p, first, n, x, y, vx, vy, z, j, k, zdot, jdot, kdot):
    """Return what coupling adds to the forces [N] of roll and another axis, and write the rates of the hysteretic vectors.

    On brackets (`law` says so) that is all of both, of a loop with the axial axis its elastic energy, else nothing. (x, y) and
    (vx, vy) are the deflections and their rates; the states of both begin at `z[j:]` and `z[k:]`, their rates at `zdot[jdot:]`
    and `zdot[kdot:]`.
    """
    if law == WITH_ANOTHER:
        return on_brackets(p, first, n, x, y, vx, vy, z, j, k, zdot, jdot, kdot)
    for scale in range(n):
        biaxial_rates(p, first + RATE_NUMBERS * scale, vx, vy, z, j + scale, k + scale, zdot, jdot + scale, kdot + scale)
    if axial:
        return loop_force(p, first + RATE_NUMBERS * n, x, y)
    return 0.0 * x, 0.0 * x


@njit
def couple_axes(lay, m, axis, par, q, act, a, u, record, rates, site_xmat, ux, uy, uz):
    """Give roll and another axis of the mount in row `m` a hysteretic vector on every scale, whose rates replace theirs.

    Returns what that adds to the mount's force [N], world axes. `axis` is the row behind the mount's axes, `u[record:]` its
    deflection and force, (ux, uy, uz) the rate of the deflection.
    """
    first, other, r = q + index(lay[m + at.COUPLING]), index(lay[m + at.PARTNER]), 9 * index(lay[m + 1])
    state = axis - 3 * at.AXIS_COLUMNS + 2
    j, k = index(lay[state]), index(lay[state + at.AXIS_COLUMNS * other])
    roll = site_xmat[r] * ux + site_xmat[r + 3] * uy + site_xmat[r + 6] * uz
    along = site_xmat[r + other] * ux + site_xmat[r + 3 + other] * uy + site_xmat[r + 6 + other] * uz
    fu, fw = coupled_forces(
        lay[state - 2], other == AXIAL, par, first, index(lay[state + 1]), u[record], u[record + other], roll, along, act,
        a + j, a + k, u, rates + j, rates + k,
    )  # fmt: skip
    u[record + 3] += fu
    u[record + 3 + other] += fw
    return (
        fu * site_xmat[r] + fw * site_xmat[r + other],
        fu * site_xmat[r + 3] + fw * site_xmat[r + 3 + other],
        fu * site_xmat[r + 6] + fw * site_xmat[r + 6 + other],
    )


@njit
def add_torque(lay, m, site_xmat, site_xquat, xfrc):
    """Add the torques of the mount in row `m` that resists turning to the wrenches on its bodies."""
    r, x, b = 9 * index(lay[m + 1]), 6 * index(lay[m + 2]) + 3, 6 * index(lay[m + 3]) + 3
    t1, t2, t3 = righting_torque(lay, m, site_xquat)
    for c in range(3):
        torque = site_xmat[r + 3 * c] * t1 + site_xmat[r + 3 * c + 1] * t2 + site_xmat[r + 3 * c + 2] * t3
        xfrc[x + c] += torque
        if lay[m + 6] != 0.0:
            xfrc[b + c] -= torque


@njit
def bent(lay, k, coordinates, column):
    """Return Phi times modal coordinates (column 1), rates or accelerations (column 0) at a site, in its axes."""
    x = y = z = 0.0
    for mode in range(index(lay[k])):
        row = k + 1 + at.SHAPE_COLUMNS * mode
        value = coordinates[index(lay[row + column])]
        x, y, z = x + lay[row + 2] * value, y + lay[row + 3] * value, z + lay[row + 4] * value
    return x, y, z


@njit
def push_modes(lay, k, r, site_xmat, qfrc_applied, fx, fy, fz):
    """Add Phi^T f of the force f on a flexible part, world axes, at a site with the axes `site_xmat[r:]`."""
    f1 = site_xmat[r] * fx + site_xmat[r + 3] * fy + site_xmat[r + 6] * fz
    f2 = site_xmat[r + 1] * fx + site_xmat[r + 4] * fy + site_xmat[r + 7] * fz
    f3 = site_xmat[r + 2] * fx + site_xmat[r + 5] * fy + site_xmat[r + 8] * fz
    for mode in range(index(lay[k])):
        row = k + 1 + at.SHAPE_COLUMNS * mode
        qfrc_applied[index(lay[row])] += lay[row + 2] * f1 + lay[row + 3] * f2 + lay[row + 4] * f3


@inlined
def apply_mounts(
    lay, i, par, q, u, w, act, a, site_xpos, site_xmat, site_xquat, subtree_com, cvel, xipos, xfrc, qpos, qvel,
    qfrc_applied,
):  # fmt: skip
    """Write every mount's deflection, force and state rates to userdata and its wrenches to `xfrc`.

    `lay[i:]` is the layout, `par[q:]` the laws' parameters, `u[w:]` the system's userdata, `act[a:]` its states.
    """
    n_mounts = index(lay[i + at.N_MOUNTS])
    record, rates = w + index(lay[i + at.USER_MOUNTS]), w + index(lay[i + at.USER_RATES])
    m = i + index(lay[i + at.MOUNTS])
    for mount in range(n_mounts):
        for side in range(2, 4):
            body = index(lay[m + at.MOUNT_COLUMNS * mount + side])
            for c in range(6):
                xfrc[6 * body + c] = 0.0
    axis = i + index(lay[i + at.AXES])
    for _ in range(n_mounts):
        payload, base = index(lay[m + 2]), index(lay[m + 3])
        s, b, r = 3 * index(lay[m]), 3 * index(lay[m + 1]), 9 * index(lay[m + 1])
        px, py, pz = site_xpos[s], site_xpos[s + 1], site_xpos[s + 2]
        shapes, below = index(lay[m + at.SHAPES]), index(lay[m + at.SHAPES + 1])
        ox, oy, oz = 0.0, 0.0, 0.0
        if shapes:
            ox, oy, oz = turned(site_xmat, 3 * s, bent(lay, i + shapes, qpos, 1))
            px, py, pz = px + ox, py + oy, pz + oz
        dx, dy, dz = px - site_xpos[b], py - site_xpos[b + 1], pz - site_xpos[b + 2]
        ux, uy, uz = point_velocity(cvel, payload, subtree_com, index(lay[m + 4]), px, py, pz)
        bx, by, bz = point_velocity(cvel, base, subtree_com, index(lay[m + 5]), px, py, pz)
        ux, uy, uz = ux - bx, uy - by, uz - bz
        if shapes:
            ox, oy, oz = turned(site_xmat, 3 * s, bent(lay, i + shapes, qvel, 0))
            ux, uy, uz = ux + ox, uy + oy, uz + oz
        if below:
            ox, oy, oz = turned(site_xmat, r, bent(lay, i + below, qpos, 1))
            dx, dy, dz = dx - ox, dy - oy, dz - oz
            ox, oy, oz = turned(site_xmat, r, bent(lay, i + below, qvel, 0))
            ux, uy, uz = ux - ox, uy - oy, uz - oz
        fx, fy, fz = 0.0, 0.0, 0.0
        for c in range(3):
            ex, ey, ez = site_xmat[r + c], site_xmat[r + 3 + c], site_xmat[r + 6 + c]
            deflection = ex * dx + ey * dy + ez * dz
            force = 0.0
            law = int(lay[axis])
            if law >= 0:
                rate = ex * ux + ey * uy + ez * uz
                state = index(lay[axis + 2])
                force = evaluate(law, par, q + index(lay[axis + 1]), deflection, rate, act, a + state, u, rates + state)
                fx, fy, fz = fx + force * ex, fy + force * ey, fz + force * ez
            u[record + c], u[record + 3 + c] = deflection, force
            axis += at.AXIS_COLUMNS
        if lay[m + at.COUPLING] >= 0.0:
            gx, gy, gz = couple_axes(lay, m, axis, par, q, act, a, u, record, rates, site_xmat, ux, uy, uz)
            fx, fy, fz = fx + gx, fy + gy, fz + gz
        add_force(xfrc, payload, xipos, px, py, pz, -fx, -fy, -fz)
        if shapes:
            push_modes(lay, i + shapes, 3 * s, site_xmat, qfrc_applied, -fx, -fy, -fz)
        if below:
            push_modes(lay, i + below, r, site_xmat, qfrc_applied, fx, fy, fz)
        if lay[m + 6] != 0.0:
            add_force(xfrc, base, xipos, px, py, pz, fx, fy, fz)
        if resists_turning(lay, m):
            add_torque(lay, m, site_xmat, site_xquat, xfrc)
        record += 6
        m += at.MOUNT_COLUMNS


@inlined
def remove_overshoot(lay, i, par, q, act, a):
    """Take out of the states what the last step carried beyond a slider's slip force."""
    left = index(lay[i + at.N_SLIPPING])
    axis = i + index(lay[i + at.AXES])
    while left > 0:
        if lay[axis] == MASING or lay[axis] == PARALLEL:
            hold_slips(index(lay[axis]), par, q + index(lay[axis + 1]), act, a + index(lay[axis + 2]))
            left -= 1
        axis += at.AXIS_COLUMNS


@inlined
def copy_rates(lay, i, u, w, act_dot, a):
    """Hand the state rates from userdata to MuJoCo's activation rates and return the first of them.

    MuJoCo takes the returned value where an actuator has one activation, and what is written to `act_dot` where it has more.
    """
    rates = w + index(lay[i + at.USER_RATES])
    n_states = index(lay[i + at.N_STATES])
    if n_states == 0:
        return 0.0
    for k in range(n_states):
        act_dot[a + k] = u[rates + k]
    return u[rates]


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
def apply_loads(lay, i, u, w, time, site_xpos, site_xmat, xipos, xfrc, qfrc_applied):
    """Add the forces and moments of this instant, which act at sites and along their axes."""
    n_forces = index(lay[i + at.N_FORCES])
    if n_forces == 0 or u[w + at.STAGE_POINTS] == 0.0:
        return
    k = w + index(lay[i + at.USER_FORCES]) + 6 * n_forces * stage_row(u, w, time)
    j = i + index(lay[i + at.FORCES])
    for _ in range(n_forces):
        site, body = index(lay[j]), index(lay[j + 1])
        s, r = 3 * site, 9 * site
        fx, fy, fz = turned(site_xmat, r, (u[k], u[k + 1], u[k + 2]))
        tx, ty, tz = turned(site_xmat, r, (u[k + 3], u[k + 4], u[k + 5]))
        add_force(xfrc, body, xipos, site_xpos[s], site_xpos[s + 1], site_xpos[s + 2], fx, fy, fz)
        if index(lay[j + 2]):
            push_modes(lay, i + index(lay[j + 2]), r, site_xmat, qfrc_applied, fx, fy, fz)
        xfrc[6 * body + 3] += tx
        xfrc[6 * body + 4] += ty
        xfrc[6 * body + 5] += tz
        j += at.FORCE_COLUMNS
        k += 6


@inlined
def turned(matrix, r, vector):
    """Return R v, the matrix standing row by row from `r` on."""
    x, y, z = vector
    return (
        matrix[r] * x + matrix[r + 1] * y + matrix[r + 2] * z,
        matrix[r + 3] * x + matrix[r + 4] * y + matrix[r + 5] * z,
        matrix[r + 6] * x + matrix[r + 7] * y + matrix[r + 8] * z,
    )
