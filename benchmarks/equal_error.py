"""Cost of the engine: wirerope-mj, SciPy and a numba RK4 by hand on the same equations, at equal error.

    python benchmarks/equal_error.py

Every contender runs at its coarsest setting whose mount deflections and forces stay within 1e-4 of their peaks, at common
instants, of a DOP853 solution at 1e-10 that is split at the pulse's end.
"""

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import equations as eq
import mujoco
import numpy as np
import numpy.typing as npt
from floor import ISOLATOR, K, floor_mjcf
from rounds import interleaved
from scipy.integrate import solve_ivp

import wirerope_mj as wr
from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.install import STATE
from wirerope_mj.motions import BaseMotion

Array = npt.NDArray[np.float64]

TARGET = 1e-4
SDOF_MJCF = f"""<mujoco model="bench_mass">
  <option gravity="0 0 0"/>
  <worldbody>
    <body name="table"><joint name="table_z" type="slide" axis="0 0 1"/>
      <geom name="plate" type="box" size="0.1 0.1 0.01" mass="10" contype="0" conaffinity="0"/>
      <site name="table/m1" pos="0 0 0.05"/></body>
    <body name="mass" pos="0 0 0.05"><joint name="mass_z" type="slide" axis="0 0 1"/>
      <geom name="block" type="box" size="0.05 0.05 0.02" pos="0 0 0.05" mass="{eq.SDOF_MASS}" contype="0" conaffinity="0"/>
      <site name="mass/m1"/></body>
  </worldbody>
  <custom><text name="isolator/bench" data="bench.toml"/>
    <tuple name="mount/m1"><element objtype="site" objname="mass/m1"/><element objtype="site" objname="table/m1"/>
      <element objtype="text" objname="isolator/bench"/></tuple></custom>
</mujoco>"""


@dataclass(frozen=True, kw_only=True)
class Problem:
    """A problem in the forms that its contenders need."""

    name: str
    system: wr.System
    motion: BaseMotion
    duration: float
    rate: float  # common instants per second
    rates: Callable[[float, Array], Array]
    rk4: Callable[..., Array]
    start: Array
    scale: Array  # of the states, for SciPy's absolute tolerances
    breaks: tuple[float, ...]  # ends of the smooth parts of the motion
    steps: tuple[int, ...]  # steps per common interval, coarse to fine
    observed: Callable[[Array], tuple[Array, Array]]  # states -> deflections, forces, (n_t, n)


@dataclass(frozen=True, kw_only=True)
class Contender:
    """One way to solve a problem, at its coarsest setting."""

    name: str
    setting: str
    error: float
    work: Callable[[], object]


def floor_problem() -> Problem:
    shock = [wr.HalfSine(peak=eq.SHOCK[i], duration=eq.PULSE, direction=axis) for i, axis in ((2, "z"), (0, "x"))]
    return Problem(
        name="F: floor, 8 mounts x 3 axes, shock, 1 s", system=wr.load_system(floor_mjcf(8), isolators={"bench": ISOLATOR}),
        motion=shock[0] + shock[1], duration=1.0, rate=100.0, rates=eq.floor_rates, rk4=eq.floor_rk4, start=eq.FLOOR_START,
        scale=np.repeat([0.03, 0.6, 1.0, 0.3, 400.0], [3, 3, 4, 3, 24]), breaks=(eq.PULSE,),
        steps=(2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 25, 32, 40, 50, 64), observed=floor_observed,
    )  # fmt: skip


def floor_observed(y: Array) -> tuple[Array, Array]:
    w, x, v, u = y[:, 6:10].T
    rotation = np.array(
        [
            [1 - 2 * (v * v + u * u), 2 * (x * v - w * u), 2 * (x * u + w * v)],
            [2 * (x * v + w * u), 1 - 2 * (x * x + u * u), 2 * (v * u - w * x)],
            [2 * (x * u - w * v), 2 * (v * u + w * x), 1 - 2 * (x * x + v * v)],
        ]
    )
    deflection = y[:, None, :3] + np.einsum("ijt,mj->tmi", rotation, eq.ARMS) - eq.ARMS
    deflection = deflection.reshape(y.shape[0], -1)
    return deflection, K * deflection + y[:, 13:]


def sdof_problem() -> Problem:
    isolator = wr.Isolator(name="bench", axial=eq.SDOF_LAW)
    return Problem(
        name="S: one mass, sweep, 20 s", system=wr.load_system(SDOF_MJCF, isolators={"bench": isolator}),
        motion=wr.Sweep(start=5.0, stop=30.0, rate=2.0, acceleration=eq.SWEEP_LEVEL, direction="z"), duration=20.0,
        rate=100.0, rates=eq.sdof_rates, rk4=eq.sdof_rk4, start=eq.SDOF_START, scale=np.array([0.005, 0.2, 8.0]),
        breaks=(), steps=(1, 2, 3, 4, 5, 6, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 50, 64, 80, 100),
        observed=sdof_observed,
    )  # fmt: skip


def sdof_observed(y: Array) -> tuple[Array, Array]:
    x, z = y[:, :1], y[:, 2:]
    return x, z + eq.SDOF[4] * x + eq.SDOF[6] * x**3


def times_of(problem: Problem) -> Array:
    return np.arange(round(problem.duration * problem.rate) + 1) / problem.rate


