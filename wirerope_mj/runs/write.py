"""A scenario simulated into one folder, and summary.json of it, written and read back."""

import math
import os
import re
import shutil
import tomllib
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from time import perf_counter

import tomli_w

from wirerope_mj.assessment.criteria import summary
from wirerope_mj.assessment.criteria.sampled import samples_hold
from wirerope_mj.content.blocks import Chart
from wirerope_mj.content.judged_run import JudgedRun, judged_run
from wirerope_mj.content.run import run_content
from wirerope_mj.engine.response import Response, load_response
from wirerope_mj.engine.simulation import simulate
from wirerope_mj.engine.simulation.progress import work_after
from wirerope_mj.engine.simulation.recorder import column_plan
from wirerope_mj.engine.simulation.run import aliasing, missing_modes
from wirerope_mj.engine.simulation.simulate import checked_corners
from wirerope_mj.engine.statics.linear import soft_equalities
from wirerope_mj.engine.system.model_files import model_table, write_model
from wirerope_mj.foundation.arguments import one_of, positive
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.atomic_files import atomic_folder, check_folder, json_text
from wirerope_mj.foundation.errors import Absent, FontWarning, ModelError, RecordError
from wirerope_mj.foundation.plain_text import markdown, markdown_lines
from wirerope_mj.foundation.processes import run_beside
from wirerope_mj.foundation.summary import json_values
from wirerope_mj.foundation.toml_file import read_json
from wirerope_mj.motions.records.record import records_in
from wirerope_mj.motions.registry import copy_records
from wirerope_mj.runs.folder import CHECKSUMS, FORMAT, KIND, MARKS, SCENARIO, SUMMARY, write_checksums
from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.runs.scenario_file import judge_table, scenario_content, system_and_motion, system_of

_REMEDY = "Take the file from another copy of the folder, or repeat the run."


def summary_content(judged: JudgedRun, *, seconds: float) -> Entries:
    """Return the content of summary.json; `seconds` is how long the simulation took."""
    response, content = judged.response, run_content(judged)
    numerics = response.numerics
    names = ("criterion", "subject", "value", "unit", "note")  # standard errors of random vibration are in its notes
    random = (
        [] if isinstance(judged.random, Absent) else [{name: getattr(row, name) for name in names} for row in judged.random]
    )
    return {
        "format": FORMAT, "name": str(judged.inputs["name"]), "motion": judged.motion.description,
        "record_warnings": list(judged.record_warnings),
        **({"model_warnings": list(judged.model_warnings)} if judged.model_warnings else {}),
        **summary(response, judged.verdicts),
        **({"random": random} if random else {}),
        **({"untested": judged.untested} if judged.untested else {}),
        "content": content.to_dict(*content.sections_of("headline", "summary")),
        "numerics": {
            "timestep_s": numerics.timestep, "steps": numerics.steps, "samples": int(response.time.size),
            "samples_hold": samples_hold(response), "callback": numerics.callback, "engine": numerics.engine,
            "why_not_kernel": numerics.why, "accuracy": json_values(numerics.accuracy),
            "estimated_error": json_values(numerics.error_estimate), "limited_by": numerics.limited_by,
            "seconds": seconds, "versions": numerics.versions,
        },
    }  # fmt: skip


def read_summary(folder: str | Path) -> Entries:
    """Return the content of a run's summary.json; RecordError if there is none, or it cannot be read."""
    path = Path(folder) / SUMMARY
    if not path.exists():
        raise RecordError(f"{folder}: there is no {SUMMARY} here. {_REMEDY}")
    return read_json(path, "the summary of a run", _REMEDY)


_REFRESH = 4.0  # times a second: it shows that work goes on, and costs nothing that can be measured


