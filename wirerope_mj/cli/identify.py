"""`wirerope identify`: cyclic tests -> an isolator file, a table of the parameters, and a report."""

import math
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from rich.markup import escape

from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.mounts.identification.families import family_of
from wirerope_mj.mounts.identification.identify import identify
from wirerope_mj.mounts.identification.isolator_file import assumptions, falling_in_rating, identified_isolator
from wirerope_mj.mounts.identification.options import Constraint
from wirerope_mj.mounts.identification.records import Tests, contents, loop_warnings, read_tests
from wirerope_mj.mounts.identification.result import FittedLoop, Identification, fitted_loops
from wirerope_mj.mounts.isolator import Isolator, read_law
from wirerope_mj.mounts.laws import LAWS, Law, Masing, Stop
from wirerope_mj.mounts.vendor_parts import load_isolator
from wirerope_mj.runs.folder import atomic_run, check_target
from wirerope_mj.runs.report import REPORT, write_page
from wirerope_mj.views.report import check_pdf
from wirerope_mj.views.report.identification import (
    findings,
    identification_content,
    law_lines,
    loop_table,
    parameter_table,
    scale_tables,
    stage_table,
)
from wirerope_mj.views.terminal import console, print_lines, print_table

NOT_CONVERGED = 1
"""Exit code of a fit that did not converge."""

_PDF = "report.pdf"
_OLD_REPORT = "report.md"  # of older versions, which may be replaced
_OURS = (REPORT, _PDF, _OLD_REPORT, "loops.png", "residuals.png", "measures.png")
"""Files of a report, and those of older versions: of another fit they would be wrong."""
_ELEMENTS = 5  # of a Masing law: with eleven parameters within what an identification of four amplitudes can fix


@dataclass(frozen=True, kw_only=True)
class Request:
    """Arguments of the command, as `identify_options` describes them; None: its default."""

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
    join: Path | None = None
    elements: int | None = None
    scales: int | Literal["auto"] = 1
    start: Path | None = None
    force: bool = False
    accept_unconverged: bool = False
    pdf: bool = False

    @property
    def folder(self) -> Path:
        """Folder of the report."""
        return self.report or self.out.with_name(f"{self.out.stem}-report")

    @property
    def given(self) -> list[str]:
        """Conditions that are given to the fit."""
        texts = [*self.fix, *([self.constraint] if self.constraint is not None else [])]
        return [*texts, f"the law of {self.beside.name} beside it"] if self.beside is not None else texts


def identify_command(request: Request) -> int:
    """Fit a law to records, print the fit, write report and isolator; return the exit code."""
    kind, fixed = _kind(request), _fixed(request.fix)
    start = None if request.start is None else _start(request.start, request.axis)
    if request.beside is not None and request.join is not None:
        raise ValueError("`--beside` already keeps the other axes of its isolator; `--join` is for a law alone.")
    known = None if request.beside is None else load_isolator(request.beside)
    known_law = None if known is None else _known_law(known, request)
    whole = None if request.join is None else load_isolator(request.join)
    _check_outputs(request)
    tests = read_tests(request.files, stop=kind is Stop and known is None)
    loops = [loop for one in tests.values() for loop in one]
    result = identify(
        loops, law=kind, start=start, fixed=fixed, free=request.free, beside=known_law, constraint=request.constraint,
        elements=request.elements or _ELEMENTS, scales=request.scales,
    )  # fmt: skip
    fits = fitted_loops(result)
    isolator = identified_isolator(
        result, name=request.name or request.out.stem, axis=request.axis, files=request.files, given=request.given,
        known=known, whole=whole,
    )  # fmt: skip
    wanted, warnings = result.converged or request.accept_unconverged, loop_warnings(tests, result)
    if falling := falling_in_rating(result, request.axis, whole or known):
        warnings = [
            *warnings,
            f"{falling}, within the rated travel: a shock that goes there has no answer; test as far as that",
        ]
    with atomic_run(request.folder, force=request.force, kind="report", marks=_marks(request.folder)) as folder:
        _write_report(folder, request, result, fits, tests, warnings)
        _keep_others(request.folder, folder)
        if wanted:
            isolator.save(request.out)
    _print(request, isolator.name, result, fits, tests, warnings)
    screen = console()
    written = f"{REPORT}, {_PDF}" if request.pdf else REPORT
    screen.print(f"written: {escape(str(request.folder))}/ ({written})", soft_wrap=True)
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


