"""Injects faults into every command that writes: `python tests/faults.py study search --times 40 --seed 1`.

A write, a renaming or the making of a file or folder fails (EIO, no space), is cut short, or is the last thing that the process
does. What the command replaces is then there whole as it was, or whole as a command makes it that nobody disturbed; nothing
else is, or after a kill once the next command has cleared up. The error is one message that names no hidden file.
"""

import argparse
import ctypes
import faulthandler
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import traceback
from collections import Counter
from pathlib import Path
from threading import Timer

from kills import hidden
from writing_commands import FIRST, GOES_ON, WRITING, files, prepare

from wirerope_mj.cli import main as wirerope
from wirerope_mj.foundation import processes
from wirerope_mj.foundation.half_written import clear_half_written

KINDS = ("EIO once", "no space", "short writes", "kill", "EIO from now on")
_LIBRARY = "WIREROPE_FAULTY_CALLS"
_ENDS = 600.0  # A command that takes longer hangs [s]; it says where


def library(folder: Path) -> Path:
    """Compile what makes calls fail; RuntimeError where there is no compiler."""
    made = folder / "faulty_calls.so"
    source = Path(__file__).with_name("faulty_calls.c")
    if not shutil.which("gcc") or subprocess.run(["gcc", "-O1", "-shared", "-fPIC", "-o", made, source, "-ldl"]).returncode:
        raise RuntimeError("this needs gcc")
    return made


