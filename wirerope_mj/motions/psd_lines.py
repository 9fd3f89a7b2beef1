"""Densities and spectra given by points, straight on logarithmic axes, zero outside; their files, and tables of forces."""

import math
import warnings
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.arguments import positive
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.foundation.errors import RecordError, RecordWarning
from wirerope_mj.foundation.plain_text import quoted, short
from wirerope_mj.foundation.said_above import rms_above
from wirerope_mj.foundation.table_files import number_in, read_header, rows_below, rows_in_si
from wirerope_mj.foundation.table_header import Header, is_missing
from wirerope_mj.foundation.units import (
    ACCELERATION_UNITS,
    FORCE_UNITS,
    FREQUENCY_UNITS,
    LENGTH_UNITS,
    MOMENT_UNITS,
    PSD_UNITS,
    STANDARD_GRAVITY,
    TIME_UNITS,
    UNITS,
    VELOCITY_UNITS,
    find_unit,
)
from wirerope_mj.motions.doubts import doubt_of_swing

Points = tuple[tuple[float, float], ...]
FORCE_COLUMNS = ("fx", "fy", "fz", "mx", "my", "mz")
ForceRows = tuple[tuple[float, ...], tuple[tuple[float, ...], ...]]  # times [s] and loads [N, N m], (n,) and (n, 6)
_AMPLITUDE_UNITS = {"displacement": LENGTH_UNITS, "velocity": VELOCITY_UNITS, "acceleration": ACCELERATION_UNITS}


def checked_points(
    name: str, points: Sequence[Sequence[float]], *, quantity: str, least: int = 2, steps: bool = False
) -> Points:
    """Check that points (frequency [Hz], level) are positive, rise in frequency and are at least `least`; return plain floats.

    With `steps` two points, not the first or the last two, may have one frequency: there the level steps from one to the other.
    Messages call the argument `name` and the level `quantity`.
    """
    plain: list[tuple[float, float]] = []
    if not isinstance(points, Iterable) or isinstance(points, str | bytes | Mapping):
        raise ValueError(f"`{name}` must be pairs of frequency [Hz] and {quantity}, got {quoted(points)}.")
    for number, point in enumerate(points, start=1):
        try:
            frequency, level = point
        except (TypeError, ValueError):
            raise ValueError(
                f"`{name}` must be pairs of frequency [Hz] and {quantity}, got {quoted(point)} as point {number}."
            ) from None
        try:
            plain.append((positive("frequency", frequency), positive(quantity, level)))
        except ValueError as error:
            raise ValueError(f"`{name}`, point {number}: {error}") from None
        step = steps and number > 2 and plain[-1][0] == plain[-2][0] > plain[-3][0]
        if number > 1 and plain[-1][0] <= plain[-2][0] and not step:
            raise ValueError(
                f"the frequencies of `{name}` must increase, got {plain[-1][0]:g} Hz after {plain[-2][0]:g} Hz, "
                f"as point {number}."
            )
    if len(plain) > 1 and plain[-1][0] == plain[-2][0]:
        raise ValueError(f"`{name}` must go on behind the step at {plain[-1][0]:g} Hz, got it as the last point.")
    if len(plain) < least:
        raise ValueError(f"`{name}` must have at least {least} point{'s' if least > 1 else ''}, got {len(plain)}.")
    return tuple(plain)


def psd_level(psd: Sequence[Sequence[float]], frequencies: ArrayLike) -> Array:
    """Return the level of a power spectral density at the frequencies [Hz], any shape, in the unit of its points.

    Between the points (frequency [Hz], level) it is straight on logarithmic axes; it is zero outside. At two points of one
    frequency it steps, and has the second level there.
    """
    f, levels = np.array(checked_points("psd", psd, quantity="level", steps=True)).T
    at = np.asarray(frequencies, dtype=float)
    inside = (at >= f[0]) & (at <= f[-1])
    logarithm = np.interp(np.log(np.where(inside, at, f[0])), np.log(f), np.log(levels))
    return np.where(inside, np.exp(logarithm), 0.0)


