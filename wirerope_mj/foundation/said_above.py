"""Figures that a text says of itself above its header: the sampling rate, the rms value."""

import re

from wirerope_mj.foundation.table_header import Header

_NUMBER = r"(\d+(?:[.,]\d+)?(?:[eE][-+]?\d+)?)"
_RATED = re.compile(
    r"(?:sampl\w*|abtast\w*|\bfs\b|\bsps\b)(?:[ _-]*(?:rate|freq\w*))?"
    rf"\s*(?:[\[(](k?hz|sps|s/s)[\])])?\s*[:=,;\t]?\s*{_NUMBER}\s*(k?hz|k?sps|samples/s|s/s)?",
    re.IGNORECASE,
)
_ANY_RATE = re.compile(rf"{_NUMBER}\s*(k?hz|k?sps|samples/s|s/s)", re.IGNORECASE)
_RMS = re.compile(
    rf"(?:rms|overall)\w*\s*(?:level|value|acceleration)?\s*[:=,;\t]?\s*{_NUMBER}\s*(g|m/s\^?2|m/s²)?", re.IGNORECASE
)
_RMS_BEHIND = re.compile(rf"{_NUMBER}\s*(g|m/s\^?2|m/s²)?[ -]?rms", re.IGNORECASE)


def lines_above(header: Header) -> list[str]:
    """Return the lines of a text that stand above its header; none of a file of another kind."""
    if header.content is not None or not header.line:
        return []
    with header.path.open(encoding=header.encoding, errors="replace") as file:
        return [line for _, line in zip(range(header.line - 1), file, strict=False)]


def rates_above(header: Header) -> list[float]:
    """Return the sampling rates [Hz] that stand above a header, and beside them in their lines; [] where none is said."""
    rates: list[float] = []
    for line in lines_above(header):
        found = [(number, before or behind) for before, number, behind in _RATED.findall(line) if before or behind]
        for number, unit in (*found, *(_ANY_RATE.findall(line) if found else ())):
            rates.append(float(number.replace(",", ".")) * (1e3 if unit.lower().startswith("k") else 1.0))
    return rates


def rms_above(header: Header) -> list[tuple[float, str]]:
    """Return the rms values that stand above a header, with their units, "g", "m/s^2" or "" where none is said."""
    found = [pair for line in lines_above(header) for form in (_RMS_BEHIND, _RMS) for pair in form.findall(line)]
    return [(float(number.replace(",", ".")), "m/s^2" if "/" in unit else unit.lower()) for number, unit in found]
