"""Frequency responses from a CSV file: a row for each frequency of each level of the base."""

from pathlib import Path

import numpy as np

from wirerope_mj.foundation.csv_units import number_in, read_header, rows_below
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.units import ACCELERATION_UNITS
from wirerope_mj.motions.records.channel_map import parse_channel
from wirerope_mj.studies.calibration.frequency_test import FrequencyTest

_KIND, _EXAMPLE = "frequency response", '"frequency [Hz], level [g], transmissibility"'
_COLUMNS = ("frequency", "level", "transmissibility")


def read_frequency_tests(path: Path, phrase: str) -> list[FrequencyTest]:
    """Return a test for each level of a file with the columns frequency [Hz], level (with its unit) and transmissibility.

    Args:
        path: of the file.
        phrase: what was measured: "body/rack z".

    Raises:
        RecordError: the file has other columns, or too few rows of a level.
        ValueError: the phrase names no body with an axis.
    """
    said = parse_channel("transmissibility", phrase)
    kind, _, payload = said.subject.partition("/")
    if kind != "body":
        raise ValueError(f"a frequency response is of a body, such as 'body/rack z', got {phrase!r}.")
    header = read_header(path, kind=_KIND, example=_EXAMPLE)
    if missing := [name for name in _COLUMNS if name not in header.names]:
        raise RecordError(
            f"{header.location}: a frequency response has the columns {_EXAMPLE}; {missing[0]!r} is missing among "
            f"{header.listed()}."
        )
    places = [header.names.index(name) for name in _COLUMNS]
    factors = (header.factor(places[0], {"Hz": 1.0}), header.factor(places[1], ACCELERATION_UNITS), 1.0)
    rows = np.array(
        [
            [
                number_in(location, name, cells[k]) * factor
                for name, k, factor in zip(_COLUMNS, places, factors, strict=True)
            ]
            for _, location, cells in rows_below(header)
        ]
    ).reshape(-1, 3)
    tests = []
    for level in np.unique(rows[:, 1]).tolist():
        own = rows[rows[:, 1] == level]
        own = own[np.argsort(own[:, 0])]
        tests.append(
            FrequencyTest(
                name=f"{path.stem} {level:.3g} m s-2", payload=payload, acceleration=level, frequency=own[:, 0],
                transmissibility=own[:, 2], direction=said.axis,
            )
        )  # fmt: skip
    if not tests:
        raise RecordError(f"{path}: there are no rows below the header.")
    return tests
