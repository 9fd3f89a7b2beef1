"""`wirerope explore`: a scenario behind sliders, in a browser of this machine."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from wirerope_mj.cli.file_command import file_command, run_with_options
from wirerope_mj.cli.options import NUMERICS, own_option, with_numerics

_OWN = (
    own_option("browser", bool, True, "open the page; its address is printed in any case", negative="--no-browser"),
    own_option("viewer", bool, True, "show the recording of the last two runs in the page", negative="--no-viewer"),
    own_option("port", int, 0, "on which the page is served; a free one if it is not given"),
)  # fmt: skip


@file_command(
    "SCENARIO-OR-MODEL",
    "the scenario or the model comes first: wirerope explore SCENARIO-OR-MODEL",
    "`wirerope explore SCENARIO-OR-MODEL --help` also shows the options of that scenario or model.",
    [*NUMERICS, *_OWN],
)
def explore(name: str, tokens: Sequence[str]) -> None:
    """Move sliders in a page of this machine and see verdict, curves and recording change: a what-if.

    SCENARIO-OR-MODEL is a scenario as `wirerope run` takes it, a model, whose base is then struck by a half-sine, or the folder
    of a run: the channels of tests that it was compared with are drawn below the curves of every new run. The page
    has sliders for the level and the direction of the base motion, the payload's mass, the stiffness of each kind of isolator
    and the damping. It is served on this machine alone, and nothing is sent anywhere. Ctrl-C ends it.
    """
    from wirerope_mj.runs.explore import Exploration, scenario_or_model

    file = scenario_or_model(name)
    numerics = [option for option in NUMERICS if option.name not in file.defaults]

    def action(options: dict[str, Any], own: dict[str, Any]) -> None:
        made = file.make(**options)
        asked = {option.name: own.get(option.name) for option in NUMERICS}
        made = replace(made, simulate=with_numerics(made.simulate, **asked))
        from wirerope_mj.runs.measured import tests_of
        from wirerope_mj.views.explore.server import serve

        if not 0 <= own["port"] < 65536:
            raise ValueError(f"`--port` must be from 0 to 65535, got {own['port']}.")
        print(f"Simulating {made.name} once ...", flush=True)
        explored = Exploration(made, tests_of(Path(name)))
        try:
            serve(explored, browser=own["browser"], viewer=own["viewer"], port=own["port"])
        finally:
            explored.close()

    run_with_options(f"wirerope explore {file.name}", file.function, [*numerics, *_OWN], action, tokens)
