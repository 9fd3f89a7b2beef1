"""`wirerope isolators`: its options, and those of `fit` and `estimate`."""

from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from wirerope_mj.cli.integers import Integer

isolators_app = App(
    name="isolators",
    help="Show the isolators of the catalogue, fit one from a data sheet, or estimate one from its geometry.",
)


@isolators_app.default
def isolators(
    name: str | None = None,
    *,
    all: Annotated[bool, Parameter(negative=())] = False,  # noqa: A002  # the option's name
    out: Path | None = None,
) -> int:
    """Show the catalogue, or one isolator: its parameters, what its loops measure, and their picture.

    `wirerope isolators fit DATASHEET OUT` makes an isolator file from a vendor's data sheet, and `wirerope isolators estimate`
    one from the geometry alone.

    Args:
        name: isolator of the catalogue, part of a vendor's table such as CB1500-30, or the path of an isolator file; without it
            the whole catalogue.
        all: list the parts of the vendors' tables instead, each of which is a name, too.
        out: where the picture of the loops is written (.png, .svg, .pdf).
    """
    from wirerope_mj.cli.isolators import print_isolator, print_isolators, print_parts

    if name is None:
        if out is not None:
            raise ValueError("`--out` writes the picture of one isolator; name it: wirerope isolators NAME --out FILE")
        (print_parts if all else print_isolators)()
    else:
        print_isolator(name, out)
    return 0


@isolators_app.command
def fit(datasheet: Path, out: Path) -> int:
    """Fit an isolator from a vendor's data sheet and print every value of the sheet beside that of the fit.

    Args:
        datasheet: TOML file with the vendor's values, or with `curve = "shock"` or `"static"` and force-deflection curves.
        out: isolator file to write.
    """
    from wirerope_mj.cli.isolators import fit_isolator

    fit_isolator(datasheet, out)
    return 0


@isolators_app.command
def estimate(
    *,
    height: float,
    width: float,
    rope: float,
    loops: Integer,
    bar: float | None = None,
    bar_length: float | None = None,
    out: Path | None = None,
) -> int:
    """Estimate an isolator without data sheet from its geometry, with the errors that such estimates make of known parts.

    Args:
        height: unloaded, over both bars [mm].
        width: over the ropes, across the bars [mm].
        rope: diameter [mm].
        loops: number of full loops.
        bar: thickness of one bar [mm]; as known parts of this rope have it by default.
        bar_length: over which the loops are spread evenly [mm], for the rotational stiffness.
        out: isolator file to write; it says that all is estimated.
    """
    from wirerope_mj.cli.estimate import estimate_command

    estimate_command(height=height, width=width, rope=rope, loops=loops, bar=bar, bar_length=bar_length, out=out)
    return 0
