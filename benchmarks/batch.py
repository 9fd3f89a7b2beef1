"""Cost of a variant: floors on mounts that scatter, shocked side by side, against a loop of `wr.simulate`.

    python benchmarks/batch.py            # variants per second, and where the time of a variant goes
    python benchmarks/batch.py growth     # cost and memory of a variant as mounts and variants grow

Every contender makes its variants anew, finds where each rests, and steps it through the same shock; all take equal steps.
"""

import argparse
import multiprocessing
import resource
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from floor import ISOLATOR, floor_mjcf
from rounds import interleaved

import wirerope_mj as wr
from wirerope_mj.engine.simulation.stability import stable_step

SHOCK = wr.HalfSine(peak=100.0, duration=0.011, direction=(0.3, 0.2, 1.0), start=0.01)
STEPS = {"duration": 1.0, "timestep": 1e-3}
SCATTER = 0.1  # of every mount's stiffness and hysteresis
MOUNTS, VARIANTS = (4, 8, 16, 32), (10, 100, 1000)


@cache
def base(n_mounts: int) -> wr.System:
    text = floor_mjcf(n_mounts).replace('gravity="0 0 0"', f'gravity="0 0 {-wr.STANDARD_GRAVITY}"')
    return wr.load_system(text, isolators={"bench": ISOLATOR})


def variants(n_mounts: int, count: int, seed: int = 0) -> list[wr.System]:
    """Return floors whose mounts scatter, each mount for itself."""
    rng, system = np.random.default_rng(seed), base(n_mounts)
    return [wr.varied(system, isolators={mount: scattered(rng) for mount in system.mounts}) for _ in range(count)]


def scattered(rng: np.random.Generator) -> wr.Isolator:
    factor = 1.0 + SCATTER * rng.standard_normal()
    law = ISOLATOR.axial
    assert isinstance(law, wr.BoucWen)
    law = replace(law, alpha=factor * law.alpha, k=factor * law.k)
    return replace(ISOLATOR, roll=law, shear=law, axial=law)


def batch(n_mounts: int, count: int, *, threads: int, sample_rate: float = 1000.0, seed: int = 0) -> int:
    systems = variants(n_mounts, count, seed)
    results = wr.simulate_batch(systems, SHOCK, threads=threads, sample_rate=sample_rate, **STEPS)
    return sum(isinstance(result, wr.BatchResult) for result in results)


def loop(n_mounts: int, count: int) -> None:
    for system in variants(n_mounts, count):
        wr.simulate(system, SHOCK, **STEPS)


def rates(n_mounts: int, count: int, rounds: int) -> None:
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(2, mp_context=context) as pool:

        def two_processes() -> None:
            halves = [pool.submit(batch, n_mounts, count // 2, threads=1, seed=seed) for seed in (0, 1)]
            assert sum(half.result() for half in halves) == 2 * (count // 2)

        contenders: dict[str, Callable[[], object]] = {
            "loop of wr.simulate": lambda: loop(n_mounts, count),
            "batch, 1 thread": lambda: batch(n_mounts, count, threads=1),
            "batch, 2 threads": lambda: batch(n_mounts, count, threads=2),
            "2 processes, a batch of half each": two_processes,
            "batch, 2 threads, sample_rate=100": lambda: batch(n_mounts, count, threads=2, sample_rate=100.0),
        }
        two_processes()
        medians = interleaved(contenders, rounds=rounds)
    slowest = medians["loop of wr.simulate"]
    print(f"{count} floors on {n_mounts} mounts, {STEPS['duration']:g} s in steps of {STEPS['timestep']:g} s; {rounds} rounds")
    print(f"{'':34} {'variants/s':>10} {'ms each':>8} {'relative':>9}")
    for name, seconds in medians.items():
        print(f"{name:34} {count / seconds:10.1f} {1e3 * seconds / count:8.1f} {slowest / seconds:9.2f}")


def shares(n_mounts: int, count: int, rounds: int) -> None:
    """Print where the time of a variant goes on one thread."""
    spent: dict[str, list[float]] = {}

    def timed(name: str, work: Callable[[], Any]) -> Any:
        begin = time.perf_counter()
        result = work()
        spent.setdefault(name, []).append(1e3 * (time.perf_counter() - begin) / count)
        return result

    for _ in range(rounds):
        systems = timed("making the variant", lambda: variants(n_mounts, count))
        starts = timed("finding where it rests", lambda s=systems: [wr.equilibrium(system).state for system in s])
        timed("largest stable step", lambda s=systems: [stable_step(system) for system in s])
        timed("steps and peaks", lambda s=systems, at=starts: wr.simulate_batch(s, SHOCK, initial=at, threads=1, **STEPS))
    print(f"\nwhere the time of a variant goes, one thread, {n_mounts} mounts")
    for name, values in spent.items():
        print(f"{name:34} {np.median(values):8.2f} ms")


def resident(n_mounts: int, count: int) -> tuple[float, float]:
    """Return seconds and peak memory [MB] of a batch in a process of its own."""
    batch(n_mounts, 2, threads=2)
    begin = time.perf_counter()
    batch(n_mounts, count, threads=2)
    return time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def growth(rounds: int) -> None:
    """Print what a variant costs as mounts and variants grow; every figure from a fresh process."""
    cases = [(n, 64) for n in MOUNTS] + [(8, count) for count in VARIANTS]
    context = multiprocessing.get_context("spawn")
    found: dict[tuple[int, int], list[tuple[float, float]]] = {case: [] for case in cases}
    for _ in range(rounds):
        for case in cases:
            with ProcessPoolExecutor(1, mp_context=context) as pool:
                found[case].append(pool.submit(resident, *case).result())
    print(f"\nbatch on 2 threads, medians of {rounds} interleaved rounds\nmounts variants  ms each  process [MB]")
    for (n_mounts, count), values in found.items():
        seconds, memory = np.median(values, axis=0)
        print(f"{n_mounts:6d} {count:8d} {1e3 * seconds / count:8.2f} {memory:13.0f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("question", nargs="?", choices=("rates", "growth"), default="rates")
    parser.add_argument("--mounts", type=int, default=8, help="mounts of the floor (default 8)")
    parser.add_argument("--variants", type=int, default=64, help="variants of a batch (default 64)")
    parser.add_argument("--rounds", type=int, default=5, help="rounds whose median is taken (default 5)")
    arguments = parser.parse_args()
    if arguments.question == "growth":
        growth(arguments.rounds)
        return
    rates(arguments.mounts, arguments.variants, arguments.rounds)
    shares(arguments.mounts, arguments.variants, arguments.rounds)


if __name__ == "__main__":
    main()
