"""`wirerope study`: the options of a study file become those of the command."""

import inspect
import sys
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any, Literal, get_type_hints

from cyclopts import App, Parameter

from wirerope_mj.cli.tables import console, print_questions
from wirerope_mj.scenario import shipped_scenarios
from wirerope_mj.study.study_file import StudyFile, load_study_file, shipped_studies

OWN: dict[str, Any] = {
    "engine": "local", "keep": "peaks", "workers": None, "address": None, "resume": False, "out": None, "force": False,
    "by": None, "open_worst": 0,
}  # fmt: skip
"""Options of the command itself and their defaults; a study's own must have other names."""


def list_studies() -> None:
    """Print name and question of the studies that ship with the package."""
    print_questions("study", {name: load_study_file(name).question for name in shipped_studies()})


def study_command(name: str, tokens: Sequence[str]) -> None:
    """Compute the study called `name` with the options in `tokens`, and print what came out."""
    if name in shipped_scenarios():
        raise ValueError(
            f"{name!r} is a scenario, one run: wirerope run {name}. Studies: {', '.join(shipped_studies())}."
        )
    file = load_study_file(name)
    _app_of(file)(list(tokens), exit_on_error=False, print_error=False, result_action="return_value")


def _app_of(file: StudyFile) -> App:
    """Return a command whose options are those of the study, and how it is computed."""

    def command(**options: Any) -> None:
        own = {name: options.pop(name, default) for name, default in OWN.items()}
        _run(file, options, **own)

    hints = get_type_hints(file.function)
    declared = inspect.signature(file.function).parameters.values()
    taken = [option.name for option in declared if option.name in OWN]
    if taken:
        raise ValueError(f"{file.path}: `{taken[0]}` is an option of the command; the study's must have another name.")
    engine = "local: processes of this machine; dask: the workers of a cluster"
    how = [
        _option("engine", Literal["local", "dask"], engine),
        _option("keep", Literal["peaks", "responses"], "of each variant: its peaks, or its whole response, too"),
        _option("workers", int | None, "processes; one per processor if it is not given"),
        _option("address", str | None, "of a Dask scheduler that exists, tcp://HOST:8786 for instance"),
        _option("resume", bool, "go on with the study that stands in --out", negative=()),
        _option("out", Path | None, "folder of the study; runs/NAME-DATE-TIME if it is not given"),
        _option("force", bool, "replace a study that is there", negative=()),
        _option("by", str | None, "measure by which variants are worst; travel if anything is rated"),
        _option("open_worst", int, "write the worst variants as runs, and two or more as a comparison, too"),
    ]
    options = [option.replace(annotation=hints.get(option.name, type(option.default))) for option in declared]
    command.__signature__ = inspect.Signature([*options, *how])  # type: ignore[attr-defined]
    command.__annotations__ = {option.name: option.annotation for option in [*options, *how]}
    command.__doc__ = file.function.__doc__
    app = App(name=f"wirerope study {file.name}", version_flags=[], suppress_keyboard_interrupt=False)
    app.default(command)
    return app


def _option(name: str, kind: Any, words: str, **more: Any) -> inspect.Parameter:
    annotation = Annotated[kind, Parameter(help=words, **more)]
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=OWN[name], annotation=annotation)


def _run(
    file: StudyFile, options: dict[str, Any], *, engine: str, keep: str, workers: int | None, address: str | None,
    resume: bool, out: Path | None, force: bool, by: str | None, open_worst: int,
) -> None:  # fmt: skip
    from wirerope_mj.cli.study_tables import print_study
    from wirerope_mj.runfolder.study import checked_count, write_study_pictures, write_worst
    from wirerope_mj.study.answer import answer_of
    from wirerope_mj.study.folder import STUDY
    from wirerope_mj.study.measures import measure_names

    if resume and out is None:
        raise ValueError("--resume goes on with the study in a folder; say which one with --out FOLDER.")
    checked_count(open_worst)
    study = file.make(**options)
    names = measure_names(study.base)
    if by is not None and by not in names:
        raise ValueError(f"`--by`: there is no measure {by!r}; there are {', '.join(names[:8])}, ...")
    folder = out or Path("runs") / f"{file.name}-{datetime.now():%Y%m%d-%H%M%S}"
    try:
        result = study.run(
            folder, engine=engine, keep=keep, workers=workers, address=address, resume=resume, force=force,
            progress=sys.stderr.isatty(),
        )  # fmt: skip
    except KeyboardInterrupt:
        if (folder / STUDY).is_file():
            print(
                f"wirerope: what is done is kept; go on with the same options and --resume --out {folder}",
                file=sys.stderr,
            )
        raise
    if len(result.failed) == result.table.num_rows:
        number, message = next(iter(result.failed.items()))
        raise ValueError(f"every variant failed; variant {number}: {message} The table is in {folder}.")
    answer = answer_of(result, by)
    write_study_pictures(answer)
    worst = write_worst(result, answer.by, open_worst) if open_worst else []
    files = sorted(path.name for path in folder.iterdir() if path.is_file())
    print_study(answer, files)
    for path in worst:
        word = "opens the worst variants over each other" if path.suffix else "opens the view of a variant"
        console().print(f"  [bold]wirerope show {path}[/] {word}", soft_wrap=True)
