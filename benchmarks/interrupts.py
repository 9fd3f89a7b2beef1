"""How long commands take to stop after Ctrl-C or SIGTERM at random instants, and what is left of them then.

    python -m benchmarks.interrupts                       # 100 signals to each command: hours
    python -m benchmarks.interrupts study select --times 10 --seed 1

The instants are drawn evenly over the time that the command takes when nobody disturbs it, and a tenth more; every second
signal is a SIGTERM, and half of the commands write over what is there. What must hold afterwards is what `tests/interrupts.py`
says: results are whole, those of before or those of an undisturbed command, no half-written file, no process and no temporary
folder is left, and no traceback is printed. Commands that go on are given again, complete what was interrupted, and their
results are equal byte for byte to those of an undisturbed one.
"""

import argparse
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).parents[1] / "tests")]

from interrupts import COMMANDS, SOON, Command, faults  # noqa: E402  # of the tests
from interrupts import prepare as prepare_runs  # noqa: E402
from kills import finish  # noqa: E402

from benchmarks.estimates import CALIBRATE, SELECT, prepare  # noqa: E402

COMMANDS |= {
    "select": Command(f"{SELECT} 'half-sine 15 g 11 ms y' --mounts 4+2 --out out", "out"),
    "laws": Command("laws loops.csv --law bouc-wen masing", force=""),
    "identify": Command("identify loops.csv --law bouc-wen --out out.toml --report out", "out", ("out.toml",)),
    "calibrate": Command(f"{CALIBRATE} --out out", "out"),
    "frf": Command("frf sdof_shaker --keep kept --out out", "out", ("out/branches.parquet",)),
    "compare": Command("compare run other --out out", "out"),
    "new": Command("new out --template cabinet", "out"),
    "replay": Command("replay run", force=""),
    "modes": Command("modes cabinet", force=""),
    "statics": Command("statics cabinet", force=""),
    "docx": Command("report run --out out.html --docx", "", ("out.html",), "report other --out out.html --docx"),
    "study-report": Command("study-report tried --out out.html", "out.html", ("out.html",)),
    "picture": Command("export run out.png", "out.png", ("out.png",)),
    "share": Command("share run out", "out"),
    "fmu": Command("fmu shock_table out.fmu", "out.fmu"),
    "loops": Command("loops enidine_wr16_400 --out out.png", "out.png", ("out.png",), force=""),
    "isolator": Command("isolators enidine_wr16_400 --out out.png", "out.png", ("out.png",), force=""),
    "levels": Command("levels ac156 --sds 1.2 --z-h 1 --out out.toml", "out.toml", ("out.toml",)),
    "durability": Command("durability long --exponent 5", force=""),
    "comfort": Command("comfort run", force=""),
    "check": Command("check run job.toml cabinet", force=""),
    "compile": Command("compile", force=""),
}
# What these add to go on with what is done.
RESUMED = {"study": "--resume", "search": "--resume", "cases": "", "frf": "--force"}


def prepare_all(folder: Path) -> None:
    """Write what the commands read into a folder."""
    prepare_runs(folder)
    job = (folder / "job.toml").read_bytes()
    prepare(folder)
    (folder / "job.toml").write_bytes(job)
    finish(folder, "run shock_table --duration 0.3 --out long")
    finish(folder, "study floor_levels --levels 8 --duration 0.12 --out tried")


def signals(name: str, times: int, inputs: Path, place: Path, *, seed: int) -> tuple[list[float], dict[str, int]]:
    """Interrupt a command `times` times, and return the times to its end [s], and how often what happened."""
    command, chance = COMMANDS[name], random.Random(f"{seed} {name}")
    shutil.copytree(inputs, old := place / "old")
    if not command.seconds and command.whole:
        finish(old, command.before or command.words)
    shutil.copytree(inputs, reference := place / "reference")
    began = time.monotonic()
    if not command.seconds:
        finish(reference, command.words)
    seconds = command.seconds or time.monotonic() - began
    counts, stops = {"in the middle": 0, "wrong": 0, "resumed": 0}, []
    for turn in range(times):
        over = turn % 4 < 2 and bool(command.whole) and not command.seconds
        number = (signal.SIGINT, signal.SIGTERM)[turn % 2]
        shutil.copytree(old if over else inputs, folder := place / str(turn))
        delay = chance.uniform(0.05, 1.1) * seconds
        wrong, stop, ended = faults(name, folder, reference, delay, number, over=over)
        if ended != "finished":
            stops.append(stop)
            counts["in the middle"] += 1
            if stop > SOON:
                wrong.append(f"ended after {stop:.2f} s")
            if name in RESUMED and not wrong and not over:
                wrong += other_bits(f"{command.words} {RESUMED[name]}", command.results, folder, reference)
                counts["resumed"] += 1
        counts["wrong"] += bool(wrong)
        if wrong:
            print(f"{name}: signal {number} after {delay:.2f} of {seconds:.2f} s, over {over}: {wrong}", flush=True)
        shutil.rmtree(folder)
    return stops, {"seconds": round(seconds), **counts}


def other_bits(words: str, results: tuple[str, ...], folder: Path, reference: Path) -> list[str]:
    """Give an interrupted command again; return what is wrong with its results."""
    try:
        finish(folder, words)
    except RuntimeError as error:
        return [f"not resumed: {error}"]
    return [
        f"resumed with another {file}" for file in results if (folder / file).read_bytes() != (reference / file).read_bytes()
    ]


def main() -> int:
    """Interrupt the commands that are named, and print a line for each; the exit code says whether all is well."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commands", nargs="*", default=list(COMMANDS))
    parser.add_argument("--times", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    every, bad = list[float](), 0
    print("command     takes signals  median     p95 longest wrong resumed  load")
    with tempfile.TemporaryDirectory(prefix="interrupts-") as prepared:
        prepare_all(inputs := Path(prepared) / "inputs")
        for name in asked.commands:
            with tempfile.TemporaryDirectory(prefix=f"interrupts-{name}-") as place:
                stops, counts = signals(name, asked.times, inputs, Path(place), seed=asked.seed)
            every += stops
            bad += counts["wrong"]
            median, p95, longest = np.quantile(stops, [0.5, 0.95, 1.0]) if stops else (np.nan,) * 3
            print(
                f"{name:10} {counts['seconds']:4d} s {counts['in the middle']:7d} {median:5.2f} s {p95:5.2f} s "
                f"{longest:5.2f} s {counts['wrong']:5d} {counts['resumed']:7d} {os.getloadavg()[0]:5.1f}", flush=True,
            )  # fmt: skip
    if every:
        late = sum(stop > SOON for stop in every)
        print(f"all: {len(every)} signals, p95 {np.quantile(every, 0.95):.2f} s, {late} later than {SOON:g} s, {bad} wrong")
    return int(bool(bad))


if __name__ == "__main__":
    sys.exit(main())
