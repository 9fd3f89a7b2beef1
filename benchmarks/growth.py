"""How the cost of a run grows with mounts and duration, and how near the kernel's steps are to what the processor can do.

    python benchmarks/growth.py mounts     # 8 to 1000 mounts, 0.5 s in steps of 1 ms
    python benchmarks/growth.py durations  # 0.5 to 50 s of the floor with 8 mounts
    python benchmarks/growth.py roofline   # operations and bytes of a step, beside the processor's own rates

The floor of `benchmarks/floor.py` under a half-sine along three axes; processor time of one process, the least of three runs.
Operations and loads are counted where the kernel's source runs as plain Python, on arrays that count.
"""

import argparse
import builtins
import math
import os
import resource
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable

import numpy as np
from floor import ISOLATOR, floor_mjcf

import wirerope_mj as wr
from wirerope_mj.engine.kernel.equations import equations
from wirerope_mj.engine.kernel.variants import NOTHING, group_of
from wirerope_mj.engine.simulation.in_lanes import moving_indices
from wirerope_mj.foundation.jit import njit
from wirerope_mj.foundation.lanes import WIDTH, rows

STEP = 1e-3
MOUNTS, DURATIONS = (8, 32, 128, 512, 1000), (0.5, 5.0, 50.0)
COUNTED, WHOLE = 3, 2000  # steps, where they are counted and where they are timed
DIVISIONS = ("divide", "sqrt")
PASSES = 4_000_000


def system_of(mounts: int) -> wr.System:
    return wr.load_system(floor_mjcf(mounts), isolators={"bench": ISOLATOR})


def least(work: Callable[[], object], times: int = 3) -> float:
    """Return the least processor time [s]."""

    def once() -> float:
        begun = time.process_time()
        work()
        return time.process_time() - begun

    return min(once() for _ in range(times))


def simulated(system: wr.System, duration: float) -> float:
    pulses = [wr.HalfSine(peak=50.0, duration=0.011, direction=axis, start=0.01) for axis in "xyz"]
    motion = pulses[0] + pulses[1] + pulses[2]
    wr.equilibrium(system)
    return least(lambda: wr.simulate(system, motion, duration=duration, timestep=STEP, engine="kernel"))


