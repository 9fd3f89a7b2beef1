"""The scenario of a run, made again from the run's folder, for what else is asked of it."""

from pathlib import Path

from wirerope_mj.engine.system.named_files import check_inside
from wirerope_mj.runs.folder import SCENARIO
from wirerope_mj.runs.judging import read_judge_table
from wirerope_mj.runs.scenario import Scenario, ScenarioFile
from wirerope_mj.runs.scenario_file import scenario_content
from wirerope_mj.runs.sources import system_and_motion

_RESOLVED = ("engine",)
"""What a run's folder says of its simulation that nobody asked for: the engine that was chosen."""


def is_run(path: str | Path) -> bool:
    """Return whether a path is the folder of a run."""
    return (Path(path) / SCENARIO).is_file()


def stored_scenario(folder: str | Path) -> ScenarioFile:
    """Return the scenario of a run, which has no options; nothing outside the folder is read.

    Its step is chosen again for the accuracy of the run, if that was how it was chosen. It is called as the folder is.

    Raises:
        RecordError: the folder is not a run, or its files are damaged.
        ModelError: the model or an isolator in it is not what it must be.
    """
    folder = Path(folder)
    content = scenario_content(folder)
    system, motion = system_and_motion(folder, content)
    left_out = (*_RESOLVED, *(["timestep"] if "accuracy" in content["simulate"] else []))
    simulate = {key: value for key, value in content["simulate"].items() if key not in left_out}
    model = check_inside(folder, content["model"]).resolve()

    def scenario() -> Scenario:
        return Scenario(
            question=content["question"],
            model=model,
            motion=motion,
            simulate=simulate,
            changes=system.changes,
            **read_judge_table(content.get("judge", {})),
        )

    scenario.__doc__ = content["question"]
    return ScenarioFile(name=folder.resolve().name, path=(folder / SCENARIO).resolve(), function=scenario)
