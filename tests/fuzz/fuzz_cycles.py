"""Cyclic tests, as CSV files and as series, cut into loops as a user would."""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from campaign import Case
from tables import DAMAGE, damaged_bytes, table_of

import wirerope_mj as wr
from wirerope_mj.mounts.identification.measured import prepare
from wirerope_mj.mounts.test_rig import load_cycles, steady_loops

_POINTS = 60
_SIZES = (2e-3, 8e-3)


@cache
def _clean() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time [s], deflection [m] and force [N] of three cycles of each amplitude."""
    time = np.arange(6 * _POINTS + 1) / _POINTS
    path = np.repeat([*_SIZES, _SIZES[-1]], [3 * _POINTS, 3 * _POINTS, 1]) * np.sin(2.0 * np.pi * time)
    return time, path, wr.BoucWen(alpha=300e3, beta=200.0, gamma=0.0, n=1.0, k=80e3).trace(path).force


def mutate(rng: np.random.Generator, folder: Path) -> Case:
    """Write a cyclic test that is damaged or strange below `folder`, or make its series so."""
    time, path, force = _clean()
    one = rng.random() < 0.4
    if one:
        time, path, force = (values[-_POINTS - 1 :] for values in (time, path, force))
    done, valid = "nothing of the signals", True
    if rng.random() < 0.5:
        kind = str(rng.choice(list(_SIGNALS)))
        time, path, force, valid = _SIGNALS[kind](rng, time.copy(), path.copy(), force.copy())
        done = f"signals: {kind}"
    if done.startswith("signals") and rng.random() < 0.4:
        names = ("samples", "`deflection`", "`time`", "the record", "loop 1", "loop 2")
        return Case(f"series, {done}", {"series": (path, force, time)}, names, False if valid is False else None)
    return _file(rng, folder / "test.csv", (time, path, force), done, valid, one)


def _file(
    rng: np.random.Generator, path: Path, signals: tuple[np.ndarray, ...], done: str, valid: bool | None, one: bool
) -> Case:
    """Write signals to a file, and damage it if they are whole."""
    time, deflection, force = signals
    table = table_of(["time [s]", "deflection [mm]", "force [kN]"], [time, 1e3 * deflection, 1e-3 * force])
    if rng.random() < 0.3:
        table.header.insert(0, "loop")
        table.rows = [["1", *row] for row in table.rows]
    if done.startswith("nothing"):
        change = DAMAGE[int(rng.integers(len(DAMAGE)))]
        done, valid = change.__name__, change(table, rng)
    content = table.content()
    if rng.random() < 0.2:
        how, content = damaged_bytes(content, rng)
        done, valid = f"{done}, {how}", None
    path.write_bytes(content)
    inputs: dict[str, Any] = {"path": path, "one": one and rng.random() < 0.7}
    if valid:
        inputs["sizes"] = _SIZES[-1:] if one else _SIZES
    return Case(done, inputs, (path.name, "loop 1", "loop 2"), False if valid is False else None)


def _noise(share: float) -> Any:
    def change(rng: np.random.Generator, t: np.ndarray, x: np.ndarray, f: np.ndarray) -> tuple[Any, ...]:
        noisy = [values + share * np.ptp(values) * rng.standard_normal(values.size) for values in (x, f)]
        return t, *noisy, None

    return change


def _only_noise(which: str) -> Any:
    def change(rng: np.random.Generator, t: np.ndarray, x: np.ndarray, f: np.ndarray) -> tuple[Any, ...]:
        noise = rng.standard_normal(t.size)
        return (t, 1e-2 * noise, f, False) if which == "deflection" else (t, x, 1e3 * noise, False)

    return change


def _clipped(rng: np.random.Generator, t: np.ndarray, x: np.ndarray, f: np.ndarray) -> tuple[Any, ...]:
    return t, x, np.minimum(f, rng.uniform(0.6, 0.95) * f.max()), False


def _spike(rng: np.random.Generator, t: np.ndarray, x: np.ndarray, f: np.ndarray) -> tuple[Any, ...]:
    values, value = (x, f)[int(rng.integers(2))], float(rng.choice([np.nan, np.inf, 1e300, -1e300, 1e20, 1e8, 0.0]))
    values[int(rng.integers(t.size))] = value
    return t, x, f, None if abs(value) < 1e200 else False


def _time(rng: np.random.Generator, t: np.ndarray, x: np.ndarray, f: np.ndarray) -> tuple[Any, ...]:
    place = int(rng.integers(1, t.size))
    t[place] += float(rng.choice([1e-9, 5.0, 2e10, -1.0, 1e300, np.nan, np.inf]))
    return t, x, f, None


_SIGNALS: dict[str, Any] = {
    "noise of 1 %": _noise(0.005), "noise of 10 %": _noise(0.05), "noise of 100 %": _noise(0.5),
    "deflection is noise": _only_noise("deflection"), "force is noise": _only_noise("force"),
    "clipped": _clipped, "a spike": _spike, "time": _time,
    "wrong sign": lambda rng, t, x, f: (t, x, -f, False),
    "backwards": lambda rng, t, x, f: (t, x[::-1], f[::-1], False),
    "swapped": lambda rng, t, x, f: (t, f, x, None),
    "constant deflection": lambda rng, t, x, f: (t, 0.0 * x + 1e-3, f, False),
    "constant force": lambda rng, t, x, f: (t, x, 0.0 * f + 5.0, False),
    "half a cycle": lambda rng, t, x, f: (t[: _POINTS // 2 + 1], x[: _POINTS // 2 + 1], f[: _POINTS // 2 + 1], None),
    "few samples": lambda rng, t, x, f: (t[::9], x[::9], f[::9], None),
    "huge": lambda rng, t, x, f: (t, x * 1e200, f * 1e200, False),
    "tiny": lambda rng, t, x, f: (t, x * 1e-200, f * 1e-200, None),
    "metres for millimetres": lambda rng, t, x, f: (t, 1e3 * x, f, False),
    "drift": lambda rng, t, x, f: (t, x, f + 100.0 * t, None),
}  # fmt: skip
"""Each returns time, deflection, force, and whether that is valid still."""


def use(case: Case) -> str | None:
    """Cut the test into loops, look at them, and make them ready for a fit."""
    if "series" in case.inputs:
        x, f, time = case.inputs["series"]
        loops = steady_loops(x, f, time=time)
    else:
        loops = (wr.load_cyclic_test if case.inputs["one"] else load_cycles)(case.inputs["path"])
    if not loops:
        return "there are no loops, and nothing is said"
    for loop in loops:
        values = (loop.amplitude, loop.operating_point, loop.secant_stiffness, loop.dissipated_energy)
        if not (np.isfinite(values).all() and np.isfinite(loop.force).all() and loop.amplitude > 0.0):
            return f"amplitude, operating point, stiffness and energy are {values}"
        if not case.inputs.get("one") and (loop.dissipated_energy <= 0.0 or loop.secant_stiffness < 0.0):
            return f"stiffness and energy are {values[2:]}"
    prepare(loops)
    sizes = case.inputs.get("sizes")
    if sizes and not np.allclose([loop.amplitude for loop in loops], sizes, rtol=0.01):
        return f"amplitudes are {[loop.amplitude for loop in loops]} where {sizes} were meant"
    return None
