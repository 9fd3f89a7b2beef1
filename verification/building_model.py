"""The building as a system of the library: six levels above each other on a table, one mount for all of its isolators."""

import csv
import tempfile
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import wirerope_mj as wr
from verification.building_data import LEVELS, Motion
from verification.models import deck, mjcf, mounts
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.laws import Law


@dataclass(frozen=True, kw_only=True)
class Storeys:
    """What stands between the levels, each of unit mass: stiffness [1/s^2] and damping [1/s] of five storeys, from below."""

    stiffness: Array
    damping: Array


def building(law: Law, storeys: Storeys) -> wr.System:
    """Make the system: a table that slides along x, and six levels of 1 kg, each on a slide along x of the one below it."""
    world = deck({"below": 'pos="0 0 .2"'}, slides="x")
    inner = ""
    for i in reversed(range(LEVELS)):
        spring = f'stiffness="{float(storeys.stiffness[i - 1])!r}" damping="{float(storeys.damping[i - 1])!r}"' if i else ""
        site = "" if i else '<site name="above" pos="0 0 -.1"/>'
        inner = (
            f'<body name="level{i}" pos="0 0 {0.3 if i == 0 else 0.2!r}"><joint type="slide" axis="1 0 0" {spring}/>'
            f'<geom size=".05" mass="1"/>{site}{inner}</body>'
        )
    isolator = wr.Isolator(name="bearings", roll=law)
    return wr.load_system(
        mjcf(world + inner, custom=mounts([("bearings", "above", "below", "bearings")])),
        isolators={"bearings": isolator},
    )


def base_motion(time: Array, acceleration: Array) -> BaseMotion:
    """Return the table's motion along x as the library reads it from a file."""
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore", wr.RecordWarning)  # of drift: only relative motions are looked at
        path = Path(folder) / "table.csv"
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(["time [s]", "x [m/s^2]"])
            writer.writerows(zip(time.tolist(), acceleration.tolist(), strict=True))
        return wr.load_record(path)


@dataclass(frozen=True, kw_only=True)
class Prediction:
    """Calculated as `Motion` has it measured: absolute accelerations and displacements relative to the table, (n_t, 6)."""

    acceleration: Array
    displacement: Array


def predict(systems: Sequence[wr.System], motion: Motion) -> list[Prediction]:
    """Simulate systems of one layout under the acceleration of a test's table, two steps to a sample."""
    rate = 1.0 / motion.interval
    results = wr.simulate_batch(
        systems,
        base_motion(motion.time, motion.table),
        duration=float(motion.time[-1]),
        timestep=0.5 * motion.interval,
        initial="unloaded",
        sample_rate=rate,
        responses=True,
        judged=False,  # half the step moves peaks by 0.1 %, a tenth of what the model is off
    )
    found = []
    for result in results:
        if isinstance(result, wr.BatchFailure):
            raise result.error
        response = result.response
        assert response is not None
        levels = [response.bodies[f"level{i}"] for i in range(LEVELS)]
        base = response.base.displacement[:, 0]
        found.append(
            Prediction(
                acceleration=np.column_stack([level.acceleration[:, 0] for level in levels]),
                displacement=np.column_stack([level.position[:, 0] - level.position[0, 0] - base for level in levels]),
            )
        )
    return found