def psd_power(psd: Sequence[Sequence[float]], up_to: ArrayLike) -> Array:
    """Return the integral of a power spectral density from zero to the frequencies [Hz], exact, any shape.

    Between two points, S = S1 (f/f1)^m, it is S1 f1 ((f/f1)^(m+1) - 1)/(m+1), or S1 f1 ln(f/f1) for m = -1.
    """
    f, levels = np.array(checked_points("psd", psd, quantity="level", steps=True)).T
    octaves_between = np.diff(np.log(f))
    slopes = np.divide(np.diff(np.log(levels)), octaves_between, out=np.zeros(f.size - 1), where=octaves_between > 0.0)
    end = np.asarray(up_to, dtype=float)
    power = np.zeros(end.shape)
    for low, high, level, slope in zip(f[:-1], f[1:], levels[:-1], slopes, strict=True):
        octaves = np.log(np.clip(end, low, high) / low)
        exponent = (slope + 1) * octaves
        # (e^x - 1)/x is 1 at x = 0, that is for slope -1 or nothing passed.
        growth = np.divide(np.expm1(exponent), exponent, out=np.ones(end.shape), where=exponent != 0)
        power += level * low * octaves * growth
    return power


def psd_rms(psd: Sequence[Sequence[float]]) -> float:
    """Return the rms value of a stationary signal of a power spectral density, in the root of its unit times Hz."""
    points = checked_points("psd", psd, quantity="level", steps=True)
    return math.sqrt(float(psd_power(points, points[-1][0])))


def flat_psd(rms: float, lowest: float, highest: float) -> Points:
    """Return the power spectral density of one level from a lowest to a highest frequency [Hz] that has an rms value."""
    if not 0.0 < lowest < highest:
        raise ValueError(f"its band must go from a lower to a higher frequency above 0, got {lowest:g} to {highest:g} Hz.")
    level = positive("rms", rms) ** 2 / (highest - lowest)
    return (lowest, level), (highest, level)


def psd_from_g(points: Sequence[Sequence[float]]) -> Points:
    """Return a power spectral density [(m/s^2)^2/Hz] from points (frequency [Hz], level [g^2/Hz])."""
    checked = checked_points("points", points, quantity="level [g^2/Hz]", steps=True)
    return tuple((frequency, level * STANDARD_GRAVITY**2) for frequency, level in checked)


# highest frequency [Hz] of a density from which its unit is questioned: specifications of equipment end at 2000, those of
# gunfire and pyrotechnics at 5000; rms displacement [m] from which it is: the heave of ships in the worst sea stays below
_HIGHEST, _FARTHEST = 5e3, 4.0
# rms acceleration [m/s^2] beyond which the unit of a density is questioned, 50 g; how many times a single point stands off both
# beside it; displacement [m] of an oscillator under a spectrum, which the ground of no earthquake and no ship's deck reaches
_LOUDEST, _LONE, _SWEPT = 50.0 * STANDARD_GRAVITY, 100.0, 1.2
_SAID = 0.1  # relative error of an rms value that a file says of itself
_RISING = 8.0  # level at the end over all before it, over more than an octave: those of standards fall there, or rise twice


def doubt_of_rms(rms: float) -> str:
    """Return a question about the unit of a density whose rms [m/s^2] no shaker reaches; else ""."""
    if rms <= _LOUDEST:
        return ""
    return (
        f"its rms is {rms / STANDARD_GRAVITY:.3g} g, more than shakers reach: is it in (m/s^2)^2/Hz where g^2/Hz is said, or "
        "in m/s^2 where g is?"
    )


