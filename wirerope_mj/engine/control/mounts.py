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
from wirerope_mj.engine.control.vectors import (
    column,
    cross,
    dot,
    grow,
    minus,
    plus,
    product,
    quaternion,
    swept,
    times,
    turned,
    turned_back,
    vector,
)
from wirerope_mj.foundation.jit import index, inlined, njit
from wirerope_mj.mounts.laws.plane_kernels import RATE_NUMBERS, WITH_ANOTHER, biaxial_rates, loop_force, on_brackets
from wirerope_mj.mounts.laws.registry import MASING, PARALLEL, evaluate, hold_slips

AXIAL = 2  # index of the axial axis


@njit
def righting_torque(base, payload, modelled, stiffness):
    """Return the torque [N m] of rotational stiffnesses on a payload, in the base site's axes.

    Orientations are unit quaternions: of the base's site, of the payload's, and of the payload's in the base's as modelled.
    """
    turn = product((base[0], -base[1], -base[2], -base[3]), payload)
    e0, e1, e2, e3 = product(turn, (modelled[0], -modelled[1], -modelled[2], -modelled[3]))
    k1, k2, k3 = stiffness[0] * e1, stiffness[1] * e2, stiffness[2] * e3
    return -2.0 * (e0 * k1 + e2 * k3 - e3 * k2), -2.0 * (e0 * k2 + e3 * k1 - e1 * k3), -2.0 * (e0 * k3 + e1 * k2 - e2 * k1)


@inlined
def stage_row(u, w, time):
    """Return the row of an instant in the table of the base's accelerations at the segment's half steps."""
    n_points = int(u[w + at.STAGE_POINTS])
    row = 0
    if n_points > 0:
        row = int(round((time - u[w + at.STAGE_START]) * u[w + at.STAGE_RATE]))
        row = min(max(row, 0), n_points - 1)
    return row


@inlined
def drive_base(lay, i, u, w, time, qfrc_applied, qfrc_bias, qfrc_passive):
    """Apply the base's tabulated accelerations of this instant to its slides and hinges."""
    n_points = int(u[w + at.STAGE_POINTS])
    stage, turns = 3 * stage_row(u, w, time), index(lay[i + at.USER_TURNS])
    base = vector(u, w + at.STAGES + stage)
    j = i + index(lay[i + at.DRIVEN])
    for _ in range(index(lay[i + at.N_DRIVEN])):
        dof = index(lay[j])
        acceleration = dot(vector(lay, j + 2), base) if n_points > 0 else 0.0
        if turns and n_points > 0:
            acceleration += dot(vector(lay, j + 5), vector(u, w + turns + stage))
        # The bias carries gravity, so that the base does not sink; contacts and mounts act on 1e10 kg.
        qfrc_applied[dof] = lay[j + 1] * acceleration + qfrc_bias[dof] - qfrc_passive[dof]
        j += at.DRIVEN_COLUMNS
    j = i + index(lay[i + at.MODES])
    for _ in range(index(lay[i + at.N_MODES])):  # -Gamma a of the base
        qfrc_applied[index(lay[j])] = -dot(vector(lay, j + 1), base) if n_points > 0 else -0.0
        j += at.MODE_COLUMNS


@inlined
def point_velocity(cvel, body, subtree_com, root, point):
    """Return the velocity [m/s] of a point that moves with `body`."""
    return swept(vector(cvel, 6 * body + 3), vector(cvel, 6 * body), minus(point, vector(subtree_com, 3 * root)))


@inlined
def add_force(xfrc, body, xipos, point, force):
    """Add a force at a point to the wrench on a body, which is about its centre of mass."""
    grow(xfrc, 6 * body, force)
    grow(xfrc, 6 * body + 3, cross(minus(point, vector(xipos, 3 * body)), force))


@inlined
def coupled_forces(law, axial, p, first, n, x, y, vx, vy, z, j, k, zdot, jdot, kdot):
    """Return the forces [N] that coupling adds along roll and its partner axis, and write the rates of the coupled states.

    On brackets (see `law`) these are the whole forces, of a rope loop with the axial axis those of its elastic energy, else 0.
    (x, y) and (vx, vy) are the deflections and their rates; the states of both axes begin at `z[j:]` and `z[k:]`, the states'
    rates at `zdot[jdot:]` and `zdot[kdot:]`.
    """
    if law == WITH_ANOTHER:
        return on_brackets(p, first, n, x, y, vx, vy, z, j, k, zdot, jdot, kdot)
    for scale in range(n):
        biaxial_rates(p, first + RATE_NUMBERS * scale, vx, vy, z, j + scale, k + scale, zdot, jdot + scale, kdot + scale)
    if axial:
        return loop_force(p, first + RATE_NUMBERS * n, x, y)
    return 0.0 * x, 0.0 * x


