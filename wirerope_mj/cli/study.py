"""`wirerope study`: a study file's options, or a scenario's and what varies of it, become those of the command."""

import inspect
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import App, Parameter

from wirerope_mj.cli.exit_codes import BAD_INPUT
from wirerope_mj.cli.function_options import listing_options, own_option, run_with_options
from wirerope_mj.cli.study_run import compute_and_print
from wirerope_mj.cli.tables import print_questions
from wirerope_mj.foundation.errors import ModelError, StudyWarning
from wirerope_mj.runs.folder import SCENARIO
from wirerope_mj.runs.from_scenario import VARIANTS, limits_of, study_of, what_can_vary
from wirerope_mj.runs.option_file import defines
from wirerope_mj.runs.scenario import Scenario, ScenarioFile, load_scenario, shipped_scenarios
from wirerope_mj.runs.sources import is_run, stored_scenario
from wirerope_mj.runs.study_file import StudyFile, load_study_file, shipped_studies
from wirerope_mj.studies.inputs.sampling import SAMPLINGS
from wirerope_mj.studies.inputs.vary_option import EXAMPLE, read_vary
from wirerope_mj.studies.inputs_file import STUDY
from wirerope_mj.studies.study import Study
from wirerope_mj.views.terminal import console

_RUN = (
    own_option(
        "engine", Literal["local", "dask"], "local", "local: processes of this machine; dask: the workers of a cluster"
    ),
    own_option("workers", int | None, None, "processes; one per processor if it is not given"),
    own_option("address", str | None, None, "of a Dask scheduler that exists, tcp://HOST:8786 for instance"),
    own_option(
        "keep",
        Literal["peaks", "responses"],
        "peaks",
        "of each variant its peaks, or responses: every sample, too, in a file each",
    ),
    own_option("resume", bool, False, "go on with the study that stands in --out", negative=()),
    own_option("out", Path | None, None, "folder of the study; runs/NAME-DATE-TIME if it is not given"),
    own_option("force", bool, False, "replace a study that is there", negative=()),
    own_option("by", str | None, None, "measure by which variants are worst; travel if anything is rated"),
    own_option(
        "limit",
        list[str] | None,
        None,
        '"deflection/*/roll = 35 mm": how often it is exceeded is said here and in the report',
        negative=(),
    ),
    own_option(
        "open_worst", int, 0, "0 to 6: write the worst variants as runs, lay two or more over each other, and open them"
    ),
)
"""Options of the computation of a study."""

_VARY = (
    own_option(
        "vary", list[str] | None, None, f'"{EXAMPLE}", once for each quantity; without it all that can vary is listed',
        negative=(),
    ),
    own_option("variants", int | None, None, f"how many; {VARIANTS} unless a grid says it"),
    own_option("sampling", Literal[SAMPLINGS], "sobol", "how the variants are chosen"),
    own_option("seed", int, 1, "of the sampling"),
    own_option("timestep", float | None, None, "largest step [s], instead of the scenario's"),
    own_option("accuracy", float | None, None, "error of the peaks for which the step is chosen, instead of the scenario's"),
)  # fmt: skip
"""Options of a study that a scenario does not have."""

_OTHER_NAME = "study_{}"
"""Name of such an option if the scenario has one of its name."""


_LIST = own_option("list", bool, False, "print the studies that ship with the package, and nothing else", negative=())

study_app = App(
    name="study",
    usage="Usage: wirerope study STUDY-OR-SCENARIO [OPTIONS]",
    help_epilogue="`wirerope study NAME --help` also shows the options of that study.",
    help_flags=[],
    version_flags=[],
    suppress_keyboard_interrupt=False,
)


@study_app.default
@listing_options([*_VARY, *_RUN, _LIST])
def study(*tokens: Annotated[str, Parameter(show=False, allow_leading_hyphen=True)]) -> int:
    """Compute many variants of one system into one folder: what is likely, which inputs matter, which variants are worst.

    STUDY-OR-SCENARIO is the path of a study file or of a scenario file, or the name of one that ships with the package, or the
    folder of a run, which holds its scenario.

    A scenario becomes a study by what varies of it, said with --vary, once for each quantity; without --vary, all that can
    vary is listed. What varies in a study file, how many variants there are and how they are sampled the file says itself.

    A study that was interrupted goes on with the same options, --resume and --out FOLDER.
    """
    if not tokens or tokens[0] in ("--help", "-h"):
        from wirerope_mj.cli.app import app

        app.help_print(["study"])
        return 0 if tokens else BAD_INPUT
    if tokens[0] == "--list":
        list_studies()
        return 0
    if tokens[0].startswith("-"):
        raise ValueError(f"the study comes first: wirerope study STUDY {' '.join(tokens)}")
    study_command(tokens[0], tokens[1:])
    return 0