def psd_points(path: Path) -> Points:
    """Read the points (frequency [Hz], level [(m/s^2)^2/Hz]) of a file such as "frequency [Hz], psd [g^2/Hz]".

    Or the bands of one such as "from [Hz], to [Hz], psd [g^2/Hz], slope [dB/oct]", each with a level or a slope.

    Warns:
        RecordWarning: the frequencies, or the displacement that they make, are beyond what any vibration has. Of the rms
            the motion that is made of it says the same (`doubt_of_rms`).
    """
    points = _density(path)
    moved = psd_rms([(frequency, level / (2.0 * math.pi * frequency) ** 4) for frequency, level in points])
    in_hertz, doubt = " Say the unit in the header, or write them in Hz.", ""
    if points[-1][0] > _HIGHEST:
        doubt = (
            f"it reaches {points[-1][0]:.4g} Hz, and densities end at 2000 or 5000 Hz: are its frequencies in rad/s?{in_hertz}"
        )
    elif (odd := _lone_point(points)) is not None:
        doubt = f"its level at {odd:.4g} Hz stands a hundred times off both beside it: is a digit wrong?"
    elif points[-1][1] > _RISING * max(level for _, level in points[:-1]) and points[-1][0] > 2.0 * points[-2][0]:
        doubt = (
            f"it rises to {points[-1][1] / points[-2][1]:.3g} times its level from {points[-2][0]:.4g} Hz on, where densities "
            "fall: does its last slope lack a minus, or has its last level a digit too many?"
        )
    elif moved > _FARTHEST:
        doubt = f"at {points[0][0]:.3g} Hz its base would move by {moved:.3g} m rms: are its frequencies in kHz?{in_hertz}"
    else:
        doubt = _doubt_of_said(read_header(path, kind="power spectral density", example=""), psd_rms(points))
    if doubt:
        warnings.warn(f"{path}: {doubt}", RecordWarning, stacklevel=2)
    return points


def _doubt_of_said(header: Header, rms: float) -> str:
    """Return a question about an rms value above a header that is not that of the density [m/s^2]; "" if there is none."""
    of_g = any(unit is not None and "g" in unit for unit in header.units)
    said = [value * (STANDARD_GRAVITY if (unit or "g" * of_g) == "g" else 1.0) for value, unit in rms_above(header)]
    if not said or any(abs(value / rms - 1.0) < _SAID for value in said):
        return ""
    unit, size = ("g", STANDARD_GRAVITY) if of_g else ("m/s^2", 1.0)
    return (
        f"above its header stands an rms of {said[0] / size:.4g} {unit}, and its points have {rms / size:.4g} {unit}: is a "
        "level, a frequency or the unit another?"
    )


def _lone_point(points: Points) -> float | None:
    """Return the frequency [Hz] of a point that alone stands a hundred times above or below both beside it, half an octave off.

    Narrow bands upon a density are narrower, and have two points at their level.
    """
    for before, here, after in zip(points, points[1:], points[2:], strict=False):
        ratios = before[1] / here[1], after[1] / here[1]
        wide = here[0] / before[0] > math.sqrt(2.0) and after[0] / here[0] > math.sqrt(2.0)
        if wide and (max(ratios) < 1.0 / _LONE or min(ratios) > _LONE):
            return here[0]
    return None


_MEETS = 0.5  # Largest step at the end of a slope [dB]: slopes are printed in whole decibels


