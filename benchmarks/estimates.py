"""What commands say beforehand that they take, beside what they then took: time, memory and disk.

    python -m benchmarks.estimates              # all requests
    python -m benchmarks.estimates study select # those whose first word is one of these

Each request is a command in a process of its own, whose estimates are printed however short it is; one that ends before an
estimate is there took no more than a second or two of work. The factor is the larger of estimate over taken and taken over
estimate, both from the start of what is estimated to its end, of a run to that of the command; `passed` is the fraction of it
that was over when the estimate was there, and `whole` the time of the command, with its imports. Memory is that of the command
and its processes where it is largest, and disk the folder that is written. On a machine that does other things the speed
changes in between: its load is printed beside.
"""

import argparse
import os
import re
import shlex
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from threading import Thread

import numpy as np
import psutil

import wirerope_mj as wr

# A command that says when what is estimated begins and ends, and says its estimate however short it is.
COMMAND = """
import sys
from contextlib import contextmanager
from wirerope_mj.engine.simulation import progress

def print_line(line):
    print(line, file=sys.stderr, flush=True)

class Estimate(progress.Estimate):
    def __init__(self, word, **how):
        super().__init__(word, **how)
        print_line(f"{word}: begins")

bar = progress.share_bar

@contextmanager
def share_bar(*words, **how):
    with bar(*words, **how) as update:
        yield update
    print_line(f"{words[0]}: ends")

progress.Estimate, progress.SAID = Estimate, 0.0
for module in list(sys.modules.values()):
    if getattr(module, "share_bar", None) is bar:
        module.share_bar = share_bar
from wirerope_mj.cli import main
sys.exit(main())
"""
SAID = re.compile(r"(.+): about ([\d.e+]+) (s|min|h), ([\d.]+ \w+) of memory(?:, ([\d.]+ \w+) of disk)?$")
SIZES = {"B": 1.0, "kB": 1e3, "MB": 1e6, "GB": 1e9}
TIMES = {"s": 1.0, "min": 60.0, "h": 3600.0}
JOB = """
name = "Cabinet"
model = "cabinet"
[[case]]
name = "Vertical"
half-sine = "15 g 11 ms z"
[[case]]
name = "Athwart"
half-sine = "10 g 11 ms y"
[[case]]
name = "Lengthwise"
half-sine = "10 g 11 ms x"
[[case]]
name = "Sine"
sine = "0.5 g 12 Hz z 10 s"
"""
SELECT = "select --mass 420 --size 800 800 1800 --fragility 15 --travel 60 --shock"
MEASURED = "--test test.csv --map 'A0=base z g' 'A1=body/block z g'"
CALIBRATE = f"calibrate shock_table {MEASURED} --vary 'mount/*/stiffness = Uniform(0.7, 1.4)'"
REQUESTS = (
    "run cabinet_random --duration 20 --out out", "run cabinet_random --duration 60 --out out",
    "run floating_floor_sweep --out out", "run sdof_sweep --out out",
    "run shock_table --duration 200 --out out", "run floating_floor_shock --duration 8 --accuracy 1e-5 --out out",
    "shock shock_table_contacts --half-sine '30 g 11 ms z' --out out",
    "shock floating_floor --half-sine '5 g 11 ms z' --duration 15 --timestep 2e-5 --out out",
    "shock cabinet --sine '0.5 g 10 Hz z 60 s' --duration 60 --out out",
    "study floor_levels --levels 300 --workers 1 --out out", "study floor_levels --levels 600 --workers 2 --out out",
    "study floor_tolerances --variants 400 --workers 1 --out out",
    "study floor_tolerances --variants 800 --workers 2 --out out",
    "study floor_directions --workers 2 --out out", "study floor_failed_mount --workers 2 --out out",
    "study floor_specimens --workers 2 --out out",
    "study cabinet_shock --vary 'mount/*/stiffness = Uniform(0.8, 1.2)' --variants 800 --workers 1 --out out",
    "study cabinet_shock --vary 'motion/level = Uniform(0.8, 1.2)' --variants 64 --keep responses --workers 2 --out out",
    f"{SELECT} 'half-sine 15 g 11 ms y' --mounts 4+2", f"{SELECT} 'half-sine 15 g 11 ms z' --mounts 4 --mounts 4+2",
    f"{SELECT} 'half-sine 15 g 11 ms z' --shock 'half-sine 10 g 11 ms x' --mounts 4+2",
    "select cabinet --shock 'half-sine 15 g 11 ms z'",
    "laws loops.csv --law bouc-wen masing", "laws loops.csv",
    f"{CALIBRATE} --out out", f"{CALIBRATE} --vary 'mount/*/damping = Uniform(0.5, 1.5)' --out out",
    "frf sdof_shaker --acceleration 1 --out out",
    "frf sdof_shaker --acceleration 1 --method sweep --start 4 --stop 16 --out out",
    "cases job.toml --workers 1 --out out", "cases job.toml --workers 2 --out out",
)  # fmt: skip


