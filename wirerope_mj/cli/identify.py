"""`wirerope identify`: cyclic tests -> an isolator file, a table of the parameters, and a report."""

import math
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from rich.markup import escape

from wirerope_mj.cli.options import All, Flag, Integer, Texts
from wirerope_mj.content.identification import identification_content
from wirerope_mj.foundation.atomic_files import atomic_folder, check_folder, check_writable
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.structure import Place
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.mounts.identification.families import family_of
from wirerope_mj.mounts.identification.identify import identify
from wirerope_mj.mounts.identification.records import (
    assumptions,
    contents,
    falling_in_rating,
    identified_isolator,
    loop_warnings,
    read_tests,
    turned_round,
)
from wirerope_mj.mounts.identification.result import fitted_loops
from wirerope_mj.mounts.isolator import read_law
from wirerope_mj.mounts.laws import LAWS, Law, Masing, Stop
from wirerope_mj.mounts.vendor_parts import load_isolator
from wirerope_mj.runs.page import REPORT, write_page
from wirerope_mj.views.terminal import console, show_result
from wirerope_mj.views.typesetting import load_typst

NOT_CONVERGED = 1  # Exit code of a fit that did not converge
_PDF = "report.pdf"
_OLD_REPORT = "report.md"  # of older versions, which may be replaced
# Files of a report, and those of older versions: of another fit they would be wrong.
_OURS = (REPORT, _PDF, _OLD_REPORT, "loops.png", "residuals.png", "measures.png")
_ELEMENTS = 5  # of a Masing law: with eleven parameters within what an identification of four amplitudes can fix


def identify_records(
    *files: Path,
    law: str,
    out: Path,
    axis: Literal["roll", "shear", "axial"] = "axial",
    report: Path | None = None,
    name: str | None = None,
    constraint: Literal["beta>gamma", "beta=gamma", "beta<gamma"] | None = None,
    fix: Texts = None,
    free: Texts = None,
    beside: Path | None = None,
    join: Path | None = None,
    elements: Integer | None = None,
    scales: Literal["1", "2", "3", "auto"] = "1",
    start: Path | None = None,
    force: Flag = False,
    accept_unconverged: Flag = False,
    every: All = False,
    pdf: Flag = False,
) -> int:
    """Fit a law to records of cyclic tests: an isolator file, what the data fix, and a report.

    Records are CSV with units in the header, such as "time [s], deflection [mm], force [kN]", of any sampling, with several
    cycles, amplitudes and operating points one after the other or in several files. A fit that does not converge exits 1 and
    writes its report alone.

    Args:
        files: records, one or several.
        law: to fit: asymmetric-bouc-wen for tension and compression, symmetric-bouc-wen for shear and roll, bouc-wen, ozdemir,
            vaiana-rosati, enhanced-dry-friction or masing; stop for a bump stop, alone or with --beside.
        out: isolator file to write.
        axis: along which the tests moved.
        report: folder of the report; NAME-report beside the isolator file by default.
        name: of the isolator; that of its file by default.
        constraint: on beta and gamma, where nothing else tells them apart.
        fix: parameters that are given, NAME=VALUE in SI units, by the names that the table prints.
        free: parameters that are searched for, though they are given otherwise: a stop's exponent (1) and rounding (0), k2 and
            k3 of a masing law (0).
        beside: isolator file whose law on this axis is known and acts in parallel, as where the isolator strikes its bumper;
            the file written is that isolator with both laws.
        join: isolator file to which the law is added, or in which it takes the place of that axis' law: other axes, limits and
            geometry stay. One axis after the other makes the isolator whole.
        elements: Jenkin elements of a masing law; 5 by default.
        scales: of friction, of a Bouc-Wen law or one of Ni's: so many sets in parallel with one spring and one asymmetry;
            auto: as many as amplitudes left out support.
        start: law file or isolator file from which a search in three stages begins, besides those from a grid.
        force: replace an isolator file and a report that are there.
        accept_unconverged: write the isolator even of a fit that did not converge.
        pdf: write a PDF of the report beside it, which needs the extra "pdf" (Typst).
    """
    if not files:
        raise ValueError("name the records: wirerope identify TEST.csv .. --law LAW --out ISOLATOR.toml")
    kind, values = _kind(law, elements), _fixed(fix or ())
    first = None if start is None else _start(start, axis)
    if beside is not None and join is not None:
        raise ValueError("`--beside` already keeps the other axes of its isolator; `--join` is for a law alone.")
    known = None if beside is None else load_isolator(beside)
    known_law = None if known is None else known.conditioned.axes[axis]
    if known is not None and known_law is None:
        raise ModelError(f"{beside}: [{axis}] is missing; nothing is known beside what the tests moved.")
    whole = None if join is None else load_isolator(join)
    target, name = report or out.with_name(f"{out.stem}-report"), name or out.stem
    _check_outputs(out, target, force=force, pdf=pdf)
    tests = read_tests(files, stop=kind is Stop and known is None)
    result = identify(
        [loop for loops in tests.values() for loop in loops], law=kind, start=first, fixed=values, free=free or (),
        beside=known_law, constraint=constraint, elements=elements or _ELEMENTS,
        scales="auto" if scales == "auto" else int(scales),
    )  # fmt: skip
    given = [*(fix or ()), *([constraint] if constraint is not None else [])]
    given += [f"the law of {beside.name} beside it"] if beside is not None else []
    isolator = identified_isolator(result, name=name, axis=axis, files=files, given=given, known=known, whole=whole)
    kinds = " and ".join(one.name for one in result.law.components)
    if result.scales:
        kinds = f"{result.law.components[0].name} on {len(result.scales)} scales"
    warnings, unseen = loop_warnings(tests, result)
    if falling := falling_in_rating(result, axis, whole or known):
        warnings.append(f"{falling}, within the rated travel: a shock that goes there has no answer; test as far as that")
    if turned := turned_round(result, axis):
        warnings.append(turned)
    content = identification_content(
        result, fitted_loops(result), title=f"{name}, {axis}: {kinds}",
        sources=[f"{path}: {contents(loops)}{unseen.get(path, '')}" for path, loops in tests.items()], warnings=warnings,
        given=assumptions(result, given),
    )  # fmt: skip
    wanted = result.converged or accept_unconverged
    with atomic_folder(target, force=force, kind="report", marks=_marks(target)) as folder:
        write_page(content, [folder / REPORT, *([folder / _PDF] if pdf else [])])
        _keep_others(target, folder)
        if wanted:
            isolator.save(out)
    show_result(content, "brief", "answer", "parameters", others=("loops-and-residuals", "search"), every=every)
    _print_written(out, f"{target}/ ({f'{REPORT}, {_PDF}' if pdf else REPORT})", wanted=wanted)
    return 0 if result.converged else NOT_CONVERGED


