"""`wirerope study`: a study file's options, or a scenario's and what varies of it, become those of the command."""

import inspect
import shlex
import sys
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Literal

from rich.markup import escape

from wirerope_mj.cli.file_command import file_command, run_with_options
from wirerope_mj.cli.options import ALL, dated, own_option
from wirerope_mj.cli.tables import DOCUMENT, print_questions, say_next, say_where
from wirerope_mj.content.study import varied_table
from wirerope_mj.engine.flexible import deck_of
from wirerope_mj.engine.statics import model_warnings
from wirerope_mj.engine.system import load_system
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError, StudyWarning, WireRopeError
from wirerope_mj.foundation.interrupts import resumed_by
from wirerope_mj.foundation.payload_limits import ON_MOUNTS
from wirerope_mj.runs.folder import SCENARIO
from wirerope_mj.runs.job_file import load_job
from wirerope_mj.runs.scenario import Scenario, ScenarioFile, defines, load_scenario, shipped_scenarios
from wirerope_mj.runs.scenario_file import is_run, stored_scenario
from wirerope_mj.runs.study import (
    VARIANTS,
    checked_count,
    limits_of,
    load_study_file,
    result_content,
    shipped_studies,
    study_job,
    study_of,
    what_can_vary,
    write_content,
    write_worst,
)
from wirerope_mj.studies.folder import dead_chunks
from wirerope_mj.studies.inputs_file import STUDY
from wirerope_mj.studies.measures import measure_names
from wirerope_mj.studies.result import NOT_COMPUTED, StudyResult
from wirerope_mj.studies.results.measure import unknown_measure
from wirerope_mj.studies.results.varied import limit_of_text, write_stated
from wirerope_mj.studies.search.search import Search
from wirerope_mj.studies.study import Study
from wirerope_mj.studies.vary.distributions import Distribution
from wirerope_mj.studies.vary.sampling import SAMPLINGS
from wirerope_mj.studies.vary.vary_option import EXAMPLE, read_vary
from wirerope_mj.views.terminal import console, print_block, print_lines, print_warnings, show_result

# Options of the computation of a study, and of a study that a scenario does not have.
_RUN = (
    own_option("engine", Literal["local", "dask"], "local", "local: processes of this machine; dask: the workers of a cluster"),
    own_option("workers", int | None, None, "processes; one per processor if it is not given"),
    own_option("address", str | None, None, "of a Dask scheduler that exists, tcp://HOST:8786 for instance"),
    own_option(
        "keep", Literal["peaks", "responses"], "peaks",
        "of each variant its peaks, or responses: every sample, too, in a file each",
    ),
    own_option("resume", bool, False, "go on with the study that stands in --out", negative=()),
    own_option("out", Path | None, None, "folder of the study; runs/NAME-DATE-TIME if it is not given"),
    ALL,
    own_option("force", bool, False, "replace a study that is there", negative=()),
    own_option("by", str | None, None, "measure by which variants are worst; by default the most critical one"),
    own_option(
        "limit", list[str] | None, None,
        '"deflection/*/roll = 35 mm": how often it is exceeded is said here and in the report', negative=(),
    ),
    own_option(
        "open_worst", int, 0, "0 to 6: write the worst variants as runs, lay two or more over each other, and open them"
    ),
)  # fmt: skip
_VARY = (
    own_option(
        "vary", list[str] | None, None, f'"{EXAMPLE}", once for each quantity; without it all that can vary is listed',
        negative=(),
    ),
    own_option(
        "deck", str | None, None,
        '"10 Hz 800 kg 4 %": a deck panel of that mass, frequency alone and damping ratio, in place of the rigid deck',
    ),
    own_option("variants", int | None, None, f"how many; {VARIANTS} unless a grid says it"),
    own_option("sampling", Literal[SAMPLINGS], "sobol", "how the variants are chosen"),
    own_option("seed", int, 1, "of the sampling"),
    own_option("timestep", float | None, None, "largest step [s], instead of the scenario's"),
    own_option("accuracy", float | None, None, "error of the peaks for which the step is chosen, instead of the scenario's"),
)  # fmt: skip
_LIST = own_option("list", bool, False, "print the studies that ship with the package, and nothing else", negative=())
_OTHER_NAME = "study_{}"  # Name of such an option if the scenario has one of its name


def list_studies() -> None:
    """Print name and question of the studies that ship with the package."""
    print_questions("study", {name: load_study_file(name).question for name in shipped_studies()})
    scenarios = ", ".join(shipped_scenarios())
    console().print(f'\nA scenario becomes a study with --vary "{EXAMPLE}":\n  {scenarios}', soft_wrap=True)


