"""What coupled laws of roll and axial deflection store: by it no closed path can draw work from them."""

import numpy as np
from numpy.polynomial.legendre import leggauss

from wirerope_mj.mounts.laws.plane import asymmetry_of, elastic_of

NODES, WEIGHTS = leggauss(32)  # of exp(lambda x) F1(x) to rounding up to lambda x = 20
SMALL = 1e-2  # Exponent below which a power series is more exact than the closed form


def stored_energy(law, deflection, hysteretic_state):
    """Return what is stored [J], (...): elastic, and what unloading without loss gives back of the hysteretic forces.

    It is zero where undeflected and unloaded; deflections [m] are of roll and axial, (..., 2), and so are the hysteretic
    states [N], (..., 2), of several scales (..., n_scales, 2).
    """
    d, z = np.asarray(deflection, dtype=np.float64), np.asarray(hysteretic_state, dtype=np.float64)
    if len(law.scales) > 1:
        return np.sum([stored_energy(scale, d, z[..., number, :]) for number, scale in enumerate(law.scales)], axis=0)
    total = law.loop.energy(d)
    for axis, own in enumerate(law.laws):
        total = total + _elastic_energy(own, d[..., axis]) + _given_back(own, d[..., axis], z[..., axis])
    return total


def _elastic_energy(law, x):
    """Return int_0^x F2 F1 [J]."""
    (k1, k2, k3), exponent = elastic_of(law), asymmetry_of(law)
    s = 0.5 * x[..., None] * (1.0 + NODES)
    force = np.exp(exponent * s) * s * (k1 + k2 * np.abs(s) + k3 * s * s)
    return 0.5 * x * (force @ WEIGHTS)


def _given_back(law, x, z):
    """Return S(x, z) [J] = (z^2 / alpha) F2(x) (exp(-t) - 1 + t) / t^2 with t = lambda z / alpha."""
    alpha, exponent = float(law.kernel_parameters()[0]), asymmetry_of(law)
    t = exponent * z / alpha
    large = np.where(np.abs(t) < SMALL, 1.0, t)
    series = 1 / 2 - t * (1 / 6 - t * (1 / 24 - t * (1 / 120 - t * (1 / 720 - t / 5040))))
    ratio = np.where(np.abs(t) < SMALL, series, (np.expm1(-large) + large) / large**2)
    return z * z / alpha * np.exp(exponent * x) * ratio
