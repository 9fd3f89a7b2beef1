"""`wirerope identify`: cyclic tests -> an isolator file, a table of what the data fix, and a report with pictures."""

import math
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rich import box
from rich.markup import escape
from rich.table import Table

from wirerope_mj.cli.identify_records import Tests, held, read_tests, remarks
from wirerope_mj.cli.identify_report import (
    PICTURES,
    Rows,
    law_words,
    loop_rows,
    parameter_rows,
    report_text,
    sentences,
    stage_rows,
)
from wirerope_mj.cli.screen import console
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.mounts.identification.fitted import FittedLoop, fitted_loops
from wirerope_mj.mounts.identification.identify import Constraint, family_of, identify
from wirerope_mj.mounts.identification.result import Identification
from wirerope_mj.mounts.isolator import Isolator, Provenance, load_isolator, read_law
from wirerope_mj.mounts.laws import LAWS, AsymmetricBoucWen, Law, Masing, Stop
from wirerope_mj.runs.folder import atomic_run, check_target

NOT_CONVERGED = 1
"""Exit code of a fit that did not converge."""

_REPORT = "report.md"
_ELEMENTS = 5  # of a Masing law: with eleven parameters within what an identification of four amplitudes can fix


@dataclass(frozen=True, kw_only=True)
class Request:
    """What is to be identified and where it goes.

    Attributes:
        files: records of cyclic tests.
        law: name of the law.
        out: isolator file.
        axis: which the tests moved.
        report: folder; None: beside `out`.
        name: of the isolator; None: that of its file.
        constraint: on Bouc-Wen's beta and gamma.
        fix: NAME=VALUE each.
        free: parameters that are given otherwise.
        beside: isolator file with the law that is known.
        elements: of a Masing law; None: five, or as many as the start has.
        start: law or isolator file where a three-stage search begins too.
        force: whether `out` and `report` are replaced.
        accept_unconverged: whether a fit that did not converge may become an isolator.
    """

    files: Sequence[Path]
    law: str
    out: Path
    axis: str = "axial"
    report: Path | None = None
    name: str | None = None
    constraint: Constraint | None = None
    fix: Sequence[str] = ()
    free: Sequence[str] = ()
    beside: Path | None = None
    elements: int | None = None
    start: Path | None = None
    force: bool = False
    accept_unconverged: bool = False

    @property
    def folder(self) -> Path:
        """Where the report goes."""
        return self.report or self.out.with_name(f"{self.out.stem}-report")


def identify_command(request: Request) -> int:
    """Fit a law to records, print what was found, write report and isolator; return the exit code."""
    kind, fixed = _kind(request), _fixed(request.fix)
    start = None if request.start is None else _start(request.start, request.axis)
    known = None if request.beside is None else load_isolator(request.beside)
    known_law = None if known is None else _known_law(known, request)
    _check_places(request)
    tests = read_tests(request.files, stop=kind is Stop and known is None)
    loops = [loop for part in tests.values() for loop in part]
    result = identify(
        loops, law=kind, start=start, fixed=fixed, free=request.free, beside=known_law, constraint=request.constraint,
        elements=request.elements or _ELEMENTS,
    )  # fmt: skip
    fits = fitted_loops(result)
    isolator = _isolator(request, result, fits, _given(request, result), known)
    wanted = result.converged or request.accept_unconverged
    with atomic_run(request.folder, force=request.force, kind="report", marks=(_REPORT,)) as folder:
        _write_report(folder, request, result, fits, tests)
        _keep_others(request.folder, folder)
        if wanted:
            isolator.save(request.out)
    _print(request, isolator.name, result, fits, tests)
    screen = console()
    screen.print(f"written: {escape(str(request.folder))}/ ({_REPORT}, {', '.join(PICTURES)})", soft_wrap=True)
    if wanted:
        screen.print(f"written: {escape(str(request.out))}", soft_wrap=True)
    else:
        screen.print(
            f"[bold]not written[/]: {escape(str(request.out))}, because the fit did not converge; test more amplitudes, fix "
            "parameters or take another law, or take it as it is with --accept-unconverged.",
            soft_wrap=True,
        )
        if request.out.exists():
            screen.print(
                f"  {escape(str(request.out))} stands there from before: it is not of this fit.", soft_wrap=True
            )
    return 0 if result.converged else NOT_CONVERGED


def _kind(request: Request) -> type[Law]:
    """Return the class of a law that cyclic tests can fix."""
    name, elements = request.law, request.elements
    if name not in LAWS:
        raise ValueError(f"`--law`: there is no law {name!r}; the laws are {', '.join(sorted(LAWS))}.")
    family_of(LAWS[name], _ELEMENTS if elements is None else elements)  # raises if it cannot be identified
    if elements is not None and LAWS[name] is not Masing:
        raise ValueError(f"`--elements` counts the Jenkin elements of a masing law; {name} has none.")
    return LAWS[name]


def _known_law(known: Isolator, request: Request) -> Law:
    """Return the law of a known isolator on the axis of the tests."""
    law = known.conditioned.axes[request.axis]
    if law is None:
        raise ModelError(
            f"{request.beside}: [{request.axis}] is missing; nothing is known beside what the tests moved."
        )
    return law


def _fixed(words: Sequence[str]) -> dict[str, float]:
    """Return the values of NAME=VALUE."""
    values = {}
    for word in words:
        name, sign, text = word.partition("=")
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not (name and sign and math.isfinite(value)):
            raise ValueError(f"`--fix` must be NAME=VALUE with a number in SI units, got {word!r}.")
        if name in values:
            raise ValueError(f"`--fix` names {name!r} twice.")
        values[name] = value
    return values


