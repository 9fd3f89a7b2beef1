"""`wirerope run`: the options of a scenario become those of the command."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from wirerope_mj.cli.file_command import file_command, run_with_options
from wirerope_mj.cli.options import ALL, DECKS, NUMERICS, dated, own_option, with_numerics
from wirerope_mj.cli.tables import print_questions, run_and_print
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.payload_limits import limit_from_text
from wirerope_mj.runs.scenario import load_scenario, shipped_scenarios

_OWN = (
    own_option("out", Path | None, None, "folder of the run; runs/NAME-DATE-TIME if it is not given"),
    own_option("force", bool, False, "replace a run that is there", negative=()),
    own_option("state", bool, False, "keep every sample in the recording, too", negative=()),
    DECKS,
    ALL,
    own_option("combined_travel", bool, True, "judge mounts on all axes at once, by this program's own rule"),
    own_option(
        "limit", list[str] | None, None, negative=(),
        help_text='"acceleration/rack = 15 g" or "clearance/rack_top = 30 30 20 mm" of the payload, "load/m3 = 5 kN" of a '
        'mount, "force/s1 = 10 kN", "closing/s1 = 0.5 m/s" or "gap/s1 = 80 %" of its stops: a limit in place of the model\'s; '
        'with "stops = none" no stop may be touched',
    ),
)  # fmt: skip
_LIST = own_option("list", bool, False, "print the scenarios that ship with the package, and nothing else", negative=())


def list_scenarios() -> None:
    print_questions("scenario", {name: load_scenario(name).question for name in shipped_scenarios()})


@file_command(
    "SCENARIO", "the scenario comes first: wirerope run SCENARIO",
    "`wirerope run SCENARIO --help` also shows the options of that scenario.", [*NUMERICS, *_OWN, _LIST], list_scenarios,
)  # fmt: skip
def run(name: str, tokens: Sequence[str]) -> None:
    """Simulate a scenario into one folder and print its peaks against the limits.

    SCENARIO is the path of a scenario file or the name of one that ships with the package. The folder is
    runs/NAME-DATE-TIME unless --out names another; a run that is there is replaced only with --force.
    """
    scenario = load_scenario(name)
    # A scenario with an option of such a name decides itself what becomes of it.
    numerics = [option for option in NUMERICS if option.name not in scenario.defaults]

    def action(options: Entries, own: Entries) -> None:
        folder = own["out"] or dated(scenario.name)
        made = scenario.make(**options)
        simulate = with_numerics(made.simulate, **{option.name: own.get(option.name) for option in NUMERICS})
        combined = made.combined_travel and own["combined_travel"]
        limits = [*made.limits, *(limit_from_text(text) for text in own["limit"] or ())]
        made = replace(made, simulate=simulate, combined_travel=combined, limits=limits)
        run_and_print(made, folder, force=own["force"], every=own["all"], state=own["state"], decks=own["decks"])

    run_with_options(f"wirerope run {scenario.name}", scenario.function, [*numerics, *_OWN], action, tokens)