def memory() -> float:
    """Return the most memory that this process has used [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def by_mounts() -> None:
    print(f"{'mounts':>8}{'run [ms]':>10}{'us a mount and step':>22}{'memory [MB]':>13}")
    for mounts in MOUNTS:
        seconds = simulated(system_of(mounts), 0.5)
        print(f"{mounts:8}{1e3 * seconds:10.1f}{1e6 * seconds / mounts * STEP / 0.5:22.3f}{memory():13.0f}")


def by_durations() -> None:
    print(f"{'duration [s]':>14}{'run [ms]':>10}{'us a step':>11}{'memory [MB]':>13}")
    system = system_of(8)
    for duration in DURATIONS:
        seconds = simulated(system, duration)
        print(f"{duration:14.1f}{1e3 * seconds:10.1f}{1e6 * seconds * STEP / duration:11.2f}{memory():13.0f}")


class Counting(np.ndarray):
    """Lanes that count what is computed of them and how often they are read or written."""

    operations: Counter[str] = Counter()

    def __array_ufunc__(self, ufunc, method, *inputs, out=(), **how):  # type: ignore[no-untyped-def]
        """Compute, and count what fills all lanes."""
        plain = [np.asarray(one) for one in inputs]
        into = {"out": tuple(np.asarray(one) for one in out)} if out else {}
        result = getattr(ufunc, method)(*plain, **into, **how)
        if np.shape(result) == (WIDTH,):
            self.operations[ufunc.__name__] += 1
        return result.view(Counting) if isinstance(result, np.ndarray) else result

    def __array_function__(self, function, kinds, inputs, how):  # type: ignore[no-untyped-def]
        """Choose among lanes, which goes on counting."""
        result = super().__array_function__(function, kinds, inputs, how)
        return result.view(Counting) if isinstance(result, np.ndarray) else result

    def __getitem__(self, key):  # type: ignore[no-untyped-def]
        """Read."""
        self.operations["moved"] += 1
        return super().__getitem__(key)

    def __setitem__(self, key, value) -> None:  # type: ignore[no-untyped-def]
        """Write."""
        self.operations["moved"] += 1
        super().__setitem__(key, value)


def stepping(mounts: int, steps: int, kind: type[np.ndarray] = np.ndarray) -> Callable[[], None]:
    """Return a function that steps WIDTH equal floors, swinging freely; their arrays are of `kind`."""
    system = system_of(mounts)
    start = np.zeros((1, moving_indices(system).size))
    start[0, system.model.nq + np.arange(3, 6)] = 0.1  # three velocities of the floor
    start[0, : system.model.nq] = system.model.qpos0
    group = group_of([equations(system)], start, [0])
    for array in ("numbers", "states", "memory"):
        object.__setattr__(group, array, getattr(group, array).view(kind))
    grid = np.array([[0.0], [steps * STEP], [float(steps)], [0.0], [0.0]])
    still = np.zeros((1, 1, len(system.assembly.tables.drive)))
    base, ends = np.zeros((1, 2 * steps + 1, 3)), np.array([2 * steps + 1])
    return lambda: group.go(grid, still, still, base, ends, NOTHING)


def counted(mounts: int) -> Counter[str]:
    """Return how often lanes are computed and moved in a step, in a process without compiled code."""
    go = stepping(mounts, COUNTED, Counting)
    for name in ("sqrt", "floor", "exp", "expm1", "log", "tanh"):
        setattr(math, name, getattr(np, name))  # of lanes, too
    builtins.min, builtins.max = np.minimum, np.maximum
    go()
    return Counter({name: number // COUNTED for name, number in Counting.operations.items()})


@njit
def multiply_and_add(array, passes):  # type: ignore[no-untyped-def]
    """Keep eight products and sums under way."""
    r = rows(array)
    a, b, c, d, e, f, g, h, x, y = r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8], r[9]
    for _ in range(passes):
        a, b, c, d = a * x + y, b * x + y, c * x + y, d * x + y
        e, f, g, h = e * x + y, f * x + y, g * x + y, h * x + y
    r[0] = a + b + c + d + e + f + g + h


@njit
def read(array, passes):  # type: ignore[no-untyped-def]
    """Read 64 lanes again and again, eight sums under way."""
    r = rows(array)
    a = b = c = d = e = f = g = h = r[0]
    for _ in range(passes // 8):
        for i in range(0, 64, 8):
            a, b, c, d = a + r[i], b + r[i + 1], c + r[i + 2], d + r[i + 3]
            e, f, g, h = e + r[i + 4], f + r[i + 5], g + r[i + 6], h + r[i + 7]
    r[0] = a + b + c + d + e + f + g + h


@njit
def divide(array, passes):  # type: ignore[no-untyped-def]
    """Keep four quotients under way."""
    r = rows(array)
    a, b, c, d, x = r[0], r[1], r[2], r[3], r[8]
    for _ in range(passes):
        a, b, c, d = a / x, b / x, c / x, d / x
    r[0] = a + b + c + d


def roofline() -> None:
    lanes = np.ones((64, WIDTH))
    rates = {}
    for work, each in ((multiply_and_add, 16), (read, 8), (divide, 4)):
        work(lanes, 8)
        rates[work] = each * PASSES / least(lambda work=work: work(lanes, PASSES))
        print(f"{work.__name__.replace('_', ' '):>18}: {rates[work] / 1e9:.2f} billion lanes a second")
    for mounts in (8, 24):
        go = stepping(mounts, WHOLE)
        go()
        taken = least(go) / WHOLE
        out = subprocess.run(
            [sys.executable, __file__, "counted", str(mounts)], env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
            capture_output=True, text=True, check=True,
        ).stdout  # fmt: skip
        numbers = Counter({name: int(number) for name, number in (line.split() for line in out.splitlines())})
        moved, divisions = numbers.pop("moved"), sum(numbers.pop(name, 0) for name in DIVISIONS)
        plain = numbers.total()
        least_time = max(plain / rates[multiply_and_add] + divisions / rates[divide], moved / rates[read])
        print(f"{mounts} mounts: {plain} operations, {divisions} divisions and roots, {moved} lanes moved in a step")
        print(f"    ({8 * WIDTH * moved / 1e3:.0f} kB); at these rates {1e6 * least_time:.2f} us, taken {1e6 * taken:.2f} us")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("mounts", "durations", "roofline", "counted"))
    parser.add_argument("count", type=int, nargs="?", default=8, help="mounts whose operations are counted")
    asked = parser.parse_args()
    if asked.what == "counted":
        print(*(f"{name} {number}" for name, number in counted(asked.count).items()), sep="\n")
    else:
        {"mounts": by_mounts, "durations": by_durations, "roofline": roofline}[asked.what]()


if __name__ == "__main__":
    main()