def solve(problem: Problem, method: str, rtol: float, atol: Array) -> Array:
    """Return the states at the common instants by `solve_ivp`, one call for each smooth part of the motion."""
    times, y, begin, rows = times_of(problem), problem.start, 0.0, [problem.start[None]]
    for end in (*problem.breaks, problem.duration):
        at_times = np.append(times[(times > begin + 1e-12) & (times < end - 1e-12)], end)
        done = solve_ivp(problem.rates, (begin, end), y, method=method, rtol=rtol, atol=atol, t_eval=at_times)
        rows.append(done.y.T[: at_times.size if np.abs(times - end).min() < 1e-12 else -1])
        y, begin = done.y[:, -1], end
    return np.concatenate(rows)


def error_against(reference: tuple[Array, Array], observed: tuple[Array, Array]) -> float:
    return max(float(np.abs(a - b).max() / np.abs(a).max()) for a, b in zip(reference, observed, strict=True))


def simulated(problem: Problem, timestep: float | None) -> wr.Response:
    return wr.simulate(
        problem.system, problem.motion, duration=problem.duration, initial="unloaded", sample_rate=problem.rate,
        timestep=timestep,
    )  # fmt: skip


def response_observed(problem: Problem, response: wr.Response) -> tuple[Array, Array]:
    mounts = response.mounts.values()
    law_of = next(iter(problem.system.mounts.values())).isolator.axes
    used = [axis for axis, law in enumerate(law_of.values()) if law is not None]
    deflection, force = ([getattr(mount, kind)[:, used] for mount in mounts] for kind in ("deflection", "force"))
    return np.concatenate(deflection, axis=1), np.concatenate(force, axis=1)


def bare_stepping(problem: Problem, per_interval: int) -> Callable[[], None]:
    """Return a function that makes as many steps with the same callbacks, without segments, samples or a response."""
    model, assembly = problem.system.model, problem.system.assembly
    model.opt.timestep = 1.0 / (problem.rate * per_interval)
    data = mujoco.MjData(model)
    user = data.userdata[assembly.userdata : assembly.userdata + assembly.tables.user.size]
    user[at.OBSERVING], user[at.STAGE_POINTS] = 1.0, 1.0
    data.qvel[-1 if problem.breaks == () else 5] = 0.3  # the mass or floor rings
    begin = np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, begin, STATE)

    def work() -> None:
        mujoco.mj_setState(model, data, begin, STATE)
        with installed(model, data):
            mujoco.mj_step(model, data, nstep=round(problem.duration * problem.rate) * per_interval)

    return work


def coarsest(steps: tuple[int, ...], error: Callable[[int], float]) -> tuple[int, float]:
    reached = np.inf
    for step in steps:
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                reached = error(step)
        except wr.SimulationError:  # too coarse to stay bounded
            continue
        if reached <= TARGET:
            return step, reached
    raise SystemExit(f"no setting reaches {TARGET:g}; the finest gave {reached:.2g}")


def contenders(problem: Problem) -> list[Contender]:
    reference = problem.observed(solve(problem, "DOP853", 1e-10, 1e-10 * problem.scale))
    rows = round(problem.duration * problem.rate)

    def by_hand(n: int) -> Array:
        return problem.rk4(problem.start, 1.0 / (problem.rate * n), n, rows)

    def with_engine(n: int) -> wr.Response:
        return simulated(problem, timestep=1.0 / (problem.rate * n))

    def engine_error(response: wr.Response) -> float:
        return error_against(reference, response_observed(problem, response))

    n, error = coarsest(problem.steps, lambda n: error_against(reference, problem.observed(by_hand(n))))
    found = [Contender(name="numba RK4 by hand", setting=_step(problem, n), error=error, work=partial(by_hand, n))]
    n, error = coarsest(problem.steps, lambda n: engine_error(with_engine(n)))
    step = _step(problem, n)
    found.append(Contender(name="wr: stepping alone", setting=step, error=error, work=bare_stepping(problem, n)))
    found.append(Contender(name="wr.simulate", setting=step, error=error, work=partial(with_engine, n)))
    chosen = simulated(problem, timestep=None)
    found.append(
        Contender(
            name="wr.simulate, step chosen", setting=f"{1e3 * chosen.timestep:.3g} ms", error=engine_error(chosen),
            work=partial(simulated, problem, None),
        )
    )  # fmt: skip
    for method in ("LSODA", "RK45"):
        tolerances = 10.0 ** -np.arange(2.0, 10.0, 0.5)

        def run(i: int, method: str = method, tolerances: Array = tolerances) -> Array:
            return solve(problem, method, tolerances[i], tolerances[i] * problem.scale)

        i, error = coarsest(tuple(range(tolerances.size)), lambda i: error_against(reference, problem.observed(run(i))))
        found.append(
            Contender(name=f"SciPy {method}, NumPy", setting=f"rtol {tolerances[i]:.1e}", error=error, work=partial(run, i))
        )
    return found


def _step(problem: Problem, n: int) -> str:
    return f"{1e3 / (problem.rate * n):.3g} ms"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=7, help="rounds whose median is taken (default 7)")
    rounds = parser.parse_args().rounds
    for problem in (floor_problem(), sdof_problem()):
        rivals = contenders(problem)
        medians = interleaved({rival.name: rival.work for rival in rivals}, rounds=rounds)
        fastest = medians[rivals[0].name]
        print(f"\n{problem.name}; medians of {rounds} interleaved rounds")
        print(f"{'':26} {'setting':>12} {'error':>8} {'time':>11} {'relative':>9}")
        for rival in rivals:
            time = medians[rival.name]
            print(f"{rival.name:26} {rival.setting:>12} {rival.error:8.0e} {1e3 * time:8.2f} ms {time / fastest:9.1f}")


if __name__ == "__main__":
    main()
