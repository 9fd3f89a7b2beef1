"""Memory that a long three-axis record needs: read, simulated into a folder, and as a whole run with its view.

    python benchmarks/long_record.py                      # 1 minute and 10 minutes at 10 kHz
    python benchmarks/long_record.py --minutes 1 --whole  # the whole run, recording and pictures included

Every case runs in a process of its own, so that the peak of its resident memory is its own.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

import numpy as np

import wirerope_mj as wr
from wirerope_mj.foundation.resources import models_folder

RATE = 10_000.0  # [Hz]
BLOCK = 100_000  # rows that are made and written at once


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, nargs="*", default=[1.0, 10.0])
    parser.add_argument("--sample-rate", type=float, default=1000.0, help="of the response [Hz]")
    parser.add_argument("--whole", action="store_true", help="write the whole run instead of the response alone")
    parser.add_argument("--case", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.case:
        print(json.dumps(measure(**json.loads(arguments.case))))
        return
    print(f"{'minutes':>8} {'samples':>9} {'read [s]':>9} {'run [s]':>8} {'steps/s':>9} "
          f"{'imports':>8} {'read':>7} {'run':>7}   peak resident memory [MiB]")  # fmt: skip
    for minutes in arguments.minutes:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "long.csv"
            write_record(path, 60.0 * minutes)
            case = {"path": str(path), "sample_rate": arguments.sample_rate, "whole": arguments.whole}
            done = subprocess.run([sys.executable, __file__, "--case", json.dumps(case)], check=True, stdout=subprocess.PIPE)
            r = json.loads(done.stdout.splitlines()[-1])
        print(f"{minutes:8.3g} {r['samples']:9d} {r['read_s']:9.1f} {r['run_s']:8.1f} {r['steps'] / r['run_s']:9.0f} "
              f"{r['imports']:8.0f} {r['read']:7.0f} {r['run']:7.0f}", flush=True)  # fmt: skip


def write_record(path: Path, seconds: float) -> None:
    """Write a ride on three axes, 5 m/s^2 rms each: noise between 2 and 400 Hz, made block by block."""
    from scipy.signal import butter, sosfilt

    rng, sos = np.random.default_rng(6), butter(2, [2.0, 400.0], "bandpass", fs=RATE, output="sos")
    state, rows = np.zeros((sos.shape[0], 2, 3)), round(seconds * RATE)
    gain = 5.0 / np.sqrt(2.0 * 400.0 / RATE)  # white noise of unit variance has this share of it below 400 Hz
    with path.open("w", encoding="utf-8") as file:
        file.write("time [s],x [m/s^2],y [m/s^2],z [m/s^2]\n")
        for first in range(0, rows, BLOCK):
            count = min(BLOCK, rows - first)
            values, state = sosfilt(sos, rng.standard_normal((count, 3)), axis=0, zi=state)
            place = first + np.arange(count)
            fade = np.clip(np.minimum(place, rows - 1 - place) / RATE, 0.0, 1.0)  # over the first and last second
            table = np.column_stack([place / RATE, gain * values * fade[:, None]])
            np.savetxt(file, table, fmt="%.4f,%.6g,%.6g,%.6g")


def measure(*, path: str, sample_rate: float, whole: bool) -> dict[str, float]:
    """Return times [s] and peaks of resident memory [MiB] of one case."""
    system = wr.load_system(models_folder() / "shock_table.xml")
    wr.simulate(system, wr.HalfSine(peak=1.0, duration=0.01, direction="z"), duration=0.05)  # compiles what is compiled
    imports, began = peak_memory(), perf_counter()
    record = wr.load_record(path, baseline="velocity")
    read, read_s = peak_memory(), perf_counter() - began
    began = perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        if whole:
            scenario = wr.Scenario(
                question="How much memory does a long record need?", model="shock_table.xml", motion=record,
                simulate={"duration": record.duration, "sample_rate": sample_rate}, name="long_record",
            )  # fmt: skip
            response = wr.run_scenario(scenario, Path(folder) / "run")
        else:
            response = wr.simulate(system, record, duration=record.duration, sample_rate=sample_rate, out=folder)
        steps = response.numerics.steps
    return {
        "samples": record.time.size, "imports": imports, "read": read, "read_s": read_s, "run": peak_memory(),
        "run_s": perf_counter() - began, "steps": steps,
    }  # fmt: skip


def peak_memory() -> float:
    """Return the peak of the resident memory of this process [MiB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


if __name__ == "__main__":
    main()
