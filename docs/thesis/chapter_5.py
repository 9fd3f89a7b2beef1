"""Chapter 5, appendices D and E: the three stages, fits in one stage, and optimisers on the thesis' problem."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
import numpy.typing as npt
from figures.drawing import BLUES, COLOURS, GUIDE, canvas, explain, inscribe
from matplotlib.figure import Figure as Picture
from scipy.optimize import differential_evolution, least_squares, minimize

import wirerope_mj as wr
from docs.thesis.rope import MM, record, spring

Array = npt.NDArray[np.float64]
START = wr.AsymmetricBoucWen.from_normalised(z_max=300.0, x_y=2e-3, sigma=0.5, n=1.0, k1=5e4, k2=0.0, k3=0.0, b=np.e, c=5.0)
"""Where every search begins: round figures off by factors of two to five."""
SIZES = np.array([300.0, 1e-3, 0.5, 1.0, 5e4, 1e8, 10.0])
"""Units of z_max, x_y, sigma, n, k1, k3 and c: one number each, so that steps in all of them are alike."""
LOW, HIGH = np.array([0.1, 0.1, 0.2, 0.1, 0.0, -1.0, -5.0]), np.array([20.0, 20.0, 2.0, 4.0, 6.0, 20.0, 10.0])
SEED = 1


def law_of(numbers: Array) -> wr.AsymmetricBoucWen:
    """Return the law of seven numbers in units of SIZES."""
    z_max, x_y, sigma, n, k1, k3, c = numbers * SIZES
    return wr.AsymmetricBoucWen.from_normalised(z_max=z_max, x_y=x_y, sigma=sigma, n=n, k1=k1, k2=0.0, k3=k3, b=np.e, c=c)


@dataclass
class Problem:
    """The thesis' sum of squares over the samples of all loops, each loop over its half force range; counts evaluations."""

    evaluations: int = 0

    def residual(self, numbers: Array) -> Array:
        """Return the differences of all samples [-]."""
        self.evaluations += 1
        if (numbers < LOW).any() or (numbers > HIGH).any():
            return np.full(6 * 50, 10.0)
        law = law_of(numbers)
        return np.concatenate([self._of(law, loop) for loop in record(spring())])

    @staticmethod
    def _of(law: wr.AsymmetricBoucWen, loop: wr.Loop) -> Array:
        path = loop.deflection[:-1]
        twice = law.trace(np.concatenate([path, path, path])).force[-path.size :]  # closed after two cycles
        apart = twice - loop.force[:-1]
        apart = apart[:: path.size // 50][:50]
        return (apart - apart.mean()) / (0.5 * np.ptp(loop.force)) / np.sqrt(50.0)

    def error(self, numbers: Array) -> float:
        """Return the root mean square over loops [-]."""
        return float(np.sqrt(np.sum(self.residual(numbers) ** 2) / 6.0))


def marquardt(problem: Problem, numbers: Array) -> Array:
    """Minimise with Marquardt's rule: lambda / 10 after a step that serves, times 10 after one that does not."""
    damping, value = 1e-2, problem.residual(numbers)
    for _ in range(60):
        columns = [(problem.residual(numbers + 1e-6 * unit) - value) / 1e-6 for unit in np.eye(numbers.size)]
        jacobian = np.stack(columns, axis=1)
        normal, gradient = jacobian.T @ jacobian, jacobian.T @ value
        for _try in range(12):
            step = -np.linalg.solve(normal + damping * np.diag(np.diag(normal)), gradient)
            trial = problem.residual(numbers + step)
            if trial @ trial < value @ value:
                break
            damping *= 10.0
        else:
            return numbers
        gain = 1.0 - (trial @ trial) / (value @ value)
        numbers, value, damping = numbers + step, trial, damping / 10.0
        if gain < 1e-8:
            return numbers
    return numbers


def _start() -> Array:
    form = START.normalised
    return np.array([form.z_max, form.x_y, form.sigma, START.n, START.k1, START.k3, START.c]) / SIZES


OPTIMISERS: dict[str, Callable[[Problem], Array]] = {
    "marquardt": lambda problem: marquardt(problem, _start()),
    "region": lambda problem: least_squares(problem.residual, _start(), bounds=(LOW, HIGH), diff_step=1e-6).x,
    "simplex": lambda problem: (
        minimize(problem.error, _start(), method="Nelder-Mead", options={"maxfev": 1500, "xatol": 1e-5, "fatol": 1e-7}).x
    ),
    "evolution": lambda problem: (
        differential_evolution(
            problem.error, list(zip(LOW, HIGH, strict=True)), rng=SEED, maxiter=25, popsize=8, polish=False, tol=1e-6
        ).x
    ),
}


@cache
def fits() -> dict[str, wr.Identification]:
    """Return the fits from START: in three stages, at once in time, at once in frequency."""
    methods = {"three": "three-stage", "time": "time", "frequency": "frequency"}
    return {
        name: wr.identify(record(spring()), start=START, method=method, grid=False, profiles=False)
        for name, method in methods.items()
    }


def numbers() -> dict[str, float]:
    """Return errors after every stage and method, and errors and evaluations of the optimisers."""
    found: dict[str, float] = {}
    for name, fit in fits().items():
        found[f"{name}_error"], found[f"{name}_evaluations"] = 100.0 * fit.residual, float(fit.evaluations)
    for place, stage in enumerate(fits()["three"].stages, 1):
        found[f"stage_{place}"], found[f"stage_{place}_steps"] = 100.0 * stage.error, float(stage.iterations)
    grid = wr.identify(record(spring()), profiles=False)
    found["grid_error"] = 100.0 * grid.residual
    found["first_loop"], found["last_loop"] = 100.0 * float(grid.residuals[0]), 100.0 * float(grid.residuals[-1])
    problem = Problem()
    found["start"] = 100.0 * problem.error(_start())
    for name, optimise in OPTIMISERS.items():
        problem = Problem()
        best = optimise(problem)
        found[f"{name}_n"] = float(problem.evaluations)
        found[f"{name}_rms"] = 100.0 * problem.error(best)
    return found


def pictures() -> dict[str, Callable[[], Picture]]:
    """Return what draws the loops and the fits."""
    return {"chapter_5_fits": partial(_draw)}


def _draw() -> Picture:
    picture, panels = canvas(2, height=3.9)
    loops = record(spring())
    for panel, loop in zip(panels, (loops[-2], loops[0]), strict=True):
        panel.plot(MM * loop.deflection, loop.force, color=GUIDE, lw=3.0, label="measured (virtual)")
        for name, colour, label in (("three", COLOURS[1], "one set, three stages"),):
            law = fits()[name].law
            path = np.concatenate([loop.deflection[:-1], loop.deflection[:-1], loop.deflection])
            force = law.trace(path).force[-loop.deflection.size :]
            offset = loop.force[:-1].mean() - force[:-1].mean()
            panel.plot(MM * loop.deflection, force + offset, color=colour, lw=1.4, label=label)
        inscribe(panel, f"±{MM * loop.amplitude:.1f} mm", "deflection [mm]", "force [N]")
    explain(panels[0])
    panels[1].plot([], [], color=BLUES[0])
    return picture
