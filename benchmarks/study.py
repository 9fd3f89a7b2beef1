"""Cost of a variant of a study: on one and two processors, against single runs, with more mounts and more variants.

    python benchmarks/study.py rate      # a study, independent processes, threads, and a loop of `simulate` take turns
    python benchmarks/study.py mounts    # 4, 8, 16 and 32 mounts
    python benchmarks/study.py variants  # 100, 1000 and 10000 variants, with the memory of the study's own process
    python benchmarks/study.py dask      # this machine's own cluster of Dask against the local engine

The floor of `benchmarks/floor.py` under a half-sine along three axes, 0.5 s in steps of 1 ms, settled; every mount has an axial
stiffness of its own. Rates are those of warm processes, from part to part of the table as they land in the study's folder;
times of `variants` and `dask` hold everything: checks, folder, parts, table.
"""

import argparse
import json
import math
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
from wirerope_mj.studies.engines.compute import compute
from wirerope_mj.studies.engines.local import run_local
from wirerope_mj.studies.folder import prepare, write_part
from wirerope_mj.studies.inputs_file import PEAKS
from wirerope_mj.studies.measures import measures
from wirerope_mj.studies.study import CHUNK, chunk_size, chunks
from wirerope_mj.studies.vary.variants import Maker

DURATION, TIMESTEP = 0.5, 1e-3
PROCESSORS = 2
READY = "ready\n"


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


Rate = tuple[float, float]
"""Variants per second once all runs warm, and seconds until it does: processes started, code compiled."""


def steady(began: float, landed: list[tuple[float, int]], workers: int = 1) -> Rate:
    """Return the rate between parts that landed, as (instant, variants), while all workers ran warm.

    The first two parts of each are left out but for one, from which time is taken, and the last ones, when some have no more.
    """
    first = 2 * workers - 1
    warm = landed[first : len(landed) - workers + 1]
    rate = sum(count for _, count in warm) / (warm[-1][0] - landed[first - 1][0])
    return rate, max(landed[0][0] - began - workers * landed[0][1] / rate, 0.0)


def parts_of(study: wr.Study, workers: int) -> Rate:
    """Compute and write the parts of a study as `Study.run` does, from the check of its variants on."""
    with tempfile.TemporaryDirectory() as name:
        began, landed = time.perf_counter(), []
        numbers = range(math.ceil(study.size / chunk_size(study)))
        prepare(study, Path(name) / "study", keep=PEAKS, resume=False, force=False)
        for part in run_local(study.work, chunks(study, numbers), workers=workers):
            write_part(Path(name) / "study", part)
            landed.append((time.perf_counter(), part.table.num_rows))
    return steady(began, landed, workers)


def threaded(study: wr.Study, threads: int) -> Rate:
    """Compute the same chunks in this process, as batches on several threads."""
    work = study.work
    began, landed = time.perf_counter(), []
    for chunk in chunks(study, range(math.ceil(study.size / chunk_size(study)))):
        make = Maker(work.system, work.motions, work.columns)
        systems = [make.system(row) for row in chunk.rows]
        results = wr.simulate_batch(
            systems, [make.motion(row) for row in chunk.rows], duration=work.duration, timestep=work.timestep,
            initial=work.initial, sample_rate=work.sample_rate, corners=work.corners, threads=threads,
        )  # fmt: skip
        for system, result in zip(systems, results, strict=True):
            assert isinstance(result, wr.BatchResult)
            measures(system, result.peaks, result.initial_state)
        landed.append((time.perf_counter(), len(systems)))
    return steady(began, landed)


def loop(study: wr.Study) -> Rate:
    """Simulate every variant by a call of its own."""
    began, landed = time.perf_counter(), []
    for variant in range(study.size):
        wr.simulate(study.system(variant), study.motion(variant), duration=DURATION, timestep=TIMESTEP)
        landed.append((time.perf_counter(), 1))
    return steady(began, landed)


def independent(number: int, variants: int) -> Rate:
    """Run as many processes at once, each with a study of its own on one thread, that know nothing of each other."""
    command = [sys.executable, __file__, "alone", "--number", str(variants)]
    began = time.perf_counter()
    processes = [subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) for _ in range(number)]
    for process in processes:
        assert process.stdout is not None
        assert process.stdout.readline() == READY
    warm = time.perf_counter() - began
    for process in processes:  # all at the same moment
        assert process.stdin is not None
        process.stdin.write(READY)
        process.stdin.flush()
    rates = [json.loads(process.communicate()[0]) for process in processes]
    assert not any(process.returncode for process in processes)
    return sum(rates), warm


