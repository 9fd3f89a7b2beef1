"""What a variant of a study costs: on one and two processors, against single runs, with more mounts and more variants.

    python benchmarks/study.py rate      # a study, independent processes, and a loop of `simulate`, which take turns
    python benchmarks/study.py mounts    # 4, 8, 16 and 32 mounts
    python benchmarks/study.py variants  # 100, 1000 and 10000 variants, with the memory of the study's own process
    python benchmarks/study.py dask      # this machine's own cluster of Dask against the local engine

The floor of `benchmarks/floor.py` under a half-sine along three axes, 0.5 s in steps of 1 ms, settled; every mount has an axial
stiffness of its own. Times of studies hold everything: checks, folder, parts, table.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from floor import ISOLATOR, floor_mjcf
from rounds import interleaved

import wirerope_mj as wr
from wirerope_mj.study.compute import compute
from wirerope_mj.study.run import chunks

DURATION, TIMESTEP = 0.5, 1e-3
PROCESSORS = 2


def floor_study(variants: int, mounts: int = 8, seed: int = 1) -> wr.Study:
    motions = [wr.HalfSine(peak=50.0, duration=0.011, direction=axis, start=0.01) for axis in "xyz"]
    return wr.Study(
        model=floor_mjcf(mounts), isolators={"bench": ISOLATOR}, motion=motions[0] + motions[1] + motions[2],
        duration=DURATION, timestep=TIMESTEP, variants=variants, seed=seed, sampling="random",
        vary={"mount/*/axial/alpha": wr.Normal(1.0, 0.1, relative=True, each=True, low=0.5, high=1.5)},
    )  # fmt: skip


def run(study: wr.Study, **how: object) -> None:
    """Run a study into a folder that is gone afterwards."""
    with tempfile.TemporaryDirectory() as folder:
        result = study.run(Path(folder) / "study", **how)  # type: ignore[arg-type]
        assert not result.failed


def loop(study: wr.Study) -> None:
    """Simulate every variant by a call of its own."""
    for variant in range(study.size):
        wr.simulate(study.system(variant), study.motion(variant), duration=DURATION, timestep=TIMESTEP)


def independent(number: int, variants: int) -> None:
    """Run as many processes at once, each with a study of its own on one thread, that know nothing of each other."""
    command = [sys.executable, __file__, "alone", "--number", str(variants)]
    processes = [subprocess.Popen(command) for _ in range(number)]
    assert not any(process.wait() for process in processes)


def rate(variants: int, rounds: int) -> None:
    """Print variants per second of contenders that take turns; all processes but this one start anew in every round."""
    few = max(variants // 8, 8)
    many = PROCESSORS * variants
    contenders: dict[str, tuple[int, Callable[[], None]]] = {
        "study, one worker": (variants, lambda: run(floor_study(variants), workers=1)),
        f"study, {PROCESSORS} workers": (many, lambda: run(floor_study(many), workers=PROCESSORS)),
        f"{PROCESSORS} independent studies at once": (many, lambda: independent(PROCESSORS, variants)),
        "loop of simulate": (few, lambda: loop(floor_study(few))),
    }  # fmt: skip
    medians = interleaved({name: work for name, (_, work) in contenders.items()}, rounds=rounds)
    rates = {name: contenders[name][0] / seconds for name, seconds in medians.items()}
    base = rates["study, one worker"]
    print(
        f"variants per second, start of processes included, {variants} variants per worker, medians of {rounds} rounds"
    )
    for name, value in rates.items():
        print(f"{name:34s} {value:8.1f}   {value / base:5.2f} of one worker")


def mounts(variants: int, rounds: int) -> None:
    """Print the processor time that a variant costs with more mounts, which others on the machine disturb little."""
    works = {n: floor_study(variants, n) for n in (4, 8, 16, 32)}
    spent: dict[int, list[float]] = {n: [] for n in works}
    for _ in range(rounds + 1):
        for n, study in works.items():
            parts, began = list(chunks(study, range(16))), time.process_time()
            for part in parts:
                compute(study.work, part)
            spent[n].append(1e3 * (time.process_time() - began) / study.size)
    cost = {n: float(np.median(values[1:])) for n, values in spent.items()}
    print(
        f"{variants} variants in 16 chunks, medians of {rounds} interleaved rounds\nmounts  processor time [ms] per variant"
    )
    for n, value in cost.items():
        print(f"{n:6d} {value:8.2f}")
    slope, constant = np.polyfit(list(cost), list(cost.values()), 1)
    print(f"straight line: {constant:.2f} ms + {slope:.3f} ms per mount")


def sizes(numbers: list[int]) -> None:
    """Print what a variant costs in a study of more of them, and the memory of a process that computes all by itself."""
    print("variants   processor time [s]    [ms] per variant   peak [MiB]   of it before the study")
    for number in numbers:
        done = subprocess.run(
            [sys.executable, __file__, "case", "--number", str(number)], check=True, stdout=subprocess.PIPE
        )
        r = json.loads(done.stdout.splitlines()[-1])
        print(
            f"{number:8d} {r['s']:6.1f} {1e3 * r['s'] / number:12.2f} {r['peak']:15.0f} {r['before']:15.0f}", flush=True
        )


def case(variants: int) -> None:
    run(floor_study(16), workers=1)  # compiles what is compiled
    before, began = peak_memory(), time.process_time()
    run(floor_study(variants), workers=1)
    print(json.dumps({"s": time.process_time() - began, "before": before, "peak": peak_memory()}))


def dask(variants: int, rounds: int) -> None:
    """Print what Dask's workers cost beside the local ones; both start anew in every round."""
    number = PROCESSORS * variants
    medians = interleaved(
        {engine: (lambda engine=engine: run(floor_study(number), engine=engine, workers=PROCESSORS))  # type: ignore[misc]
         for engine in ("local", "dask")}, rounds=rounds,
    )  # fmt: skip
    for engine, seconds in medians.items():
        print(
            f"{engine:6s} {seconds:7.1f} s for {number} variants on {PROCESSORS} workers, which start within that time"
        )


def peak_memory() -> float:
    """Return the peak of the resident memory of this process [MiB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", choices=("rate", "mounts", "variants", "dask", "alone", "case"))
    parser.add_argument("--number", type=int, nargs="*", help="variants")
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_args()
    number, rounds = arguments.number, arguments.rounds
    if arguments.part == "variants":
        sizes(number or [100, 1000, 10000])
    elif arguments.part in ("alone", "case"):
        run(floor_study(number[0]), workers=1) if arguments.part == "alone" else case(number[0])
    else:
        {"rate": rate, "mounts": mounts, "dask": dask}[arguments.part]((number or [256])[0], rounds)


if __name__ == "__main__":
    main()
