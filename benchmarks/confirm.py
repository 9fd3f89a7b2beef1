"""Every claim of speed, measured again: claim, where it stands, measured value, verdict.

    python -m benchmarks.confirm            # all, some minutes
    python -m benchmarks.confirm mounts     # one group

Claims are ratios of contenders that take turns in one process, or of commands to the start of what they import: seconds belong
to the machine of the day. On a machine with other work, ratios scatter by a third from run to run. So a claim holds if what is
measured is no worse than 1.5 times what is claimed. Of short works the least time of many rounds counts. The scripts beside
this file make the tables behind the claims.

On a machine that does other things nothing is judged: before each group a loop runs on each processor, which should not have
to wait for it.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Literal

import numpy as np

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

import callback_cost  # noqa: E402
import equal_error  # noqa: E402
import frequency_response  # noqa: E402
import identification  # noqa: E402
import study  # noqa: E402
import trace_speed  # noqa: E402
from floor import ISOLATOR, floor_mjcf  # noqa: E402
from rounds import interleaved  # noqa: E402

import wirerope_mj as wr  # noqa: E402
from wirerope_mj.mounts.laws import LAWS  # noqa: E402

SCATTER = 1.5
ROUNDS = 5
least = partial(interleaved, rounds=21, of=min)
COMMANDS = "README.md, docs/start.md"


@dataclass(frozen=True, kw_only=True)
class Measured:
    """One claim, and what was measured of it.

    Attributes:
        claim: in words.
        where: the page that makes it.
        claimed, measured: the number.
        better: whether smaller or larger numbers are better.
    """

    claim: str
    where: str
    claimed: float
    measured: float
    better: Literal["smaller", "larger"]

    @property
    def holds(self) -> bool:
        """Whether the measured number is no worse than the claimed one, within the scatter."""
        if self.better == "smaller":
            return self.measured <= SCATTER * self.claimed
        return self.measured >= self.claimed / SCATTER


def mounts() -> Iterator[Measured]:
    """Native and Python callback on 16 mounts."""
    steps = 2000
    t = least(callback_cost.contenders(16, steps=steps))
    native = t[callback_cost.NATIVE]
    for claim, other, claimed in (
        ("a step with 16 hysteretic mounts, over one of the bare bodies", callback_cost.BARE, 1.52),
        ("the native callback over the one in Python", callback_cost.PYTHON, 0.30),
        ("hysteretic mounts over MuJoCo's own springs", callback_cost.SPRINGS, 11.3 / 24.2),
    ):
        yield Measured(claim=claim, where="benchmarks/README.md", claimed=claimed, measured=native / t[other], better="smaller")


def engine() -> Iterator[Measured]:
    """`wr.simulate` over a Runge-Kutta loop by hand, at equal error."""
    for problem, given, chosen in ((equal_error.floor_problem(), 11.0, 42.0), (equal_error.sdof_problem(), 7.7, 26.0)):
        rivals = {one.name: one.work for one in equal_error.contenders(problem) if not one.name.startswith("SciPy")}
        t = least(rivals)
        for name, claimed in (("wr.simulate", given), ("wr.simulate, step chosen", chosen)):
            yield Measured(
                claim=f"{problem.name.split(',')[0]}: {name} over Runge-Kutta by hand, at equal error",
                where="benchmarks/README.md", claimed=claimed, measured=t[name] / t["numba RK4 by hand"],
                better="smaller",
            )  # fmt: skip


def traces() -> Iterator[Measured]:
    """`solve_ivp` over a law's trace, at equal error."""
    for name, claimed in (("masing", 360.0), ("asymmetric-bouc-wen", 205.0), ("vaiana-rosati", 122.0)):
        law = LAWS[name](**trace_speed.PARAMETERS[name])
        short, stretch = (trace_speed.turning_points(n) for n in (trace_speed.CHECKED, 200))
        samples, reference = trace_speed.sampled(stretch), trace_speed.solved_closely(law, short)
        own = trace_speed.error(trace_speed.traced(law, trace_speed.sampled(short)), reference)
        how = trace_speed.cheapest(law, short, reference, max(own, trace_speed.ERROR))[:2]
        t = interleaved(
            {"trace": lambda law=law, s=samples: trace_speed.traced(law, s),
             "solve_ivp": lambda law=law, e=stretch, how=how: trace_speed.solved(law, e, *how)}, rounds=3,
        )  # fmt: skip
        yield Measured(
            claim=f"{name}: SciPy's solve_ivp over a trace, at equal error", where="benchmarks/README.md",
            claimed=claimed, measured=t["solve_ivp"] / t["trace"], better="larger",
        )  # fmt: skip


