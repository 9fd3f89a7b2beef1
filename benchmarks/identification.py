"""Identification: synthetic specimens, choice of law, the thesis' methods, and what a fit costs beside `solve_ivp`.

    python benchmarks/identification.py synthetic [--truths 20] [--starts 20] [--laws bouc-wen ...] [--processes 2]
    python benchmarks/identification.py errors [--truths 20] [--draws 20] [--laws bouc-wen ...] [--processes 2]
    python benchmarks/identification.py choice | methods | cost

synthetic: loops of random known laws, five amplitudes, 1 % force noise, unknown offset; starts with every parameter log-uniform
within a factor of ten of the truth. Success: loops at three amplitudes not used are within the noise of the truth.
errors: as synthetic, from the grid alone, but many draws of the noise for each truth: how often the parameters that count as
identifiable are within three standard errors, which is 99.73 % for normal errors.
choice: several laws on the device of `odd_device.py`, which is none of them. methods: three stages, one stage in the time
domain, one in the frequency domain, from near and poor starts without the grid. cost: one residual of the nine-parameter law on
six loops of 1000 points against the same one made with SciPy's `solve_ivp`; both need as many of them.
"""

import argparse
import math
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from itertools import repeat
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from odd_device import OddDevice
from rounds import interleaved
from scipy.integrate import solve_ivp
from synthetic import (
    LAWS,
    NOISE,
    SyntheticSpecimen,
    deviations_of_draws,
    noisy_loops,
    start_of,
    synthetic_specimen,
    truth_of,
)

import wirerope_mj as wr
from wirerope_mj.mounts.identification import compare_laws, compare_methods
from wirerope_mj.mounts.identification.families import family_of
from wirerope_mj.mounts.identification.identify import identify
from wirerope_mj.mounts.identification.measured import STEADY, MeasuredLoop, prepare
from wirerope_mj.mounts.identification.search import loop_residual
from wirerope_mj.mounts.laws import Law
from wirerope_mj.mounts.test_rig import cyclic_test, measured

Array = npt.NDArray[np.float64]

SHARES = np.array([0.02, 0.03, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0])  # of the travel, tested on the odd device
CALLED = {kind.name: kind for kind in LAWS}


def synthetic(arguments: argparse.Namespace) -> None:
    """Print success rates, as truths end."""
    print(f"{arguments.truths} truths x {arguments.starts} starts")
    print(
        "law                      identify  start alone  within 3 errors  largest  evaluations per start     [s]",
        flush=True,
    )
    with ProcessPoolExecutor(arguments.processes) as pool:
        for name in arguments.laws:
            begin = time.perf_counter()
            truths, starts = range(arguments.truths), repeat(arguments.starts)
            rows = list(pool.map(synthetic_specimen, repeat(CALLED[name]), truths, starts, timeout=None))
            print(specimen_row(name, rows) + f"{time.perf_counter() - begin:8.0f}", flush=True)
            for row in rows:
                if not all(row.together):
                    print(f"    truth {row.truth}: {row.together.count(False)} of {len(row.together)} missed", flush=True)


def specimen_row(name: str, rows: list[SyntheticSpecimen]) -> str:
    """Return the table's row of a law."""
    together = [good for row in rows for good in row.together]
    alone = [good for row in rows for good in row.alone]
    known = sum(len(row.deviations) for row in rows)
    within = sum(row.within for row in rows)
    farthest = max((abs(value) for row in rows for value in row.deviations.values()), default=0.0)
    evaluations = sum(row.evaluations for row in rows) / max(len(together), 1)
    return (
        f"{name:22s}{100 * np.mean(together):9.1f} %{100 * np.mean(alone):11.1f} %{within:9d} / {known:<5d}"
        f"{farthest:8.1f}{evaluations:15.0f}       "
    )


