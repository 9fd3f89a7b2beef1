"""Synthetic specimens: loops of a known law with noise, searches from poor starts, and whether they end at the known law."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import wirerope_mj as wr
from wirerope_mj.mounts.identification.families import family_of
from wirerope_mj.mounts.identification.identify import Identification, identify
from wirerope_mj.mounts.identification.uncertainty import OPEN
from wirerope_mj.mounts.laws import Law, Loop
from wirerope_mj.mounts.test_rig import cyclic_test, measured

Array = npt.NDArray[np.float64]

TRAVEL = 0.01
TESTED = TRAVEL * np.array([0.05, 0.15, 0.4, 0.7, 1.0])
LEFT_OUT = TRAVEL * np.array([0.1, 0.25, 0.85])
NOISE = 0.01  # of half the force range of each loop
FACTOR = 10.0  # starts are within this factor of the truth
LAWS: tuple[type[Law], ...] = (
    wr.BoucWen,
    wr.SymmetricBoucWen,
    wr.AsymmetricBoucWen,
    wr.EnhancedDryFriction,
    wr.VaianaRosati,
)


@dataclass(frozen=True, kw_only=True)
class SyntheticSpecimen:
    """Identification of one known law.

    Attributes:
        law: its name.
        truth: number of the truth.
        alone: for each start, whether the search from it, without the grid, ended at the law.
        together: for each start, whether the better of that search and the grid's did, which is what `identify` returns.
        deviations: by name, the distance of each identifiable parameter in standard errors, of `identify` begun at the best.
        evaluations: residuals computed in all.
    """

    law: str
    truth: int
    alone: tuple[bool, ...]
    together: tuple[bool, ...]
    deviations: dict[str, float]
    evaluations: int

    @property
    def within(self) -> int:
        """Identifiable parameters within three standard errors."""
        return sum(abs(value) < 3.0 for value in self.deviations.values())


def truth_of(kind: type[Law], rng: np.random.Generator) -> Law:
    """Return a law as a wire-rope isolator of 10 mm travel could have, sampled at random."""

    def draw(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    if kind is wr.EnhancedDryFriction:
        return kind(k=draw(2e4, 1e5), d=draw(200.0, 1000.0), u_c=draw(3e-4, 3e-3))
    if kind is wr.VaianaRosati:
        return kind(
            kb=draw(2e4, 5e4), f0=draw(100.0, 400.0), alpha=draw(300.0, 2000.0), b1=draw(20.0, 100.0), b2=draw(80.0, 250.0),
            g1=draw(30.0, 150.0), g2=draw(200.0, 800.0), g3=float(rng.uniform(-2e-3, 2e-3)),
        )  # fmt: skip
    shape = {"z_max": draw(200.0, 1000.0), "x_y": draw(3e-4, 3e-3), "sigma": draw(0.5, 1.0), "n": draw(0.7, 2.0)}
    if kind is wr.BoucWen:
        return kind.from_normalised(**shape, k=draw(2e4, 1e5))
    elastic = {"k1": draw(2e4, 1e5), "k2": float(rng.uniform(-1e6, 3e6)), "k3": draw(1e8, 1e9)}
    if kind is wr.SymmetricBoucWen:
        return kind.from_normalised(**shape, **elastic)
    return wr.AsymmetricBoucWen.from_normalised(**shape, **elastic, b=float(np.e), c=float(rng.uniform(10.0, 60.0)))


def noisy_loops(law: Law, rng: np.random.Generator, *, points: int = 200) -> list[Loop]:
    """Return loops of the tested amplitudes with force noise and an unknown zero of the load cell each."""
    loops = []
    for loop in cyclic_test(law, TESTED):
        half = 0.5 * float(np.ptp(loop.force))
        noise, seed = NOISE * half, int(rng.integers(1 << 31))
        one = measured([loop], points_per_cycle=points, force_noise=noise, seed=seed)[0]
        loops.append(Loop.from_samples(one.deflection, one.force + rng.uniform(-0.5, 0.5) * half))
    return loops


def start_of(truth: Law, rng: np.random.Generator) -> Law:
    """Return a law of which every parameter that is searched for is log-uniform within the factor of the truth's."""
    family = family_of(type(truth))
    away = {
        name: value * float(np.exp(rng.uniform(-np.log(FACTOR), np.log(FACTOR)))) for name, value in family.read(truth).items()
    }
    return family.make(away)


def left_out_error(fitted: Law, truth: Law) -> float:
    """Return the largest rms error at the amplitudes not used, over half the true force range, means apart."""
    pairs = zip(cyclic_test(fitted, LEFT_OUT), cyclic_test(truth, LEFT_OUT), strict=True)
    return max(float(np.std(a.force - b.force) / (0.5 * np.ptp(b.force))) for a, b in pairs)


def synthetic_specimen(kind: type[Law], number: int, starts: int) -> SyntheticSpecimen:
    """Return what becomes of one truth from several starts.

    `identify` keeps the better of the searches from the given start and from the grid. The grid does not depend on the start:
    it is searched once, and joined with each start afterwards.
    """
    rng = np.random.default_rng([number, LAWS.index(kind)])
    truth = truth_of(kind, rng)
    loops = noisy_loops(truth, rng)
    grid = identify(loops, law=kind)
    good = left_out_error(grid.law, truth) < NOISE
    evaluations, alone, together, best = grid.evaluations, [], [], grid
    for _ in range(starts):
        try:
            one = identify(loops, law=kind, start=start_of(truth, rng), grid=False)
        except ValueError:  # a parameter that moves nothing there
            alone.append(False)
            together.append(good)
            continue
        evaluations += one.evaluations
        alone.append(left_out_error(one.law, truth) < NOISE)
        better = one.residual < grid.residual
        together.append(alone[-1] if better else good)
        best = one if one.residual < best.residual else best
    final = identify(loops, law=kind, start=best.law, method="time")
    return SyntheticSpecimen(
        law=kind.name, truth=number, alone=tuple(alone), together=tuple(together), deviations=_deviations(final, truth),
        evaluations=evaluations,
    )  # fmt: skip


def deviations_of_draws(kind: type[Law], number: int, draws: int) -> list[dict[str, float]]:
    """Return the distances of one truth's identifiable parameters in standard errors, for each draw of the noise.

    The parameters of one fit err together: a rate needs many fits.
    """
    truth = truth_of(kind, np.random.default_rng([number, LAWS.index(kind)]))
    seeds = ([number, LAWS.index(kind), draw, 1] for draw in range(draws))
    return [_deviations(identify(noisy_loops(truth, np.random.default_rng(seed)), law=kind), truth) for seed in seeds]


def _deviations(fitted: Identification, truth: Law) -> dict[str, float]:
    """Return the distances of the identifiable parameters from the truth, in standard errors.

    Identifiable is what the data fix to better than `OPEN` of itself or of its scale, away from a bound.
    """
    expected = family_of(type(truth)).read(truth)
    return {
        name: (p.value - expected[name]) / p.standard_error
        for name, p in fitted.parameters.items()
        if not p.fixed and not p.at_bound and p.standard_error < OPEN * abs(p.value)
    }
