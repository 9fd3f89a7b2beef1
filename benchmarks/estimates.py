"""What commands say beforehand that they take, beside what they then took: time, memory and disk.

    python -m benchmarks.estimates              # all requests
    python -m benchmarks.estimates study select # those whose first word is one of these
    python -m benchmarks.estimates --held-out   # those from which nothing was taken that estimates are made of

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
_STIFFNESS = "--vary 'mount/*/stiffness = Uniform(0.7, 1.3)'"
# Written down before any of them was run.
HELD_OUT = (
    "run floating_floor_double_pulse --duration 12 --out out",
    "run floating_floor_double_pulse --shape triangle --level-g 60 --accuracy 2e-5 --out out",
    "run shock_table_frame --duration 60 --out out", "run cabinet_shock --duration 100 --out out",
    "run floating_floor_sweep --start-hz 4 --stop-hz 12 --rate 1 --out out",
    "shock genset/genset.xml --sweep '0.3 g 4 to 40 Hz 4 oct/min z' --out out",
    "shock stages/stages.xml --half-sine '20 g 11 ms z' --duration 30 --out out",
    "shock machine/machine.xml --sawtooth '12 g 15 ms x' --duration 60 --sample-rate 4000 --out out",
    "shock sdof_shaker --sine '1 g 8 Hz z 120 s' --duration 120 --sample-rate 2000 --out out",
    "shock cabinet --psd 'transport.csv 45 s z seed 2' --accuracy 1e-4 --out out",
    "shock shock_table_contacts --sawtooth '25 g 11 ms x' --duration 20 --timestep 1e-4 --out out",
    "shock floating_floor --deck '12 Hz 20000 kg 4 %' --half-sine '6 g 8 ms z' --duration 6 --out out",
    "study floor_placement --generations 4 --workers 2 --out out", "study floor_sensitivity --rows 32 --workers 2 --out out",
    f"study shock_table {_STIFFNESS} --variants 20000 --workers 1 --out out",
    f"study shock_table_frame {_STIFFNESS} --variants 1500 --workers 2 --out out",
    f"study cabinet_random {_STIFFNESS} --variants 48 --workers 2 --out out",
    f"study cabinet_shock {_STIFFNESS} --variants 300 --accuracy 1e-5 --workers 2 --out out",
    "study floating_floor_double_pulse --vary 'motion/level = Uniform(0.5, 1)' --variants 200 --workers 1 --out out",
    "study floor_levels --levels 300 --direction z --duration 1.2 --keep responses --workers 2 --out out",
    "select --mass 1500 --size 1200 900 1500 --fragility 12 --travel 50 --shock 'half-sine 12 g 15 ms z' --mounts 6",
    "select genset/genset.xml --shock 'half-sine 10 g 18 ms z'",
    "select cabinet --shock 'sawtooth 10 g 11 ms x' --shock 'sine 0.5 g 12 Hz z 5 s'",
    "laws wide.csv loops.csv --law masing vaiana-rosati bouc-wen",
    "laws wide.csv --law asymmetric-bouc-wen enhanced-dry-friction",
    f"{CALIBRATE} --vary 'body/block/mass = Uniform(40, 60)' --vary 'mount/*/damping = Uniform(0.5, 1.5)' --out out",
    "frf cabinet --acceleration 2 --direction x --out out",
    "frf floating_floor --acceleration 1 --method sweep --rate 4 --start 4 --stop 16 --out out",
    "cases genset.toml --workers 2 --out out", "cases floor.toml --workers 2 --out out",
)  # fmt: skip
GENSET = """
name = "Genset"
model = "genset/genset.xml"
[[case]]
name = "Vertical"
half-sine = "10 g 11 ms z"
[[case]]
name = "Athwart"
sawtooth = "6 g 11 ms y"
[[case]]
name = "Lengthwise"
half-sine = "6 g 18 ms x"
[[case]]
name = "Transport"
psd = "transport.csv 20 s z seed 1"
[[case]]
name = "Sweep"
sweep = "0.2 g 4 to 30 Hz 8 oct/min z"
"""
FLOOR = """
name = "Floor"
model = "floating_floor"
[[case]]
name = "Vertical"
half-sine = "6 g 11 ms z"
[[case]]
name = "Athwart"
half-sine = "4 g 11 ms y"
[[case]]
name = "Lengthwise"
half-sine = "4 g 11 ms x"
"""


def prepare(folder: Path) -> None:
    """Write what the requests read: a job, loops of a rig, and a measured pulse."""
    (folder / "job.toml").write_text(JOB, encoding="utf-8")
    law = wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.0, k=5e4)
    time_of = np.arange(0.0, 24.0, 0.005)
    path = np.array([1e-3, 2e-3, 4e-3, 8e-3])[(time_of / 6.0).astype(int)] * np.sin(2.0 * np.pi * time_of)
    force = law.trace(path).force + np.random.default_rng(1).normal(0.0, 4.0, path.size)
    rows = np.column_stack([time_of, 1e3 * path, 1e-3 * force])
    np.savetxt(folder / "loops.csv", rows, delimiter=",", header="time [s],deflection [mm],force [kN]", comments="")
    law = wr.BoucWen.from_normalised(z_max=500.0, x_y=1e-3, sigma=0.6, n=1.5, k=8e4)
    path = np.array([2e-3, 6e-3, 12e-3])[(time_of / 8.0).astype(int)] * np.sin(3.0 * np.pi * time_of)
    force = law.trace(path).force + np.random.default_rng(3).normal(0.0, 6.0, path.size)
    rows = np.column_stack([time_of, 1e3 * path, 1e-3 * force])
    np.savetxt(folder / "wide.csv", rows, delimiter=",", header="time [s],deflection [mm],force [kN]", comments="")
    system = wr.load_system("shock_table")
    motion = wr.HalfSine(peak=50.0, duration=0.011, direction="z", start=0.02)
    response = wr.simulate(system, motion, duration=0.5, sample_rate=2000.0)
    measured = [response.time, response.base.acceleration[:, 2], response.bodies["block"].acceleration[:, 2]]
    (folder / "genset.toml").write_text(GENSET, encoding="utf-8")
    (folder / "floor.toml").write_text(FLOOR, encoding="utf-8")
    lines = "frequency [Hz],psd [g^2/Hz]\n5,0.002\n20,0.01\n80,0.01\n200,0.001\n"
    (folder / "transport.csv").write_text(lines, encoding="utf-8")
    for name, template in (("genset", "genset"), ("stages", "two-stage"), ("machine", "medium-weight-machine")):
        words = [sys.executable, "-c", COMMAND, "new", name, "--template", template]
        subprocess.run(words, cwd=folder, stdout=subprocess.DEVNULL, check=True)
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
    parser.add_argument("--held-out", action="store_true")
    asked = parser.parse_args()
    listed = HELD_OUT if asked.held_out else REQUESTS
    requests = [request for request in listed if not asked.commands or request.split()[0] in asked.commands]
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
