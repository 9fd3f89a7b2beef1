"""`wirerope run`: the options of a scenario become those of the command."""

from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any

from cyclopts import App, Parameter

from wirerope_mj.cli.options import BAD_INPUT, NUMERICS, listing_options, own_option, run_with_options, with_numerics
from wirerope_mj.cli.printed_run import run_and_print
from wirerope_mj.cli.tables import print_questions
from wirerope_mj.foundation.payload_limits import limit_from_text
from wirerope_mj.runs.scenario import load_scenario, shipped_scenarios

LIMIT = (
    '"acceleration/rack = 15 g" or "clearance/rack_top = 30 30 20 mm": a limit of the payload, in place of the model\'s'
)

_OWN = (
    own_option("out", Path | None, None, "folder of the run; runs/NAME-DATE-TIME if it is not given"),
    own_option("force", bool, False, "replace a run that is there", negative=()),
    own_option("state", bool, False, "keep every sample in the recording, too", negative=()),
    own_option("combined_travel", bool, True, "judge mounts on all axes at once, by this program's own rule"),
    own_option("limit", list[str] | None, None, LIMIT, negative=()),
)


_LIST = own_option("list", bool, False, "print the scenarios that ship with the package, and nothing else", negative=())

# The scenario's own options are not known before its file is read: everything behind its name is handed on as it is.
run_app = App(
    name="run",
    usage="Usage: wirerope run SCENARIO [OPTIONS]",
    help_epilogue="`wirerope run SCENARIO --help` also shows the options of that scenario.",
    help_flags=[],
    version_flags=[],
    suppress_keyboard_interrupt=False,
)


@run_app.default
@listing_options([*NUMERICS, *_OWN, _LIST])
def run(*tokens: Annotated[str, Parameter(show=False, allow_leading_hyphen=True)]) -> int:
    """Simulate a scenario into one folder and print its peaks against the limits.

    SCENARIO is the path of a scenario file or the name of one that ships with the package. The folder is
    runs/NAME-DATE-TIME unless --out names another; a run that is there is replaced only with --force.
    """
    if not tokens or tokens[0] in ("--help", "-h"):
        from wirerope_mj.cli.app import app

        app.help_print(["run"])
        return 0 if tokens else BAD_INPUT
    if tokens[0] == "--list":
        list_scenarios()
        return 0
    if tokens[0].startswith("-"):
        raise ValueError(f"the scenario comes first: wirerope run SCENARIO {' '.join(tokens)}")
    run_command(tokens[0], tokens[1:])
    return 0


def list_scenarios() -> None:
    """Print name and question of the scenarios that ship with the package."""
    print_questions("scenario", {name: load_scenario(name).question for name in shipped_scenarios()})


def run_command(name: str, tokens: Sequence[str]) -> None:
    """Simulate the scenario called `name` with the options in `tokens`, and print what came out."""
    scenario = load_scenario(name)
    # A scenario with an option of such a name decides itself what becomes of it.
    numerics = [option for option in NUMERICS if option.name not in scenario.defaults]

    def action(options: dict[str, Any], own: dict[str, Any]) -> None:
        folder = own["out"] or Path("runs") / f"{scenario.name}-{datetime.now():%Y%m%d-%H%M%S}"
        made = scenario.make(**options)
        asked = {option.name: own.get(option.name) for option in NUMERICS}
        made = replace(made, simulate=with_numerics(made.simulate, **asked))
        limits = [limit_from_text(text) for text in own["limit"] or ()]
        made = replace(
            made, combined_travel=made.combined_travel and own["combined_travel"], limits=[*made.limits, *limits]
        )
        run_and_print(made, folder, force=own["force"], state=own["state"])

    run_with_options(f"wirerope run {scenario.name}", scenario.function, [*numerics, *_OWN], action, tokens)
