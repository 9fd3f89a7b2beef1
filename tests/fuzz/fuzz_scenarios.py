"""Scenarios: options of those that ship with wrong values and types, and hostile arguments of `simulate`."""

from functools import cache

import numpy as np
from campaign import Case
from hostile import pick

import wirerope_mj as wr
from wirerope_mj.runs import run_scenario
from wirerope_mj.runs.scenario import Scenario, load_scenario, shipped_scenarios

VALUES = (float("nan"), float("inf"), float("-inf"), 0, 0.0, -1.0, 1e-300, 1e300, 1e9, 1e6, 1e-9, 10**400, True, None)
VALUES += ("", "x", "z", "q", "nan", "native", [], [1.0], {}, (1, 2), "../..", "Ünï", 3, 1.5, b"z")

ARGUMENTS = ("duration", "sample_rate", "timestep", "accuracy", "initial", "callback", "corners", "out", "colour")


@cache
def files():
    """Return the scenario files that ship."""
    return tuple(load_scenario(name) for name in shipped_scenarios())


def mutate(rng, folder):
    """Return the case of a scenario with a few hostile options, or of hostile arguments."""
    if rng.random() < 0.5:
        file = pick(rng, files())
        options = {pick(rng, list(file.defaults)): pick(rng, VALUES) for _ in range(int(rng.integers(1, 3)))}
        if rng.random() < 0.05:
            options["colour"] = 1.0
        names = (file.path.name, file.name, *options, *file.defaults)
        return Case(f"{file.name} {options!r:.120}", {"file": file, "options": options}, names=names)
    arguments = {"duration": 0.01, "timestep": 1e-3, "sample_rate": 1000.0}
    for _ in range(int(rng.integers(1, 3))):
        arguments[pick(rng, ARGUMENTS)] = pick(rng, VALUES)
    if rng.random() < 0.1:
        del arguments["duration"]
    inputs = {"arguments": arguments, "folder": folder / "run"}
    return Case(f"simulate {arguments!r:.120}", inputs, names=(*ARGUMENTS, "step", "sdof_shaker", "samples", "state", "starts"))


def use(case):
    """Make the scenario and look at its motion, or simulate with the arguments."""
    if "file" in case.inputs:
        made = case.inputs["file"].make(**case.inputs["options"])
        motion = made.motion
        for name in ("acceleration", "velocity", "displacement"):
            if not np.isfinite(getattr(motion, name)(np.linspace(0.0, 0.1, 7))).all():
                return f"{name} is not finite"
        system = wr.load_system(made.model_source(), isolators=made.isolators)
        duration = made.simulate["duration"]
        if isinstance(duration, float) and (duration > 2.0 or motion.corners.size > 1000):
            return None  # a long run is a valid one
        arguments = {**made.simulate, "timestep": 5e-4}
        arguments["duration"] = min(duration, 0.002) if isinstance(duration, float) else duration
        response = wr.simulate(system, motion, **arguments)
    else:
        arguments = case.inputs["arguments"]
        motion = wr.HalfSine(peak=20.0, duration=0.002, direction="z")
        made = Scenario("does it hold?", "sdof_shaker.xml", motion, arguments)
        if isinstance(arguments.get("duration"), float) and arguments["duration"] > 1.0:
            arguments["duration"] = 0.005
        response = run_scenario(made, case.inputs["folder"])
    for name, mount in response.mounts.items():
        if not np.isfinite(mount.force).all():
            return f"mount {name}: forces are not finite"
    return None
