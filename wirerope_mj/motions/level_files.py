"""Points of a power spectral density or a response spectrum, from a CSV file with units in its header."""

from collections.abc import Mapping
from pathlib import Path

from wirerope_mj.foundation.csv_units import number_in, read_header, rows_below
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.units import ACCELERATION_UNITS, STANDARD_GRAVITY, in_si
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