def fits() -> Iterator[Measured]:
    """`solve_ivp` over a residual of the identification."""
    for case in identification.costs(rounds=3, cases=[("RK45", 1e-6, False), ("RK45", 1e-8, True)]):
        start = "from rest until steady" if case.cycle else "given the steady state"
        claimed = 102.0 if case.cycle else 15.0
        yield Measured(
            claim=f"a residual by solve_ivp ({case.method} {case.tolerance:.0e}, {start}) over ours",
            where="benchmarks/README.md", claimed=claimed, measured=case.ratio, better="larger",
        )  # fmt: skip


def curves() -> Iterator[Measured]:
    """Steps of sweeps that agree with a branch, over those of the branch: counts, which do not scatter."""
    case = frequency_response.CASES["one"]
    system = wr.load_system(frequency_response.models_folder() / f"{case.model}.xml")
    _, branch = frequency_response.timed_branch(system, case, case.largest_step)
    _, fine = frequency_response.timed_branch(system, case, case.largest_step / 6.0)
    curve = frequency_response.PchipInterpolator(np.log(fine.frequency), fine.amplitude)
    steps, _, differences = frequency_response.swept(system, case, branch, curve, 0.5)
    if differences.max() > frequency_response.AGREEMENT:
        steps = 0  # then these sweeps are no rivals
    yield Measured(
        claim="one mass: steps of sweeps that agree to 0.5 % over those of a branch", where="benchmarks/README.md",
        claimed=21.5, measured=steps / branch.model_steps, better="larger",
    )  # fmt: skip


def studies() -> Iterator[Measured]:
    """A study's rate beside those of a loop and of independent processes."""
    study.parts_of(study.floor_study(64), 1)  # compiles
    one = study.parts_of(study.floor_study(512), 1)[0]
    loop = study.loop(study.floor_study(32))[0]
    yield Measured(
        claim="8 mounts: variants per second of a study's worker over a loop of `wr.simulate`",
        where="docs/studies_at_scale.md", claimed=16.0, measured=one / loop, better="larger",
    )  # fmt: skip


def commands() -> Iterator[Measured]:
    """Commands over the start of what they stand on, `python -c "import numpy, mujoco"`; the kernels are compiled before."""
    with tempfile.TemporaryDirectory() as folder:
        wirerope = [sys.executable, "-c", "from wirerope_mj.cli import main; main()"]
        run = [*wirerope, "run", "floating_floor_shock", "--out", f"{folder}/run", "--force"]
        subprocess.run(run, check=True, stdout=subprocess.DEVNULL)
        times: dict[str, list[float]] = {}
        for _ in range(ROUNDS):
            for name, work in {
                "start": lambda: _seconds([sys.executable, "-c", "import numpy, mujoco"]),
                "import": lambda: _seconds([sys.executable, "-c", "import wirerope_mj"]),
                "help": lambda: _seconds([*wirerope, "--help"]),
                "verdict": lambda: _seconds(run, until="checks are within"),
                "folder": lambda: _seconds(run),
            }.items():
                times.setdefault(name, []).append(work())
    t = {name: float(np.median(values)) for name, values in times.items()}
    for claim, name, claimed in (
        ("`import wirerope_mj`", "import", 0.2),
        ("`wirerope --help`", "help", 0.8),
        ("a shock on the shipped floor: the verdict", "verdict", 8.9),
        ("a shock on the shipped floor: report, recording and pictures written", "folder", 19.0),
    ):
        yield Measured(
            claim=f"{claim} over the start of Python with MuJoCo", where=COMMANDS, claimed=claimed,
            measured=t[name] / t["start"], better="smaller",
        )  # fmt: skip


