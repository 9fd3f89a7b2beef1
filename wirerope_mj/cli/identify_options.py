"""The options of `wirerope identify`."""

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from wirerope_mj.cli.options import Integer


def identify_records(
    *files: Path,
    law: str,
    out: Path,
    axis: Literal["roll", "shear", "axial"] = "axial",
    report: Path | None = None,
    name: str | None = None,
    constraint: Literal["beta>gamma", "beta=gamma", "beta<gamma"] | None = None,
    fix: Annotated[list[str] | None, Parameter(consume_multiple=True, negative=())] = None,
    free: Annotated[list[str] | None, Parameter(consume_multiple=True, negative=())] = None,
    beside: Path | None = None,
    join: Path | None = None,
    elements: Integer | None = None,
    scales: Literal["1", "2", "3", "auto"] = "1",
    start: Path | None = None,
    force: Annotated[bool, Parameter(negative=())] = False,
    accept_unconverged: Annotated[bool, Parameter(negative=())] = False,
    pdf: Annotated[bool, Parameter(negative=())] = False,
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
        pdf: write a PDF of the report beside it, which needs the extra "pdf" (WeasyPrint).
    """
    from wirerope_mj.cli.identify import Request, identify_command

    if not files:
        raise ValueError("name the records: wirerope identify TEST.csv .. --law LAW --out ISOLATOR.toml")
    request = Request(
        files=files, law=law, out=out, axis=axis, report=report, name=name, constraint=constraint, fix=fix or (),
        free=free or (), beside=beside, join=join, elements=elements,
        scales="auto" if scales == "auto" else int(scales), start=start, force=force,
        accept_unconverged=accept_unconverged, pdf=pdf,
    )  # fmt: skip
    return identify_command(request)
