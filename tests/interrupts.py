"""Interrupts commands at random instants: `python tests/interrupts.py run shock board --times 20 --seed 1`.

A SIGINT or a SIGTERM to the command alone must end it within `SOON`, with the exit code of that signal and without a traceback.
Results are then whole, those of before or those of a command that nobody disturbed; no other file is left, and no process. Half
of the commands write over what is there. One that ends late is given once more before it counts, as machines are busy at times.
"""

import argparse
import os
import random
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from commands import JOB, WIREROPE
from kills import finish, hidden, names
from small_search import SEARCH_FILE

SOON = 2.0  # Time in which an interrupted command ends [s]
_ORPHANS = 3.0  # Time in which processes end whose command is gone [s]
_MARK = "WIREROPE_INTERRUPTED"


@dataclass(frozen=True)
class Command:
    """A command that is interrupted, in a folder of its own.

    Attributes:
        words: its arguments, but for `force`.
        whole: file or folder that it writes whole or not at all; "" for none.
        results: files that are equal byte for byte whenever it ends.
        before: arguments of the command that wrote what it replaces.
        force: what it adds to replace that.
        seconds: time after which one that serves does nothing new [s]; 0 if the command ends by itself.
    """

    words: str
    whole: str = ""
    results: tuple[str, ...] = ()
    before: str = ""
    force: str = "--force"
    seconds: float = 0.0


_RUN = ("out/response.parquet", "out/loops.png")
_TABLE = ("out/variants.parquet", "out/summary.json", "out/study.toml")
_OTHER = "run shock_table --duration 0.11 --out out"
_STUDY = "study floor_levels --levels 24 --workers 2 --out out --duration"
COMMANDS = {
    "run": Command("run shock_table --duration 0.1 --out out", "out", _RUN, _OTHER),
    "shock": Command("shock shock_table --half-sine '5 g 11 ms z' --duration 0.1 --out out", "out", _RUN, _OTHER),
    "cases": Command("cases job.toml --workers 2 --out out", "", ("out/cases/down/response.parquet",)),
    "study": Command(f"{_STUDY} 0.12", "out", _TABLE, f"{_STUDY} 0.13"),
    "search": Command("study search.py --workers 2 --out out", "out", _TABLE, f"{_STUDY} 0.13"),
    "export": Command("export run out.h5", "out.h5", (), "export run out.h5"),
    "workbook": Command("export run out.xlsx", "out.xlsx", (), "export run out.xlsx"),
    "report": Command("report run --out out.html", "out.html", ("out.html",), "report other --out out.html"),
    "pdf": Command("report run --out out.html --pdf", "", ("out.html",), "report other --out out.html --pdf"),
    "film": Command("film run out.mp4 --at '50 ms'", "out.mp4", (), "film other out.mp4 --at '50 ms'"),
    "show": Command("show run --web", seconds=4.0),
    "board": Command("board shock_table --no-browser", seconds=6.0),
}
GOES_ON = {"study", "search", "frf"}  # Commands of which what is done is kept


def prepare(folder: Path) -> None:
    """Write what the commands read into a folder: two runs, a job, a search and what that imports."""
    folder.mkdir(parents=True)
    (folder / "job.toml").write_text(JOB, encoding="utf-8")
    (folder / "search.py").write_text(SEARCH_FILE, encoding="utf-8")
    for name in ("small_search.py", "house.py"):
        shutil.copy(Path(__file__).parent / name, folder)
    finish(folder, "run shock_table --duration 0.1 --out run")
    finish(folder, "run shock_table --duration 0.11 --out other")


def contents(folder: Path) -> dict[str, bytes]:
    """Return what stands in the files of a folder, by name."""
    return {name: (folder / name).read_bytes() for name in names(folder) if "__pycache__" not in name}


def orphans(mark: str) -> list[str]:
    """Return the processes that a command has left, once they had time to end."""
    end, wanted = time.monotonic() + _ORPHANS, f"{_MARK}={mark}".encode()
    while True:
        left = []
        for path in Path("/proc").glob("[0-9]*"):
            try:
                if wanted in (path / "environ").read_bytes().split(b"\0"):
                    left.append((path / "cmdline").read_bytes().replace(b"\0", b" ").decode())
            except OSError:
                continue
        if not left or time.monotonic() > end:
            return left
        time.sleep(0.1)


