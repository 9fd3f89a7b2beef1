"""`wirerope compare`: two or more runs over each other, as tables and one recording; or two jobs, case by case."""

import os
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter
from rich.markup import escape

from wirerope_mj.foundation.atomic_files import check_writable
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import plain


def compare(
    *runs: Path,
    out: Path | None = None,
    names: Annotated[list[str] | None, Parameter(consume_multiple=True, negative=())] = None,
    align: Literal["start", "shock"] = "start",
    force: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Lay two or more runs over each other, peaks side by side and one recording; or two jobs, case by case.

    The recording holds the scenes side by side and as ghosts in one, the histories of all runs in the same axes, their loops,
    and tables of what differs, where and when. Runs of different models are compared in what they share by name; the rest is
    listed. Differences are those to the first run. Of two jobs the tables say what each uses of the limits in every load case,
    and which inputs differ.

    Args:
        runs: folders of runs, two or more, or of two jobs.
        out: recording to write (.rrd); runs/compare-DATE-TIME.rrd by default.
        names: what the runs are called, one for each; the names of their folders by default.
        align: start: runs begin together; shock: their base motions do.
        force: replace a recording that is there.
    """
    from wirerope_mj.content.comparison import comparison_content
    from wirerope_mj.engine.response import load_response
    from wirerope_mj.runs.checksums import warn_of_alterations
    from wirerope_mj.runs.job import is_job
    from wirerope_mj.runs.sources import run_inputs, run_verdicts
    from wirerope_mj.views.recording.drawn_runs import several_runs
    from wirerope_mj.views.recording.record import record_runs
    from wirerope_mj.views.terminal import console, print_headline, show

    if len(runs) < 2:
        raise ValueError(f"compare takes two runs or more, got {len(runs)}: wirerope compare RUN RUN [RUN ..]")
    called = _names(runs, names)
    if any(map(is_job, runs)):
        return _compare_jobs(runs, called, out)
    target = _target(out, force=force)
    for folder in runs:
        warn_of_alterations(folder)
    responses = {name: load_response(folder) for name, folder in zip(called, runs, strict=True)}
    inputs = {name: run_inputs(folder) for name, folder in zip(called, runs, strict=True)}
    verdicts = {name: run_verdicts(folder, responses[name]) for name, folder in zip(called, runs, strict=True)}
    drawn = several_runs(responses, align, verdicts)
    record_runs(drawn, target, inputs=inputs)
    content, screen = comparison_content(drawn.comparison, inputs), console()
    screen.print(f"\n[bold]{escape(content.title)}[/]")
    show(content, "headlines", "differences", "accelerations", "travel")
    print_headline(content.verdict)
    show(content, "findings")
    written = escape(str(target))
    screen.print(f"\n  written to {written}, {target.stat().st_size / 1e6:.1f} MB", soft_wrap=True)
    screen.print(f"  [bold]wirerope show {written}[/] opens the view", soft_wrap=True)
    return 0


def _compare_jobs(jobs: Sequence[Path], names: Sequence[str], out: Path | None) -> int:
    """Print what two jobs use of their limits, case by case, and what differs between their inputs."""
    from wirerope_mj.content.job_comparison import job_comparison_content
    from wirerope_mj.runs.job import CASES, is_job, judged_job
    from wirerope_mj.runs.sources import run_inputs
    from wirerope_mj.views.terminal import print_headline, show

    if len(jobs) != 2 or not all(map(is_job, jobs)):
        raise ValueError(
            "compare takes two jobs, or two runs or more: wirerope compare JOB JOB, wirerope compare RUN RUN"
        )
    if out is not None:
        raise ValueError(
            "`--out` is for the recording of runs; of two jobs there is none. Leave it out, or compare two runs."
        )
    judged = {name: judged_job(folder) for name, folder in zip(names, jobs, strict=True)}
    inputs = {
        name: {case.name: run_inputs(folder / CASES / case.folder) for case in judged[name].cases}
        for name, folder in zip(names, jobs, strict=True)
    }
    content = job_comparison_content(judged, inputs)
    show(content)
    print_headline(content.verdict)
    return 0


def _names(runs: Sequence[Path], names: Sequence[str] | None) -> list[str]:
    """Return what the runs are called: as is said, or as their folders are, told apart by the folders above or by numbers."""
    if names is None:
        paths = [Path(os.path.abspath(folder)) for folder in runs]  # as it is called, also where that is a link
        names = [path.name for path in paths]
        longer = [f"{path.parent.name}/{path.name}" for path in paths]
        if len(set(names)) < len(names) == len(set(longer)):
            names = longer
        return [
            name if name not in names[:index] else f"{name} ({names[: index + 1].count(name)})"
            for index, name in enumerate(names)
        ]
    if len(names) != len(runs):
        raise ValueError(f"`--names` must be one for each of the {len(runs)} runs, got {len(names)}.")
    twice = [name for name in names if list(names).count(name) > 1]
    if twice:
        raise ValueError(f"`--names` must be different names, got {twice[0]!r} {len(twice)} times.")
    if not all(name.strip() for name in names):
        raise ValueError("`--names` must not be empty.")
    for name in names:
        if plain(name) != name:
            raise ValueError(f"`--names` must be visible characters on one line, got {name!r}.")
    return list(names)


def _target(out: Path | None, *, force: bool) -> Path:
    """Return the file to write; ValueError or RecordError if it must not be written."""
    target = out or Path("runs") / f"compare-{datetime.now():%Y%m%d-%H%M%S}.rrd"
    if target.suffix != ".rrd":
        raise ValueError(f"`--out` must be a file that ends with .rrd, got {target}.")
    if target.is_dir():
        raise RecordError(f"{target}: this is a folder; a recording is a file. Choose another place.")
    if target.exists() and not force:
        raise RecordError(f"{target}: there is a recording already. Replace it with --force, or choose another place.")
    if out is not None:
        check_writable(out)
    return target
