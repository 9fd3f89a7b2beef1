"""`wirerope export`: the samples of a run or the table of a study for other programs."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter


def export(folder: Path, out: Path, *, force: Annotated[bool, Parameter(negative=())] = False) -> int:
    """Write the samples of a run, or the table of a study, for other programs: CSV, HDF5 or MATLAB.

    The ending of OUT says which: .csv, .h5 or .hdf5, .mat. Numbers are SI with all their digits; names and units of the columns
    stand in the header, with every dataset, or in the variables `variables`, `names` and `units`.

    Args:
        folder: folder of a run or a study.
        out: file to write.
        force: replace a file that is there.
    """
    from wirerope_mj.engine.response import load_response
    from wirerope_mj.foundation.plain_text import plain
    from wirerope_mj.studies.inputs_file import STUDY
    from wirerope_mj.studies.study import load_study

    table = load_study(folder) if (folder / STUDY).is_file() else load_response(folder)
    written = table.export(out, force=force)
    print(plain(f"written: {written} ({len(table.exported.names)} columns, {written.stat().st_size / 1e6:.2f} MB)"))
    return 0