@contextmanager
def progress_line(*, enabled: bool) -> Iterator[Callable[[str], None]]:
    """Show on standard error what is being written while the block runs, if that is a terminal, and clear it afterwards.

    Yields what to call with the name of what comes next.
    """
    from rich.console import Console  # late: nothing of it is needed where nothing is shown
    from rich.progress import Progress, SpinnerColumn, TextColumn

    console = Console(stderr=True) if enabled else None
    if console is None or not console.is_terminal:
        yield lambda name: None
        return
    columns = SpinnerColumn(), TextColumn("writing {task.description}")
    with Progress(*columns, console=console, transient=True, refresh_per_second=_REFRESH) as progress:
        task = progress.add_task("")
        yield lambda name: progress.update(task, description=name, refresh=True)


STREAM_SAMPLES = 10_000  # Samples above which a run goes straight to its file: 50 MB of a floor with some 600 columns
PAGES = (3.0, 1.2e8)  # time of a processor [s] and memory [B] that the pages of a run take
OF_A_NUMBER = (1.5e-7, 8.0)  # and what they take for each number sampled
SAMPLE_RATE = 1000.0  # Sampling rate of `simulate` where the scenario gives none [Hz]
_PACKAGES = ("wirerope-mj", "mujoco", "numpy", "scipy", "numba", "pyarrow", "rerun-sdk")
_ARGUMENTS = ("duration", "initial", "timestep", "accuracy", "sample_rate", "corners", "callback", "engine")


def run_scenario(scenario: Scenario, folder: str | Path, *, force: bool = False, progress: bool = False) -> Response:
    """Simulate a scenario, write the run as `folder`, whole or not at all, and return its response.

    Args:
        scenario: what to simulate.
        folder: the run's folder; it must not exist, or be empty, or be a run that `force` replaces.
        force: whether a run that is there is replaced.
        progress: whether it is shown on standard error how far the run is.

    Raises:
        RecordError: the folder exists and must not be replaced.
        ModelError: the scenario's model or its arguments are not what they must be.
        SimulationError, ConvergenceError: the simulation cannot start, or ended before its time.
    """
    write_run(scenario, folder, force=force, progress=progress)
    return load_response(folder)


def write_run(
    scenario: Scenario, folder: str | Path, *, force: bool = False, progress: bool = False, state: bool = False,
    decks: bool = False, when_judged: Callable[[JudgedRun], None] = lambda judged: None,
) -> None:  # fmt: skip
    """Simulate a scenario and write the run as `folder`, whole or not at all, without reading the response back.

    `when_judged` is called with the judged run before anything is made of it; what it raises ends the run, whose folder is
    not written then. With `state` the recording keeps every sample, too; with `decks` the report has the peaks on decks that
    bend.
    """
    target = Path(folder)
    check_folder(target, force=force, kind=KIND, marks=MARKS)
    arguments = checked_arguments(scenario)
    scenario = scenario.on_its_floor()
    system = system_of(scenario)
    with atomic_folder(target, force=force, kind=KIND, marks=MARKS) as temporary:
        started = perf_counter()
        model = write_model(system, temporary / "model")
        long = is_streamed(arguments)
        with warnings.catch_warnings():
            for text in (*soft_equalities(system), *missing_modes(system, scenario.motion)):  # the run's own pages say them
                warnings.filterwarnings("ignore", message=re.escape(text))
            numbers = arguments["duration"] * arguments.get("sample_rate", SAMPLE_RATE) * len(column_plan(system).names)
            seconds, memory = PAGES[0] + OF_A_NUMBER[0] * numbers, PAGES[1] + OF_A_NUMBER[1] * numbers
            with work_after("run", seconds, memory=memory, enabled=progress):
                response = simulate(system, scenario.motion, **arguments, out=temporary if long else None, progress=progress)
        seconds = perf_counter() - started
        text = _scenario_text(scenario, response, temporary, model=model_table(system, model), arguments=arguments)
        judged = replace(judged_run(system, scenario.motion, response, tomllib.loads(text)), decks=decks)
        when_judged(judged)
        with progress_line(enabled=progress) as writing:
            writing("the response")
            if not long:
                response.save(temporary)
            (temporary / SCENARIO).write_text(text, encoding="utf-8")
            content = summary_content(judged, seconds=round(seconds, 3))
            (temporary / SUMMARY).write_text(json_text(content), encoding="utf-8")
            _write_views(scenario, judged, temporary, writing, state=state)
            write_checksums(temporary)