def list_studies() -> None:
    """Print name and question of the studies that ship with the package."""
    print_questions("study", {name: load_study_file(name).question for name in shipped_studies()})
    console().print(
        f'\nA scenario becomes a study with --vary "{EXAMPLE}":\n  {", ".join(shipped_scenarios())}', soft_wrap=True
    )


def study_command(name: str, tokens: Sequence[str]) -> None:
    """Compute the study called `name`, or that of the scenario or the run called so, with the options in `tokens`."""
    path = Path(name)
    if is_run(path):
        _of_scenario(stored_scenario(path), tokens)
        return
    if path.is_file():
        of_scenario = defines(path, "scenario") and not defines(path, "study")
    else:
        of_scenario = name in shipped_scenarios() and name not in shipped_studies()
    if of_scenario:
        _of_scenario(load_scenario(name), tokens)
        return
    _check_known(name)
    if any(token.split("=")[0] == "--vary" for token in tokens):
        raise ValueError("`--vary` is for scenarios; what varies in a study file is said there.")
    _of_file(load_study_file(name), tokens)


def _check_known(name: str) -> None:
    """Raise ModelError if there is neither such a file nor such a study; a file of a run is answered with its folder."""
    path = Path(name)
    if path.name == SCENARIO and is_run(path.parent):
        raise ModelError(f"{path}: name the folder of the run instead: wirerope study {path.parent}")
    if path.is_file() or name in shipped_studies():
        return
    if (path / STUDY).is_file():
        raise ModelError(
            f"{path}: this is the folder of a study that was computed. `wirerope study-report {path}` makes its report; a "
            f"study that was interrupted goes on with the command that began it and --resume --out {path}."
        )
    if path.is_dir():
        raise ModelError(
            f"{path}: this folder is no run, of which a study could be made; there is no {SCENARIO} in it."
        )
    if path.suffix or len(path.parts) > 1:
        raise ModelError(f"{name}: there is no such file.")
    raise ModelError(
        f"there is no study {name!r}. The package ships {', '.join(shipped_studies())}; with --vary a scenario is one, "
        f"too: {', '.join(shipped_scenarios())}; anything else must be the path of a Python file or the folder of a run."
    )


def _of_file(file: StudyFile, tokens: Sequence[str]) -> None:
    """Compute the study of a study file."""
    _check_names(file.path, "study", file.function, _RUN)

    def action(options: dict[str, Any], own: dict[str, Any]) -> None:
        compute_and_print(lambda: file.make(**options), file.name, **own)

    run_with_options(f"wirerope study {file.name}", file.function, _RUN, action, tokens)


def _of_scenario(file: ScenarioFile, tokens: Sequence[str]) -> None:
    """Compute the study of a scenario; an option that the scenario has already is called study-... here."""
    _check_names(file.path, "scenario", file.function, _RUN)
    names = {one.name: _OTHER_NAME.format(one.name) if one.name in file.defaults else one.name for one in _VARY}
    vary = [option.replace(name=names[option.name]) for option in _VARY]

    def action(options: dict[str, Any], own: dict[str, Any]) -> None:
        arguments = {name: own.pop(names[name]) for name in names}
        scenario = file.make(**options)
        own["limit"] = _limits(scenario, own["limit"] or [])
        compute_and_print(lambda: _study(scenario, **arguments), file.name, **own)

    run_with_options(f"wirerope study {file.name}", file.function, [*vary, *_RUN], action, tokens)


def _limits(scenario: Scenario, given: Sequence[str]) -> list[str]:
    """Return the limits that are given, and behind them the scenario's on other measures; warn of what is not judged."""
    can, cannot = limits_of(scenario)
    if cannot:
        text = (
            f"a study does not judge {'; '.join(cannot)}: it keeps peaks, and of clearances those of points alone, and no "
            "accelerations along an axis."
        )
        warnings.warn(text, StudyWarning, stacklevel=2)
    names = {text.partition("=")[0].strip() for text in given}
    return [*given, *(text for text in can if text.partition("=")[0].strip() not in names)]


def _study(scenario: Scenario, *, vary: Sequence[str] | None, **rest: Any) -> Study:
    if not vary:
        raise ValueError(f"nothing varies yet. {what_can_vary(scenario)}")
    try:
        quantities = read_vary(vary)
    except ValueError as error:
        raise ValueError(f"`--vary`: {error}") from None
    return study_of(scenario, vary=quantities, **rest)


def _check_names(path: Path, kind: str, function: Callable[..., Any], own: Sequence[inspect.Parameter]) -> None:
    """Raise ValueError if an option of the file is called as one of the command."""
    names = {option.name for option in own}
    taken = [name for name in inspect.signature(function).parameters if name in names]
    if taken:
        raise ValueError(f"{path}: `{taken[0]}` is an option of the command; the {kind}'s must have another name.")
