"""Kills commands at random instants and looks at what is left: `python tests/kills.py run study identify report --kills 50`.

A kill is a SIGKILL of the command's process group, which the workers of a study may outlive. The next command then writes
beside what was left: the same one over it, or one of another name. Its results are compared with those of a command that
nobody disturbed.
"""

import argparse
import itertools
import os
import random
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from threading import Timer

import psutil
from rig_records import rig_record, write_record

import wirerope_mj as wr

LONGEST = 600.0
"""A command that takes longer hangs [s]."""


def wait_until_ended(number: int) -> None:
    """Wait until a process is gone or a zombie: after its SIGKILL that takes as long as the machine is busy.

    One that lives on makes the test run into the time that pytest allows.
    """
    with suppress(psutil.NoSuchProcess):
        process = psutil.Process(number)
        while process.is_running() and process.status() != psutil.STATUS_ZOMBIE:
            time.sleep(0.02)


@dataclass(frozen=True)
class Command:
    """A command that is killed, in a folder of its own; NAME in its words stands for the name of what it writes.

    Attributes:
        words: its arguments.
        results: files that are equal byte for byte whenever the command ends.
        appears: file or folder that is there only if it is complete; None for a study, which goes on.
        again: what the next command adds to write over what is there.
    """

    words: str
    results: tuple[str, ...]
    appears: str | None
    again: str


COMMANDS = {
    "run": Command("run shock_table --duration 0.1 --out NAME", ("NAME/response.parquet", "NAME/loops.png"), "NAME", "--force"),
    "study": Command(
        "study floor_levels --levels 24 --duration 0.12 --workers 2 --out NAME",
        ("NAME/study.toml", "NAME/variants.parquet", "NAME/summary.json"),
        None,
        "--resume",
    ),
    "identify": Command(
        "identify loops.csv --law bouc-wen --name device --out NAME.toml", ("NAME.toml",), "NAME-report", "--force"
    ),
    "report": Command("report run --out NAME.html", ("NAME.html",), "NAME.html", "--force"),
}


def prepare(folder: Path) -> None:
    """Write what the commands read into a folder: the record of a rig, and a run."""
    folder.mkdir(parents=True)
    law = wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.0, k=5e4)
    write_record(folder / "loops.csv", *rig_record(law, [1e-3, 4e-3, 8e-3], seed=7, points=90.3))
    finish(folder, "run shock_table --duration 0.1 --out run")


def start(folder: Path, words: str) -> subprocess.Popen[bytes]:
    """Start a command in `folder`, in a process group of its own."""
    code = "import sys; from wirerope_mj.cli import main; sys.exit(main())"
    return subprocess.Popen(
        [sys.executable, "-c", code, *shlex.split(words)], cwd=folder, start_new_session=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
    )  # fmt: skip


@contextmanager
def interruptible(command: list[str], **options) -> Iterator[subprocess.Popen[str]]:
    """Run a command that an interrupt ends, also where these tests ignore it, as in the background; killed after the block."""
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL), **options,
    )  # fmt: skip
    timer = Timer(120.0, process.kill)  # who reads a line would wait for ever
    timer.start()
    try:
        yield process
    finally:
        timer.cancel()
        process.kill()
        process.communicate()


def killed_at_call(number: int, work: Callable[[], object]) -> bool:
    """Run something in a copy of this process, killed at its call of Python of that number; say whether it was."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # threads of libraries do not matter to this copy
        copy = os.fork()
    if copy == 0:
        count = itertools.count(1)
        try:
            sys.setprofile(
                lambda _, event, __: os.kill(os.getpid(), signal.SIGKILL) if event == "call" and next(count) == number else None
            )
            work()
        finally:
            os._exit(0)
    return os.WIFSIGNALED(os.waitpid(copy, 0)[1])


def finish(folder: Path, words: str) -> None:
    """Give a command in `folder`; RuntimeError if it fails."""
    process = start(folder, words)
    _, told = process.communicate(timeout=LONGEST)
    if process.returncode:
        raise RuntimeError(f"wirerope {words}: exit code {process.returncode}: {told.decode()}")


def hidden(folder: Path) -> list[str]:
    """Return what a person does not see below a folder."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob(".*"))