def errors(arguments: argparse.Namespace) -> None:
    """Print how often identifiable parameters are within three standard errors, for each law and each parameter."""
    with ProcessPoolExecutor(arguments.processes) as pool:
        for name in arguments.laws:
            begin = time.perf_counter()
            kind, truths = CALLED[name], range(arguments.truths)
            draws = pool.map(deviations_of_draws, repeat(kind), truths, repeat(arguments.draws))
            rows = [(number, found) for number, truth in enumerate(draws) for found in truth]
            deviations = [abs(value) for _, found in rows for value in found.values()]
            print(
                f"{name}: {sum(d < 3.0 for d in deviations)} of {len(deviations)} within 3 errors, "
                f"{100 * np.mean([d < 3.0 for d in deviations]):.2f} %, largest {max(deviations):.1f}; "
                f"{sum(any(abs(v) >= 3.0 for v in found.values()) for _, found in rows)} of {len(rows)} fits with a miss, "
                f"{time.perf_counter() - begin:.0f} s",
                flush=True,
            )
            for parameter in dict.fromkeys(key for _, found in rows for key in found):
                values = [(number, found[parameter]) for number, found in rows if parameter in found]
                missed = ", ".join(f"truth {number}: {value:.1f}" for number, value in values if abs(value) >= 3.0)
                spread = np.std([value for _, value in values])
                print(
                    f"    {parameter:8s}{len(values):6d} fits, spread {spread:.2f} errors; missed {missed or 'none'}",
                    flush=True,
                )


def choice(_arguments: argparse.Namespace) -> None:
    """Print the comparison of laws on the odd device under both weights."""
    device = OddDevice()
    loops = [device.measured(share * device.travel, noise=NOISE, seed=place) for place, share in enumerate(SHARES)]
    exact = [device.loop(share * device.travel) for share in SHARES]
    print("secant stiffness [kN/m]", *(f"{1e-3 * loop.secant_stiffness:.0f}" for loop in exact))
    print("damping ratio [%]      ", *(f"{100 * loop.damping_ratio:.1f}" for loop in exact))
    for weights in ("equal", "range"):
        begin = time.perf_counter()
        table = compare_laws(loops, laws=[wr.BoucWen, wr.SymmetricBoucWen, wr.Masing], weights=weights)
        print(f"\nweights {weights!r} ({time.perf_counter() - begin:.0f} s)\n{table}", flush=True)


def methods(arguments: argparse.Namespace) -> None:
    """Print what the three methods do from a near start and from poor ones."""
    for name in arguments.laws:
        rng = np.random.default_rng(arguments.seed)
        truth = truth_of(CALLED[name], rng)
        family, loops = family_of(type(truth)), noisy_loops(truth, rng)
        near = family.make({key: 1.2 * value for key, value in family.read(truth).items()})
        starts = {"20 % off": near} | {f"poor {one}": start_of(truth, rng) for one in (1, 2, 3)}
        print(f"\n{name}\n{compare_methods(loops, starts=starts)}", flush=True)


class Cost(NamedTuple):
    """One way to a residual by `solve_ivp`, its error, and medians of seconds of it and of the house's."""

    method: str
    tolerance: float
    cycle: bool
    error: float
    seconds: float
    house: float

    @property
    def ratio(self) -> float:
        """Seconds of `solve_ivp` over the house's."""
        return self.seconds / self.house


def costs(cases: list[tuple[str, float, bool]], *, rounds: int) -> Iterator[Cost]:
    """Yield what residuals cost by `solve_ivp`: method, tolerance, and whether it finds the steady state from rest."""
    truth, loops = nine_parameters()
    ready = prepare(loops)
    house = loop_residual(ready)
    reference = house(truth)
    for case in cases:

        def theirs(how: tuple[str, float, bool] = case) -> Array:
            return solved(ready, truth, *how)

        off = float(np.abs(theirs() - reference).max())
        medians = interleaved({"house": lambda: house(truth), "solve_ivp": theirs}, rounds=rounds)
        yield Cost(*case, error=off, seconds=medians["solve_ivp"], house=medians["house"])


def nine_parameters() -> tuple[wr.AsymmetricBoucWen, list[wr.Loop]]:
    """Return a law of Ni and six noisy loops of 1000 points of it."""
    truth = wr.AsymmetricBoucWen.from_normalised(
        z_max=700.0, x_y=1e-3, sigma=0.6, n=1.3, k1=5e4, k2=1e6, k3=2e8, b=math.e, c=35.0
    )
    tested = cyclic_test(truth, 0.01 * np.array([0.05, 0.1, 0.2, 0.4, 0.7, 1.0]), points_per_cycle=1000)
    return truth, [
        measured([loop], points_per_cycle=1000, force_noise=NOISE * np.ptp(loop.force) / 2.0, seed=place)[0]
        for place, loop in enumerate(tested)
    ]