def alone(variants: int) -> None:
    """Warm up, wait until told to begin, and print the rate of a study."""
    run(floor_study(16), workers=1)
    study = floor_study(variants)
    print(READY, end="", flush=True)
    assert sys.stdin.readline() == READY
    print(json.dumps(parts_of(study, 1)[0]))


def rate(variants: int, rounds: int) -> None:
    """Print variants per second of contenders that take turns, warm; what their processes take to start stands apart.

    From 512 variants on the chunks of all contenders are equally large.
    """
    few, many = max(variants // 8, 8), PROCESSORS * variants
    together = f"{PROCESSORS} independent studies at once"
    contenders: dict[str, Callable[[], Rate]] = {
        "study, one worker": lambda: parts_of(floor_study(variants), 1),
        f"study, {PROCESSORS} workers": lambda: parts_of(floor_study(many), PROCESSORS),
        together: lambda: independent(PROCESSORS, variants),
        f"one process, batch of {PROCESSORS} threads": lambda: threaded(floor_study(variants), PROCESSORS),
        "loop of simulate": lambda: loop(floor_study(few)),
    }
    found: dict[str, list[Rate]] = {name: [] for name in contenders}
    for number in range(rounds + 1):
        for name, work in contenders.items():
            result = work()
            if number:  # the first round compiles
                found[name].append(result)
    medians = {name: np.median(values, axis=0) for name, values in found.items()}
    ratios = np.array([v for v, _ in found[f"study, {PROCESSORS} workers"]]) / [v for v, _ in found[together]]
    print(f"{variants} variants per worker, medians of {rounds} rounds in which all take turns, processes new in each")
    print(f"{'':34s} variants/s   of one worker   start [s]")
    for name, (value, start) in medians.items():
        print(f"{name:34s} {value:10.1f} {value / medians['study, one worker'][0]:15.2f} {start:11.1f}")
    print(f"study on {PROCESSORS} workers / {together}, round by round: {' '.join(f'{r:.2f}' for r in ratios)}")


def mounts(variants: int, rounds: int) -> None:
    """Print the processor time that a variant costs with more mounts, which others on the machine disturb little."""
    count = max(variants // CHUNK, 1)
    works = {n: floor_study(16 * count * CHUNK, n) for n in (4, 8, 16, 32)}  # so many that its chunks are full ones
    spent: dict[int, list[float]] = {n: [] for n in works}
    for _ in range(rounds + 1):
        for n, study in works.items():
            parts, began = list(chunks(study, range(count))), time.process_time()
            for part in parts:
                compute(study.work, part)
            spent[n].append(1e3 * (time.process_time() - began) / (count * CHUNK))
    cost = {n: float(np.median(values[1:])) for n, values in spent.items()}
    print(f"{count} chunks of {CHUNK} variants, medians of {rounds} rounds\nmounts  processor time [ms] per variant")
    for n, value in cost.items():
        print(f"{n:6d} {value:8.2f}")
    slope, constant = np.polyfit(list(cost), list(cost.values()), 1)
    print(f"straight line: {constant:.2f} ms + {slope:.3f} ms per mount")


def sizes(numbers: list[int]) -> None:
    """Print what a variant costs in a study of more of them, and the memory of a process that computes all by itself."""
    print("variants   processor time [s]    [ms] per variant   peak [MiB]   of it before the study")
    for number in numbers:
        done = subprocess.run([sys.executable, __file__, "case", "--number", str(number)], check=True, stdout=subprocess.PIPE)
        r = json.loads(done.stdout.splitlines()[-1])
        print(f"{number:8d} {r['s']:6.1f} {1e3 * r['s'] / number:12.2f} {r['peak']:15.0f} {r['before']:15.0f}", flush=True)


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
        print(f"{engine:6s} {seconds:7.1f} s for {number} variants on {PROCESSORS} workers, which start within that time")


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
        alone(number[0]) if arguments.part == "alone" else case(number[0])
    else:
        work, usual = {"rate": (rate, 512), "mounts": (mounts, 256), "dask": (dask, 256)}[arguments.part]
        work((number or [usual])[0], rounds)


if __name__ == "__main__":
    main()