def _fixed(options: Sequence[str]) -> dict[str, float]:
    """Return the values of NAME=VALUE."""
    values = {}
    for option in options:
        name, sign, text = option.partition("=")
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not (name and sign and math.isfinite(value)):
            raise ValueError(f"`--fix` must be NAME=VALUE with a number in SI units, got {option!r}.")
        if name in values:
            raise ValueError(f"`--fix` names {name!r} twice.")
        values[name] = value
    return values


def _start(path: Path, axis: str) -> Law:
    """Return the law of a law file, or of one axis of an isolator file."""
    if not path.is_file():
        raise ModelError(f"{path}: no such file. A search starts at a law file or at an isolator file.")
    content = read_toml(path, "start of a search")
    if {"law", "laws"} & content.keys():
        return read_law(content, f"{path}:", path.parent)
    table, location = content.get(axis), f"{path}: [{axis}]"
    if not isinstance(table, dict):
        raise ModelError(f"{location} is missing; a search on this axis has no start there.")
    return read_law(table, location, path.parent)


def _check_outputs(request: Request) -> None:
    """Raise an error unless isolator and report can be written."""
    out = request.out
    if out.suffix != ".toml":
        raise ValueError(f"`--out` is an isolator file and must end with .toml, got {str(out)!r}.")
    if not out.resolve().parent.is_dir():
        raise ValueError(f"`--out`: there is no folder {str(out.resolve().parent)!r}.")
    if out.is_dir():
        raise ValueError(f"`--out`: {out} is a folder.")
    if out.exists() and not request.force:
        raise ValueError(f"{out}: there is an isolator file already. Replace it with --force, or choose another path.")
    if request.pdf:
        check_pdf()
    check_target(request.folder, force=request.force, kind="report", marks=_marks(request.folder))


def _marks(folder: Path) -> tuple[str]:
    """Return the file by which a folder is known as a report."""
    return (_OLD_REPORT,) if (folder / _OLD_REPORT).is_file() else (REPORT,)


def _keep_others(before: Path, folder: Path) -> None:
    """Copy the other files of a report's folder into the one that replaces it."""
    for path in before.iterdir() if before.is_dir() else ():
        if path.name in _OURS:
            continue
        if path.is_dir() and not path.is_symlink():
            shutil.copytree(path, folder / path.name, symlinks=True)
        else:
            shutil.copy2(path, folder / path.name, follow_symlinks=False)


def _write_report(
    folder: Path, request: Request, result: Identification, fits: Sequence[FittedLoop], tests: Tests,
    warnings: Sequence[str],
) -> None:  # fmt: skip
    """Write the page into a folder, and its PDF."""
    from wirerope_mj.views.report import report_html

    kinds = " and ".join(law.name for law in result.law.components)
    if result.scales:
        kinds = f"{result.law.components[0].name} on {len(result.scales)} scales"
    sources = [f"{path}: {contents(loops)}" for path, loops in tests.items()] + list(warnings)
    content = identification_content(
        result, fits, title=f"{request.name or request.out.stem}, {request.axis}: {kinds}", sources=sources,
        given=assumptions(result, request.given),
    )  # fmt: skip
    write_page(report_html(content), [folder / REPORT, *([folder / _PDF] if request.pdf else [])])


def _print(
    request: Request,
    name: str,
    result: Identification,
    fits: Sequence[FittedLoop],
    tests: Tests,
    warnings: Sequence[str],
) -> None:
    screen = console()
    screen.print(
        f"[bold]{escape(name)}[/], {request.axis}: {_count(len(fits), 'loop')} of {_count(len(tests), 'file')}"
    )
    print_lines(law_lines(result))
    for table in (parameter_table(result), *scale_tables(result), loop_table(fits), stage_table(result)):
        print_table(table)
    print_lines([*findings(result, fits), *warnings])


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