def rejudge_run(
    scenario: Scenario, folder: str | Path, *, when_judged: Callable[[JudgedRun], None] = lambda judged: None
) -> None:
    """Judge a run by other limits, and write it anew from its own samples, without simulation.

    The scenario is as it was but for `limits` and `combined_travel`; the rest as `write_run` takes it. WireRopeError if the
    run is damaged, or a limit is on nothing that is there.
    """
    target = Path(folder)
    with atomic_folder(target, force=True, kind=KIND, marks=MARKS) as temporary:
        shutil.copytree(target, temporary, dirs_exist_ok=True, copy_function=_linked)
        judge = judge_table(combined_travel=scenario.combined_travel, limits=scenario.limits)
        content = scenario_content(temporary) | {"options": _options(scenario), "judge": judge, "written": _now()}
        content = {key: value for key, value in content.items() if key != "judge" or value}
        system, motion = system_and_motion(temporary, content)
        response = load_response(temporary)
        scene = replace(response.scene, limits=system.limits, combined_travel=system.combined_travel)
        response = replace(response, scene=scene)
        response.save(temporary)
        judged = judged_run(system, motion, response, content)
        when_judged(judged)
        seconds = read_summary(temporary)["numerics"]["seconds"]
        summary = json_text(summary_content(judged, seconds=seconds))
        for name, text in ((SCENARIO, tomli_w.dumps(content, multiline_strings=True)), (SUMMARY, summary)):
            (temporary / name).unlink()
            (temporary / name).write_text(text, encoding="utf-8")
        for old in (*temporary.glob("*.png"), *temporary.glob("*.html"), *temporary.glob("*.rrd"), temporary / CHECKSUMS):
            old.unlink()
        _write_views(scenario, judged, temporary, lambda name: None, state=False)
        write_checksums(temporary)


def _linked(source: str, target: str) -> None:
    """Hard-link a file into a second folder, or copy it where that is impossible."""
    try:
        os.link(source, target)
    except OSError:
        shutil.copyfile(source, target)


def _options(scenario: Scenario) -> Entries:
    """Return the options of a scenario as TOML values."""
    return {
        name: value if isinstance(value, bool | int | float | str) else str(value)
        for name, value in scenario.options.items()
        if value is not None
    }


def _now() -> datetime:
    return datetime.now(UTC).replace(microsecond=0)


def is_streamed(arguments: Entries) -> bool:
    """Tell whether a run has so many samples that they are written to their file during the simulation."""
    return bool(arguments["duration"] * arguments.get("sample_rate", SAMPLE_RATE) > STREAM_SAMPLES)


def checked_arguments(scenario: Scenario) -> Entries:
    """Return the arguments of a scenario's simulation; ModelError if one is missing, or no file could state it."""
    arguments = dict(scenario.simulate)
    for name in arguments:
        if name not in _ARGUMENTS:
            raise ModelError(
                f"scenario {scenario.name!r}: `simulate` takes {', '.join(_ARGUMENTS)} here, got {name!r}; "
                "the run's folder decides the rest."
            )
    if "duration" not in arguments:
        raise ModelError(f"scenario {scenario.name!r}: `simulate` must say the duration [s].")
    try:
        for name in ("duration", "sample_rate", "timestep", "accuracy"):
            value = arguments.get(name, SAMPLE_RATE)
            if value is not None or name not in ("timestep", "accuracy"):  # None leaves a step to be chosen
                positive(name, value)
        for name, known in (("callback", ("native", "python")), ("engine", ("auto", "mujoco", "kernel"))):
            one_of(name, arguments.get(name, known[0]), known)
        checked_corners(arguments.get("corners", ()))
    except ValueError as error:
        raise ModelError(f"scenario {scenario.name!r}: {error}") from None
    if not isinstance(arguments.get("initial"), str | None):
        choices = "'settled', 'relaxed' or 'unloaded'"
        raise ModelError(f"scenario {scenario.name!r}: `initial` must be {choices}, so that a file can say it.")
    return arguments


