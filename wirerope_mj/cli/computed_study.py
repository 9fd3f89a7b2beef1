"""Compute a study or a search, print its results, and open its worst variants."""

import sys
from collections.abc import Callable, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

from rich.markup import escape

from wirerope_mj.cli.tables import say_where
from wirerope_mj.content.study import varied_table
from wirerope_mj.engine.statics import model_warnings
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.studies.folder import dead
from wirerope_mj.studies.inputs_file import STUDY
from wirerope_mj.studies.measures import measure_names
from wirerope_mj.studies.result import NOT_COMPUTED, StudyResult
from wirerope_mj.studies.results.measure import unknown_measure
from wirerope_mj.studies.results.stated_limits import limit_of_text, write_stated
from wirerope_mj.studies.search.search import Search
from wirerope_mj.studies.study import Study
from wirerope_mj.views.terminal import console, print_block, print_warnings, show_answer


def compute_and_print(
    make: Callable[[], Study | Search], name: str, *, resume: bool, out: Path | None, by: str | None, open_worst: int,
    limit: Sequence[str] | None = None, **how: Any,
) -> None:  # fmt: skip
    """Compute the study or search that `make` returns, and print its results.

    `name` is its folder's, unless `out` says it; `by` is the measure by which variants are worst, `open_worst` how many of them
    become runs and are opened; how often a `limit` is exceeded is printed, and stands in the folder's summary. `how` are other
    arguments of `Study.run`.
    """
    from wirerope_mj.runs.study import checked_count

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
    print_block(varied_table(study.study if isinstance(study, Search) else study))
    folder = out or Path("runs") / f"{name}-{datetime.now():%Y%m%d-%H%M%S}"
    result = _computed(study, folder, resume=resume, **how)
    if limits:
        write_stated(result, limits)
    _show(result, by, open_worst)
    if dead(folder):  # tables and pictures are there, but a script must not take them for those of the whole study
        raise WireRopeError(f"{folder}: {NOT_COMPUTED}")


def _computed(study: Study | Search, folder: Path, **how: Any) -> StudyResult:
    """Return the result of a study of which at least one variant could be simulated."""
    try:
        result = study.run(folder, progress=True, **how)
    except KeyboardInterrupt:
        if not (folder / STUDY).is_file():
            raise
        raise KeyboardInterrupt(f"what is done is kept; go on with the same options and --resume --out {folder}") from None
    if len(result.failed) == result.table.num_rows:
        number, message = next(iter(result.failed.items()))
        raise ValueError(f"every variant failed; variant {number}: {message} The table is in {folder}.")
    return result


def _show(result: StudyResult, by: str | None, open_worst: int) -> None:
    """Print a study or a search, write its pictures and worst variants, and open these."""
    from wirerope_mj.runs.study import result_content, write_content, write_worst

    content = result_content(result, by)
    console().print(f"\n[bold]{escape(result.study.name)}[/]  {escape(result.message)}")
    show_answer(content, "results", "inputs", "worst")
    write_content(content, result.folder)
    worst = write_worst(result, by, open_worst) if open_worst else []
    print()
    # What begins with a dot another process is writing just now.
    say_where(f"{result.folder}/", sorted(path.name for path in result.folder.glob("[!.]*") if path.is_file()))
    _open(worst)


def _open(paths: Sequence[Path]) -> None:
    """Print how the worst variants are opened, and open the first where there is a screen."""
    from wirerope_mj.views.recording.viewer import has_display
    from wirerope_mj.views.recording.viewer import show as open_viewer

    for path in paths:
        effect = "opens the worst variants over each other" if path.suffix else "opens the view of a variant"
        console().print(f"  [bold]wirerope show {escape(str(path))}[/] {effect}", soft_wrap=True)
    if paths and not has_display():
        console().print("  there is no screen here: --web behind it shows them in a browser", soft_wrap=True)
    elif paths and sys.stdout.isatty():
        open_viewer(paths[0])