@njit
def couple_axes(lay, m, axis, par, q, act, a, u, record, rates, site_xmat, rate):
    """Couple roll and its partner axis of the mount in row `m`: write the rates of their hysteretic states anew, add forces.

    Returns the added force [N], world axes. `axis` is the row behind the mount's axes, `u[record:]` its
    deflection and force, `rate` that of the deflection.
    """
    first, other, r = q + index(lay[m + at.COUPLING]), index(lay[m + at.PARTNER]), 9 * index(lay[m + at.BASE_SITE])
    row = axis - 3 * at.AXIS_COLUMNS
    j, k = index(lay[row + at.FIRST_STATE]), index(lay[row + at.FIRST_STATE + at.AXIS_COLUMNS * other])
    roll, along = column(site_xmat, r, 0), column(site_xmat, r, other)
    fu, fw = coupled_forces(
        lay[row + at.LAW], other == AXIAL, par, first, index(lay[row + at.LAW_STATES]), u[record], u[record + other],
        dot(roll, rate), dot(along, rate), act, a + j, a + k, u, rates + j, rates + k,
    )  # fmt: skip
    u[record + 3] += fu
    u[record + 3 + other] += fw
    return plus(times(fu, roll), times(fw, along))


@njit
def add_torque(lay, m, site_xmat, site_xquat, xfrc):
    """Add the torques of the mount in row `m` that resists turning to the wrenches on its bodies."""
    payload, base = index(lay[m + at.PAYLOAD_SITE]), index(lay[m + at.BASE_SITE])
    torque = righting_torque(
        quaternion(site_xquat, 4 * base), quaternion(site_xquat, 4 * payload), quaternion(lay, m + at.MODELLED),
        vector(lay, m + at.TURNING),
    )  # fmt: skip
    torque = turned(site_xmat, 9 * base, torque)
    grow(xfrc, 6 * index(lay[m + at.PAYLOAD]) + 3, torque)
    if lay[m + at.MOVED] != 0.0:
        grow(xfrc, 6 * index(lay[m + at.BASE]) + 3, times(-1.0, torque))


@njit
def elastic_motion(lay, k, coordinates, kind):
    """Return a site's elastic motion in its axes: shapes times modal coordinates (kind 1), or rates or accelerations (0)."""
    x = (0.0, 0.0, 0.0)
    for mode in range(index(lay[k])):
        row = k + 1 + at.SHAPE_COLUMNS * mode
        x = plus(x, times(coordinates[index(lay[row + kind])], vector(lay, row + at.SHAPE)))
    return x


@njit
def push_modes(lay, k, r, site_xmat, qfrc_applied, force):
    """Add the modal forces Phi^T f of a force f, world axes, at a flexible part's site with the axes `site_xmat[r:]`."""
    along = turned_back(site_xmat, r, force)
    for mode in range(index(lay[k])):
        row = k + 1 + at.SHAPE_COLUMNS * mode
        qfrc_applied[index(lay[row])] += dot(vector(lay, row + at.SHAPE), along)


@inlined
def separation(lay, i, m, site_xpos, site_xmat, qpos):
    """Return the payload's point of the mount in row `m` and its offset from the base's site [m], world axes."""
    s, b = index(lay[m + at.PAYLOAD_SITE]), index(lay[m + at.BASE_SITE])
    shapes, below = index(lay[m + at.SHAPES]), index(lay[m + at.SHAPES + 1])
    point = vector(site_xpos, 3 * s)
    if shapes:
        point = plus(point, turned(site_xmat, 9 * s, elastic_motion(lay, i + shapes, qpos, 1)))
    apart = minus(point, vector(site_xpos, 3 * b))
    if below:
        apart = minus(apart, turned(site_xmat, 9 * b, elastic_motion(lay, i + below, qpos, 1)))
    return point, apart


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
        for side in (at.PAYLOAD, at.BASE):
            body = index(lay[m + at.MOUNT_COLUMNS * mount + side])
            for c in range(6):
                xfrc[6 * body + c] = 0.0
    axis = i + index(lay[i + at.AXES])
    for _ in range(n_mounts):
        payload, base = index(lay[m + at.PAYLOAD]), index(lay[m + at.BASE])
        s, r = 9 * index(lay[m + at.PAYLOAD_SITE]), 9 * index(lay[m + at.BASE_SITE])
        shapes, below = index(lay[m + at.SHAPES]), index(lay[m + at.SHAPES + 1])
        point, apart = separation(lay, i, m, site_xpos, site_xmat, qpos)
        rate = minus(
            point_velocity(cvel, payload, subtree_com, index(lay[m + at.PAYLOAD_ROOT]), point),
            point_velocity(cvel, base, subtree_com, index(lay[m + at.BASE_ROOT]), point),
        )
        if shapes:
            rate = plus(rate, turned(site_xmat, s, elastic_motion(lay, i + shapes, qvel, 0)))
        if below:
            rate = minus(rate, turned(site_xmat, r, elastic_motion(lay, i + below, qvel, 0)))
        total = (0.0, 0.0, 0.0)
        for c in range(3):
            along = column(site_xmat, r, c)
            deflection = dot(along, apart)
            force = 0.0
            law = int(lay[axis + at.LAW])
            if law >= 0:
                p, state = q + index(lay[axis + at.FIRST_PARAMETER]), index(lay[axis + at.FIRST_STATE])
                force = evaluate(law, par, p, deflection, dot(along, rate), act, a + state, u, rates + state)
                total = plus(total, times(force, along))
            u[record + c], u[record + 3 + c] = deflection, force
            axis += at.AXIS_COLUMNS
        if lay[m + at.COUPLING] >= 0.0:
            total = plus(total, couple_axes(lay, m, axis, par, q, act, a, u, record, rates, site_xmat, rate))
        against = times(-1.0, total)
        add_force(xfrc, payload, xipos, point, against)
        if shapes:
            push_modes(lay, i + shapes, s, site_xmat, qfrc_applied, against)
        if below:
            push_modes(lay, i + below, r, site_xmat, qfrc_applied, total)
        if lay[m + at.MOVED] != 0.0:
            add_force(xfrc, base, xipos, point, total)
        if lay[m + at.TURNING] != 0.0 or lay[m + at.TURNING + 1] != 0.0 or lay[m + at.TURNING + 2] != 0.0:
            add_torque(lay, m, site_xmat, site_xquat, xfrc)
        record += 6
        m += at.MOUNT_COLUMNS