def _density(path: Path) -> Points:
    """Read the points (frequency [Hz], level [(m/s^2)^2/Hz]) of a file that lists points, or bands with levels or slopes.

    A band that has a slope goes on from the level of the band before it, or else from that of the band behind.
    """
    example = '"frequency [Hz], psd [g^2/Hz]"'
    header = read_header(path, kind="power spectral density", example=example)
    if [name.lower() for name in header.names[:2]] != ["from", "to"]:
        return _points(path, PSD_UNITS, kind="power spectral density", example=example, steps=True)
    known = [FREQUENCY_UNITS, FREQUENCY_UNITS, PSD_UNITS, UNITS["slope"]][: len(header.names)]
    if len(header.names) not in (3, 4):
        raise RecordError(
            f'{header.location}: bands of a density have the columns "from [Hz], to [Hz], psd [g^2/Hz], slope [dB/oct]"; '
            f"here are {header.listed(units=True)}."
        )
    factors = [header.factor(column, units) for column, units in enumerate(known)]
    bands: list[tuple[float, float, float, float]] = []  # frequencies, level and slope; NaN for what is not given
    for _, place, cells in rows_below(header):
        low, high, level, slope = [
            math.nan if column > 1 and is_missing(cell) else number_in(place, header.names[column], cell) * factor
            for column, (cell, factor) in enumerate(zip(cells, factors, strict=True))
        ] + [math.nan] * (4 - len(factors))
        if not 0.0 < low < high or (bands and low != bands[-1][1]):
            begins = f"at {bands[-1][1]:g} Hz, where the one before ends," if bands else "above 0 Hz"
            raise RecordError(f"{place}: the band must begin {begins} and end above its begin, got {low:g} to {high:g} Hz.")
        if math.isnan(level) == math.isnan(slope) or level <= 0.0:
            raise RecordError(f"{place}: a band has either a level > 0 or a slope, the other cell is empty.")
        bands.append((low, high, level, slope))
    ends = [(level, level) for _, _, level, _ in bands]
    growths = [(high / low) ** (slope / (10.0 * math.log10(2.0))) for low, high, _, slope in bands]
    for order in (range(len(bands)), reversed(range(len(bands)))):  # on from the band before, else from that behind
        for i in order:
            if math.isnan(ends[i][0]) and i and not math.isnan(ends[i - 1][1]):
                ends[i] = (ends[i - 1][1], ends[i - 1][1] * growths[i])
            elif math.isnan(ends[i][0]) and i + 1 < len(bands) and not math.isnan(ends[i + 1][0]):
                ends[i] = (ends[i + 1][0] / growths[i], ends[i + 1][0])
    if any(math.isnan(level) for level, _ in ends):
        raise RecordError(f"{header.location}: no band has a level; one with a slope goes on from it.")
    for i, (low, high, level, slope) in enumerate(bands[:-1]):
        gap = 10.0 * math.log10(ends[i + 1][0] / ends[i][1])
        if math.isnan(level) and abs(gap) > _MEETS:
            meets = slope + gap / math.log2(high / low)
            raise RecordError(
                f"{header.location}: the slope of {slope:g} dB/octave from {low:g} Hz ends {abs(gap):.2g} dB "
                f"{'below' if gap > 0 else 'above'} the level from {high:g} Hz on; {meets:.3g} dB/octave would meet it."
            )
    points: list[tuple[float, float]] = []
    for (low, high, _, _), (first, last) in zip(bands, ends, strict=True):
        if not points or abs(points[-1][1] / first - 1.0) > 1e-12:
            points.append((low, first))
        points.append((high, last))
    return checked_points("rows", points, quantity="level", steps=True)


def spectrum_points(path: Path) -> Points:
    """Read the points (frequency [Hz], acceleration [m/s^2]) of a file such as "frequency [Hz], acceleration [g]".

    Warns:
        RecordWarning: oscillators under it would move as far as under no shock.
    """
    points = _points(path, ACCELERATION_UNITS, kind="response spectrum", example='"frequency [Hz], acceleration [g]"')
    frequency, moved = max(((f, a / (2.0 * math.pi * f) ** 2) for f, a in points), key=lambda point: point[1])
    if moved > _SWEPT:
        warnings.warn(
            f"{path}: at {frequency:.3g} Hz it moves an oscillator by {moved:.3g} m: are its frequencies in kHz, or its "
            "accelerations in another unit, m/s^2 or mm/s^2 for g?",
            RecordWarning, stacklevel=2,
        )  # fmt: skip
    return points


def table_lines(path: Path) -> tuple[str, Points]:
    """Read the lines of an amplitude table: the quantity, and frequencies [Hz] with its amplitudes in SI.

    The file has "frequency [Hz], displacement [mm]", a row for each frequency, or "from [Hz], to [Hz], displacement [mm]" for
    bands, passed in steps of 1 Hz; a velocity or an acceleration may stand in place of the displacement.
    """
    example = '"frequency [Hz], displacement [mm]" or "from [Hz], to [Hz], displacement [mm]"'
    header = read_header(path, kind="amplitude table", example=example)
    *places, quantity = header.names
    if places not in (["frequency"], ["from", "to"]) or quantity not in _AMPLITUDE_UNITS:
        raise RecordError(
            f"{header.location}: an amplitude table has the columns {example}, or with a velocity or an acceleration at the "
            f"end; here are {header.listed(units=True)}."
        )
    rows = rows_in_si(header, dict(enumerate([*[FREQUENCY_UNITS] * len(places), _AMPLITUDE_UNITS[quantity]])))
    try:
        lines = banded_lines([row if len(row) == 3 else (row[0], *row) for row in rows])
    except ValueError as error:
        raise RecordError(f"{path}: {error}") from None
    orders = {"acceleration": 0, "velocity": 1, "displacement": 2}
    peaks = [(frequency, size * (2.0 * math.pi * frequency) ** orders[quantity]) for frequency, size in lines]
    if doubt := next(filter(None, (doubt_of_swing(*peak) for peak in reversed(peaks))), ""):
        warnings.warn(f"{path}: {doubt}", RecordWarning, stacklevel=2)
    return quantity, lines


