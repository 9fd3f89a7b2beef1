"""Accelerations of the coordinates from the forces on the links, tree by tree.

A driven tree follows the base, a mode has unit mass, a floating link alone obeys Newton and Euler in its own axes, and one that
only slides has a mass matrix that never changes. Any other tree has that of its composite bodies, M_jk = S_k . I_j S_j over the
dofs k from j to the root, factored from the leaves on (Featherstone 2008, 6.2 and 6.5). A driven dof there has the drive's
inertia and force, as MuJoCo's has, so that both push back on it alike.
"""

from wirerope_mj.engine.control.vectors import (
    acceleration_at,
    cross,
    dot,
    keep,
    minus,
    plus,
    six,
    symmetric,
    times,
    turned,
    turned_back,
    vector,
)
from wirerope_mj.engine.kernel import layout as at
from wirerope_mj.foundation.jit import inlined, njit


@inlined
def drive(lay, fix, number, base):
    """Return the acceleration of a driven slide or hinge from those of the base."""
    f = lay[at.DRIVEN] + at.DRIVEN_COLUMNS * number
    acceleration = fix[f] * base[0] + fix[f + 1] * base[1] + fix[f + 2] * base[2]
    if lay[at.ROTATES] >= 0:
        acceleration = acceleration + (fix[f + 3] * base[3] + fix[f + 4] * base[4] + fix[f + 5] * base[5])
    return acceleration


@inlined
def follow_base(lay, t, fix, work, base):
    """Give the only link of a driven tree the acceleration of the base."""
    k = lay[at.KIN] + at.KIN_SIZE * lay[t + at.TREE_LINK]
    a, turns = times(0.0, base), lay[at.ROTATES] >= 0
    if turns:
        a, alpha, o = vector(work, k + at.KIN_L0), vector(work, k + at.KIN_A0), vector(work, k + at.KIN_O)
    for dof in range(lay[t + at.TREE_DOF], lay[t + at.TREE_DOF] + lay[t + at.TREE_DOFS]):
        d = lay[at.DOFS] + at.DOF_COLUMNS * dof
        acceleration = drive(lay, fix, lay[d + at.DOF_DRIVEN], base)
        work[lay[at.RHS] + dof] = acceleration
        if turns:  # axis and anchor as `place_turning` has left them
            part = times(acceleration, vector(work, lay[at.SUB] + 6 * dof))
            if lay[d + at.DOF_KIND] == at.HINGE:
                alpha, part = plus(alpha, part), cross(part, minus(o, vector(work, lay[at.SUB] + 6 * dof + 3)))
            a = plus(a, part)
        else:
            a = plus(a, times(acceleration, vector(fix, lay[d + at.DOF_FIX] + at.AXIS)))
    keep(work, k + at.KIN_L, a)
    if turns:
        keep(work, k + at.KIN_A, alpha)


@inlined
def solve_floating_link(lay, t, fix, num, y, work):
    """Solve Newton's and Euler's equations of a floating link that carries no other."""
    first, link = lay[t + at.TREE_DOF], lay[t + at.TREE_LINK]
    k, wrench, r = lay[at.KIN] + at.KIN_SIZE * link, lay[at.WRENCH] + 6 * link, lay[at.RHS] + first
    i = lay[lay[at.LINKS] + at.LINK_COLUMNS * link + at.INERTIA]
    w, c = vector(y, lay[at.NQ] + first + 3), vector(num, i + at.CENTRE)
    force = vector(work, wrench)
    torque = turned_back(work, k + at.KIN_R, vector(work, wrench + 3))
    torque = minus(torque, cross(c, turned_back(work, k + at.KIN_R, force)))
    alpha = symmetric(six(num, i + at.INVERSE), minus(torque, cross(w, symmetric(six(num, i + at.ABOUT), w))))
    a = plus(times(1.0 / num[i + at.MASS_OF], force), vector(fix, lay[at.GRAVITY]))
    a = minus(a, turned(work, k + at.KIN_R, plus(cross(alpha, c), cross(w, cross(w, c)))))
    keep(work, r, a)
    keep(work, r + 3, alpha)
    keep(work, k + at.KIN_A, turned(work, k + at.KIN_R, alpha))
    keep(work, k + at.KIN_L, a)