@file_command(
    "STUDY-OR-SCENARIO", "the study comes first: wirerope study STUDY",
    "`wirerope study NAME --help` also shows the options of that study.", [*_VARY, *_RUN, _LIST], list_studies,
)  # fmt: skip
def study(name: str, tokens: Sequence[str]) -> None:
    """Compute many variants of one system into one folder: what is likely, which inputs matter, which variants are worst.

    STUDY-OR-SCENARIO is the path of a study file or of a scenario file, or the name of one that ships with the package, or the
    folder of a run, which holds its scenario, or the file of a job (.toml): the same variants under every load case, and how
    often any limit of any of them is exceeded.

    A scenario becomes a study by what varies of it, said with --vary, once for each quantity; without --vary, all that can
    vary is listed. What varies in a study file, how many variants there are and how they are sampled the file says itself.

    A study that was interrupted goes on with the same options, --resume and --out FOLDER.
    """
    path = Path(name)
    if is_run(path):
        _of_scenario(stored_scenario(path), tokens)
    elif path.suffix.lower() == ".toml" and path.name != SCENARIO:
        _of_job(path, tokens)
    elif (
        defines(path, "scenario") and not defines(path, "study")
        if path.is_file()
        else name in shipped_scenarios() and name not in shipped_studies()
    ):
        _of_scenario(load_scenario(name), tokens)
    else:
        _check_known(name)
        if any(token.split("=")[0] == "--vary" for token in tokens):
            raise ValueError("`--vary` is for scenarios; what varies in a study file is said there.")
        file = load_study_file(name)
        _check_names(file.path, "study", file.function, _RUN)

        def action(options: Entries, own: Entries) -> None:
            compute_and_print(lambda: file.make(**options), file.name, **own)

        run_with_options(f"wirerope study {file.name}", file.function, _RUN, action, tokens)


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
        raise ModelError(f"{path}: this folder is no run, of which a study could be made; there is no {SCENARIO} in it.")
    if path.suffix or len(path.parts) > 1:
        raise ModelError(f"{name}: there is no such file.")
    raise ModelError(
        f"there is no study {name!r}. The package ships {', '.join(shipped_studies())}; with --vary a scenario is one, "
        f"too: {', '.join(shipped_scenarios())}; anything else must be the path of a Python file or the folder of a run."
    )


def _of_scenario(file: ScenarioFile, tokens: Sequence[str]) -> None:
    """Compute the study of a scenario; an option that the scenario has already is called study-... here."""
    _check_names(file.path, "scenario", file.function, _RUN)
    names = {one.name: _OTHER_NAME.format(one.name) if one.name in file.defaults else one.name for one in _VARY}
    vary = [option.replace(name=names[option.name]) for option in _VARY]

    def action(options: Entries, own: Entries) -> None:
        arguments = {name: own.pop(names[name]) for name in names}
        deck, scenario = arguments.pop("deck"), file.make(**options)
        if deck is not None:
            scenario = scenario.on_deck(deck_of(deck))
        can, cannot = limits_of(scenario)
        _warn_of_unjudged(cannot)
        named = {text.partition("=")[0].strip() for text in own["limit"] or ()}
        own["limit"] = [*(own["limit"] or ()), *(text for text in can if text.partition("=")[0].strip() not in named)]
        varied = arguments.pop("vary")
        compute_and_print(lambda: study_of(scenario, vary=_quantities(scenario, varied), **arguments), file.name, **own)

    run_with_options(f"wirerope study {file.name}", file.function, [*vary, *_RUN], action, tokens)


def _of_job(path: Path, tokens: Sequence[str]) -> None:
    """Compute the same variants under every load case of a job."""
    job = load_job(path)
    kept = [option for option in _RUN if option.name not in ("by", "limit", "open_worst")]

    def action(_: Entries, own: Entries) -> None:
        drawn = {name: own.pop(name) for name in ("variants", "sampling", "seed", "timestep", "accuracy")}
        folder, varied, every = own.pop("out") or Path("runs") / f"{path.stem}-study", own.pop("vary"), own.pop("all")
        if (deck := own.pop("deck")) is not None:
            raise ValueError(f"`--deck {deck}` is for a scenario; a job names its model.")
        first = job.cases[0].scenario
        print_warnings(model_warnings(load_system(first.model_source(), isolators=first.isolators)))
        _warn_of_unjudged(limits_of(first)[1])
        content = study_job(job, folder, vary=_quantities(first, varied), how={**own, "progress": True}, drawn=drawn)
        show_result(content, "cases", "answer", others=(), every=every)
        say_where(folder, every=every)
        say_next({("study-report", folder, "--pdf"): DOCUMENT})

    def none() -> None:
        """Compute the same variants under every load case of a job."""

    run_with_options(f"wirerope study {path}", none, [*_VARY, *kept], action, tokens)


