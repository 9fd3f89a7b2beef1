"""Fuzz campaigns: mutated inputs, each used as a user would, and what came of each.

    python tests/fuzz/campaign.py models records --inputs 5000 --seed 1 --processes 2

A target is a function of a module beside this file: it takes a generator of random numbers and a folder, writes a mutated input
there, and returns a `Case`, which knows how a user would use it. The input of a seed is always the same: `--only SEED` runs one
again and shows its traceback.
"""

import argparse
import importlib
import multiprocessing
import os
import re
import signal
import sys
import tempfile
import traceback
import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from queue import Empty
from time import monotonic
from typing import Any

import numpy as np

from wirerope_mj.foundation.errors import WireRopeError

TARGETS = {
    "devices": ("models", "isolators", "layouts"),
    "motions": ("records", "cycles", "phrases", "levels", "limits"),
    "runs": ("folders", "scenarios", "returns", "actions"),
    "studies": ("vary", "studies", "missions", "responses"),
    "commands": ("commands", "tools"),
    "meanings": ("meant",),
    "hostile": ("hostile",),
}  # fmt: skip
"""Targets by the modules that hold them, `fuzz_devices.py` and so on."""

MODULES = {name: f"fuzz_{module}" for module, names in TARGETS.items() for name in names}

LIMIT, WAIT = 20.0, 900.0
"""An input that computes longer hangs [s], or that is waited for longer: others may have the processor meanwhile."""

ACCEPTED, REFUSED = "accepted", "refused"
FAULTS = ("undocumented", "vague", "silent", "hang", "killed")
"""What must not happen: another exception than a documented one, a message that does not say what of the user's is wrong, an
acceptance that should be a refusal or a wrong result, no answer in time, the end of the process."""

_VAGUE = re.compile(
    r"SVD did not converge|Singular matrix|must not contain infs or NaNs|array is too big|Unable to allocate|broadcast|"
    r"ufunc|dtype|object is not|has no attribute|unexpected keyword|positional argument|list index|index out of|"
    r"invalid literal|could not convert|not well-formed \(|ArrowInvalid|ndarray|NoneType|engine error|zero-size"
)
"""Words of NumPy, SciPy, MuJoCo, pyarrow and the interpreter that say nothing of the user's input by themselves."""


@dataclass(frozen=True)
class Case:
    """One mutated input.

    Attributes:
        mutation: what was done to it.
        use: uses it as a user would; returns a complaint if it is accepted and the result is wrong.
        names: of which a refusal must name one: a file, a body, a parameter; empty asks for nothing.
        valid: False if accepting it is a fault; None if only the result tells.
    """

    mutation: str
    use: Callable[[], str | None]
    names: tuple[str, ...] = ()
    valid: bool | None = None


Target = Callable[[np.random.Generator, Path], Case]


@dataclass(frozen=True)
class Outcome:
    """What came of one input."""

    seed: int
    kind: str
    mutation: str
    message: str = ""


def attempt(make: Target, seed: int) -> Outcome:
    """Return what comes of the input of one seed."""
    with tempfile.TemporaryDirectory(prefix="fuzz-") as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        case = make(np.random.default_rng(seed), Path(folder))
        try:
            complaint = case.use()
        except (WireRopeError, ValueError) as error:
            message = str(error)
            if type(error) not in _documented():
                return Outcome(seed, "undocumented", case.mutation, f"{type(error).__name__}: {message}")
            named = not case.names or any(name in message for name in case.names)
            kind = REFUSED if named and not _VAGUE.search(message) else "vague"
            return Outcome(seed, kind, case.mutation, message)
        except Exception as error:
            last = traceback.extract_tb(error.__traceback__)[-1]
            where = f"{Path(last.filename).name}:{last.lineno}"
            return Outcome(seed, "undocumented", case.mutation, f"{type(error).__name__} at {where}: {error}")
    if complaint is None and case.valid is False:
        complaint = "accepted, and must be refused"
    return Outcome(seed, ACCEPTED if complaint is None else "silent", case.mutation, complaint or "")


