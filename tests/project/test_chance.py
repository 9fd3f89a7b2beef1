"""No test depends on chance or on the clock: what is drawn has a seed, work is counted, and a time is only waited for."""

import ast
from pathlib import Path

import pytest

pytestmark = pytest.mark.quick

TESTS = Path(__file__).parents[1]
CLOCKS = {"monotonic", "perf_counter", "process_time", "thread_time", "monotonic_ns", "perf_counter_ns", "time.time"}
SEEDED = {"Random", "default_rng", "RandomState", "SeedSequence", "PCG64"}
PATIENCE = 120.0
"""Time [s] below which giving up would decide where a machine is busy; a test that hangs may take as long."""


def faults(text, *, helper=False):
    """Return the lines of a test that read a clock, give up soon or draw without a seed; a helper may do the first two."""
    nodes = list(ast.walk(ast.parse(text)))
    imports = [alias for node in nodes if isinstance(node, ast.Import) for alias in node.names if alias.name == "random"]
    found, plain = [], [[alias.asname or "random"] for alias in imports]
    for node in nodes:
        if isinstance(node, ast.ImportFrom) and node.module == "random":
            found.append(f"line {node.lineno}: {ast.unparse(node)}")
        if not isinstance(node, ast.Call):
            continue
        called = ast.unparse(node.func)
        *before, name = called.split(".")
        drawn = name in {"SystemRandom", "uuid4"} or (name in SEEDED and not node.args and not node.keywords)
        drawn |= name not in SEEDED and (before[-2:] in (["np", "random"], ["numpy", "random"]) or before in plain)
        soon = [key.value for key in node.keywords if key.arg == "timeout"]
        soon = [value.value for value in soon if isinstance(value, ast.Constant) and value.value is not None]
        timed = name in CLOCKS or called in CLOCKS or any(value < PATIENCE for value in soon)
        if drawn or (timed and not helper):
            found.append(f"line {node.lineno}: {ast.unparse(node)[:80]}")
    return found


def test_nothing_is_drawn_without_a_seed_and_no_time_is_measured():
    found = {
        str(path.relative_to(TESTS)): faults(path.read_text(encoding="utf-8"), helper=not path.name.startswith("test_"))
        for path in TESTS.rglob("*.py")
    }
    assert {name: lines for name, lines in found.items() if lines} == {}
    assert len(found) > 100


@pytest.mark.parametrize("fault", [
    "import random\nrandom.uniform(0, 1)", "from random import uniform", "import random as chance\nchance.SystemRandom()",
    "np.random.default_rng()", "np.random.seed(3)", "start = time.perf_counter()", "assert monotonic() - begun < 5.0",
    "process.wait(timeout=20.0)",
])  # fmt: skip
def test_what_depends_on_chance_or_on_the_clock_is_found(fault):
    assert len(faults(fault)) == 1


@pytest.mark.parametrize("sound", [
    "import random\nrandom.Random(3)", "np.random.default_rng(seed)", "rng.uniform(0, 1)", "process.wait(timeout=120)",
    "random.description", "subprocess.run(command, timeout=LIMIT)",
])  # fmt: skip
def test_what_does_not_is_left_alone(sound):
    assert faults(sound) == []
