"""The options of `wirerope loops`."""

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from wirerope_mj.cli.integers import Integer


def loops(
    source: str,
    *,
    amplitudes: Annotated[
        list[float] | None, Parameter(name=("--amplitudes", "--amplitudes-mm"), consume_multiple=True, negative=())
    ] = None,
    operating_point_mm: float = 0.0,
    axis: Literal["roll", "shear", "axial"] | None = None,
    frequency: float = 1.0,
    cycles: Integer | None = None,
    out: Path | None = None,
    csv: Path | None = None,
) -> int:
    """Test an isolator or a law in a virtual rig: print what its loops measure and draw them.

    Args:
        source: isolator of the catalogue, or the path of an isolator file or of a law file: a TOML file that holds what stands
            under an axis of an isolator file, law = "..." and its parameters.
        amplitudes: of the sine [mm], one or several; 5, 10, 25, 50 and 100 % of the rated travel by default.
        operating_point_mm: mean deflection [mm], negative in compression; the test ramps there first.
        axis: the only axis to test; for a law file the axis that it stands for, axial by default.
        frequency: of the sine [Hz]; without effect on a rate-independent law.
        cycles: cycles to run before the loop is taken; until it closes by default.
        out: where the picture is written (.png, .svg, .pdf); NAME-loops.png in the current folder by default.
        csv: where the loops of one axis are written, in m and N.
    """
    from wirerope_mj.cli.loops import print_loops

    print_loops(
        source,
        None if amplitudes is None else [size / 1e3 for size in amplitudes],
        operating_point=operating_point_mm / 1e3,
        axis=axis,
        frequency=frequency,
        cycles=cycles,
        out=out,
        csv=csv,
    )
    return 0
