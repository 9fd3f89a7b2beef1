"""`wirerope export`: the samples of a run, its spectra, or the table of a study for other programs."""

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter


def export(
    folder: Path,
    out: Path,
    *,
    spectrum: str | None = None,
    q: float = 10.0,
    force: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Write the samples of a run, or the table of a study, for other programs: CSV, HDF5 or MATLAB.

    The ending of OUT says which: .csv, .h5 or .hdf5, .mat. Numbers are SI with all their digits; names and units of the columns
    stand in the header, with every dataset, or in the variables `variables`, `names` and `units`.

    Args:
        folder: folder of a run or a study.
        out: file to write.
        spectrum: name of a body, a point or "base": its shock response spectra along x, y and z in place of the samples. They
            reach a tenth of the run's sample rate; up to where the samples hold them within 1 % is printed.
        q: amplification of the spectra's oscillators at resonance.
        force: replace a file that is there.
    """
    from wirerope_mj.engine.response import load_response
    from wirerope_mj.foundation.errors import RecordError
    from wirerope_mj.foundation.exports import write_export
    from wirerope_mj.foundation.plain_text import plain
    from wirerope_mj.motions.spectra import shock_response_spectrum
    from wirerope_mj.motions.spectra.srs import exported_spectra, held
    from wirerope_mj.studies.inputs_file import STUDY
    from wirerope_mj.studies.study import load_study

    if spectrum is None:
        table = (load_study(folder) if (folder / STUDY).is_file() else load_response(folder)).exported
    else:
        response = load_response(folder)
        moved: dict[str, Any] = {"base": response.base, **response.bodies, **response.points}
        if spectrum not in moved:
            raise RecordError(f"`--spectrum`: nothing is called {spectrum!r}; there are {', '.join(moved)}.")
        acceleration = moved[spectrum].acceleration
        spectra = shock_response_spectrum(response.time, acceleration, q=q)
        table, up_to = exported_spectra(spectra), held(response.time, acceleration, spectra)
        print(f"The samples hold it within 1 % {f'up to {up_to:.3g} Hz' if up_to else 'nowhere'}.")
    written = write_export(table, out, force=force)
    print(plain(f"written: {written} ({len(table.names)} columns, {written.stat().st_size / 1e6:.2f} MB)"))
    return 0
