"""`wirerope compare`: runs over each other, a run and what was measured, or two jobs, as tables, a page and a recording."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from wirerope_mj.cli.options import All, Flag, Texts, dated
from wirerope_mj.foundation.atomic_files import check_folder, check_writable
from wirerope_mj.foundation.plain_text import plain


def compare(
    *runs: Path, out: Path | None = None, names: Texts = None, align: Literal["start", "shock"] = "start", map: Texts = None,
    start: float | None = None, clock: float | None = None, baseline: Literal["none", "rest", "mean"] | None = None,
    gaps: Literal["refuse", "fill"] | None = None, every: All = False, force: Flag = False,
) -> int:  # fmt: skip
    """Lay two or more runs over each other, a run and measured tests, or two jobs: what differs, and how well they agree.

    The folder holds a page with every table, the figures as JSON and, of runs, a recording: the scenes side by side and as
    ghosts in one, the histories of all runs in the same axes, their loops, and tables of what differs, where and when. Runs of
    different models are compared in what they share by name; the rest is listed. Differences are those to the first run. Of two
    jobs the tables say what each uses of the limits in every load case, and which inputs differ.

    With --map the files behind the first run are measured tests, CSV, MATLAB, XLSX, Parquet or universal files:

    wirerope compare runs/drop drop.csv --map "A1=point/rack_top z g" "A0=base z g"

    Their files are kept in the run's folder; correlation.html and correlation.rrd there show all curves over each other.

    Args:
        runs: folders of runs, two or more, or of two jobs; or one run, and files of tests.
        out: folder of the result, or, of runs, a .rrd file for the recording alone; runs/compare-DATE-TIME by default, of
            tests the run's folder.
        names: what the runs, jobs or tests are called, one for each; the names of their folders or files by default.
        align: start: runs begin together; shock: their base motions do.
        map: what the columns of the tests are, COLUMN=PHRASE, such as "A1=point/rack_top -z g" or "F1=mount/m1 axial kN", or a
            TOML file with a table [channels].
        start: of tests: instant of the run at which the first sample was taken [s]; the delay that is left is found.
        clock: of tests: seconds of the run in a second of the file's clock.
        baseline: of tests: none, rest (the level at rest is taken off each channel) or mean.
        gaps: of tests: refuse missing samples, or fill them with straight lines.
        force: replace what is at --out, or another test of the same name.
    """
    given = {"start": start, "clock": clock, "baseline": baseline, "gaps": gaps}
    options = {name: value for name, value in given.items() if value is not None}
    if map is not None:
        return _compare_tests(runs, names, map, options, out, every=every, force=force)
    if options:
        raise ValueError(f"`--{next(iter(options))}` is for measured tests, whose columns --map names.")
    from wirerope_mj.cli.tables import TIMELINE, say_next, say_where
    from wirerope_mj.content.comparison import comparison_content
    from wirerope_mj.content.numbers import listed
    from wirerope_mj.engine.response import load_response
    from wirerope_mj.motions.records.record import is_measurement, record_channels
    from wirerope_mj.runs.analyses import COMPARISON_KIND, COMPARISON_MARKS, write_comparison
    from wirerope_mj.runs.folder import warn_of_alterations
    from wirerope_mj.runs.job import is_job
    from wirerope_mj.runs.scenario_file import is_run, judged_folder, run_inputs, run_verdicts
    from wirerope_mj.views.terminal import show_result

    for path in runs:
        if path.is_file() and is_measurement(path):
            columns = listed(list(record_channels(path)))
            example = '--map "COLUMN=point/NAME z g"'
            raise ValueError(
                f"{path} is no run. If it was measured, say what its columns are, such as {example}; its columns are {columns}."
            )
    if len(runs) < 2:
        raise ValueError(f"compare takes two runs or more, got {len(runs)}: wirerope compare RUN RUN [RUN ..]")
    called = _names(runs, names)
    target = out or dated("compare")
    alone = target.suffix == ".rrd"
    if alone:
        check_writable(target, force=force)
    else:
        check_folder(target, force=force, kind=COMPARISON_KIND, marks=COMPARISON_MARKS)
    if any(is_job(folder) for folder in runs):
        return _compare_jobs(runs, called, target, every=every, force=force)
    for folder in runs:
        warn_of_alterations(folder)
    from wirerope_mj.views.recording.drawn_runs import several_runs  # late: rerun takes long to import
    from wirerope_mj.views.recording.record import record_runs

    pairs = list(zip(called, runs, strict=True))
    responses = {name: load_response(folder) for name, folder in pairs}
    inputs = {name: run_inputs(folder) for name, folder in pairs}
    judged = {name: judged_folder(folder, responses[name]) for name, folder in pairs if is_run(folder)}
    verdicts = {name: one.verdicts for name, one in judged.items()}
    verdicts |= {name: run_verdicts(folder, responses[name]) for name, folder in pairs if name not in judged}
    drawn = several_runs(responses, align, verdicts)
    content = comparison_content(drawn.comparison, inputs, judged)

    def record(path: Path) -> None:
        record_runs(drawn, path, inputs=inputs, judged=judged)

    if alone:
        record(target)
    else:
        write_comparison(content, target, record, force=force)
    others = ("differences", "accelerations", "travel", "credibility")
    show_result(content, "headlines", "findings", others=others, every=every)
    say_where(target, every=every and not alone)  # a folder's page holds every table
    say_next({("show", target): TIMELINE}, again="--force --all" if alone and not every else "")
    return 0


def _compare_tests(
    paths: Sequence[Path], names: Sequence[str] | None, mapped: Sequence[str], options: dict[str, Any], out: Path | None,
    *, every: bool, force: bool,
) -> int:  # fmt: skip
    """Correlate the run at the first path with the measured tests at the other paths."""
    from wirerope_mj.cli.tables import TIMELINE, say_next
    from wirerope_mj.content.correlation import correlation_content
    from wirerope_mj.runs.measured import read_map, write_correlation
    from wirerope_mj.views.terminal import print_lines, show_result

    if len(paths) < 2:
        raise ValueError('compare takes a run and a test or several: wirerope compare RUN TEST --map "COLUMN=PHRASE" ..')
    run, *files = paths
    called = _names(files, names) if names else [file.stem for file in files]
    page = (out or run) / "correlation.html"
    if out is not None:
        check_folder(out, force=force, kind="comparison with tests", marks=(page.name,))
    tests = write_correlation(run, dict(zip(called, files, strict=True)), read_map(mapped) | options, page, force=force)
    content = correlation_content(run.resolve().name, tests)
    show_result(content, *content.sections_of("headline"), others=content.sections_of("summary"), every=every)
    print_lines(["", f"written to {page}"])
    say_next({("show", page.with_suffix(".rrd")): TIMELINE})
    return 0


def _compare_jobs(jobs: Sequence[Path], names: Sequence[str], target: Path, *, every: bool, force: bool) -> int:
    """Print what two jobs use of their limits, case by case, and what differs between their inputs."""
    from wirerope_mj.cli.tables import say_where
    from wirerope_mj.content.job_comparison import job_comparison_content
    from wirerope_mj.runs.analyses import write_comparison
    from wirerope_mj.runs.job import CASES, is_job, judged_job
    from wirerope_mj.runs.scenario_file import run_facts, run_inputs
    from wirerope_mj.views.terminal import show_result

    if len(jobs) != 2 or not all(map(is_job, jobs)):
        raise ValueError("compare takes two jobs, or two runs or more: wirerope compare JOB JOB, wirerope compare RUN RUN")
    if target.suffix == ".rrd":
        raise ValueError(f"`--out` must be a folder, since two jobs have no recording, got {target}.")
    judged = {name: judged_job(folder) for name, folder in zip(names, jobs, strict=True)}
    inputs = {
        name: {case.name: run_inputs(folder / CASES / case.folder) for case in judged[name].cases}
        for name, folder in zip(names, jobs, strict=True)
    }
    known: dict[tuple[str, ...], dict[str, str]] = {}  # of models that several cases share
    models: dict[str, dict[str, dict[str, str]]] = {name: {} for name in names}
    for name, folder in zip(names, jobs, strict=True):
        for case in judged[name].cases:
            digests = tuple(f"{key} {text}" for key, text in inputs[name][case.name].items() if key.startswith("model"))
            if digests not in known:
                known[digests] = run_facts(folder / CASES / case.folder)
            models[name][case.name] = known[digests]
    content = job_comparison_content(judged, inputs, models)
    write_comparison(content, target, force=force)
    show_result(content, "headlines", "inputs", others=("cases", "limits"), every=every)
    say_where(target, every=every)
    return 0


def _names(runs: Sequence[Path], names: Sequence[str] | None) -> list[str]:
    """Name the runs: by `names`, or by their folders, distinguished by parent folders or numbers where these are equal."""
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