def cost(arguments: argparse.Namespace) -> None:
    """Print seconds per residual of the house and of `solve_ivp`."""
    print("solve_ivp                 method  tolerance  error of residual  s per residual    ratio")
    cases = [(m, t, cycle) for cycle in (True, False) for m in ("RK45", "LSODA") for t in (1e-6, 1e-8)]
    for one in costs(cases, rounds=arguments.rounds):
        words = "from rest until steady" if one.cycle else "steady state for nothing"
        print(
            f"{words:26s}{one.method:6s}{one.tolerance:11.0e}{one.error:19.1e}{one.seconds:16.3f}{one.ratio:9.0f}",
            flush=True,
        )
    begin = time.perf_counter()
    fit = identify(nine_parameters()[1], law=wr.AsymmetricBoucWen)
    seconds = time.perf_counter() - begin
    print(f"house: {1e3 * one.house:.2f} ms per residual; the whole fit, grid included, {seconds:.2f} s,")
    print(f"{fit.evaluations} residuals after the grid, error {100 * fit.residual:.2f} % at 1 % noise")


def solved(loops: list[MeasuredLoop], law: wr.AsymmetricBoucWen, method: str, tolerance: float, cycle: bool) -> Array:
    """Return the residual of the loops with z from `solve_ivp`, started anew at every reversal."""
    parts = []
    for loop in loops:
        x = loop.deflection
        turns = [0, *sorted((int(np.argmax(x)), int(np.argmin(x)))), x.size - 1]
        z = 0.0 if cycle else steady(loop, law)
        for _ in range(200):
            before, samples = z, np.empty(x.size)
            samples[0] = z
            for first, last in zip(turns, turns[1:], strict=False):
                if last > first:
                    samples[first : last + 1] = branch(law, x[first : last + 1], z, method, tolerance)
                    z = samples[last]
            if not cycle or abs(z - before) <= max(tolerance, STEADY) * float(np.ptp(loop.force)):
                break
        elastic = law.k1 * x + law.k2 * np.sign(x) * x**2 + law.k3 * x**3
        part = (np.exp(law.asymmetry * x) * (samples + elastic) - loop.force) / loop.weight
        parts.append(part - part.mean())
    return np.concatenate(parts)


def branch(law: wr.AsymmetricBoucWen, x: Array, z: float, method: str, tolerance: float) -> Array:
    """Return z at the samples of a monotone path."""
    s, alpha, beta, gamma, n = math.copysign(1.0, x[-1] - x[0]), law.alpha, law.beta, law.gamma, law.n

    def slope(_: float, y: Array) -> list[float]:
        one = y.item()
        return [s * (alpha - (gamma + beta * math.copysign(1.0, s * one)) * abs(one) ** n)]

    samples, places = np.unique(s * x, return_inverse=True)
    run = solve_ivp(
        slope, (samples[0], samples[-1]), [z], method=method, t_eval=samples, rtol=tolerance, atol=tolerance * law.z_max
    )
    return run.y[0][places]


def steady(loop: MeasuredLoop, law: Law) -> float:
    """Return z at the loop's first sample in the steady state."""
    x, p = loop.deflection[0], law.kernel_parameters()
    force = loop.model_force(law)[0]
    return float(force / math.exp(p[7] * x) - (p[4] * x + p[5] * math.copysign(x * x, x) + p[6] * x**3))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", choices=("synthetic", "errors", "choice", "methods", "cost"))
    parser.add_argument("--truths", type=int, default=20)
    parser.add_argument("--starts", type=int, default=20)
    parser.add_argument("--draws", type=int, default=20, help="of the noise, for `errors`")
    parser.add_argument("--laws", nargs="*", default=[kind.name for kind in LAWS], choices=list(CALLED))
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seed", type=int, default=0, help="of the truth of `methods`")
    arguments = parser.parse_args()
    {"synthetic": synthetic, "errors": errors, "choice": choice, "methods": methods, "cost": cost}[arguments.part](arguments)


if __name__ == "__main__":
    main()
