"""The kind of a file that a user gives: by its ending, the keys of a TOML file, or the columns and units of a table."""

from collections.abc import Mapping
from pathlib import Path

from wirerope_mj.engine.from_tables.cad_list import columns_of_masses
from wirerope_mj.foundation.regular_files import regular
from wirerope_mj.foundation.structure import keys_of
from wirerope_mj.foundation.table_files import read_header
from wirerope_mj.foundation.table_header import TIME_COLUMN, Header
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.foundation.units import (
    ACCELERATION_UNITS,
    FORCE_UNITS,
    FREQUENCY_UNITS,
    LENGTH_UNITS,
    PSD_UNITS,
    TIME_UNITS,
    find_unit,
    underscored_unit,
)
from wirerope_mj.motions.psd_lines import FORCE_COLUMNS
from wirerope_mj.motions.records.record import is_measurement
from wirerope_mj.motions.records.uff import is_uff
from wirerope_mj.runs.new_model import TABLES
from wirerope_mj.runs.scenario import defines
from wirerope_mj.runs.schemas import FILES

# What messages call each kind, and how one is recognised.
KINDS = {
    "model": "MJCF, .xml with <mujoco>", "scenario": "Python with `def scenario`", "study": "Python with `def study`",
    "isolator": "TOML with [axial], [shear] or [roll]", "law": "TOML with `law`", "datasheet": "TOML with [compression]",
    "levels": "TOML with [[motion]]", "job": "TOML with `model` and [[case]]", "life": "TOML with [[stage]] and `exponent`",
    "map": "TOML with [channels]", "mounts": "table with isolator, x, y, z", "masses": "table with name, mass; .urdf",
    "stops": "table with name, gap, stiffness", "points": "table with name, x, y, z", "forces": "as points, called forces",
    "envelope": "table with size_x, size_y, size_z", "folder of tables": "mounts.csv and masses.csv in it",
    "run": "folder with scenario.toml", "density": "table with a column [g^2/Hz]",
    "spectrum": "table of frequency [Hz] and acceleration [g]", "amplitudes": "table of frequency [Hz] and displacement [mm]",
    "cyclic test": "table of deflection [mm] and force [N]", "curve": "table of deflection, upper, lower",
    "forces over time": "table of time, fx, fy, fz, mx, my, mz", "record": "table with time [s] and a column [g]; .uff, .mat",
}  # fmt: skip


_DENSITIES = {"psd", "asd", "power spectral density"}  # what a column of a density may be called, with a unit or without


def kind_of(path: Path) -> str | None:
    """Tell the kind of a file, a key of `KINDS`; None where it cannot be told.

    RecordError or ModelError if it is TOML or a table by its ending and cannot be read.
    """
    ending = path.suffix.lower()
    if ending == ".toml":
        content = read_toml(path, "TOML file")
        if {"law", "laws"} & content.keys():
            return "law"
        if "format" in content:  # written by a command, which reads it with the folder around it
            return None
        fits = {
            kind: max(2 * len(content.keys() & keys_of(one).keys()) - len(content) for one in classes)
            for kind, classes in FILES.items() if kind != "scenario"
        }  # fmt: skip
        best = max(fits, key=fits.__getitem__)
        return best if fits[best] > -len(content) // 2 else None
    if ending == ".xml":
        return "model" if b"<mujoco" in regular(path).read_bytes() else None
    if ending == ".py":
        return next((kind for kind in ("scenario", "study") if defines(path, kind)), None)
    if ending == ".urdf" or (ending == ".txt" and path.stem.lower() == "masses"):
        return "masses"
    if is_uff(path):
        return "record"
    return _kind_of_table(read_header(path, kind="table", example='"time [s], z [g]"')) if is_measurement(path) else None


def _kind_of_table(header: Header) -> str | None:
    """Tell the kind of a table by its file's name and by the names and units of its columns; None where it cannot be told."""
    names = {name.lower() for name in header.names}
    if {"part", "loops"} <= names:  # a vendor's table, which the package itself reads
        return None
    stem = (header.sheet or header.path.stem).lower()
    if stem in TABLES and (names & {"name", "x"} or stem == "masses"):
        return stem
    if "name" in names:
        own = {"stops": {"gap", "gap_up", "acts"}, "envelope": {"size_x", "corner_x", "centre_x"}, "mounts": {"isolator"}}
        if "mass" not in names and (kind := next((kind for kind, marks in own.items() if names & marks), None)):
            return kind
    if {"name", "mass"} <= set(columns_of_masses(header.names)):
        return "masses"
    if {"name", "x", "y", "z"} <= names:
        return "points"
    if has_unit(header, PSD_UNITS) or names & _DENSITIES or names >= {"from", "to", "slope"}:
        return "density"
    if has_unit(header, FREQUENCY_UNITS):
        return "spectrum" if has_unit(header, ACCELERATION_UNITS) and "from" not in names else "amplitudes"
    if names & {"upper", "lower"} and has_unit(header, FORCE_UNITS):
        return "curve"
    if names & {*FORCE_COLUMNS} and names & {"time"}:
        return "forces over time"
    if has_unit(header, LENGTH_UNITS) and has_unit(header, FORCE_UNITS) and not has_unit(header, ACCELERATION_UNITS):
        return "cyclic test"
    timed = has_unit(header, TIME_UNITS) or any(TIME_COLUMN.fullmatch(name) for name in header.names)
    return "record" if timed else None


def has_unit(header: Header, units: Mapping[str, float]) -> bool:
    """Tell whether any column of a table has one of the `units`."""
    return any(
        find_unit(unit or "", units) or underscored_unit(name, units)[1]
        for name, unit in zip(header.names, header.units, strict=True)
    )