@inlined
def solve_sliding_link(lay, t, fix, num, y, work):
    """Solve the equations of a link that only slides, whose mass matrix never changes."""
    first, n, link = lay[t + at.TREE_DOF], lay[t + at.TREE_DOFS], lay[t + at.TREE_LINK]
    k, r, inverse = lay[at.KIN] + at.KIN_SIZE * link, lay[at.RHS] + first, lay[t + at.TREE_INVERSE]
    mass = num[lay[lay[at.LINKS] + at.LINK_COLUMNS * link + at.INERTIA] + at.MASS_OF]
    force = plus(vector(work, lay[at.WRENCH] + 6 * link), times(mass, vector(fix, lay[at.GRAVITY])))
    for i in range(n):
        d = lay[at.DOFS] + at.DOF_COLUMNS * (first + i)
        work[lay[at.MASS] + i] = dot(vector(fix, lay[d + at.DOF_FIX] + at.AXIS), force) + joint_passive_force(
            lay, d, first + i, num, y
        )
    a = times(0.0, force)
    for i in range(n):
        acceleration = num[inverse + n * i] * work[lay[at.MASS]]
        for j in range(1, n):
            acceleration = acceleration + num[inverse + n * i + j] * work[lay[at.MASS] + j]
        work[r + i] = acceleration
        d = lay[at.DOFS] + at.DOF_COLUMNS * (first + i)
        a = plus(a, times(acceleration, vector(fix, lay[d + at.DOF_FIX] + at.AXIS)))
    keep(work, k + at.KIN_L, a)


@inlined
def joint_passive_force(lay, d, dof, num, y):
    """Return the force of spring and damper of a joint [N or N m]."""
    n = lay[d + at.DOF_NUM]
    force = -num[n + at.DAMPING] * y[lay[at.NQ] + dof]
    if lay[d + at.DOF_KIND] <= at.HINGE:
        force = force - num[n + at.STIFFNESS] * (y[lay[d + at.DOF_QPOS]] - num[n + at.REFERENCE])
    return force


@inlined
def rotated(work, r, i):
    """Return R I R^T of a symmetric matrix as xx, yy, zz, xy, xz, yz."""
    x, y, z = vector(work, r), vector(work, r + 3), vector(work, r + 6)
    ix, iy, iz = symmetric(i, x), symmetric(i, y), symmetric(i, z)
    return dot(x, ix), dot(y, iy), dot(z, iz), dot(x, iy), dot(x, iz), dot(y, iz)


@njit
def compose(lay, link, ref, fix, num, work):
    """Write a link's mass, its first and second moments, and its forces, about the point `ref` of its tree."""
    row, k = lay[at.LINKS] + at.LINK_COLUMNS * link, lay[at.KIN] + at.KIN_SIZE * link
    i, c, wrench = lay[row + at.INERTIA], lay[at.COMPOSITE] + at.COM_SIZE * link, lay[at.WRENCH] + 6 * link
    mass, arm = num[i + at.MASS_OF], minus(vector(work, k + at.KIN_O), ref)
    centre = turned(work, k + at.KIN_R, vector(num, i + at.CENTRE))
    r, w, alpha = plus(arm, centre), vector(work, k + at.KIN_W), vector(work, k + at.KIN_A0)
    about = rotated(work, k + at.KIN_R, six(num, i + at.ABOUT))
    work[c + at.COM_M] = mass
    keep(work, c + at.COM_H, times(mass, r))
    for j in range(3):
        work[c + at.COM_I + j] = about[j] + mass * (dot(r, r) - r[j] * r[j])
    work[c + at.COM_I + 3] = about[3] - mass * r[0] * r[1]
    work[c + at.COM_I + 4] = about[4] - mass * r[0] * r[2]
    work[c + at.COM_I + 5] = about[5] - mass * r[1] * r[2]
    force = vector(work, wrench)
    keep(work, c + at.COM_E, force)
    keep(work, c + at.COM_E + 3, plus(vector(work, wrench + 3), cross(arm, force)))
    a = minus(acceleration_at(centre, w, alpha, vector(work, k + at.KIN_L0)), vector(fix, lay[at.GRAVITY]))
    f = times(mass, a)
    keep(work, c + at.COM_B, f)
    spin = plus(symmetric(about, alpha), cross(w, symmetric(about, w)))
    keep(work, c + at.COM_B + 3, plus(spin, cross(r, f)))