def _warn_of_unjudged(limits: Sequence[str]) -> None:
    """Warn of limits of the model that a study does not judge, with a remedy."""
    if limits:
        forces = all(limit.startswith(ON_MOUNTS) for limit in limits)
        remedy = "judge single runs by it" if forces else "write it into the model, as limit/KIND/NAME"
        warnings.warn(f"a study does not judge {'; '.join(limits)}: {remedy}.", StudyWarning, stacklevel=3)


def _quantities(scenario: Scenario, vary: Sequence[str] | None) -> dict[str, Distribution]:
    """Read the quantities of `--vary`; ValueError lists all that can vary if there are none."""
    if not vary:
        raise ValueError(f"nothing varies yet. {what_can_vary(scenario)}")
    try:
        return read_vary(vary)
    except ValueError as error:
        raise ValueError(f"`--vary`: {error}") from None


def _check_names(path: Path, kind: str, function: Callable[..., object], own: Sequence[inspect.Parameter]) -> None:
    """Raise ValueError if an option of the file is called as one of the command."""
    names = {option.name for option in own}
    taken = [name for name in inspect.signature(function).parameters if name in names]
    if taken:
        raise ValueError(f"{path}: `{taken[0]}` is an option of the command; the {kind}'s must have another name.")


def compute_and_print(
    make: Callable[[], Study | Search], name: str, *, resume: bool, out: Path | None, by: str | None, open_worst: int,
    all: bool = False, limit: Sequence[str] | None = None, **how: Any,
) -> None:  # fmt: skip
    """Compute the study or search that `make` returns, and print its results.

    `name` is its folder's, unless `out` says it; `by` is the measure by which variants are worst, `open_worst` how many of them
    become runs and are opened; how often a `limit` is exceeded is printed, and stands in the folder's summary. `how` are other
    arguments of `Study.run`.
    """
    if resume and out is None:
        raise ValueError("--resume goes on with the study in a folder; say which one with --out FOLDER.")
    checked_count(open_worst)
    study = make()
    if by is not None and isinstance(study, Search):
        raise ValueError("`--by` is for studies: the designs of a search are ordered by what it minimises.")
    names = measure_names(study.base)
    if by is not None and by not in names:
        raise ValueError(f"`--by`: {unknown_measure(by, names)}")
    limits = [limit_of_text(text, names) for text in limit or ()]
    print_warnings(model_warnings(study.base))
    if all:
        print_block(varied_table(study.study if isinstance(study, Search) else study))
    folder = out or dated(name)
    worst: list[Path] = []

    def show(result: StudyResult) -> None:
        if limits:
            write_stated(result, limits)
        if len(result.failed) == result.variants:
            return
        content = result_content(result, by)
        show_result(content, "answer", others=("results", "inputs", "worst"), every=all)
        if not isinstance(study, Search):  # whose answer begins with it
            print_lines([result.message])
        write_content(content, result.folder)
        written = write_worst(result, by, open_worst) if open_worst else []
        worst.extend(path.relative_to(result.folder) for path in written)

    _computed(study, folder, resume=resume, when_done=show, **how)
    say_where(folder, every=all)
    say_next(
        {("study-report", folder, "--pdf"): DOCUMENT}, again="" if all else f"--resume --out {shlex.quote(str(folder))} --all"
    )
    _open([folder / path for path in worst])
    if dead_chunks(folder):  # tables and pictures are there, but a script must not take them for those of the whole study
        raise WireRopeError(f"{folder}: {NOT_COMPUTED}")


def _computed(study: Study | Search, folder: Path, **how: Any) -> StudyResult:
    """Compute a study, or go on with it; an interrupt says how to resume. ValueError if every variant failed."""
    replaces = how.get("force") and not how["resume"] and (folder / STUDY).is_file()

    def remedy() -> str:
        if replaces:
            return f"the study in {folder} is as it was before."
        kept = (folder / STUDY).is_file()
        return f"what is done is kept; go on with the same options and --resume --out {folder}" if kept else ""

    resumed_by(remedy)
    try:
        result = study.run(folder, progress=True, **how)
    except KeyboardInterrupt:
        if said := remedy():
            raise KeyboardInterrupt(said) from None
        raise
    if len(result.failed) == result.variants:
        number, message = next(iter(result.failed.items()))
        raise ValueError(f"every variant failed; variant {number}: {message} The table is in {folder}.")
    return result


def _open(paths: Sequence[Path]) -> None:
    """Print how the worst variants are opened, and open the first where there is a screen."""
    from wirerope_mj.views.recording.program import has_display
    from wirerope_mj.views.recording.viewer import show as open_viewer

    for path in paths:
        effect = "opens the worst variants over each other" if path.suffix else "opens the view of a variant"
        console().print(f"  [bold]wirerope show {escape(str(path))}[/] {effect}", soft_wrap=True)
    if paths and not has_display():
        console().print("  there is no screen here: --web behind it shows them in a browser", soft_wrap=True)
    elif paths and sys.stdout.isatty():
        open_viewer(paths[0])