def _start(path: Path, axis: str) -> Law:
    """Return the law of a law file, or of one axis of an isolator file."""
    if not path.is_file():
        raise ModelError(f"{path}: no such file. A search starts at a law file or at an isolator file.")
    content = read_toml(path, "start of a search")
    table, place = (
        (content, f"{path}:") if {"law", "laws"} & content.keys() else (content.get(axis), f"{path}: [{axis}]")
    )
    if not isinstance(table, dict):
        raise ModelError(f"{place} is missing; a search on this axis has no start there.")
    return read_law(table, place, path.parent)


def _check_places(request: Request) -> None:
    """Raise an error unless isolator and report can be written."""
    out = request.out
    if out.suffix != ".toml":
        raise ValueError(f"`--out` is an isolator file and must end with .toml, got {str(out)!r}.")
    if not out.resolve().parent.is_dir():
        raise ValueError(f"`--out`: there is no folder {str(out.resolve().parent)!r}.")
    if out.is_dir():
        raise ValueError(f"`--out`: {out} is a folder.")
    if out.exists() and not request.force:
        raise ValueError(f"{out}: there is an isolator file already. Replace it with --force, or choose another place.")
    check_target(request.folder, force=request.force, kind="report", marks=(_REPORT,))


def _given(request: Request, result: Identification) -> list[str]:
    """Return what was assumed and not found, one sentence each."""
    words = [f"{word}: given, not fitted" for word in request.fix]
    if request.constraint is not None:
        words.append(f"{request.constraint}: given, not fitted")
    if request.beside is not None:
        words.append(f"the law of {request.beside.name} beside it: given, not fitted")
    if isinstance(result.law, AsymmetricBoucWen):
        words.append("b = e: of b and c only the product c ln b acts on the force")
    words.append("the force's zero: the mean of each loop's force was free, so that the law has no force unloaded")
    words += [f"the data leave open: {open_words}" for open_words in result.open_combinations]
    if not result.converged:
        words.append(f"the fit did not converge ({result.message})")
    return words


def _isolator(
    request: Request, result: Identification, fits: Sequence[FittedLoop], assumed: Sequence[str], known: Isolator | None
) -> Isolator:
    """Return the isolator with its provenance; everything else of one that was known stays."""
    sizes = ", ".join(f"{1e3 * fit.amplitude:.3g} ({100.0 * fit.error:.2g} %)" for fit in fits)
    points = sorted({round(1e3 * fit.operating_point, 1) + 0.0 for fit in fits})
    provenance = Provenance(
        kind="identified",
        source=f"cyclic tests: {', '.join(path.name for path in request.files)}",
        fitted_to=(
            f"{request.axis} force over cycles of amplitude [mm] (error of the force over half its range) {sizes}, "
            f"about {', '.join(f'{point:g}' for point in points)} mm; {result.validity}"
        ),
        assumed=tuple(assumed),
    )
    axes: Mapping[str, Any] = {request.axis: result.law}
    name = request.name or request.out.stem
    if known is not None:
        return replace(known.conditioned, name=name, provenance=provenance, spread=None, **axes)
    return Isolator(name=name, provenance=provenance, **axes)


def _keep_others(before: Path, folder: Path) -> None:
    """Copy what a report's folder holds beside the report into the one that takes its place."""
    for path in before.iterdir() if before.is_dir() else ():
        if path.name == _REPORT or path.name in PICTURES:
            continue
        if path.is_dir() and not path.is_symlink():
            shutil.copytree(path, folder / path.name, symlinks=True)
        else:
            shutil.copy2(path, folder / path.name, follow_symlinks=False)


def _write_report(
    folder: Path,
    request: Request,
    result: Identification,
    fits: Sequence[FittedLoop],
    tests: Tests,
) -> None:
    """Write text and pictures into a folder."""
    from wirerope_mj.views.plots.identification import fit_figure, measures_figure, residual_figure

    kinds = " and ".join(law.name for law in result.law.components)
    title = f"{request.name or request.out.stem}, {request.axis}: {kinds}"
    for name, figure in zip(PICTURES, (fit_figure, residual_figure, measures_figure), strict=True):
        figure(fits, title=title).savefig(folder / name)
    sources = [f"{path}: {held(loops)}" for path, loops in tests.items()] + remarks(tests, result)
    given = [words for words in _given(request, result) if not words.startswith(("the data leave", "the fit did"))]
    text = report_text(result, fits, title=title, sources=sources, given=given)
    (folder / _REPORT).write_text(text, encoding="utf-8")


def _print(
    request: Request,
    name: str,
    result: Identification,
    fits: Sequence[FittedLoop],
    tests: Tests,
) -> None:
    """Print what was found."""
    screen = console()
    screen.print(
        f"[bold]{escape(name)}[/], {request.axis}: {_count(len(fits), 'loop')} of {_count(len(tests), 'file')}"
    )
    screen.print(f"  {escape(law_words(result))}", soft_wrap=True)
    for rows in (parameter_rows(result), loop_rows(fits), stage_rows(result)):
        screen.print(_table(rows))
    for words in sentences(result, fits) + remarks(tests, result):
        screen.print(f"  {escape(words)}", soft_wrap=True)


def _count(number: int, word: str) -> str:
    """Return a number of things in words."""
    return f"{number} {word}" if number == 1 else f"{number} {word}s"


def _table(rows: Rows) -> Table:
    """Return a table for the screen; long headings stand on two lines."""
    table = Table(
        box=box.SIMPLE_HEAD, title=escape(rows.title), title_style="bold", title_justify="left", pad_edge=False
    )
    for place, name in enumerate(rows.columns):
        words = name.replace(" [", "\n[") if place else name
        text = place == 0 or name in ("unit", "note")
        table.add_column(escape(words), justify="left" if text else "right")
    for row in rows.rows:
        table.add_row(*[escape(cell) for cell in row])
    return table
