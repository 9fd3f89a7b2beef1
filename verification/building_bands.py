"""Bands of predicted peaks: what the fitted test tells of its own errors, carried over to another motion.

Nothing but the fitted test goes in. Blocks of it are left out in turn, and the errors of what is then calculated there, over
the table's acceleration, are a discrepancy for each frequency and channel: another motion excites as much of it as its table
moves there. Parameters vary by what the blocks disagree, as the jackknife has it. Beyond the largest fitted deflection the
spring may go on as the polynomial does, straight on, or anywhere between.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from verification.building_data import LEVELS, Motion
from verification.building_fit import Fit, bearings, springs
from verification.building_model import Prediction, Storeys, building, predict
from wirerope_mj.foundation.arrays import Array

BLOCK = 10.0
"""Length of the blocks that are left out in turn [s]: four periods of the building, and more than it remembers."""

PRIOR = 1.0
"""Standard deviation of a coordinate's logarithm before the test: parts of it alone do not fix all coordinates."""

WIDTH = 0.15
"""Ratio of frequencies over which spectra are averaged to either side."""

DECAY = 2.8
"""Seconds over which an error goes on: 1 / (2 pi 0.16 0.36 Hz), the decay of the isolated building."""

MEMBERS, DRAWS, SEED = 12, 40, 20
INSIDE = (5.0, 95.0)
"""Per cent of the draws between which a band lies: 90 %."""


@dataclass(frozen=True, kw_only=True)
class Errors:
    """What the fitted test tells of its own errors.

    Attributes:
        members: coordinates of the bearings drawn from their covariance, (MEMBERS, n_p).
        frequency: of the discrepancy [Hz], (n_f,).
        discrepancy: error of each channel over the table's acceleration, (n_f, 12): displacements, then accelerations.
        amplitude: largest deflection of the test [m].
    """

    members: Array
    frequency: Array
    discrepancy: Array
    amplitude: float


def channels(motion: Motion | Prediction) -> Array:
    """Return displacements and accelerations of all levels, (n_t, 12)."""
    return np.concatenate([motion.displacement, motion.acceleration], axis=1)


def errors_of(motion: Motion, fit: Fit, storeys: Storeys) -> Errors:
    """Derive the errors from the test that was fitted."""
    block = (motion.time // BLOCK).astype(int)
    blocks = [block == one for one in np.unique(block)]
    without = np.array([_from_part(fit, ~one) for one in blocks])
    apart = without - without.mean(axis=0)
    covariance = (len(blocks) - 1) / len(blocks) * apart.T @ apart
    members = np.random.default_rng(SEED).multivariate_normal(fit.numbers, covariance, size=MEMBERS, method="svd")
    parts = predict([building(bearings(numbers), storeys) for numbers in without], motion)
    measured, left = channels(motion), np.zeros((motion.time.size, 2 * LEVELS))
    for one, part in zip(blocks, parts, strict=True):
        left[one] = channels(part)[one] - measured[one]
    frequency, discrepancy = _over_table(left, motion)
    return Errors(
        members=members,
        frequency=frequency,
        discrepancy=discrepancy,
        amplitude=float(np.abs(motion.deflection).max()),
    )


def _from_part(fit: Fit, counted: Array) -> Array:
    """Return the coordinates that a part of the test gives, by one step of Gauss and Newton from those of the whole."""
    rows, left = fit.jacobian[counted].reshape(-1, fit.numbers.size), fit.residual[counted].ravel()
    prior = float(np.mean(fit.residual**2)) / PRIOR**2
    normal = rows.T @ rows + prior * np.eye(fit.numbers.size)
    return np.asarray(fit.numbers - np.linalg.solve(normal, rows.T @ left + prior * fit.numbers))


def _over_table(left: Array, motion: Motion) -> tuple[Array, Array]:
    """Return frequencies, and errors over the table's acceleration there, both averaged over neighbouring ones."""
    spectrum = np.fft.rfftfreq(motion.time.size, motion.interval)
    error, table = np.abs(np.fft.rfft(left, axis=0)) ** 2, np.abs(np.fft.rfft(motion.table)) ** 2
    frequency = np.geomspace(0.1, 0.4 / motion.interval, 60)
    near = [(spectrum > f * (1.0 - WIDTH)) & (spectrum < f * (1.0 + WIDTH)) for f in frequency]
    return frequency, np.array([np.sqrt(error[one].sum(axis=0) / table[one].sum()) for one in near])


def straight_on(numbers: Array, fitted: float, prediction: Prediction) -> tuple[float, float]:
    """Return the ratios by which the largest deflection and force change if the spring goes straight on beyond the fitted one.

    Beyond it the fitted polynomial is an assumption, and the tangent at its end is another. At the same energy the deflection
    grows by the area between both over the force, and the force falls by their distance less what the tangent adds there.
    """
    k1, k2, k3 = springs(numbers)
    size, force = np.abs(prediction.displacement[:, 0]).max(), np.abs(prediction.acceleration.mean(axis=1)).max()
    if size <= fitted:
        return 1.0, 1.0
    tangent = k1 + 2.0 * k2 * fitted + 3.0 * k3 * fitted**2
    way = size - fitted
    # of x |x| and x^3 what is left behind their tangents, and the integrals of that
    apart = k2 * way**2 + k3 * way**2 * (3.0 * fitted + way)
    grown = (k2 * way**3 / 3.0 + k3 * way**3 * (fitted + way / 4.0)) / force
    return 1.0 + float(grown / size), 1.0 - float((apart - tangent * grown) / force)


def bands(errors: Errors, predictions: Sequence[Prediction], motion: Motion) -> Array:
    """Return the band of each channel's peak, (2, 12), from predictions of all members; of `motion` the table alone counts."""
    rng, n = np.random.default_rng(SEED), motion.time.size
    size = scipy.fft.next_fast_len(n, real=True)
    spectrum, table = np.fft.rfftfreq(size, motion.interval), scipy.fft.rfft(motion.table, size)
    excited = table[:, None] * np.column_stack(
        [np.interp(spectrum, errors.frequency, column, left=0.0, right=0.0) for column in errors.discrepancy.T]
    )
    window = np.fft.ifftshift(scipy.signal.windows.gaussian(size, DECAY / motion.interval, sym=False))
    window /= np.sqrt(np.sum(window**2))
    peaks = []
    for numbers, prediction in zip(errors.members, predictions, strict=True):
        calculated = channels(prediction)
        ratios = np.repeat(straight_on(numbers, errors.amplitude, prediction), LEVELS)
        for _ in range(DRAWS):
            spread = scipy.fft.rfft(window * rng.normal(size=size))
            error = scipy.fft.irfft(excited * spread[:, None], size, axis=0)[:n]
            peaks.append(ratios ** rng.uniform() * np.abs(calculated + error).max(axis=0))
    return np.percentile(peaks, INSIDE, axis=0)