@njit
def subspaces(lay, link, ref, fix, work):
    """Write the motion that a unit rate of each coordinate of a link gives: angular velocity, and velocity of `ref`."""
    row, k, s = lay[at.LINKS] + at.LINK_COLUMNS * link, lay[at.KIN] + at.KIN_SIZE * link, lay[at.SUB]
    first, kind = lay[row + at.FIRST_DOF], lay[row + at.KIND]
    for dof in range(first, first + lay[row + at.DOFS_OF]):
        d, j = lay[at.DOFS] + at.DOF_COLUMNS * dof, s + 6 * dof
        if kind == at.FREE:
            for c in range(3):
                work[j + c] = work[k + at.KIN_R + 3 * c + dof - first - 3] if dof - first >= 3 else 0.0 * work[k]
                work[j + 3 + c] = 1.0 if c == dof - first else 0.0
        elif lay[d + at.DOF_KIND] == at.HINGE:
            axis = vector(work, j)
            keep(work, j + 3, cross(axis, minus(ref, vector(work, j + 3))))
        else:
            if kind == at.STRAIGHT:
                keep(work, j, vector(fix, lay[d + at.DOF_FIX] + at.AXIS))
            keep(work, j + 3, vector(work, j))
            keep(work, j, (0.0, 0.0, 0.0))


@njit
def factor(lay, first, n, work):
    """Factor a tree's mass matrix in place, L^T D L, from the leaves to the root."""
    for k in range(n - 1, -1, -1):
        i = lay[lay[at.DOFS] + at.DOF_COLUMNS * (first + k) + at.DOF_PARENT] - first
        while i >= 0:
            ratio = work[lay[at.MASS] + k * n + i] / work[lay[at.MASS] + k * n + k]
            j = i
            while j >= 0:
                work[lay[at.MASS] + i * n + j] -= ratio * work[lay[at.MASS] + k * n + j]
                j = lay[lay[at.DOFS] + at.DOF_COLUMNS * (first + j) + at.DOF_PARENT] - first
            work[lay[at.MASS] + k * n + i] = ratio
            i = lay[lay[at.DOFS] + at.DOF_COLUMNS * (first + i) + at.DOF_PARENT] - first


@njit
def substitute(lay, first, n, work):
    """Solve with a factored mass matrix for the right side in RHS, in place."""
    r = lay[at.RHS] + first
    for k in range(n - 1, -1, -1):
        i = lay[lay[at.DOFS] + at.DOF_COLUMNS * (first + k) + at.DOF_PARENT] - first
        while i >= 0:
            work[r + i] -= work[lay[at.MASS] + k * n + i] * work[r + k]
            i = lay[lay[at.DOFS] + at.DOF_COLUMNS * (first + i) + at.DOF_PARENT] - first
        work[r + k] /= work[lay[at.MASS] + k * n + k]
    for k in range(n):
        i = lay[lay[at.DOFS] + at.DOF_COLUMNS * (first + k) + at.DOF_PARENT] - first
        while i >= 0:
            work[r + k] -= work[lay[at.MASS] + k * n + i] * work[r + i]
            i = lay[lay[at.DOFS] + at.DOF_COLUMNS * (first + i) + at.DOF_PARENT] - first


@njit
def assemble_tree(lay, first, n, fix, num, y, work, base):
    """Write a tree's mass matrix and right side from its composite links."""
    for dof in range(first + n - 1, first - 1, -1):
        d, j = lay[at.DOFS] + at.DOF_COLUMNS * dof, lay[at.SUB] + 6 * dof
        c, f = lay[at.COMPOSITE] + at.COM_SIZE * lay[d + at.DOF_LINK], lay[d + at.DOF_FIX]
        turn, shift, h = vector(work, j), vector(work, j + 3), vector(work, c + at.COM_H)
        p = plus(times(work[c + at.COM_M], shift), cross(turn, h))
        l = plus(symmetric(six(work, c + at.COM_I), turn), cross(h, shift))  # noqa: E741
        k = dof
        while k >= 0:
            s = lay[at.SUB] + 6 * k
            work[lay[at.MASS] + (dof - first) * n + k - first] = dot(vector(work, s), l) + dot(vector(work, s + 3), p)
            k = lay[lay[at.DOFS] + at.DOF_COLUMNS * k + at.DOF_PARENT]
        work[lay[at.MASS] + (dof - first) * (n + 1)] += fix[f + at.ARMATURE]
        side = dot(turn, vector(work, c + at.COM_E + 3)) + dot(shift, vector(work, c + at.COM_E))
        number = lay[d + at.DOF_DRIVEN]
        if number >= 0:
            mass = fix[lay[at.DRIVEN] + at.DRIVEN_COLUMNS * number + at.INERTIA_OF_DRIVE]
            work[lay[at.RHS] + dof] = side + mass * drive(lay, fix, number, base)
            continue
        side -= dot(turn, vector(work, c + at.COM_B + 3)) + dot(shift, vector(work, c + at.COM_B))
        work[lay[at.RHS] + dof] = side + joint_passive_force(lay, d, dof, num, y)


