"""The building identified from one test: storeys from what the base level passes on, bearings from the whole response."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

import wirerope_mj as wr
from verification.building_data import LEVELS, Motion
from verification.building_model import Prediction, Storeys, building, predict
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.laws import Law

HIGHEST = 12.0
"""Frequency up to which storeys are fitted [Hz]: the records were low-passed above."""

NAMES = ("alpha_1", "z_max_1", "alpha_2", "z_max_2", "k1", "k3", "k2", "c", "softening", "reach")
START = np.array([20.0, 0.05, 5.0, 0.1, 7.0, 50.0, 0.5, 0.2, 0.5, 0.1])
"""Rough readings of the fitted test's loops, over the mass: 14 to 20 /s^2 in the smallest cycles and 5 in the largest, 0.15 of
critical damping. k2 is given over the least that is passive, -2 sqrt(k1 k3)."""

LARGEST_CHANGE = 6.0
"""Bound of each coordinate from its start: a factor of 400, or all of the range from 0 to 1."""

DIFFERENCE = 1e-3
"""Step of coordinates for the Jacobian: errors of the simulation, 1e-5 of a peak, are a hundredth of what it moves."""

EVALUATIONS = 30


def storeys_of(motion: Motion) -> Storeys:
    """Identify stiffness and damping of five storeys from the accelerations of the base and of the levels above it.

    Levels of one mass, linear springs and dampers between them; least squares of the levels' spectra up to `HIGHEST`.
    """
    n = LEVELS - 1
    spectrum = np.fft.rfft(motion.acceleration, axis=0)
    frequency = np.fft.rfftfreq(motion.time.size, motion.interval)
    chosen = (frequency > 0.0) & (frequency < HIGHEST)
    omega, base, levels = 2.0 * np.pi * frequency[chosen], spectrum[chosen, 0], spectrum[chosen, 1:]
    above = np.eye(n) - np.eye(n, k=-1)  # drift of each storey from the displacements relative to the base level
    size = np.sqrt(np.mean(np.abs(levels) ** 2))

    def residual(logs: Array) -> Array:
        springs, dampers = np.exp(logs[:n]), np.exp(logs[n:])
        stiffness, damping = (above.T @ np.diag(values) @ above for values in (springs, dampers))
        dynamic = stiffness + 1j * omega[:, None, None] * damping - omega[:, None, None] ** 2 * np.eye(n)
        relative = np.linalg.solve(dynamic, -np.outer(base, np.ones(n))[:, :, None])[:, :, 0]
        difference = (base[:, None] - omega[:, None] ** 2 * relative - levels) / size
        return np.concatenate([difference.real.ravel(), difference.imag.ravel()])

    start = np.log(np.concatenate([np.full(n, 1e3), np.full(n, 10.0)]))  # a first frequency of 1.4 Hz, 4 % of critical
    found = np.exp(least_squares(residual, start, bounds=(start - 9.0, start + 9.0)).x)
    return Storeys(stiffness=found[:n], damping=found[n:])


def _values(numbers: Array) -> dict[str, float]:
    """Return the parameters over the mass by name: `START` times exponentials, of ratios the odds times them."""
    odds = np.isin(NAMES, ["k2", "softening"])
    start = np.where(odds, START / np.where(odds, 1.0 - START, 1.0), START)
    moved = start * np.exp(numbers)
    return dict(zip(NAMES, np.where(odds, moved / (1.0 + moved), moved).tolist(), strict=True))


def springs(numbers: Array) -> tuple[float, float, float]:
    """Return k1, k2, k3 of the elastic force over the mass."""
    at = _values(numbers)
    return at["k1"], -2.0 * at["k2"] * float(np.sqrt(at["k1"] * at["k3"])), at["k3"]


def bearings(numbers: Array) -> Law:
    """Make the law of all bearings, of levels of 1 kg each, from its coordinates."""
    at = _values(numbers)
    spring = dict(zip(("k1", "k2", "k3"), (LEVELS * k for k in springs(numbers)), strict=True))
    scales = tuple(
        wr.ScraggedBoucWen.from_normalised(
            z_max=LEVELS * at[f"z_max_{scale}"], x_y=at[f"z_max_{scale}"] / at[f"alpha_{scale}"], sigma=0.5, n=1.0,
            softening=at["softening"], reach=at["reach"], **(spring if scale == 1 else {}),
        )
        for scale in (1, 2)
    )  # fmt: skip
    return wr.Parallel(laws=(*scales, wr.KelvinVoigt(k=0.0, c=LEVELS * at["c"])))


@dataclass(frozen=True, kw_only=True)
class Fit:
    """Bearings fitted to a test: coordinates, residuals (n_t, 2) and Jacobian (n_t, 2, n_p)."""

    numbers: Array
    residual: Array
    jacobian: Array

    @property
    def law(self) -> Law:
        """The law of all bearings."""
        return bearings(self.numbers)


def residuals(prediction: Prediction, motion: Motion) -> Array:
    """Return deflections and mean accelerations, calculated less measured over the largest measured, (n_t, 2)."""
    pairs = (
        (prediction.displacement[:, 0], motion.deflection),
        (-prediction.acceleration.mean(axis=1), motion.force),
    )
    return np.column_stack([(found - true) / np.abs(true).max() for found, true in pairs])


def fit_bearings(motion: Motion, storeys: Storeys) -> Fit:
    """Fit the law so that the whole building, simulated under the table's acceleration, moves as it was measured."""

    def together(all_numbers: Sequence[Array]) -> list[Array]:
        systems = [building(bearings(numbers), storeys) for numbers in all_numbers]
        return [residuals(prediction, motion) for prediction in predict(systems, motion)]

    def jacobian(numbers: Array) -> Array:
        moved = together([numbers, *(numbers + DIFFERENCE * row for row in np.eye(numbers.size))])
        return np.stack([(one - moved[0]) / DIFFERENCE for one in moved[1:]], axis=-1)

    found = least_squares(
        lambda numbers: together([numbers])[0].ravel(),
        np.zeros(len(NAMES)),
        jac=lambda numbers: jacobian(numbers).reshape(-1, numbers.size),
        bounds=(-LARGEST_CHANGE, LARGEST_CHANGE), x_scale=0.3, max_nfev=EVALUATIONS, ftol=1e-4,
    )  # fmt: skip
    return Fit(numbers=found.x, residual=together([found.x])[0], jacobian=jacobian(found.x))
