"""`wirerope replay`: a run, or the load cases of a job, computed again from the folder alone."""

import math
from pathlib import Path

from wirerope_mj.cli.options import DIFFERENT
from wirerope_mj.foundation.plain_text import plain


def replay(folder: Path) -> int:
    """Simulate a run, a job or a study again from its folder alone: whether its numbers agree, which files were altered.

    Compared are all stored numbers: samples, peaks, states, and those of summary.json; of a study its table. The exit code is
    0, or 1 if they do not agree or a file of a run was altered or removed since it was written.

    Args:
        folder: folder of a run; of a job, whose load cases are simulated one after the other; or of a study.
    """
    from wirerope_mj.runs.job import case_folders, is_job
    from wirerope_mj.runs.repeat import AGREES, replay_study
    from wirerope_mj.studies.inputs_file import STUDY

    if (folder / STUDY).is_file():
        largest, column = replay_study(folder, progress=True)
        text = f"largest difference {largest:.3g}, relative to the largest, in {column}" if column else "bit-identical"
        agrees = "the tables agree" if largest <= AGREES else "the tables do not agree"
        print(plain(f"{folder}: every variant simulated again: {text}; {agrees}."))
        return 0 if largest <= AGREES else DIFFERENT
    return max(map(_replay_run, case_folders(folder) if is_job(folder) else [folder]))


def _replay_run(folder: Path) -> int:
    """Simulate a run again, print whether its numbers agree and files were altered, and return the exit code."""
    from wirerope_mj.runs import replay as replay_run

    result = replay_run(folder, progress=True)
    if result.identical:
        text = "every stored number is bit-identical: samples, peaks, states and summary."
    elif math.isinf(result.largest_difference):
        text = f"{result.column} is not what is computed from the folder; the numbers do not agree."
    else:
        cause = "rounding, as of another processor" if result.agrees else "the numbers do not agree"
        text = f"largest difference {result.largest_difference:.3g}, relative to the peak, in {result.column}; {cause}."
    print(plain(f"{folder}: {text}"), flush=True)
    if result.alterations is None:
        print("There is no checksums.txt here: what else was altered since the run was written is not known.")
    else:
        print(plain(result.alterations.text or "No file was altered since the run was written."))
    return 0 if result.agrees and result.intact else DIFFERENT
