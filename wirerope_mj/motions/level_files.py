"""Power spectral density, response spectrum or forces over time, from a CSV file with units in its header."""

from collections.abc import Mapping
from pathlib import Path

from wirerope_mj.foundation.csv_units import number_in, read_header, rows_below
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.units import ACCELERATION_UNITS, FORCE_UNITS, STANDARD_GRAVITY, TIME_UNITS, in_si
from wirerope_mj.motions.psd_lines import Points, checked_points

PSD_UNITS = {
    "g^2/Hz": STANDARD_GRAVITY**2,
    "g2/Hz": STANDARD_GRAVITY**2,
    "g²/Hz": STANDARD_GRAVITY**2,
    "(m/s^2)^2/Hz": 1.0,
    "(m/s2)2/Hz": 1.0,
    "(m/s²)²/Hz": 1.0,
    "m^2/s^3": 1.0,
    "m2/s3": 1.0,
}
FORCE_COLUMNS = ("fx", "fy", "fz", "mx", "my", "mz")

ForceRows = tuple[tuple[float, ...], tuple[tuple[float, ...], ...]]  # times [s] and loads [N, N m], (n,) and (n, 6)
_MOMENT_UNITS = {"N.m": 1.0, "Nm": 1.0, "N m": 1.0, "kN.m": 1e3, "kNm": 1e3, "kN m": 1e3}
_FREQUENCY_UNITS = {"Hz": 1.0, "kHz": 1e3}


def psd_points(path: Path) -> Points:
    """Return the points (frequency [Hz], level [(m/s^2)^2/Hz]) of a file such as "frequency [Hz], psd [g^2/Hz]".

    Raises:
        RecordError: the file cannot be read, or is not such a table; names the line.
    """
    return _points(path, PSD_UNITS, kind="power spectral density", example='"frequency [Hz], psd [g^2/Hz]"')


def spectrum_points(path: Path) -> Points:
    """Return the points (frequency [Hz], acceleration [m/s^2]) of a file such as "frequency [Hz], acceleration [g]".

    Raises:
        RecordError: the file cannot be read, or is not such a table; names the line.
    """
    return _points(path, ACCELERATION_UNITS, kind="response spectrum", example='"frequency [Hz], acceleration [g]"')


def force_rows(path: Path) -> ForceRows:
    """Return times and loads of a file such as "time [s], fx [N], fz [kN], my [N.m]"; what is not there is zero.

    Raises:
        RecordError: the file cannot be read, or is not such a table; names the line.
    """
    header = read_header(path, kind="table of forces", example='"time [s], fz [N], mx [N.m]"')
    known = ("time", *FORCE_COLUMNS)
    for name in header.names:
        if name not in known or header.names.count(name) > 1:
            raise RecordError(
                f'{header.location}: column "{short(name)}" is unknown or there twice; columns are time and some of '
                f"{', '.join(FORCE_COLUMNS)}."
            )
    if "time" not in header.names:
        raise RecordError(f'{header.location}: there is no column "time [s]".')
    units = [
        TIME_UNITS if name == "time" else FORCE_UNITS if name[0] == "f" else _MOMENT_UNITS for name in header.names
    ]
    factors = [header.factor(number, one) for number, one in enumerate(units)]
    columns: dict[str, list[float]] = {name: [] for name in header.names}
    for _, place, cells in rows_below(header):
        for name, cell, factor in zip(header.names, cells, factors, strict=True):
            columns[name].append(in_si(number_in(place, name, cell), factor))
    zero = [0.0] * len(columns["time"])
    return tuple(columns["time"]), tuple(zip(*(columns.get(name, zero) for name in FORCE_COLUMNS), strict=True))


def _points(path: Path, units: Mapping[str, float], *, kind: str, example: str) -> Points:
    header = read_header(path, kind=kind, example=example)
    if len(header.names) != 2:
        raise RecordError(
            f"{header.location}: a {kind} has two columns, {example}; here are {len(header.names)}: {header.listed()}."
        )
    factors = header.factor(0, _FREQUENCY_UNITS), header.factor(1, units)
    rows = [
        tuple(
            in_si(number_in(place, name, cell), factor)
            for name, cell, factor in zip(header.names, cells, factors, strict=True)
        )
        for _, place, cells in rows_below(header)
    ]
    try:
        return checked_points(path.name, rows, quantity=header.names[1])
    except ValueError as error:
        raise RecordError(f"{path}: {error}") from None