def banded_lines(bands: Sequence[Sequence[float]], *, step: float = 1.0) -> Points:
    """Return lines (frequency [Hz], amplitude) at equal steps [Hz] through bands of constant amplitude, in order of frequency.

    Amplitude tables of shipboard vibration tests (MIL-STD-167-1A type I and the like) are such bands (first frequency, last
    frequency, amplitude), passed one frequency after the other: take the lines one by one for that. No table is built in.
    """
    positive("step", step)
    lines: list[tuple[float, float]] = []
    for band in bands:
        if not isinstance(band, Sequence) or len(band) != 3:
            raise ValueError(f"`bands` must hold a first frequency, a last frequency and an amplitude each, got {band!r}.")
        low, high, amplitude = (positive("bands", value) for value in band)
        if high < low:
            raise ValueError(f"a band must end above its start, got {low:g} to {high:g} Hz.")
        if lines and low <= lines[-1][0]:
            raise ValueError(
                f"the band from {low:g} to {high:g} Hz begins within the one before, which ends at {lines[-1][0]:g} Hz: "
                f"begin it at {lines[-1][0] + step:g} Hz."
            )
        # One part in 1e9: the last frequency must not be lost by rounding.
        steps = math.floor((high - low) / step * (1 + 1e-9))
        lines += [(low + number * step, amplitude) for number in range(steps + 1)]
    return checked_points("bands", lines, quantity="amplitude", least=1)


def force_rows(path: Path) -> ForceRows:
    """Read times and loads of a file such as "time [s], fx [N], fz [kN], my [N.m]"; columns that are missing are zero."""
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
    units = [TIME_UNITS if name == "time" else FORCE_UNITS if name[0] == "f" else MOMENT_UNITS for name in header.names]
    rows = [dict(zip(header.names, row, strict=True)) for row in rows_in_si(header, dict(enumerate(units)))]
    loads = tuple(tuple(row.get(name, 0.0) for name in FORCE_COLUMNS) for row in rows)
    return tuple(row["time"] for row in rows), loads


def _points(path: Path, units: Mapping[str, float], *, kind: str, example: str, steps: bool = False) -> Points:
    """Read points (frequency [Hz], level in SI) of a file of two columns; RecordError, with the line, if it is not such."""
    header = read_header(path, kind=kind, example=example)
    candidates = [
        [column for column, unit in enumerate(header.units) if unit is not None and find_unit(unit, known)]
        for known in (FREQUENCY_UNITS, units)
    ]
    if len(header.names) == 2:  # a column without a unit, or with another, is named below
        candidates = [candidates[0] or [column for column in (0, 1) if column not in candidates[1]], candidates[1] or [1]]
    if len(candidates[0]) != 1 or len(candidates[1]) != 1:
        raise RecordError(
            f"{header.location}: a {kind} has two columns, {example}; here are {len(header.names)}: "
            f"{header.listed(units=True)}. Leave one column of frequencies [Hz] and one [{next(iter(units))}]."
        )
    places = [candidates[0][0], candidates[1][0]]
    try:
        rows = rows_in_si(header, dict(zip(places, (FREQUENCY_UNITS, units), strict=True)))
        if units is PSD_UNITS and (below := [level for _, level in rows if level < 0.0]):
            raise ValueError(
                f"{len(below)} of its {len(rows)} levels are negative, such as {below[0] / header.factor(places[1], units):.4g}"
                ": are they in dB? Write them in their unit, 10^(dB/10)."
            )
        return checked_points("rows", rows, quantity=header.names[places[1]], steps=steps)
    except ValueError as error:
        raise RecordError(f"{path}: {error}") from None
