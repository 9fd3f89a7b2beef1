"""`wirerope run`: the options of a scenario become those of the command."""

import inspect
import sys
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from time import perf_counter
from typing import Annotated, Any, get_type_hints

from cyclopts import App, Parameter

from wirerope_mj.cli.tables import print_questions, print_run
from wirerope_mj.scenario import ScenarioFile, load_scenario, shipped_scenarios


def list_scenarios() -> None:
    """Print name and question of the scenarios that ship with the package."""
    print_questions("scenario", {name: load_scenario(name).question for name in shipped_scenarios()})


def run_command(name: str, tokens: Sequence[str]) -> None:
    """Simulate the scenario called `name` with the options in `tokens`, and print what came out."""
    scenario = load_scenario(name)
    _app_of(scenario)(list(tokens), exit_on_error=False, print_error=False, result_action="return_value")


def _app_of(scenario: ScenarioFile) -> App:
    """Return a command whose options are those of the scenario, and where the run is written."""

    def command(**options: Any) -> None:
        out, force = options.pop("out", None), options.pop("force", False)
        _run(scenario, options, out=out, force=force)

    hints = get_type_hints(scenario.function)
    own = inspect.signature(scenario.function).parameters.values()
    where = [
        _option("out", Path | None, None, "folder of the run; runs/NAME-DATE-TIME if it is not given"),
        _option("force", bool, False, "replace a run that is there", negative=()),
    ]
    options = [option.replace(annotation=hints.get(option.name, type(option.default))) for option in own]
    command.__signature__ = inspect.Signature([*options, *where])  # type: ignore[attr-defined]
    command.__annotations__ = {option.name: option.annotation for option in [*options, *where]}
    command.__doc__ = scenario.function.__doc__
    app = App(name=f"wirerope run {scenario.name}", version_flags=[], suppress_keyboard_interrupt=False)
    app.default(command)
    return app


def _option(name: str, kind: Any, default: Any, words: str, **more: Any) -> inspect.Parameter:
    annotation = Annotated[kind, Parameter(help=words, **more)]
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)


def _run(scenario: ScenarioFile, options: dict[str, Any], *, out: Path | None, force: bool) -> None:
    from wirerope_mj.runfolder import run_scenario

    folder = out or Path("runs") / f"{scenario.name}-{datetime.now():%Y%m%d-%H%M%S}"
    made = scenario.make(**options)
    started = perf_counter()
    response = run_scenario(made, folder, force=force, progress=sys.stderr.isatty())
    print_run(made, response, folder, seconds=perf_counter() - started)
