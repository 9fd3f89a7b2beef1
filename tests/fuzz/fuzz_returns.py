"""Functions of scenario files that return something else than a scenario, or one with something else somewhere inside."""

import numpy as np
from campaign import Case
from hostile import pick

import wirerope_mj as wr
from wirerope_mj.engine.system.varied import with_changes
from wirerope_mj.runs.scenario import load_scenario
from wirerope_mj.runs.scenario_file import judged_by
from wirerope_mj.runs.write import checked_arguments

VALUES = (
    "None",
    "3",
    "2.5",
    "float('nan')",
    "float('inf')",
    "-1.0",
    "0",
    "1e308",
    "10**400",
    "True",
    "'text'",
    "b'x'",
    "[]",
    "[1]",
    "[None]",
    "{}",
    "{1: 2}",
    "{'a': 1}",
    "()",
    "set()",
    "object()",
    "wr",
    "len",
    "lambda: 0",
    "wr.HalfSine",
    "motion",
    "motion + motion",
    "wr.load_system('sdof_shaker')",
    "Silent()",
    "1j",
    "'\\0'",
    "'x' * 5000",
    "wr.BoucWen",
    "[motion]",
    "Exception('x')",
    "...",
    "range(3)",
    "(x for x in [1])",
    "__import__('numpy').zeros(3)",
    "__import__('numpy').float64(0.01)",
    "__import__('pathlib').Path()",
)
PLACES = (
    "question",
    "model",
    "motion",
    "simulate",
    "isolators",
    "name",
    "options",
    "folder",
    "changes",
    "combined_travel",
    "limits",
)
ARGUMENTS = (
    "duration",
    "sample_rate",
    "timestep",
    "accuracy",
    "initial",
    "callback",
    "engine",
    "corners",
    "colour",
    "out",
    "progress",
)
CALLS = (
    "wr.HalfSine(peak={}, duration=0.01, direction='z')",
    "wr.HalfSine(peak=1.0, duration={}, direction='z')",
    "wr.HalfSine(peak=1.0, duration=0.01, direction={})",
    "wr.Sine(frequency={}, acceleration=1.0, direction='z')",
    "motion + {}",
    "wr.Sweep(start=1, stop=2, rate={}, acceleration=1.0, direction='z')",
    "wr.RandomVibration(psd={}, duration=1.0, seed=1, direction='z')",
    "wr.RandomVibration(psd=[(20, 1), (50, 1)], duration=1.0, seed={}, direction='z')",
    "wr.DecayingSine(frequency=10, damping={}, velocity=1.0, direction='z')",
)
FILE = '''"""Does it hold?"""
import wirerope_mj as wr
class Silent:
    def __repr__(self):
        raise RuntimeError
motion = wr.HalfSine(peak=10.0, duration=0.01, direction="z")
good = {{"question": "?", "model": "sdof_shaker", "motion": motion, "simulate": {{"duration": 0.01, "timestep": 1e-3}}}}
def scenario(*, level: float = 1.0) -> wr.Scenario:
    return {returned}
'''


def mutate(rng: np.random.Generator, folder) -> Case:
    """Write a scenario with a wrong value in one or two places."""
    value, kind = pick(rng, VALUES), rng.random()
    if kind < 0.08:
        returned = value
    elif kind < 0.45:
        changes = {pick(rng, PLACES): pick(rng, VALUES) for _ in range(pick(rng, (1, 1, 2)))}
        returned = "wr.Scenario(**(good | {" + ", ".join(f"{key!r}: {text}" for key, text in changes.items()) + "}))"
    elif kind < 0.7:
        argument = f"{pick(rng, ARGUMENTS)!r}: {value}"
        returned = f"wr.Scenario(**(good | {{'simulate': {{'duration': 0.01, 'timestep': 1e-3, {argument}}}}}))"
    elif kind < 0.85:
        returned = f"wr.Scenario(**(good | {{'motion': {pick(rng, CALLS).format(value)}}}))"
    elif kind < 0.95:
        text = pick(
            rng,
            (
                "'limits': [{}]",
                "'limits': [{0}, {0}]",
                "'isolators': {{'sdof_36hz': {}}}",
                "'changes': [{}]",
            ),
        )
        returned = f"wr.Scenario(**(good | {{{text.format(value)}}}))"
    else:
        returned = f"wr.Scenario({value}, {pick(rng, VALUES)}, {pick(rng, VALUES)}, {pick(rng, VALUES)})"
    path = folder / "mine.py"
    path.write_text(FILE.format(returned=returned), encoding="utf-8")
    return Case(returned[:150], {"path": path}, (path.name, "mine", "model", "limit", *ARGUMENTS))


def use(case: Case) -> str | None:
    """Do what a run does before it writes anything, and the run itself."""
    scenario = load_scenario(case.inputs["path"]).make()
    arguments = checked_arguments(scenario)
    system = with_changes(wr.load_system(scenario.model_source(), isolators=scenario.isolators), scenario.changes)
    system = judged_by(system, combined_travel=scenario.combined_travel, limits=scenario.limits)
    if float(arguments["duration"]) * float(arguments.get("sample_rate", 1000.0)) > 1e5 or scenario.motion.corners.size > 1e5:
        return None  # a long run is a valid one
    response = wr.simulate(system, scenario.motion, **arguments)
    forces = [mount.force for mount in response.mounts.values()]
    return None if all(np.isfinite(force).all() for force in forces) else "forces are not finite"
