"""`wirerope fmu`: a model as a functional mock-up unit for other simulation programs."""

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter


def fmu(
    model: str,
    out: Path,
    *,
    timestep: float | None = None,
    initial: Literal["settled", "relaxed", "unloaded"] = "settled",
    every: Annotated[bool, Parameter(negative=())] = False,
    force: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Write a model as a co-simulation unit of FMI 3, which other programs run as a part of theirs.

    Inputs are the base's acceleration and force and moment at every site force/NAME, held from one instant to the next; outputs
    are positions, accelerations, deflections and forces. The unit runs in a Python that has this package.

    Args:
        model: path of an MJCF file with mounts, or the name of one that ships with the package.
        out: file to write, ending in .fmu.
        timestep: largest step between two instants [s]; without it a tenth of the largest stable one.
        initial: how it begins.
        every: give out velocities, orientations and internal states, too.
        force: replace a file that is there.
    """
    from wirerope_mj.engine.system import load_system
    from wirerope_mj.foundation.plain_text import plain
    from wirerope_mj.runs.fmu import write_fmu

    system = load_system(model)
    written = write_fmu(system, out, timestep=timestep, initial=initial, every=every, force=force)
    print(plain(f"written: {written}, {written.stat().st_size / 1e6:.2f} MB"))
    return 0
