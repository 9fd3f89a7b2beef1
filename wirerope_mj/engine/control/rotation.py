"""Torque of a mount against being turned, beside its force, from a potential of the relative orientation.

With e = (e0, e) the unit quaternion that turns the payload's site, in the base site's axes, from the modelled geometry, and
K = diag(roll, shear, axial):

    U = 2 e.K e        torque on the payload = -2 (e0 K e + e x K e)

For a turn theta about one axis that is U = K (1 - cos theta) and K sin theta: K theta^2 / 2 and K theta while it is small. Both
are the same for e and -e, so that orientations need no branch. The torque is -dU for a small turn dtheta of the payload, which
changes e by (-e.dtheta, e0 dtheta + dtheta x e) / 2; a turn of the base changes it by the opposite, and takes the reaction.
"""

from wirerope_mj.engine.control import layout as at
from wirerope_mj.foundation.jit import njit


@njit
def product(a0, a1, a2, a3, b0, b1, b2, b3):
    """Return the product of two quaternions."""
    return (
        a0 * b0 - a1 * b1 - a2 * b2 - a3 * b3,
        a0 * b1 + a1 * b0 + a2 * b3 - a3 * b2,
        a0 * b2 - a1 * b3 + a2 * b0 + a3 * b1,
        a0 * b3 + a1 * b2 - a2 * b1 + a3 * b0,
    )


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
    return (
        -2.0 * (e0 * k1 + e2 * k3 - e3 * k2),
        -2.0 * (e0 * k2 + e3 * k1 - e1 * k3),
        -2.0 * (e0 * k3 + e1 * k2 - e2 * k1),
    )


@njit
def turning_energy(lay, m, site_xquat):
    """Return what the turned mount in row `m` has stored [J]."""
    _, e1, e2, e3 = turned_by(lay, m, site_xquat)
    k = m + at.TURNING
    return 2.0 * (lay[k] * e1 * e1 + lay[k + 1] * e2 * e2 + lay[k + 2] * e3 * e3)
