"""`wirerope share`, `film`, `export` and `fmu`: a run, its numbers or a model for other people and programs."""

from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from wirerope_mj.cli.options import Flag, Force, Model, Repeated


def share(folder: Path, out: Path, *, force: Force = False) -> int:
    """Write report, recording and viewer of a run as one folder that any web server shows.

    Instants of events and verdicts in the report open the timeline where they are. Nothing needs the network at view time.

    Args:
        folder: folder of a run.
        out: folder to write.
    """
    from wirerope_mj.foundation.plain_text import plain
    from wirerope_mj.runs.report import share_run

    files = share_run(folder, out, force=force)
    size = sum(path.stat().st_size for path in files) / 1e6
    print(plain(f"written: {out}, {len(files)} files, {size:.0f} MB, of which the viewer takes most"))
    print(plain(f"python -m http.server --directory {out} shows it at http://localhost:8000"))
    return 0


def film(*paths: Path, at: str | None = None, gif: Flag = False, force: Force = False) -> int:
    """Film the worst 400 ms of a run, or of two runs beside each other, in slow motion.

    wirerope film RUN [RUN] OUT.mp4

    Plan and side view with displacements enlarged stand beside the most critical acceleration and deflection with their limits,
    a running cursor and the verdict, 1920 x 1080. It needs no screen; pip install 'wirerope-mj[film]' brings what writes it.

    Args:
        paths: folders of one run or two, and the file to write, ending in .mp4.
        at: instant in the middle, such as "120 ms"; that of the most critical verdict by default.
        gif: write a GIF of half the size beside it, too.
    """
    from wirerope_mj.foundation.plain_text import plain
    from wirerope_mj.runs.report import write_films

    *folders, out = paths or (Path(),)
    for file in write_films(folders, out, gif=gif, at=at, force=force):
        print(plain(f"written: {file}, {file.stat().st_size / 1e6:.1f} MB"))
    return 0


def export(
    folder: Path, out: Path, *, channels: Repeated = None,
    at: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None, spectrum: str | None = None, q: float = 10.0,
    force: Force = False,
) -> int:  # fmt: skip
    """Write the samples of a run, or the table of a study or frequency response, as CSV, HDF5, MATLAB or XLSX; or a picture.

    The ending of OUT says which: .csv, .h5 or .hdf5, .mat; .xlsx, a workbook with every table of the report in a sheet of its
    own, and the samples that --channels names; .png, the scene at an instant. Numbers are SI with all their digits, in the
    tables of a workbook in the units of the report; names and units of the columns stand in the header, with every dataset, or
    in the variables `variables`, `names` and `units`.

    Args:
        folder: folder of a run, a study or a frequency response (its branches, or else its sweeps); for .xlsx of a job, too.
        out: file to write.
        channels: which columns, a pattern with * and ?, such as `mounts/*/force/*` or `bodies/rack/acceleration/z`; again for
            further ones; all by default, of .xlsx none.
        at: instant of the picture, such as "120 ms"; that of the most critical verdict by default.
        spectrum: name of a body, a point or "base": its shock response spectra along x, y and z in place of the samples. They
            reach a tenth of the run's sample rate, those of a base that moves by a formula 1 kHz, as in the report; up to where
            the samples hold them within 1 % is printed.
        q: amplification of the spectra's oscillators at resonance.
    """
    from wirerope_mj.content.run_spectra import fine_base, held_text
    from wirerope_mj.engine.response import load_response
    from wirerope_mj.foundation.errors import RecordError, WireRopeError
    from wirerope_mj.foundation.exports import picked, write_export
    from wirerope_mj.foundation.plain_text import plain
    from wirerope_mj.motions.registry import motion_from_dict
    from wirerope_mj.motions.spectra import shock_response_spectrum
    from wirerope_mj.motions.spectra.srs import exported_spectra, resolved_frequency
    from wirerope_mj.runs.analyses import is_frequency_response, stored_response
    from wirerope_mj.runs.report import RENDERERS, write_content_of, write_still
    from wirerope_mj.studies.inputs_file import STUDY
    from wirerope_mj.studies.study import load_study

    kind = out.suffix.lower()
    if kind == ".png" or at is not None:
        if kind != ".png" or channels or spectrum is not None:
            raise ValueError("`--at` says the instant of a picture, OUT.png, which has no `--channels` and no `--spectrum`.")
        print(plain(f"written: {write_still(folder, out, at=at, force=force)}"))
        return 0
    if kind in RENDERERS and spectrum is None:
        print(plain(f"written: {write_content_of(folder, out, channels=channels or (), force=force)}"))
        return 0
    if spectrum is None:
        if is_frequency_response(folder):
            table = stored_response(folder)[1]
        else:
            table = (load_study(folder) if (folder / STUDY).is_file() else load_response(folder)).exported
        table = picked(table, channels) if channels else table
    else:
        response = load_response(folder)
        moved: dict[str, Any] = {"base": response.base, **response.bodies, **response.points}
        if spectrum not in moved:
            raise RecordError(f"`--spectrum`: nothing is called {spectrum!r}; there are {', '.join(moved)}.")
        time, acceleration = response.time, moved[spectrum].acceleration
        if spectrum == "base":
            told = {name: value for name, value in response.motion.items() if name != "description"}
            with suppress(WireRopeError, ValueError):  # of a record that is not there, or a motion of the caller's own: samples
                time, acceleration = fine_base(motion_from_dict(told, folder=folder), response) or (time, acceleration)
        spectra = shock_response_spectrum(time, acceleration, q=q)
        table = exported_spectra(spectra)
        held = held_text(resolved_frequency(time, acceleration, spectra))
        print(f"{(time.size - 1) / time[-1]:.5g} samples a second hold it {held}.")
    written = write_export(table, out, force=force)
    print(plain(f"written: {written} ({len(table.names)} columns, {written.stat().st_size / 1e6:.2f} MB)"))
    return 0


def fmu(
    model: Model, out: Path, *, timestep: float | None = None, initial: Literal["settled", "relaxed", "unloaded"] = "settled",
    every: Flag = False, force: Force = False,
) -> int:  # fmt: skip
    """Write a model as a co-simulation unit of FMI 3, which other programs run as a part of theirs.

    Inputs are the base's acceleration and force and moment at every site force/NAME, held from one instant to the next; outputs
    are positions, accelerations, deflections and forces. The unit runs in a Python that has this package.

    Args:
        out: file to write, ending in .fmu.
        timestep: largest step between two instants [s]; without it a tenth of the largest stable one.
        initial: how it begins.
        every: give out velocities, orientations and internal states, too.
    """
    from wirerope_mj.engine.system import load_system
    from wirerope_mj.foundation.plain_text import plain
    from wirerope_mj.runs.fmu import write_fmu

    system = load_system(model)
    written = write_fmu(system, out, timestep=timestep, initial=initial, every=every, force=force)
    print(plain(f"written: {written}, {written.stat().st_size / 1e6:.2f} MB"))
    return 0