def _documented() -> set[type]:
    """Return the errors that the package documents; a subclass of ValueError from elsewhere is not one of them."""
    classes, known = [WireRopeError], {ValueError, WireRopeError}
    while classes:
        below = classes.pop().__subclasses__()
        known |= set(below)
        classes += below
    return known


def target(name: str) -> Target:
    """Return the function that makes the inputs of a target."""
    return getattr(importlib.import_module(MODULES[name]), name)


def campaign(name: str, seeds: range, processes: int = 1) -> list[Outcome]:
    """Return the outcomes of the inputs of some seeds, each killed when it hangs."""
    todo, outcomes = list(reversed(seeds)), []
    workers = [_Worker(name) for _ in range(min(processes, len(todo)))]
    while todo or any(worker.seed is not None for worker in workers):
        for worker in workers:
            if worker.seed is None and todo:
                worker.give(todo.pop())
            outcome = worker.poll()
            if outcome is not None:
                outcomes.append(outcome)
    for worker in workers:
        worker.process.kill()
    return sorted(outcomes, key=lambda outcome: outcome.seed)


class _Worker:
    """A process that works through seeds, and is started again when it hangs or dies."""

    def __init__(self, name: str) -> None:
        self.name, self.seed = name, None
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._asked, self._answers = context.Queue(), context.Queue()
        self.process = context.Process(target=_serve, args=(self.name, self._asked, self._answers), daemon=True)
        self.process.start()
        self._answers.get(timeout=300.0)  # imports and compiling do not count

    def give(self, seed: int) -> None:
        self.seed, self._begun, self._spent = seed, monotonic(), self._computed()
        self._asked.put(seed)

    def _computed(self) -> float:
        """Return the time for which the process has had a processor [s]; where the system does not say, since ever."""
        try:
            fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
            return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
        except OSError:
            return monotonic()

    def poll(self) -> Outcome | None:
        if self.seed is None:
            return None
        try:
            outcome = self._answers.get(timeout=0.01)
        except Empty:
            alive, waited = self.process.is_alive(), monotonic() - self._begun
            hangs = waited > WAIT or (waited > LIMIT and self._computed() - self._spent > LIMIT)
            if alive and not hangs:
                return None
            outcome = Outcome(self.seed, "hang" if alive else "killed", "", f"process of seed {self.seed}")
            self.process.kill()
            self._start()
        self.seed = None
        return outcome


def _serve(name: str, asked: Any, answers: Any) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    make = target(name)
    for seed in range(1, 100):  # compiles what most inputs need
        if attempt(make, seed).kind == ACCEPTED:
            break
    answers.put(None)
    while True:
        answers.put(attempt(make, asked.get()))


def main() -> int:
    """Run campaigns, print their counts and their faults, and return 1 if there are faults."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("targets", nargs="+", choices=MODULES)
    parser.add_argument("--inputs", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0, help="of the first input")
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--only", type=int, help="one seed, in this process, with its traceback")
    parser.add_argument("--show", type=int, default=10, help="faults printed of each kind")
    asked = parser.parse_args()
    faults = 0
    for name in asked.targets:
        if asked.only is not None:
            with tempfile.TemporaryDirectory() as folder:
                case = target(name)(np.random.default_rng(asked.only), Path(folder))
                print(case)
                print(case.use())
            continue
        outcomes = campaign(name, range(asked.seed, asked.seed + asked.inputs), asked.processes)
        counts = Counter(outcome.kind for outcome in outcomes)
        print(f"{name}: {len(outcomes)} inputs, " + ", ".join(f"{counts[kind]} {kind}" for kind in sorted(counts)))
        for kind in FAULTS:
            for outcome in [outcome for outcome in outcomes if outcome.kind == kind][: asked.show]:
                print(f"  {kind}: seed {outcome.seed}, {outcome.mutation}: {outcome.message[:300]}")
            faults += counts[kind]
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