def names(path: Path) -> list[str]:
    """Return the files of a result."""
    return sorted(str(file.relative_to(path)) for file in path.rglob("*") if file.is_file())


def false(command: Command, folder: Path, undisturbed: Path, name: str) -> list[str]:
    """Return the results under `name` that are there and are not those of the undisturbed command, or not all there is."""
    pairs = [(folder / file.replace("NAME", name), undisturbed / file) for file in command.results]
    wrong = [str(here) for here, there in pairs if here.is_file() and here.read_bytes() != there.read_bytes()]
    if command.appears is not None:
        whole = folder / command.appears.replace("NAME", name)
        if whole.exists() and names(whole) != names(undisturbed / command.appears):
            wrong.append(str(whole))
    return wrong


def kill_once(command: Command, folder: Path, undisturbed: Path, delay: float, *, same_name: bool) -> Counter[str]:
    """Kill a command in `folder` after a time [s], give the next one, and count what must not be."""
    count: Counter[str] = Counter(kills=1)
    process = start(folder, command.words)
    try:
        process.communicate(timeout=delay)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        count["died before finishing"] += 1
    count["left after the kill"] += bool(hidden(folder))
    wrong = false(command, folder, undisturbed, "NAME")
    count["complete and false"] += bool(wrong)
    name = "NAME" if same_name or command.appears is None else "other"
    finish(folder, f"{command.words.replace('NAME', name)} {command.again}")
    left = hidden(folder)
    count["left after the next command"] += bool(left)
    other = false(command, folder, undisturbed, name)
    other += [file for file in command.results if not (folder / file.replace("NAME", name)).is_file()]
    count["other results"] += bool(other)
    if wrong or left or other:
        print(f"after {delay:.2f} s: {wrong} {left} {other}", flush=True)
    return count


def campaign(name: str, kills: int, *, seed: int, place: Path) -> Counter[str]:
    """Kill one command `kills` times at random instants and return the counts; what was found wrong is kept in `place`."""
    command, undisturbed, chance = COMMANDS[name], place / "undisturbed", random.Random(seed)
    prepare(undisturbed)
    shutil.copytree(undisturbed, inputs := place / "inputs")
    began = time.monotonic()
    finish(undisturbed, command.words)
    seconds = time.monotonic() - began
    total: Counter[str] = Counter()
    for number in range(kills):
        folder = place / str(number)
        shutil.copytree(inputs, folder)
        # The first fifth goes for imports. Past its end, since the machine may be slower now than it was then.
        count = kill_once(command, folder, undisturbed, chance.uniform(0.2, 1.1) * seconds, same_name=number % 2 == 0)
        total += count
        if not (count["complete and false"] or count["left after the next command"] or count["other results"]):
            shutil.rmtree(folder)
    return total


COUNTED = (
    "kills",
    "died before finishing",
    "left after the kill",
    "complete and false",
    "left after the next command",
    "other results",
)


def main() -> int:
    """Kill the commands that are named and print a line of counts for each; the exit code says whether all is well."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commands", nargs="+", choices=sorted(COMMANDS))
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    bad = 0
    for name in asked.commands:
        place = Path(tempfile.mkdtemp(prefix=f"kills-{name}-"))
        count = campaign(name, asked.kills, seed=asked.seed, place=place)
        print(f"{name}: " + ", ".join(f"{what} {count[what]}" for what in COUNTED), flush=True)
        wrong = sum(count[what] for what in COUNTED[3:])
        if wrong:
            print(f"{name}: kept in {place}")
        else:
            shutil.rmtree(place)
        bad += wrong
    return int(bool(bad))


if __name__ == "__main__":
    sys.exit(main())
