"""The run of `wirerope study`: computes the study, writes pictures and worst variants, and prints the results."""

import sys
from collections.abc import Callable, Sequence
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Any

from rich.markup import escape

from wirerope_mj.cli.study_tables import print_search, print_study
from wirerope_mj.content.study_tables import varied_table
from wirerope_mj.engine.statics import model_warnings
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.studies.folder import dead
from wirerope_mj.studies.inputs_file import STUDY
from wirerope_mj.studies.measures import measure_names, unjudged_limits
from wirerope_mj.studies.result import NOT_COMPUTED, StudyResult
from wirerope_mj.studies.results.stated_file import read_stated, write_stated
from wirerope_mj.studies.results.stated_limits import limit_of_text, limit_statement
from wirerope_mj.studies.results.study_summary import summary_of
from wirerope_mj.studies.search.result import SearchResult
from wirerope_mj.studies.search.search import Search
from wirerope_mj.studies.study import Study
from wirerope_mj.studies.unknown_measure import unknown_measure
from wirerope_mj.views.terminal import console, print_table, print_warnings


def compute_and_print(
    make: Callable[[], Study | Search],
    name: str,
    *,
    resume: bool,
    out: Path | None,
    by: str | None,
    open_worst: int,
    limit: Sequence[str] | None = None,
    **how: Any,
) -> None:
    """Compute a study or a search and print its results.

    Args:
        make: returns the study.
        name: names its folder, unless `out` does.
        resume: whether the study in `out` goes on.
        out: its folder.
        by: measure by which variants are worst.
        open_worst: how many of them become runs and are opened.
        limit: limits on measures: how often each is exceeded is printed, and stands in the folder's summary.
        how: other arguments of `Study.run`.
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
    if unjudged := unjudged_limits(study.base):
        text = f"a study does not judge {', '.join(unjudged)}: it keeps peaks, and of clearances those of points"
        print_warnings([f"{text}. Name points at the corners."])
    print_table(varied_table(study.study if isinstance(study, Search) else study))
    folder = out or Path("runs") / f"{name}-{datetime.now():%Y%m%d-%H%M%S}"
    result = _computed(study, folder, resume=resume, **how)
    if limits:
        write_stated(result, limits)
    _print(result, by, open_worst)
    for stated in read_stated(result):
        console().print(f"  {escape(limit_statement(stated, result.independent, sampled=result.is_sampled))}")
    if dead(folder):  # tables and pictures are there, but a script must not take them for those of the whole study
        raise WireRopeError(f"{folder}: {NOT_COMPUTED}")


def _computed(study: Study | Search, folder: Path, **how: Any) -> StudyResult:
    """Return the result of a study of which at least one variant could be simulated."""
    try:
        result = study.run(folder, progress=True, **how)
    except KeyboardInterrupt:
        if not (folder / STUDY).is_file():
            raise
        text = f"what is done is kept; go on with the same options and --resume --out {folder}"
        raise KeyboardInterrupt(text) from None
    if len(result.failed) == result.table.num_rows:
        number, message = next(iter(result.failed.items()))
        raise ValueError(f"every variant failed; variant {number}: {message} The table is in {folder}.")
    return result


def _print(result: StudyResult, by: str | None, open_worst: int) -> None:
    """Write the pictures and the worst variants of a study or a search, print the results, and open them."""
    from wirerope_mj.runs.study import write_search_pictures, write_study_pictures, write_worst

    show: Callable[[Sequence[str]], None]
    if isinstance(result, SearchResult):
        write_search_pictures(result)
        by, show = by or result.minimise[0], partial(print_search, result)
    else:
        summary = summary_of(result, by)
        write_study_pictures(summary)
        by, show = summary.by, partial(print_study, summary)
    worst = write_worst(result, by, open_worst) if open_worst else []
    # What begins with a dot another process is writing just now.
    show(sorted(path.name for path in result.folder.glob("[!.]*") if path.is_file()))
    _open(worst)


def _open(paths: Sequence[Path]) -> None:
    """Print how the worst variants are opened, and open the first where there is a screen."""
    from wirerope_mj.views.recording.viewer import has_display, show

    for path in paths:
        effect = "opens the worst variants over each other" if path.suffix else "opens the view of a variant"
        console().print(f"  [bold]wirerope show {escape(str(path))}[/] {effect}", soft_wrap=True)
    if not paths:
        return
    if has_display() and sys.stdout.isatty():
        show(paths[0])
    elif not has_display():
        console().print("  there is no screen here: --web behind it shows them in a browser", soft_wrap=True)