def prepare(folder: Path) -> None:
    """Write what the requests read: a job, loops of a rig, and a measured pulse."""
    (folder / "job.toml").write_text(JOB, encoding="utf-8")
    law = wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.0, k=5e4)
    time_of = np.arange(0.0, 24.0, 0.005)
    path = np.array([1e-3, 2e-3, 4e-3, 8e-3])[(time_of / 6.0).astype(int)] * np.sin(2.0 * np.pi * time_of)
    force = law.trace(path).force + np.random.default_rng(1).normal(0.0, 4.0, path.size)
    rows = np.column_stack([time_of, 1e3 * path, 1e-3 * force])
    np.savetxt(folder / "loops.csv", rows, delimiter=",", header="time [s],deflection [mm],force [kN]", comments="")
    system = wr.load_system("shock_table")
    motion = wr.HalfSine(peak=50.0, duration=0.011, direction="z", start=0.02)
    response = wr.simulate(system, motion, duration=0.5, sample_rate=2000.0)
    measured = [response.time, response.base.acceleration[:, 2], response.bodies["block"].acceleration[:, 2]]
    noise = np.random.default_rng(2).normal(0.0, 0.02, (response.time.size, 2))
    rows = np.column_stack([measured[0], np.column_stack(measured[1:]) / 9.80665 + noise])
    np.savetxt(folder / "test.csv", rows, delimiter=",", header="time [s],A0 [g],A1 [g]", comments="")


@dataclass
class Taken:
    """A command that ended: lines of standard error with their instants [s], its end [s], and most memory [B]."""

    lines: list[tuple[float, str]]
    seconds: float
    memory: float
    disk: float
    code: int


def taken(request: str, folder: Path) -> Taken:
    """Run a request in a folder."""
    began, lines, most = time.perf_counter(), list[tuple[float, str]](), 0.0
    process = subprocess.Popen(
        [sys.executable, "-c", COMMAND, *shlex.split(request)], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        text=True,
    )  # fmt: skip
    assert process.stderr is not None
    stderr = process.stderr
    reader = Thread(target=lambda: lines.extend((time.perf_counter() - began, line.rstrip()) for line in stderr))
    reader.start()
    watched = psutil.Process(process.pid)
    while process.poll() is None:
        now = 0.0
        try:
            for each in (watched, *watched.children(recursive=True)):
                memory = each.memory_full_info()
                now += getattr(memory, "pss", memory.rss)  # on Linux, what processes share once
        except psutil.NoSuchProcess:
            pass
        most = max(most, now)
        time.sleep(0.2)
    seconds = time.perf_counter() - began
    reader.join()
    disk = sum(path.stat().st_size for path in (folder / "out").rglob("*") if path.is_file())
    return Taken(lines, seconds, most, float(disk), process.returncode)


def factor(estimate: float, value: float) -> float:
    return max(estimate / value, value / estimate) if estimate > 0.0 and value > 0.0 else float("nan")


def size(text: str | None) -> float:
    return float(text.split()[0]) * SIZES[text.split()[1]] if text else 0.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commands", nargs="*")
    asked = parser.parse_args()
    requests = [request for request in REQUESTS if not asked.commands or request.split()[0] in asked.commands]
    factors: dict[str, list[float]] = {"time": [], "memory": [], "disk": []}
    without = []
    print(" estimate    taken factor passed    whole     memory [MB]       disk [MB]   load  request")
    for request in requests:
        with tempfile.TemporaryDirectory() as name:
            prepare(Path(name))
            done = taken(request, Path(name))
        load, found = os.getloadavg()[0], False
        if done.code not in (0, 1):
            print(f"exit code {done.code}: {request}: {done.lines[-3:]}", flush=True)
            continue
        starts = [(at, line.removesuffix(": begins")) for at, line in done.lines if line.endswith(": begins")]
        for at, match in [(at, match) for at, line in done.lines if (match := SAID.match(line))]:
            found, word = True, match[1]
            began = max(start for start, name in starts if name == word and start <= at)
            end = next((after for after, line in done.lines if after >= at and line == f"{word}: ends"), done.seconds)
            seconds = float(match[2]) * TIMES[match[3]]
            factors["time"].append(factor(seconds, end - began))
            last = end == done.seconds or (began, word) == starts[-1]  # its memory and disk are those of the command
            sizes = [(size(match[4]), done.memory), (size(match[5]), done.disk)] if last else []
            texts = []
            for kind, pair in zip(("memory", "disk"), sizes, strict=False):
                if min(pair) > 0.0:
                    factors[kind].append(factor(*pair))
                texts.append(f"{pair[0] / 1e6:7.3g}/{pair[1] / 1e6:<7.3g}")
            print(
                f"{seconds:8.1f}s {end - began:7.1f}s {factors['time'][-1]:6.2f} {(at - began) / (end - began):6.0%} "
                f"{done.seconds:7.1f}s  "
                f"{texts[0] if texts else '':>15}  {texts[1] if texts else '':>15}  {load:5.1f}  {word} | {request}",
                flush=True,
            )
        if not found:
            without.append(done.seconds)
            print(f"{'-':>9} {done.seconds:7.1f}s {'':6} {'':6} {'':8}  {'':15}  {'':15}  {load:5.1f}  {request}", flush=True)
    for kind, values in factors.items():
        known = np.array([value for value in values if value == value])
        if known.size:
            print(f"{kind}: {np.mean(known <= 2.0):.0%} of {known.size} within a factor of two, median {np.median(known):.2f}")
    print(
        f"without an estimate: {len(without)} of {len(requests)} requests, the longest {max(without, default=0.0):.1f} s in all"
    )


if __name__ == "__main__":
    main()
