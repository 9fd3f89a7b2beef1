"""Cost of the mounts: time per RK4 step of the floor with native and Python callback, springs, and bare bodies.

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
from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.install import Kind

TIMESTEP = 1e-3
BURST = 100
START = np.array([0.15, 0.06, 0.3, 0.03, 0.015, 0.03])  # velocity [m/s] and angular velocity [rad/s] of the floor
MOUNTS = (4, 8, 16, 32)
NATIVE, PYTHON, SPRINGS, BARE = "native", "Python", "springs", "bare"


def stepping(model: mujoco.MjModel, *, steps: int) -> tuple[mujoco.MjData, Callable[[], None]]:
    """Return data and a function that makes `steps` steps in bursts from one state: the floor rising and rocking.

    The bursts are so short that bare bodies too stay where mounted ones are: what flies away costs the engine another time.
    """
    model.opt.timestep = TIMESTEP
    data = mujoco.MjData(model)
    dofs = model.body_dofadr[model.body("floor").id] + np.arange(6)

    def work() -> None:
        for _ in range(steps // BURST):
            data.qpos[:], data.qvel[:], data.act[:], data.time = model.qpos0, 0.0, 0.0, 0.0
            data.qvel[dofs] = START
            mujoco.mj_step(model, data, nstep=BURST)

    return data, work


def contenders(n_mounts: int, *, steps: int) -> dict[str, Callable[[], None]]:
    system = wr.load_system(floor_mjcf(n_mounts), isolators={"bench": ISOLATOR})
    work: dict[str, Callable[[], None]] = {}
    kinds: dict[str, Kind] = {NATIVE: "native", PYTHON: "python"}
    for name, kind in kinds.items():
        data, step = stepping(system.model, steps=steps)
        user = system.assembly.userdata
        data.userdata[user + at.OBSERVING] = 1.0
        data.userdata[user + at.STAGE_POINTS] = 1.0  # a driven deck: its acceleration, zero, is read from the table
        work[name] = with_callback(system, data, kind, step)
    for name, mounts in ((SPRINGS, "linear springs"), (BARE, "none")):
        work[name] = stepping(mujoco.MjModel.from_xml_string(floor_mjcf(n_mounts, mounts)), steps=steps)[1]
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
    steps, rounds = arguments.steps, arguments.rounds
    every = {f"{n} {name}": work for n in MOUNTS for name, work in contenders(n, steps=steps).items()}
    medians = interleaved(every, rounds=rounds)
    print(f"RK4 steps of {TIMESTEP:g} s; time per step [us], medians of {rounds} interleaved rounds of {steps} steps")
    print("mounts  native  Python  springs    bare | native/bare  native/Python  springs/native")
    for n in MOUNTS:
        native, python, springs, bare = (1e6 * medians[f"{n} {name}"] / steps for name in (NATIVE, PYTHON, SPRINGS, BARE))
        times = f"{native:7.2f} {python:7.2f} {springs:8.2f} {bare:7.2f}"
        print(f"{n:6d} {times} | {native / bare:11.2f} {native / python:14.2f} {springs / native:15.2f}")


if __name__ == "__main__":
    main()
