"""`wirerope levels`: files of levels to fill in, those of earthquakes, and few break points over a measured spectrum."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from cyclopts import App

from wirerope_mj.cli.options import Flag, Force, Integer, Texts

levels_app = App(name="levels")


@levels_app.default
def levels(
    name: str | None = None, *, sds: float | None = None, z_h: float | None = None, ag: float | None = None,
    ground: Literal["A", "B", "C", "D", "E"] | None = None, out: Path | None = None, force: Force = False,
) -> int:  # fmt: skip
    """List files of levels to fill in from a specification, or write one, for `wirerope shock MODEL --levels FILE`.

    The files name the fields and formulas of a standard. Levels are those of your own specification: none is built in, and a
    motion with an open level is refused. Those of earthquakes follow from the numbers of a site:

    wirerope levels ac156 --sds 1.2 --z-h 1

    `wirerope levels from RECORD` envelops the spectrum of a measured record by few break points.

    Args:
        name: of the file, such as bv_043; without it all are listed.
        sds: of ac156: design spectral acceleration at short periods S_DS [g].
        z_h: of ac156: height of the attachment over that of the building, from 0 to 1.
        ag: of en1998: design ground acceleration on rock times the importance factor [g].
        ground: of en1998: type of the ground, whose soil factor and corner periods of type 1 are taken.
        out: where it is written; NAME.toml in the current folder by default. Tables of spectra stand beside it and begin as it
            does: site2_horizontal.csv of site2.toml.
    """
    from wirerope_mj.cli.tables import print_questions
    from wirerope_mj.foundation.toml_file import read_toml
    from wirerope_mj.motions.registry import level_templates
    from wirerope_mj.motions.target_spectra import LEVELS, WRITERS

    templates = level_templates()
    if name is None:
        standards = {stem: read_toml(path, "file of levels")["standard"] for stem, path in templates.items()}
        print_questions("levels", standards | LEVELS)
        return 0
    if name not in (*templates, *LEVELS):
        raise ValueError(f"there are no levels {name!r}; there are {', '.join((*templates, *LEVELS))}.")
    sites: dict[str, dict[str, Any]] = {"ac156": {"sds": sds, "z_h": z_h}, "en1998": {"ag": ag, "ground": ground}}
    for standard, site in sites.items():
        for key, value in site.items():
            if (value is not None) != (standard == name):
                verb = "needs" if standard == name else "alone takes"
                raise ValueError(f"the file of levels {standard} {verb} --{key.replace('_', '-')}.")
    target = out or Path(f"{name}.toml")
    filled_in = WRITERS[name](**sites[name], stem=target.stem) if name in LEVELS else {}
    files = filled_in or {f"{target.stem}.toml": templates[name].read_text(encoding="utf-8")}
    written = {target if file == f"{target.stem}.toml" else target.parent / file: text for file, text in files.items()}
    _write(dict(reversed(written.items())), force=force)
    return 0


@levels_app.command(name="from")
def from_record(
    record: Path, *, srs: Flag = False, q: float = 10.0, points: Integer = 8, band: str | None = None,
    resolution: float | None = None, direction: str | None = None, channels: Texts = None, unit: str | None = None,
    out: Path | None = None, force: Force = False,
) -> int:  # fmt: skip
    """Envelop the spectrum of a measured acceleration along each axis by few break points, as specifications print them.

    The spectrum is the power spectral density, or with --srs the shock response spectrum (largest absolute acceleration). The
    points lie at preferred frequencies a sixth of an octave apart, slopes are whole decibels to an octave, and no measured line
    is above the curve.

    Args:
        record: file of the acceleration, as --record of `wirerope shock` takes it.
        srs: envelop the shock response spectrum.
        q: of it, amplification of the oscillators at resonance.
        points: break points at most.
        band: "20 to 2000 Hz"; by default what the record holds, of a density between lines within 40 dB of the largest one.
        resolution: distance of the lines of the density [Hz]; by default that of 15 segments.
        direction: of a record of one channel, as `wirerope shock` takes it.
        channels: which to use, NAME=DIRECTION, one or several; those named x, y and z by default.
        unit: of the accelerations, in place of what the file says, or does not say.
        out: CSV file that --psd of `wirerope shock`, or --required-spectrum, reads; of several axes OUT_x.csv, OUT_y.csv, ..
    """
    from wirerope_mj.content.measured_levels import measured_levels_content
    from wirerope_mj.foundation.errors import RecordError
    from wirerope_mj.foundation.quantities import parse_phrase
    from wirerope_mj.motions.break_points import record_envelopes
    from wirerope_mj.motions.records.record import Record
    from wirerope_mj.runs.said_motion import said_motion
    from wirerope_mj.views.terminal import show

    limits = None if band is None else parse_phrase(band, words={}).quantities.get("frequency", ())
    if limits is not None and len(limits) != 2:
        raise ValueError(f'`--band` is written "20 to 2000 Hz", got "{band}".')
    if srs and resolution is not None:
        raise ValueError("`--resolution` is of a power spectral density, and `--srs` asks for another spectrum.")
    motion = said_motion([], record=record, channels=channels, direction=direction, played={"unit": unit})
    assert isinstance(motion, Record)
    try:
        envelopes = record_envelopes(
            motion, band=limits and (limits[0], limits[1]), most=points, q=q if srs else None, resolution=resolution
        )
    except ValueError as error:
        raise RecordError(f"{record}: {error}") from None
    several = len(envelopes) > 1
    files = {out.with_stem(f"{out.stem}_{e.axis}") if several else out: e for e in envelopes} if out else {}
    show(measured_levels_content(record.name, envelopes, [path.name for path in files]))
    if files:
        _write({path: envelope.text for path, envelope in files.items()}, force=force)
    return 0


def _write(texts: Mapping[Path, str], *, force: bool) -> None:
    """Write files and print their names; RecordError, and none is written, where one exists and is not to be replaced."""
    from wirerope_mj.foundation.atomic_files import atomic_file
    from wirerope_mj.foundation.errors import RecordError

    for path in texts:
        if path.exists() and not force:
            raise RecordError(f"{path}: the file exists; --force replaces it.")
    for path, text in texts.items():
        with atomic_file(path) as temporary:
            temporary.write_text(text, encoding="utf-8")
    print(f"written: {', '.join(map(str, texts))}")
