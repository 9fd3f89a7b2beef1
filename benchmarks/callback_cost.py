"""What do the mounts cost?  Time per RK4 step of the floor with native and Python callback, springs, and bare bodies.

    python benchmarks/callback_cost.py

Four contenders step the same deck, floor, bump stops and options; only what holds the floor differs. The native and the Python
callback observe and track peaks as a simulation does.
"""

import argparse
from collections.abc import Callable

import mujoco
import numpy as np
from floor import ISOLATOR, floor_mjcf
from rounds import interleaved

import wirerope_mj as wr
from wirerope_mj.control import installed
from wirerope_mj.control import layout as at
from wirerope_mj.control.install import Kind

TIMESTEP = 1e-3
NATIVE, PYTHON, SPRINGS, BARE = "native callback", "Python callback", "24 site springs", "bare bodies"


def stepping(model: mujoco.MjModel, *, steps: int, speed: float) -> tuple[mujoco.MjData, Callable[[], None]]:
    """Return data and a function that makes `steps` steps from the same state: the floor moving at about `speed` [m/s]."""
    model.opt.timestep = TIMESTEP
    data = mujoco.MjData(model)
    start = np.array([0.5, 0.2, 1.0, 0.1, 0.05, 0.1]) * speed
    dofs = model.body_dofadr[model.body("floor").id] + np.arange(6)

    def work() -> None:
        observing = data.userdata.copy()
        mujoco.mj_resetData(model, data)
        data.userdata[:] = observing
        data.qvel[dofs] = start
        mujoco.mj_step(model, data, nstep=steps)

    return data, work


def contenders(n_mounts: int, *, steps: int) -> dict[str, Callable[[], None]]:
    system = wr.load_system(floor_mjcf(n_mounts), isolators={"bench": ISOLATOR})
    work: dict[str, Callable[[], None]] = {}
    kinds: dict[str, Kind] = {NATIVE: "native", PYTHON: "python"}
    for name, kind in kinds.items():
        data, step = stepping(system.model, steps=steps, speed=0.3)
        user = system.assembly.userdata
        data.userdata[user + at.OBSERVING] = 1.0
        data.userdata[user + at.STAGE_POINTS] = 1.0  # a deck driven with no acceleration: the table is read all the same
        work[name] = with_callback(system, data, kind, step)
    springs = mujoco.MjModel.from_xml_string(floor_mjcf(n_mounts, "linear springs"))
    work[SPRINGS] = stepping(springs, steps=steps, speed=0.3)[1]
    # Slow enough to stay where the stops' collision checks are as near as those of the mounted floors.
    bare = mujoco.MjModel.from_xml_string(floor_mjcf(n_mounts, "none"))
    work[BARE] = stepping(bare, steps=steps, speed=1e-3)[1]
    return work


def with_callback(system: wr.System, data: mujoco.MjData, kind: Kind, step: Callable[[], None]) -> Callable[[], None]:
    def work() -> None:
        with installed(system.model, data, kind):
            step()

    return work


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=11, help="rounds whose median is taken (default 11)")
    parser.add_argument("--steps", type=int, default=2000, help="steps per contender and round (default 2000)")
    arguments = parser.parse_args()
    print(f"RK4 steps of {TIMESTEP:g} s; medians of {arguments.rounds} interleaved rounds of {arguments.steps} steps")
    print(f"{'mounts':>6} | time per step [us]: native  python  springs   bare | native/bare  native/python  springs/native")
    every = {(n, name): work for n in (4, 8, 16, 32) for name, work in contenders(n, steps=arguments.steps).items()}
    medians = interleaved(every, rounds=arguments.rounds)  # type: ignore[arg-type,type-var]
    for n in (4, 8, 16, 32):
        native, python, springs, bare = (1e6 * medians[n, name] / arguments.steps for name in (NATIVE, PYTHON, SPRINGS, BARE))  # type: ignore[index]
        print(
            f"{n:6d} | {native:26.2f} {python:7.2f} {springs:8.2f} {bare:6.2f} |"
            f" {native / bare:11.2f} {native / python:14.2f} {springs / native:15.2f}"
        )


if __name__ == "__main__":
    main()