def _scenario_text(scenario: Scenario, response: Response, folder: Path, *, model: dict[str, str], arguments: Entries) -> str:
    """Return the scenario with every input resolved, as TOML; files of the motion are copied into `folder`."""
    numerics = response.numerics
    resolved: Entries = {
        "duration": float(arguments["duration"]), "initial": arguments.get("initial") or scenario.motion.initial,
        "timestep": numerics.timestep, "sample_rate": float(arguments.get("sample_rate", SAMPLE_RATE)),
        "callback": numerics.callback, "engine": numerics.engine,
    }  # fmt: skip
    if not math.isnan(numerics.accuracy):
        resolved["accuracy"] = numerics.accuracy
    if "corners" in arguments:
        resolved["corners"] = [float(corner) for corner in arguments["corners"]]
    motion = scenario.motion.to_dict(files=copy_records([scenario.motion], folder))
    content = {
        "format": FORMAT, "name": scenario.name, "question": scenario.question.strip(), "written": _now(),
        "options": _options(scenario), "model": model, "simulate": resolved,
        "motion": {"description": scenario.motion.description} | motion,
        "versions": {name: version(name) for name in _PACKAGES},
    }  # fmt: skip
    if judge := judge_table(combined_travel=scenario.combined_travel, limits=scenario.limits):
        content["judge"] = judge
    if warned := aliasing([scenario.motion], resolved["sample_rate"]):
        content["warning"] = warned
    return tomli_w.dumps(content, multiline_strings=True)


def _write_views(scenario: Scenario, judged: JudgedRun, folder: Path, writing: Callable[[str], None], *, state: bool) -> None:
    """Write the recording, the pictures and the report of a run, of which `writing` shows the name meanwhile."""
    # Here, because the page, and rerun even more, take longer to import than a small simulation takes.
    from wirerope_mj.content.first_sheet import panel_over_frequency
    from wirerope_mj.content.run import run_content
    from wirerope_mj.runs.page import REPORT
    from wirerope_mj.views.pictures import save_pictures
    from wirerope_mj.views.plots.letters import fonts_for
    from wirerope_mj.views.report import report_html

    title, content = judged.title, run_content(judged)
    options = ", ".join(f"{name} = {value}" for name, value in scenario.options.items())
    parts = [markdown_lines(scenario.question.strip()), f"**Base motion:** {markdown(scenario.motion.description)}"]
    text = "\n\n".join([*parts, *([f"**Options:** {markdown(options)}"] if options else [])])
    response = judged.response
    # Here, because what the copy of this process warns of is lost.
    fonts_for("\n".join((title, scenario.motion.description, *response.bodies, *response.points, *response.mounts)))

    def write_report() -> None:
        charts = {block.id: block for block in content.blocks() if isinstance(block, Chart)}
        drawn = [charts[name] for name in ("used", "accelerations", "deflections") if name in charts]
        save_pictures(drawn, folder / "histories.png", title=f"{title}: {scenario.motion.description}")
        if "loops" in charts:
            save_pictures([charts["loops"]], folder / "loops.png", title=title)
        for number, record in enumerate(records_in(scenario.motion), start=1):
            name = "record_baseline.png" if number == 1 else f"record_baseline-{number}.png"
            chart = charts[f"record-{record.path.name}"]
            save_pictures([chart], folder / name, title=f"{title}: {chart.caption}")
        (folder / REPORT).write_text(report_html(content), encoding="utf-8")

    writing("the recording, the pictures and the report")
    with warnings.catch_warnings(action="ignore", category=FontWarning), run_beside(write_report):
        from wirerope_mj.views.recording.record import record_run

        over = panel_over_frequency(judged)
        record_run(judged, folder / "run.rrd", title=title, scenario_text=text, state=state, over_frequency=over)
