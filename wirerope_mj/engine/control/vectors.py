"""Vectors, rotations and quaternions as tuples, of floats or lanes, for the callbacks and for the equations in lanes.

`vector`, `six` and `quaternion` read the entries from a[i] on, `keep` writes a vector there, and `grow` adds one to it.
"""

import math

from wirerope_mj.foundation.jit import inlined


@inlined
def vector(a, i):
    return a[i], a[i + 1], a[i + 2]


@inlined
def keep(a, i, v):
    a[i], a[i + 1], a[i + 2] = v[0], v[1], v[2]


@inlined
def grow(a, i, v):
    a[i], a[i + 1], a[i + 2] = a[i] + v[0], a[i + 1] + v[1], a[i + 2] + v[2]


@inlined
def plus(a, b):
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@inlined
def minus(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inlined
def times(s, a):
    return s * a[0], s * a[1], s * a[2]


@inlined
def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def norm(a):
    return math.sqrt(dot(a, a))


@inlined
def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def turned(a, r, v):
    """Return R v, the matrix row by row in a[r:]."""
    return (
        a[r] * v[0] + a[r + 1] * v[1] + a[r + 2] * v[2],
        a[r + 3] * v[0] + a[r + 4] * v[1] + a[r + 5] * v[2],
        a[r + 6] * v[0] + a[r + 7] * v[1] + a[r + 8] * v[2],
    )


@inlined
def turned_back(a, r, v):
    """Return R^T v, the matrix row by row in a[r:]."""
    return (
        a[r] * v[0] + a[r + 3] * v[1] + a[r + 6] * v[2],
        a[r + 1] * v[0] + a[r + 4] * v[1] + a[r + 7] * v[2],
        a[r + 2] * v[0] + a[r + 5] * v[1] + a[r + 8] * v[2],
    )


@inlined
def column(a, r, c):
    """Return column `c` of the matrix row by row in a[r:]."""
    return a[r + c], a[r + 3 + c], a[r + 6 + c]


@inlined
def swept(v, w, r):
    """Return v + w x r, the sums from left to right."""
    return (
        v[0] + w[1] * r[2] - w[2] * r[1], v[1] + w[2] * r[0] - w[0] * r[2], v[2] + w[0] * r[1] - w[1] * r[0],
    )  # fmt: skip


@inlined
def velocity_at(r, w, v):
    """Return v + w x r, the velocity at r from a body's point with the velocity v."""
    return plus(v, cross(w, r))


@inlined
def acceleration_at(r, w, alpha, a):
    """Return a + alpha x r + w x (w x r), the acceleration at r from a body's point with the acceleration a."""
    return plus(plus(a, cross(alpha, r)), cross(w, cross(w, r)))


@inlined
def symmetric(i, v):
    """Return I v of the symmetric matrix i = xx, yy, zz, xy, xz, yz."""
    return (
        i[0] * v[0] + i[3] * v[1] + i[4] * v[2],
        i[3] * v[0] + i[1] * v[1] + i[5] * v[2],
        i[4] * v[0] + i[5] * v[1] + i[2] * v[2],
    )


@inlined
def six(a, i):
    return a[i], a[i + 1], a[i + 2], a[i + 3], a[i + 4], a[i + 5]


@inlined
def product(p, q):
    """Return the product of two quaternions."""
    return (
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1], p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    )  # fmt: skip


@inlined
def quaternion(a, i):
    return a[i], a[i + 1], a[i + 2], a[i + 3]


@inlined
def unit(q):
    """Return a quaternion of length 1."""
    s = 1.0 / math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    return q[0] * s, q[1] * s, q[2] * s, q[3] * s


@inlined
def rotated_by(q, v):
    """Return a vector turned by a unit quaternion."""
    u = q[1], q[2], q[3]
    t = times(2.0, cross(u, v))
    return plus(plus(v, times(q[0], t)), cross(u, t))


@inlined
def rotated_back(q, v):
    """Return a vector turned by the inverse of a unit quaternion."""
    return rotated_by((q[0], -q[1], -q[2], -q[3]), v)