def documents() -> Iterator[Measured]:
    """A floor on 300 mounts and a PDF over the start of Python with MuJoCo, and the first verdict where nothing is compiled."""
    with tempfile.TemporaryDirectory() as name:
        folder, wirerope = Path(name), [sys.executable, "-c", "from wirerope_mj.cli import main; main()"]
        ISOLATOR.save(folder / "bench.toml")
        (folder / "floor.xml").write_text(floor_mjcf(300), encoding="utf-8")
        floor, shipped = [*wirerope, "shock", f"{folder}/floor.xml", "--half-sine", "5 g 11 ms xyz"], [*wirerope, "run"]
        shipped += ["floating_floor_shock", "--force", "--out"]
        start = float(np.median([_seconds([sys.executable, "-c", "import numpy, mujoco"]) for _ in range(ROUNDS)]))
        t = {"shock": min(_seconds([*floor, "--out", f"{folder}/{number}"]) for number in range(2))}
        t["report"] = min(_seconds([*wirerope, "report", f"{folder}/0"]) for _ in range(2))
        _seconds([*shipped, f"{folder}/run"])
        t["pdf"] = _seconds([*wirerope, "report", f"{folder}/run", "--pdf"])
        fresh = {**os.environ, "NUMBA_CACHE_DIR": f"{folder}/kernels"}
        t["first"] = _seconds([*shipped, f"{folder}/first"], until="checks are within", environment=fresh)
    for claim, name, claimed in (
        ("a shock on a floor on 300 mounts, its folder written", "shock", 23.0),
        ("the report of that floor", "report", 38.0),
        ("the shipped floor's report as PDF, too", "pdf", 21.0),
        ("a shock on the shipped floor: the verdict where every kernel must be compiled", "first", 132.0),
    ):
        yield Measured(
            claim=f"{claim} over the start of Python with MuJoCo", where="benchmarks/README.md", claimed=claimed,
            measured=t[name] / start, better="smaller",
        )  # fmt: skip


GROUPS: dict[str, Callable[[], Iterator[Measured]]] = {
    group.__name__: group for group in (mounts, engine, traces, fits, curves, studies, commands, documents)
}


_LOOP = """
import time
wall, own = time.perf_counter(), time.process_time()
sum(i * i for i in range(5_000_000))
print((time.perf_counter() - wall) / (time.process_time() - own))
"""
_BUSY = 1.1  # of its own time that a loop may take while there is one for each processor


def _why_busy() -> str:
    """Say why ratios mean nothing now; "" if the processors are free."""
    loops = [subprocess.Popen([sys.executable, "-c", _LOOP], stdout=subprocess.PIPE) for _ in range(os.cpu_count() or 1)]
    longest = max(float(loop.communicate()[0]) for loop in loops)
    if longest <= _BUSY:
        return ""
    return f"the machine is busy: a loop on each processor waited {longest - 1.0:.0%} of its own time"


def _seconds(command: list[str], until: str = "", environment: dict[str, str] | None = None) -> float:
    """Return the seconds of a command, or those until it prints a line that holds a word; it is let run to its end."""
    begin, found = time.perf_counter(), None
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if until and found is None and until in line:
                found = time.perf_counter() - begin
    if until and found is None:
        raise SystemExit(f"{' '.join(command)} prints nothing of {until!r}.")
    return found or time.perf_counter() - begin


def main() -> int:
    """Print a line for each claim; return 1 if one does not hold."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.confirm", description=__doc__.splitlines()[0])
    parser.add_argument("groups", nargs="*", metavar="group", help=f"of {', '.join(GROUPS)}; all without any")
    names = parser.parse_args().groups
    if unknown := [name for name in names if name not in GROUPS]:
        parser.error(f"no group is called {', '.join(unknown)}; there are {', '.join(GROUPS)}")
    print(f"{'claimed':>8} {'measured':>9}  verdict")
    kept = True
    for name in names or GROUPS:
        if why := _why_busy():
            print(f"{name}: not judged, {why}.", flush=True)
            kept = False
            continue
        for one in GROUPS[name]():
            sign = "<=" if one.better == "smaller" else ">="
            verdict = "holds" if one.holds else "DOES NOT HOLD"
            print(f"{sign}{one.claimed:6.3g} {one.measured:9.3g}  {verdict:14s} {one.claim} ({one.where})", flush=True)
            kept = kept and one.holds
    return int(not kept)


if __name__ == "__main__":
    sys.exit(main())