def given(words: list[str], folder: Path, number: int, kind: int) -> tuple[int, str, int]:
    """Give a command in a copy of this process, one of whose calls meets a fault; return exit code, messages and calls."""
    told, count = folder.with_suffix(".told"), folder.with_suffix(".count")
    child = os.fork()
    if child == 0:
        code = 99
        try:
            os.chdir(folder)
            handle = os.open(told, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            os.dup2(handle, 2)
            sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w", buffering=1)
            faulthandler.dump_traceback_later(0.9 * _ENDS, file=sys.stderr)
            faulty = ctypes.CDLL(os.environ[_LIBRARY])
            faulty.begin_faults(os.fsencode(f"{folder}/"), ctypes.c_long(number), kind)
            code = wirerope(words)
            faulty.begin_faults(b"", ctypes.c_long(-1), 0) if number >= 0 else None
            sys.stderr.flush()
            count.write_text(str(faulty.counted_calls()))
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(code)
    timer = Timer(_ENDS, lambda: os.kill(child, signal.SIGKILL))
    timer.start()
    _, status = os.waitpid(child, 0)
    timer.cancel()
    calls = int(count.read_text()) if count.exists() else 0
    said = told.read_text(errors="replace") if told.exists() else ""
    for file in (told, count):
        file.unlink(missing_ok=True)
    return os.waitstatus_to_exitcode(status), said, calls


_CLOCK = re.compile(rb"20\d\d-\d\d-\d\d \d\d:\d\d|(?<= model steps, )[\d.]+ s")


def contents(folder: Path) -> dict[str, bytes]:
    """Return the contents of all files below a folder, by their paths in it, without compiled modules and clock times."""
    found = {str(path.relative_to(folder)): _CLOCK.sub(b"now", content) for path, content in files(folder).items()}
    return {name: content for name, content in found.items() if "__pycache__" not in name}


class Reference:
    """What a command leaves that nobody disturbs: what is in its files, and which of them are as they are by chance."""

    def __init__(self, name: str, before: Path, place: Path) -> None:
        self.before, made = contents(before), []
        for number in range(2):
            shutil.copytree(before, folder := place / f"whole-{number}")
            code, said, self.calls = given(WRITING[name], folder, -1, 0)
            if code not in (0, 1):
                raise RuntimeError(f"{name}: {said}")
            made.append(contents(folder))
            shutil.rmtree(folder)
        self.after = made[0]
        self.by_chance = {file for file in made[0] if made[0][file] != made[1].get(file)}

    def unlike(self, now: dict[str, bytes], *, old: bool) -> list[str]:
        """Return the files that are not those of before, or those of a command that nobody disturbed."""
        wanted = self.before if old else self.after
        return sorted(file for file in {*wanted, *now} if not self._same(file, wanted.get(file), now.get(file), old=old))

    def _same(self, file: str, wanted: bytes | None, now: bytes | None, *, old: bool) -> bool:
        if wanted is None or now is None or old or file not in self.by_chance:
            return wanted == now
        return abs(len(now) - len(wanted)) <= 0.02 * len(wanted) + 16  # dates, times and random names in it


def fault(name: str, before: Path, reference: Reference, folder: Path, number: int, kind: int) -> list[str]:
    """Give one command that meets a fault in a copy of a folder, and return what is wrong afterwards."""
    shutil.copytree(before, folder, symlinks=True)
    code, said, _ = given(WRITING[name], folder, number, kind)
    wrong = []
    expected = {"kill": (-9, 0, 1), "short writes": (0, 1)}.get(KINDS[kind - 1], (2, 0, 1))
    if code not in expected:
        wrong.append(f"exit code {code}: {said[-300:]}")
    if "Traceback" in said or re.search(r"wirerope\.(part|old)|Errno", said):
        wrong.append(f"told: {said[-300:]}")
    if KINDS[kind - 1] == "kill":
        for place in {folder, *(path for path in folder.rglob("*") if path.is_dir())}:
            clear_half_written(place)
    elif hidden(folder):
        wrong.append(f"left: {hidden(folder)}")
    now = contents(folder)
    old, new = reference.unlike(now, old=True), reference.unlike(now, old=False)
    if code == 2 and name in GOES_ON:
        new = [file for file in new if file in now and file in old]
    pairs = [] if not old or not new else sorted(set(old) & set(new))
    if code in (0, 1) and new:
        wrong.append(f"exit code {code}, and not whole: {new}")
    elif pairs:
        wrong.append(f"neither old nor new: {pairs}")
    elif old and new and name not in SEVERAL:
        wrong.append(f"some old, some new: {old} {new}")
    if not wrong:
        shutil.rmtree(folder)
    return wrong


SEVERAL = {"report", "cases", "loops", "new", "isolators", "levels", "schemas", "identify", "compare --map", "statics"}
"""Commands that write several files, each of which is whole."""


def campaign(name: str, times: int, *, seed: int, before: Path, place: Path) -> Counter[str]:
    """Give one command with `times` faults, print what is wrong, and return the counts."""
    place.mkdir()
    shutil.copytree(before, old := place / "before")
    given(WRITING[name], old, -1, 0)  # what is replaced
    reference, chance = Reference(name, old, place), random.Random(f"{seed} {name}")
    count: Counter[str] = Counter(faults=times)
    for turn in range(times):
        kind, number = turn % len(KINDS) + 1, chance.randint(1, max(reference.calls, 1))
        wrong = fault(name, old, reference, place / str(turn), number, kind)
        count["wrong"] += bool(wrong)
        if wrong:
            print(f"{name}: {KINDS[kind - 1]} at call {number} of {reference.calls}: {wrong}", flush=True)
    print(f"{name}: {reference.calls} calls, {times} faults, {count['wrong']} wrong", flush=True)
    return count


def main() -> int:
    """Give the commands that are named with faults; the exit code says whether all is well."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commands", nargs="*")
    parser.add_argument("--times", type=int, default=35)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    if _LIBRARY not in os.environ:  # once more, with the library before all others
        made = str(library(Path(tempfile.mkdtemp(prefix="faults-"))))
        environment = {**os.environ, _LIBRARY: made, "LD_PRELOAD": made}
        return subprocess.run([sys.executable, *sys.argv], env=environment).returncode
    processes.processors = lambda: 1  # all is written by the process that is counted
    place = Path(tempfile.mkdtemp(prefix="faults-"))
    prepare(before := place / "first")
    for name in FIRST:
        given(WRITING[name], before, -1, 0)
    total = Counter[str]()
    for name in asked.commands or WRITING:
        total += campaign(name, asked.times, seed=asked.seed, before=before, place=place / name.replace(" ", "_"))
    print(f"in all {total['faults']} faults, {total['wrong']} wrong; {place}")
    return int(bool(total["wrong"]))


if __name__ == "__main__":
    sys.exit(main())
