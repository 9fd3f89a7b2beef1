"""How large a run will be, estimated before it begins."""

from pathlib import Path

from wirerope_mj.engine.simulation.recorder import column_plan
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.budget import require_disk, require_memory, require_time

NUMBER = 8  # bytes of a number

# bytes of memory that every sample takes where it is streamed: its instant, its number, and one column that is looked at
OF_AN_INSTANT = 4 * NUMBER
PILOTS = 6  # arrays of a pilot's samples that are held at once: rows and vectors of a coarse, a fine and a longer one


def check_size(
    system: System,
    *,
    duration: float,
    sample_rate: float,
    timestep: float | None = None,
    kept: float | None = None,
    out: Path | None = None,
) -> None:
    """Raise BudgetError if a run takes more memory, disk or time than there is.

    Args:
        system: the system.
        duration: simulated time [s].
        sample_rate: samples per second [Hz].
        timestep: largest step [s]; None where it is chosen.
        kept: time whose samples are kept in memory [s], of several runs together; None: the duration.
        out: folder to which samples are streamed instead.
    """
    samples, columns = duration * sample_rate, len(column_plan(system).names)
    asked = f"{duration:.4g} s with {sample_rate:.4g} samples a second"
    less = "Use a lower `sample_rate` or a shorter `duration`"
    require_time(f"a run of {asked}", max(samples, duration / timestep if timestep else 0.0), f"{less}.")
    what, size = f"the samples of this run, {asked} and {columns} columns,", NUMBER * columns
    if out is None:
        held = samples if kept is None else kept * sample_rate
        require_memory(what, held * size, f"{less}, or stream them to a folder (`out`).")
    else:
        require_disk(what, samples * size, out, f"{less}, or write to another disk.")
    require_memory(f"the instants of this run, {asked},", samples * OF_AN_INSTANT, f"{less}.")


def check_pilots(system: System, *, seconds: float, sample_rate: float) -> None:
    """Raise BudgetError if pilots of so many seconds in all take more memory than there is."""
    size = PILOTS * NUMBER * seconds * sample_rate * (system.model.nsensordata - system.assembly.sensor)
    require_memory(
        f"the runs by which a step is chosen, {seconds:.4g} s with {sample_rate:.4g} samples a second,",
        size,
        "Use a lower `sample_rate`, or give the `timestep`.",
    )