@inlined
def remove_overshoot(lay, i, par, q, act, a):
    """Clip the states of sliders to their slip forces, which the last step may have exceeded."""
    left = index(lay[i + at.N_SLIPPING])
    axis = i + index(lay[i + at.AXES])
    while left > 0:
        if lay[axis + at.LAW] == MASING or lay[axis + at.LAW] == PARALLEL:
            p, z = q + index(lay[axis + at.FIRST_PARAMETER]), a + index(lay[axis + at.FIRST_STATE])
            hold_slips(index(lay[axis + at.LAW]), par, p, act, z)
            left -= 1
        axis += at.AXIS_COLUMNS


@inlined
def copy_rates(lay, i, u, w, act_dot, a):
    """Copy the state rates from userdata to MuJoCo's activation rates and return the first rate.

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
def apply_loads(lay, i, u, w, time, site_xpos, site_xmat, xipos, xfrc, qfrc_applied):
    """Add the external loads of this instant, forces [N] and moments [N m] along the axes of sites, to the wrenches."""
    n_forces = index(lay[i + at.N_FORCES])
    if n_forces == 0 or u[w + at.STAGE_POINTS] == 0.0:
        return
    k = w + index(lay[i + at.USER_FORCES]) + 6 * n_forces * stage_row(u, w, time)
    j = i + index(lay[i + at.FORCES])
    for _ in range(n_forces):
        site, body = index(lay[j + at.FORCE_SITE]), index(lay[j + at.FORCE_BODY])
        force = turned(site_xmat, 9 * site, vector(u, k))
        add_force(xfrc, body, xipos, vector(site_xpos, 3 * site), force)
        if index(lay[j + at.FORCE_SHAPES]):
            push_modes(lay, i + index(lay[j + at.FORCE_SHAPES]), 9 * site, site_xmat, qfrc_applied, force)
        grow(xfrc, 6 * body + 3, turned(site_xmat, 9 * site, vector(u, k + 3)))
        j += at.FORCE_COLUMNS
        k += 6


@inlined
def apply_forces(
    lay, i, par, q, u, w, act, a, time, qfrc_applied, qfrc_bias, qfrc_passive, site_xpos, site_xmat, site_xquat, subtree_com,
    cvel, xipos, xfrc, qpos, qvel,
):  # fmt: skip
    """Drive the base, and write the wrenches of mounts and of external loads at sites to `xfrc` [N, N m]."""
    drive_base(lay, i, u, w, time, qfrc_applied, qfrc_bias, qfrc_passive)
    j = i + index(lay[i + at.FORCES])
    for _ in range(index(lay[i + at.N_FORCES])):  # clear the last pass; `apply_mounts` clears bodies with mounts
        for c in range(6):
            xfrc[6 * index(lay[j + at.FORCE_BODY]) + c] = 0.0
        j += at.FORCE_COLUMNS
    apply_mounts(
        lay, i, par, q, u, w, act, a, site_xpos, site_xmat, site_xquat, subtree_com, cvel, xipos, xfrc, qpos, qvel,
        qfrc_applied,
    )  # fmt: skip
    apply_loads(lay, i, u, w, time, site_xpos, site_xmat, xipos, xfrc, qfrc_applied)
