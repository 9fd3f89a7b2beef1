"""The building identified from one test: storeys from what the base level passes on, bearings from the whole response."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

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


def bearings(numbers: Array) -> Law:
    """Make the law of all bearings, of levels of 1 kg each, from its coordinates: logarithms over `START`, logits of ratios."""
    ratio = START[[6, 8]]
    k2_over, softening = 1.0 / (1.0 + np.exp(-numbers[[6, 8]] - np.log(ratio / (1.0 - ratio))))
    alpha_1, z_1, alpha_2, z_2, k1, k3, _, c, _, reach = (
        START * np.exp(np.where(np.isin(NAMES, ["k2", "softening"]), 0.0, numbers))
    ).tolist()
    spring = {"k1": LEVELS * k1, "k2": -2.0 * LEVELS * k2_over * np.sqrt(k1 * k3), "k3": LEVELS * k3}
    scales = [
        wr.ScraggedBoucWen.from_normalised(
            z_max=LEVELS * z_max, x_y=z_max / alpha, sigma=0.5, n=1.0, softening=softening, reach=reach, **more
        )
        for alpha, z_max, more in ((alpha_1, z_1, spring), (alpha_2, z_2, {}))
    ]
    return wr.Parallel(laws=[*scales, wr.KelvinVoigt(k=0.0, c=LEVELS * c)])


@dataclass(frozen=True, kw_only=True)
class Fit:
    """Bearings fitted to a test: coordinates, residuals (n_t, 2), Jacobian (n_t, 2, n_p), and the instants that counted."""

    numbers: Array
    residual: Array
    jacobian: Array
    counted: Array

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


def fit_bearings(
    motion: Motion,
    storeys: Storeys,
    *,
    counted: Array | None = None,
    start: Array | None = None,
    simulate: Callable[[Sequence[wr.System], Motion], list[Prediction]] = predict,
) -> Fit:
    """Fit the law so that the whole building, simulated under the table's acceleration, moves as it was measured.

    Args:
        motion: the test.
        storeys: what stands between the levels.
        counted: which instants count, (n_t,); all if not given. The building is simulated from the test's beginning.
        start: coordinates to begin at.
        simulate: the simulation.
    """
    weight = np.ones(motion.time.size) if counted is None else counted.astype(np.float64)
    run = partial(_together, motion=motion, storeys=storeys, simulate=simulate)

    def jacobian(numbers: Array) -> Array:
        moved = run([numbers, *(numbers + DIFFERENCE * row for row in np.eye(numbers.size))])
        return np.stack([(one - moved[0]) / DIFFERENCE for one in moved[1:]], axis=-1)

    begin = np.zeros(len(NAMES)) if start is None else start
    found = least_squares(
        lambda numbers: (weight[:, None] * run([numbers])[0]).ravel(),
        begin,
        jac=lambda numbers: (weight[:, None, None] * jacobian(numbers)).reshape(-1, numbers.size),
        bounds=(-LARGEST_CHANGE, LARGEST_CHANGE), x_scale=0.3, max_nfev=EVALUATIONS, ftol=1e-4,
    )  # fmt: skip
    return Fit(numbers=found.x, residual=run([found.x])[0], jacobian=jacobian(found.x), counted=weight > 0.0)


def _together(
    all_numbers: Sequence[Array],
    *,
    motion: Motion,
    storeys: Storeys,
    simulate: Callable[[Sequence[wr.System], Motion], list[Prediction]],
) -> list[Array]:
    """Return the residuals of several sets of coordinates, simulated side by side."""
    systems = [building(bearings(numbers), storeys) for numbers in all_numbers]
    return [residuals(prediction, motion) for prediction in simulate(systems, motion)]
