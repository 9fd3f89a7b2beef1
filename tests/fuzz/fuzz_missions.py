"""Service lives as files, for `wirerope durability`."""

import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import tomli_w
from campaign import Case
from edits import damaged
from hostile import pick

import wirerope_mj as wr
from wirerope_mj.assessment.durability.mission import mission_damage, read_mission

VALUES = (
    True,
    3,
    2.5,
    float("nan"),
    float("inf"),
    -1.0,
    0.0,
    1e300,
    1e-300,
    1e3,
    2,
    10**18,
    7,
    "",
    "x",
    "run",
    [],
    {},
    [1.0],
    "force",
)


@cache
def run() -> Path:
    """Return the folder of a short run, once a process."""
    folder = Path(tempfile.mkdtemp(prefix="fuzz-mission-"))
    sine = wr.Sine(frequency=8.0, acceleration=3.0, direction="z", duration=0.5)
    wr.simulate(wr.load_system("sdof_shaker"), sine, duration=0.6, timestep=1e-3).save(folder)
    return folder


def mutate(rng: np.random.Generator, folder) -> Case:
    """Write a service life with strange values, missing or unknown keys, or damaged bytes."""
    stages = [{"run": str(run()), pick(rng, ("repetitions", "hours")): 10.0} for _ in range(int(rng.integers(1, 3)))]
    content = {"exponent": 4.0, "constant": 1e-3, "quantity": "deflection", "stage": stages}
    for _ in range(pick(rng, (0, 1, 1, 2))):
        holder = pick(rng, (content, content, *stages))
        kind, key = rng.integers(6), pick(rng, list(holder))
        if kind == 0:
            holder.pop(key)
        elif kind == 1:
            holder["strange"] = 1
        else:
            holder[key] = pick(rng, VALUES)
    data = tomli_w.dumps(content).encode()
    path = folder / "life.toml"
    path.write_bytes(damaged(rng, data) if rng.random() < 0.1 else data)
    return Case(f"{content!r:.200}", {"path": path, "content": content}, (path.name, "run", "folder", "exponent", "quantity"))


def use(case: Case) -> str | None:
    """Count the damage, and that of another exponent, constant and number of repetitions."""
    mission = read_mission(case.inputs["path"])
    damages = mission_damage(mission)
    for one in damages:
        if not np.isfinite([one.total, one.cycles, one.largest_range]).all():
            return "damage is not finite"
        if one.cycles > 0.0 and one.largest_range > 0.0 and not one.total > 0.0:
            return "cycles without damage"
    return None
