"""Whole commands with an option or two that are strange, called as the shell calls them."""

import contextlib
import io
import os
import re
from pathlib import Path

import numpy as np
from campaign import Case
from hostile import pick
from words import NUMBERS, muddled

from wirerope_mj.cli import main

SOME = (*(number for number in NUMBERS if number not in ("1e9", "1e12", "1e6", "7e15", "12e3", "1e30")), "abc", "1 mm")
"""Numbers that ask for nothing that is large and possible all the same."""

STEPS = ("0", "nan", "-1", "1e-4", "1e400", "abc", "1e-15", "1e-308", "0.5", "1e-3", "inf", "")
"""Time steps of which no run has many."""

COMMANDS = (
    ("statics", ("shock_table",), {}),
    ("modes", ("shock_table",), {"--amplitude-mm": SOME}),
    ("select", ("--mass", "100", "--mounts", "4"), {"--mass": SOME, "--mounts": SOME, "--drop": SOME, "--velocity": SOME,
     "--travel": SOME, "--fragility": SOME, "--disturbance-rpm": SOME, "--disturbance-hz": SOME, "--isolation-ratio": SOME,
     "--loops": SOME, "--shock": ("15 g 11 ms half-sine", "2 m/s", "20 g 11 ms sawtooth")}),
    ("loops", ("enidine_wr16_400", "--axis", "axial", "--amplitudes", "2"), {"--amplitudes": SOME, "--operating-point-mm": SOME,
     "--frequency": SOME, "--cycles": SOME}),
    ("fmu", ("sdof_shaker", "o.fmu"), {"--timestep": SOME}),
    ("levels", ("bv_043",), {"--out": ("x.toml", "no/x.toml", "", "/")}),
    ("isolators", ("estimate",), {"--height": SOME, "--width": SOME, "--rope": SOME, "--loops": SOME,
     "--bar": SOME, "--bar-length": SOME}),
    ("shock", ("sdof_shaker", "--half-sine", "3 g 5 ms z", "--duration", "0.02", "--timestep", "1e-3"), {
     "--half-sine": ("3 g 5 ms z",), "--duration": SOME, "--sample-rate": SOME, "--accuracy": SOME, "--timestep": STEPS,
     "--start": SOME, "--scale": SOME, "--limit": ("acceleration/mass = 15 g",), "--direction": ("x", "1,1,0", "q")}),
    ("study", ("shock_table", "--vary", "motion/level = Uniform(0.5, 1)", "--variants", "2", "--duration", "0.06"), {
     "--variants": SOME, "--seed": SOME, "--duration": SOME, "--vary": ("motion/level = Choice(1, 2)", "motion/level", "")}),
)  # fmt: skip
ESTIMATE = ("--height", "89", "--width", "105", "--rope", "12.7", "--loops", "8")
WEIGHTS = np.array([1, 4, 12, 6, 3, 1, 8, 3, 1], dtype=float)
_NO_NUMBER = re.compile(r"(?<![\w.])[-+]?(?:nan|inf)(?![\w.])")


def mutate(rng: np.random.Generator, folder) -> Case:
    """Make a command, some of whose options are strange."""
    command, given, options = COMMANDS[int(rng.choice(len(COMMANDS), p=WEIGHTS / WEIGHTS.sum()))]
    words = [*given, *(ESTIMATE if command == "isolators" else ())]
    if command == "select" and rng.random() < 0.8:
        words += [("--drop", "0.3"), ("--velocity", "2"), ("--shock", "15 g 11 ms half-sine")][int(rng.integers(3))]
    for _ in range(pick(rng, (1, 1, 1, 2)) if options else 0):
        name = pick(rng, list(options))
        value = pick(rng, options[name])
        if " " in value and rng.random() < 0.7:
            value = muddled(rng, value)
        if name in words:
            words[words.index(name) + 1] = value
        else:
            words += [name, value]
    if rng.random() < 0.05:
        words.insert(
            int(rng.integers(len(words) + 1)),
            pick(rng, ("--nobody", "--out", "-1", "", "x", "--force", "\u00fc", "--")),
        )
    return Case(f"{command} {words!r:.200}", {"arguments": [command, *words], "folder": folder})


def use(case: Case) -> str | None:
    """Call the command in a folder of its own: it answers with finite numbers, or says one thing and exits with 2."""
    here, out, err = Path.cwd(), io.StringIO(), io.StringIO()
    os.chdir(case.inputs["folder"])
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = main(case.inputs["arguments"])
    finally:
        os.chdir(here)
    said = err.getvalue().strip()
    if code == 2:
        if not said.startswith("wirerope: ") or "Traceback" in said:
            return f"exit code 2 and no message: {said[:200]}"
        raise ValueError(said)
    found = _NO_NUMBER.search(out.getvalue())
    return f"it prints {found[0]}" if found else None