@njit
def solve_tree(lay, t, fix, num, y, work, base):
    """Solve the equations of any tree, and give its links their accelerations."""
    first, n, link = lay[t + at.TREE_DOF], lay[t + at.TREE_DOFS], lay[t + at.TREE_LINK]
    end = link + lay[t + at.TREE_LINKS]
    ref = vector(work, lay[at.KIN] + at.KIN_SIZE * link + at.KIN_O)
    for i in range(link, end):
        compose(lay, i, ref, fix, num, work)
        subspaces(lay, i, ref, fix, work)
    for i in range(end - 1, link, -1):
        parent = lay[lay[at.LINKS] + at.LINK_COLUMNS * i + at.PARENT]
        one, other = lay[at.COMPOSITE] + at.COM_SIZE * parent, lay[at.COMPOSITE] + at.COM_SIZE * i
        if parent >= link:
            for c in range(at.COM_SIZE):
                work[one + c] += work[other + c]
    assemble_tree(lay, first, n, fix, num, y, work, base)
    factor(lay, first, n, work)
    substitute(lay, first, n, work)
    for i in range(link, end):
        row, k = lay[at.LINKS] + at.LINK_COLUMNS * i, lay[at.KIN] + at.KIN_SIZE * i
        c = lay[at.COMPOSITE] + at.COM_SIZE * i
        over = lay[at.COMPOSITE] + at.COM_SIZE * lay[row + at.PARENT]
        for j in range(6):  # angular acceleration and that of `ref`, beyond the links' own
            work[c + j] = work[over + j] if lay[row + at.PARENT] >= link else 0.0 * work[c]
        for dof in range(lay[row + at.FIRST_DOF], lay[row + at.FIRST_DOF] + lay[row + at.DOFS_OF]):
            for j in range(6):
                work[c + j] += work[lay[at.SUB] + 6 * dof + j] * work[lay[at.RHS] + dof]
        turn, arm = vector(work, c), minus(vector(work, k + at.KIN_O), ref)
        keep(work, k + at.KIN_A, plus(vector(work, k + at.KIN_A0), turn))
        keep(work, k + at.KIN_L, plus(plus(vector(work, k + at.KIN_L0), vector(work, c + 3)), cross(turn, arm)))


@inlined
def accelerate(lay, fix, num, y, work, base):
    """Write the accelerations of all coordinates to RHS, those of the links to KIN; `base` is that of the base (6)."""
    t = lay[at.TREES]
    for _ in range(lay[at.N_TREES]):
        if lay[t + at.TREE_KIND] == at.DRIVEN_TREE:
            follow_base(lay, t, fix, work, base)
        elif lay[t + at.TREE_KIND] == at.FREE_TREE:
            solve_floating_link(lay, t, fix, num, y, work)
        elif lay[t + at.TREE_KIND] == at.MODAL_TREE:  # of unit mass, with all else of its right side there
            dof = lay[t + at.TREE_DOF]
            work[lay[at.RHS] + dof] += joint_passive_force(lay, lay[at.DOFS] + at.DOF_COLUMNS * dof, dof, num, y)
        elif lay[t + at.TREE_KIND] == at.SLIDING_TREE:
            solve_sliding_link(lay, t, fix, num, y, work)
        else:
            solve_tree(lay, t, fix, num, y, work, base)
        t += at.TREE_COLUMNS
