"""What a run prints: peaks against limits, and where the files are."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from rich import box
from rich.markup import escape
from rich.table import Table

from wirerope_mj.assessment.criteria import (
    COMBINED,
    EXCEEDED,
    NOT_JUDGED,
    WITHIN,
    MountPeak,
    Verdict,
    body_peaks,
    judge,
    mount_peaks,
    verdict_lines,
)
from wirerope_mj.cli.contact_table import contact_table
from wirerope_mj.cli.screen import console
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import Sweep
from wirerope_mj.mounts.isolator.travel import RATINGS
from wirerope_mj.runs.headline import read_headline
from wirerope_mj.runs.scenario import Scenario

_NEAR = 0.9  # utilisation from which it is coloured as a warning


def print_questions(kind: str, questions: Mapping[str, str]) -> None:
    """Print what ships with the package: names of scenarios or studies and what each asks."""
    table = Table(box=None, pad_edge=False)
    table.add_column(kind, no_wrap=True)
    table.add_column("question")
    for name, question in questions.items():
        table.add_row(escape(name), escape(question))
    console().print(table)


def print_run(scenario: Scenario, response: Response, folder: Path, *, seconds: float) -> None:
    """Print peaks against limits, how they were computed, and where the files are."""
    out, verdicts = console(), judge(response)
    out.print(f"\n[bold]{escape(scenario.name)}[/]  {escape(scenario.motion.description)}")
    out.print(_accelerations(scenario, response, verdicts))
    if response.scene.isolating:
        out.print()
        out.print(_mounts(response, verdicts))
        out.print()
    contacts = contact_table(response)
    if contacts is not None:
        out.print(contacts)
        out.print()
    out.print(f"  [bold]{escape(read_headline(folder))}[/]", soft_wrap=True)
    for line in verdict_lines(response, verdicts):
        out.print(f"  {escape(line)}")
    out.print(f"\n  {_numerics(response)}; {seconds:.1f} s in all")
    files = sorted(path for path in folder.iterdir() if path.is_file())
    shown = escape(str(folder))
    out.print(f"  written to {shown}/", soft_wrap=True)
    out.print(f"  {', '.join(path.name for path in files)}, {_folders(folder)}", soft_wrap=True)
    out.print(f"  [bold]wirerope show {shown}[/] opens the view", soft_wrap=True)


def _folders(folder: Path) -> str:
    return ", ".join(f"{path.name}/" for path in sorted(folder.iterdir()) if path.is_dir())


def _accelerations(scenario: Scenario, response: Response, verdicts: Sequence[Verdict]) -> Table:
    sweep = scenario.motion if isinstance(scenario.motion, Sweep) else None
    frequency = ("at [Hz]",) if sweep is not None else ()
    judged = [row for row in verdicts if row.criterion.startswith("acceleration") and row.utilisation is not None]
    limited = {row.subject: row for row in sorted(judged, key=lambda row: row.utilisation or 0.0)}
    limits = ("limit [g]", "used [%]") if limited else ()
    title = "Peak accelerations" if limited else "Peak accelerations, not judged: the model states no limits"
    table = _table(title, "", ("peak [g]", "x [g]", "y [g]", "z [g]", "at [s]", *frequency, *limits))
    for row in body_peaks(response):
        name = row.name if row.kind == "body" else f"{row.name} ({row.kind})"
        cells = [f"[bold]{row.value:.2f}[/]", *[f"{value:.2f}" for value in row.axes], f"{row.time:.4f}"]
        cells += [f"{sweep.frequency([row.time])[0]:.2f}"] if sweep is not None else []
        cells += _against_limit(limited.get(row.name)) if limits else []
        table.add_row(escape(name), *cells)
    return table


def _against_limit(row: Verdict | None) -> list[str]:
    """Return limit and utilisation of the component that is nearest to its limit."""
    if row is None or row.limit is None:
        return ["[dim]-[/]", "[dim]-[/]"]
    axis = row.criterion.removeprefix("acceleration along ")
    along = "" if axis == row.criterion else f"{axis} "
    return [f"{along}{row.limit / STANDARD_GRAVITY:.4g}", _percent(row.utilisation)]


def _mounts(response: Response, verdicts: Sequence[Verdict]) -> Table:
    rows = mount_peaks(response)
    ratings = [name for name in RATINGS if any(row.travel[name].utilisation is not None for row in rows)]
    units = ("axial [mm]", "shear [mm]", "roll [mm]", "axial [kN]", "shear [kN]", "roll [kN]")
    used = [f"{name.replace('compression', 'compr.')} [%]" for name in ratings]
    used += ["comb. [%]"] if ratings else []
    combined = {row.subject: row for row in verdicts if row.criterion == COMBINED}
    title = "Peaks of the mounts, and their utilisation of the rated travel [%]"
    table = _table(title, "mount", [name.replace(" ", "\n") for name in (*units, *used)])
    table.add_column("verdict", no_wrap=True)
    for row in rows:
        deflection = [_range(row, 2), _largest(row, 1), _largest(row, 0)]
        force = [f"{1e-3 * value:.2f}" for value in reversed(row.force)]
        used = [_percent(row.travel[name].utilisation) for name in ratings]
        used += [_percent(combined[row.name].utilisation)] if ratings else []
        table.add_row(escape(row.name), *deflection, *force, *used, _short(row, combined[row.name]))
    return table


def _table(title: str, first: str, numbers: Sequence[str]) -> Table:
    """Return a table of one column of names and columns of numbers; brackets in headings are no markup."""
    table = Table(box=box.SIMPLE_HEAD, title=escape(title), title_style="bold", title_justify="left", show_edge=False)
    table.padding = (0, 1, 0, 0) if console().width >= 100 else 0
    table.add_column(escape(first), no_wrap=True)
    for name in numbers:
        table.add_column(escape(name), justify="right", no_wrap=True)
    return table


def _range(row: MountPeak, axis: int) -> str:
    return f"{1e3 * row.minimum[axis]:+.1f} {1e3 * row.maximum[axis]:+.1f}"


def _largest(row: MountPeak, axis: int) -> str:
    return f"{1e3 * max(row.maximum[axis], -row.minimum[axis]):.1f}"


def _percent(used: float | None) -> str:
    if used is None:
        return "[dim]-[/]"
    style = "bold red" if used > 1.0 else "yellow" if used > _NEAR else "none"
    return f"[{style}]{100.0 * used:.0f}[/]"


def _numerics(response: Response) -> str:
    numerics = response.numerics
    limit = f", limited by {numerics.limited_by}" if numerics.limited_by else ""
    text = f"{numerics.steps} steps of at most {1e3 * numerics.timestep:.4g} ms{limit}, {numerics.callback} callback"
    if math.isfinite(numerics.error_estimate):
        missed = (
            "" if numerics.error_estimate <= numerics.accuracy else f", above the {numerics.accuracy:.0e} asked for"
        )
        return f"{text}, estimated error {numerics.error_estimate:.1e} of the peaks{missed}"
    return f"{text}, step given: no error estimated"


def _short(row: MountPeak, combined: Verdict) -> str:
    """Return the verdict in a word; the coloured values say in which direction, or that it is all of them together."""
    if row.exceeded or combined.verdict == EXCEEDED:
        return EXCEEDED
    return WITHIN if row.governing else NOT_JUDGED