def interrupt(command: Command, folder: Path, words: str, delay: float, number: int) -> tuple[float, int, str, list[str]]:
    """Interrupt a command after a time [s]; return time to its end [s], exit code, messages and processes left."""
    scratch = folder.with_name(f"{folder.name}-scratch")
    scratch.mkdir()
    environment = {**os.environ, _MARK: str(folder), "TMPDIR": str(scratch)}
    process = subprocess.Popen(
        [*WIREROPE, *shlex.split(words)], cwd=folder, env=environment, start_new_session=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
    try:
        process.wait(timeout=delay)
    except subprocess.TimeoutExpired:
        process.send_signal(number)
    began = time.monotonic()
    try:
        process.wait(timeout=600.0)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
    seconds, left = time.monotonic() - began, orphans(str(folder))
    told = process.communicate()[1]
    code = process.returncode if process.returncode >= 0 else 128 - process.returncode  # as shells count it
    left += [str(path) for path in scratch.iterdir()]
    shutil.rmtree(scratch)
    return seconds, code, told, left


def faults(name: str, folder: Path, reference: Path, delay: float, number: int, *, over: bool) -> tuple[list[str], float, str]:
    """Interrupt a command in `folder`; return what is wrong, the time to its end [s], and how it ended."""
    command, before = COMMANDS[name], contents(folder)
    words = f"{command.words} {command.force if over else ''}"
    seconds, code, told, left = interrupt(command, folder, words, delay, number)
    wrong = [f"left: {left}"] if left else []
    ended = "interrupted"
    if code != 128 + number:
        ended = "finished" if code == 0 else "other"
        if code or command.seconds:
            wrong.append(f"exit code {code} after signal {number}: {told}")
    elif told and not told.splitlines()[-1].startswith("wirerope:") or "Traceback" in told or "ignored" in told:
        ended = "before it began"  # Python itself was starting, or importing the command
        if "wirerope_mj/cli/app" in told or "ignored" in told:
            wrong.append(f"told: {told}")
    if hidden(folder):
        wrong.append(f"hidden: {hidden(folder)}")
    after = contents(folder)
    new = all(after.get(file) == (reference / file).read_bytes() for file in command.results)
    if name in GOES_ON and not over:
        new = all(after.get(file, b"") in (b"", (reference / file).read_bytes()) for file in command.results)
    elif command.whole:
        new = new and names(folder / command.whole) == names(reference / command.whole) and (folder / command.whole).exists()
    else:
        new = True  # each of its files is whole
    if after != before and not new:
        changed = sorted(file for file in {*after, *before} if after.get(file) != before.get(file))
        wrong.append(f"neither old nor new: {changed}")
    return wrong, seconds, ended


def campaign(name: str, times: int, *, seed: int, place: Path, soon: float = SOON) -> Counter[str]:
    """Interrupt one command `times` times, print what is wrong, and return the counts."""
    command, chance = COMMANDS[name], random.Random(f"{seed} {name}")
    prepare(inputs := place / "inputs")
    shutil.copytree(inputs, old := place / "old")
    if not command.seconds:
        finish(old, command.before or command.words)
    shutil.copytree(inputs, reference := place / "reference")
    seconds = command.seconds
    if not seconds:
        began = time.monotonic()
        finish(reference, command.words)
        seconds = time.monotonic() - began
    count: Counter[str] = Counter(times=times)
    slowest = 0.0
    for turn in range(times):
        over, number = turn % 4 < 2 and not command.seconds, (signal.SIGINT, signal.SIGTERM)[turn % 2]
        delay = chance.uniform(0.05, 1.1) * seconds
        for attempt in range(2):
            folder = place / f"{turn}-{attempt}"
            shutil.copytree(old if over else inputs, folder)
            wrong, late, ended = faults(name, folder, reference, delay, number, over=over)
            if late <= soon:
                break
            print(f"{name}: ended {late:.2f} s after signal {number}, which came after {delay:.2f} s", flush=True)
        else:
            wrong.append(f"late twice: {late:.2f} s")
        count[ended] += 1
        count["late once"] += attempt
        count["wrong"] += bool(wrong)
        slowest = max(slowest, min(late, 60.0))
        if wrong:
            print(f"{name}: signal {number} after {delay:.2f} s, over {over}: {wrong}", flush=True)
        else:
            shutil.rmtree(folder)
    print(f"{name}: {dict(count)}, slowest {slowest:.2f} s", flush=True)
    return count


def main() -> int:
    """Interrupt the commands that are named, and print a line of counts for each; the exit code says whether all is well."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commands", nargs="*", default=list(COMMANDS))
    parser.add_argument("--times", type=int, default=28)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    wrong = 0
    for name in asked.commands:
        place = Path(tempfile.mkdtemp(prefix=f"interrupts-{name}-"))
        count = campaign(name, asked.times, seed=asked.seed, place=place)
        wrong += count["wrong"]
        if not count["wrong"]:
            shutil.rmtree(place)
    print(f"in all {asked.times * len(asked.commands)} interrupts, {wrong} wrong")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