def _print_written(out: Path, report: str, *, wanted: bool) -> None:
    """Print where report and isolator are, or why there is no isolator."""
    screen, isolator = console(), escape(str(out))
    screen.print(f"written: {escape(report)}", soft_wrap=True)
    if wanted:
        screen.print(f"written: {isolator}", soft_wrap=True)
        return
    screen.print(
        f"[bold]not written[/]: {isolator}, because the fit did not converge; test more amplitudes, fix parameters or take "
        "another law, or take it as it is with --accept-unconverged.",
        soft_wrap=True,
    )
    if out.exists():
        screen.print(f"  {isolator} stands there from before: it is not of this fit.", soft_wrap=True)


def _kind(name: str, elements: int | None) -> type[Law]:
    """Find the class of a law by its name; ValueError unless cyclic tests can identify it."""
    if name not in LAWS:
        raise ValueError(f"`--law`: there is no law {name!r}; the laws are {', '.join(sorted(LAWS))}.")
    family_of(LAWS[name], _ELEMENTS if elements is None else elements)  # raises if it cannot be identified
    if elements is not None and LAWS[name] is not Masing:
        raise ValueError(f"`--elements` counts the Jenkin elements of a masing law; {name} has none.")
    return LAWS[name]


def _fixed(options: Sequence[str]) -> dict[str, float]:
    """Read values in SI units by name from texts NAME=VALUE."""
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
    """Read the law at which a search starts from a law file, or from one axis of an isolator file."""
    if not path.is_file():
        raise ModelError(f"{path}: no such file. A search starts at a law file or at an isolator file.")
    content = read_toml(path, "start of a search")
    if {"law", "laws"} & content.keys():
        return read_law(content, Place(path))
    if not isinstance(content.get(axis), dict):
        raise ModelError(f"{path}: [{axis}] is missing; a search on this axis has no start there.")
    return read_law(content[axis], Place(path, (axis,)))


def _check_outputs(out: Path, report: Path, *, force: bool, pdf: bool) -> None:
    """Raise an error unless isolator and report can be written."""
    if out.suffix != ".toml":
        raise ValueError(f"`--out` is an isolator file and must end with .toml, got {str(out)!r}.")
    check_writable(out, force=force)
    if pdf:
        load_typst()
    check_folder(report, force=force, kind="report", marks=_marks(report))


def _marks(folder: Path) -> tuple[str]:
    """Name the file by which a folder is known as that of a report."""
    return (_OLD_REPORT,) if (folder / _OLD_REPORT).is_file() else (REPORT,)


def _keep_others(before: Path, folder: Path) -> None:
    """Copy files that are not of the report from its folder into the one that replaces it."""
    for path in before.iterdir() if before.is_dir() else ():
        if path.name in _OURS:
            continue
        if path.is_dir() and not path.is_symlink():
            shutil.copytree(path, folder / path.name, symlinks=True)
        else:
            shutil.copy2(path, folder / path.name, follow_symlinks=False)
