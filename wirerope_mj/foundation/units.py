"""Units of files and displays, and their factors to SI; the library itself uses SI.

One table of units, and one notation of a column's name with its unit, for records, loops, densities, curves and tables.
"""

import math
import re
import unicodedata
from collections.abc import Mapping
from functools import cache, lru_cache
from typing import TypeVar

from wirerope_mj.foundation.arrays import Array

Number = TypeVar("Number", float, Array)
STANDARD_GRAVITY = 9.80665  # Standard acceleration of free fall [m/s^2] (ISO 80000-3), the g of shock levels
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0}
LENGTH_UNITS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254, "um": 1e-6, "ft": 0.3048}
FORCE_UNITS = {"N": 1.0, "daN": 10.0, "kN": 1e3, "lbf": 4.4482216152605, "kip": 4448.2216152605, "kgf": STANDARD_GRAVITY}
STIFFNESS_UNITS = {"N/mm": 1e3, "lb/in": 175.12683524647636}  # of vendors' tables; 4.4482216152605 N / 0.0254 m
VELOCITY_UNITS = {"m/s": 1.0, "mm/s": 1e-3, "cm/s": 1e-2, "in/s": 0.0254, "ft/s": 0.3048}
ACCELERATION_UNITS = {
    "m/s^2": 1.0, "m/s2": 1.0, "m/s²": 1.0, "g": STANDARD_GRAVITY, "mm/s^2": 1e-3, "mm/s2": 1e-3, "cm/s^2": 1e-2, "cm/s2": 1e-2,
    "gal": 1e-2, "in/s^2": 0.0254, "in/s2": 0.0254, "ft/s^2": 0.3048, "ft/s2": 0.3048,
    "mg": 1e-3 * STANDARD_GRAVITY,
}  # fmt: skip
TEMPERATURE_UNITS = {"degC": 1.0, "°C": 1.0}
ANGLE_UNITS = {"deg": math.pi / 180.0, "°": math.pi / 180.0, "rad": 1.0}
ANGULAR_RATE_UNITS = {f"{unit}/s": factor for unit, factor in ANGLE_UNITS.items()} | {"dps": ANGLE_UNITS["deg"]}
ANGULAR_ACCELERATION_UNITS = {
    f"{unit}/{square}": factor for unit, factor in ANGLE_UNITS.items() for square in ("s^2", "s2", "s²")
}  # fmt: skip
FREQUENCY_UNITS = {"Hz": 1.0, "kHz": 1e3}
MOMENT_UNITS = {"N.m": 1.0, "Nm": 1.0, "N m": 1.0, "kN.m": 1e3, "kNm": 1e3, "kN m": 1e3}
PSD_UNITS = dict.fromkeys(("g^2/Hz", "g2/Hz", "g²/Hz"), STANDARD_GRAVITY**2) | dict.fromkeys(
    ("(m/s^2)^2/Hz", "(m/s2)2/Hz", "(m/s²)²/Hz", "m^2/s^3", "m2/s3", "m^2/s^4/Hz"), 1.0
)
_POUND = 0.45359237
# units of each kind of quantity in files, in SI; an inch is 25.4 mm, a pound 0.45359237 kg (both exact)
UNITS: dict[str, Mapping[str, float]] = {
    "length": {"mm": 1e-3} | LENGTH_UNITS,
    "mass": {"kg": 1.0, "t": 1e3, "g": 1e-3, "lb": _POUND},
    "inertia": {
        "kg m^2": 1.0, "kg m2": 1.0, "kg m²": 1.0, "kg*m^2": 1.0, "kg mm^2": 1e-6, "kg mm2": 1e-6, "kg*mm^2": 1e-6,
        "kg cm^2": 1e-4, "t m^2": 1e3, "t mm^2": 1e-3, "g mm^2": 1e-9, "g cm^2": 1e-7,
        "lb in^2": _POUND * LENGTH_UNITS["in"] ** 2,
    },
    "time": TIME_UNITS,
    "angle": ANGLE_UNITS,
    "stiffness": {
        f"{force}/{length}": newtons / metres
        for force, newtons in FORCE_UNITS.items() for length, metres in (("m", 1.0), ("mm", 1e-3))
    } | {"MN/m": 1e6, "lb/in": STIFFNESS_UNITS["lb/in"]},
    "frequency": FREQUENCY_UNITS,
    "ratio": {"%": 0.01, "-": 1.0},
    "damping": {"N s/m": 1.0, "kN s/m": 1e3, "N s/mm": 1e3},
    "force": FORCE_UNITS,
    "moment": MOMENT_UNITS,
    "velocity": VELOCITY_UNITS,
    "acceleration": ACCELERATION_UNITS,
    "angular rate": ANGULAR_RATE_UNITS,
    "angular acceleration": ANGULAR_ACCELERATION_UNITS,
    "density": PSD_UNITS,
    "slope": {"dB/oct": 1.0, "dB/octave": 1.0},
}  # fmt: skip
# quantities that a phrase tells apart by their units, which hold no spaces; sweep rates in octaves/min
PHRASE_UNITS: dict[str, Mapping[str, float]] = {
    "acceleration": ACCELERATION_UNITS, "velocity": VELOCITY_UNITS, "displacement": LENGTH_UNITS, "time": TIME_UNITS,
    "frequency": FREQUENCY_UNITS, "sweep rate": {"oct/min": 1.0, "octaves/min": 1.0, "oct/s": 60.0}, "ratio": {"%": 0.01},
    "force": FORCE_UNITS, "moment": {unit: factor for unit, factor in MOMENT_UNITS.items() if " " not in unit},
    "impulse": {"N.s": 1.0, "Ns": 1.0, "kN.s": 1e3, "kNs": 1e3},
    "pressure": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "bar": 1e5, "psi": 6894.757293168},
    "areal mass": {"kg/m2": 1.0, "kg/m^2": 1.0}, "mass": {"kg": 1.0, "t": 1e3},
    "angle": ANGLE_UNITS,
    "unbalance": {"kg.m": 1.0, "kg.mm": 1e-3, "g.m": 1e-3, "g.cm": 1e-5, "g.mm": 1e-6},
}  # fmt: skip
# what else a logger writes as a unit beside the quantities that are read: enough to know a row of units, or what stands in
# parentheses, for one
_ELSEWHERE = (
    "V", "mV", "°C", "degC", "°F", "Pa", "kPa", "MPa", "bar", "psi", "rpm", "1/min", "um/m", "mm/mm", "dB",
    "J", "pC", "counts", "kg/m^3", "N/mm^2",
)  # fmt: skip
_WORDS = {
    word: unit
    for unit, words in {
        "s": "sec secs second seconds sek sekunden", "ms": "msec msecs millisecond milliseconds",
        "us": "usec usecs microsecond microseconds", "min": "mins minute minutes", "h": "hr hrs hour hours",
        "m": "meter meters metre metres", "mm": "millimeter millimeters millimetre millimetres",
        "cm": "centimeter centimeters centimetre centimetres", "in": "inch inches", "ft": "foot feet", "um": "micron microns",
        "N": "newton newtons", "kN": "kilonewton kilonewtons", "kip": "kips klbf", "kgf": "kp", "lbf": "lbsf",
        "lb": "lbs pound pounds", "kg": "kilogram kilograms", "t": "tonne tonnes", "Hz": "hertz", "gal": "gals",
        "g": "gn gs gram grams", "deg": "degree degrees grad", "%": "percent pct", "m/s2": "mps2", "m/s": "mps", "in/s": "ips",
        "ft/s": "fps", "counts": "count",
    }.items()
    for word in words.split()
}  # fmt: skip
_RANGE = re.compile(r"(?:range )?[\u00b1+/ -]*(\d+(?:\.\d+)?) *([a-zA-Z][\w/^\u00b2]*)")
_RMS = re.compile(r"(?<=g)[ _]?rms(?=\W*2)", re.IGNORECASE)  # of a density: grms^2/Hz is g^2/Hz
_SHOWN = {"m": ("mm", 1e3), "N": ("kN", 1e-3), "m/s^2": ("g", 1.0 / STANDARD_GRAVITY)}
# Displayed units to one SI unit; the g is a divisor, so that integers of it stay integers.
_PER_SI = {
    "mm": 1e3, "ms": 1e3, "mrad": 1e3, "kN": 1e-3, "kN/m": 1e-3, "mm/s": 1e3, "N/mm": 1e-3, "MB": 1e-6, "%": 100.0,
    "g²/Hz": STANDARD_GRAVITY**-2, "deg": 180.0 / math.pi,
}  # fmt: skip


def shown_in(unit: str) -> tuple[str, float]:
    """Return the unit in which an engineer reads values of an SI unit, and the factor into it; unknown units as they are."""
    return _SHOWN.get(unit, (unit, 1.0))


def find_unit(text: str, known: Mapping[str, float]) -> str | None:
    """Find which of the known units a text spells: µs and usec are us, m/s² is m/s^2, KN is kN, lbs are lbf; None if none."""
    if text in known:
        return text
    spelled = _spelled(text)
    if unit := _by_spelling(tuple(known)).get(spelled):
        return unit
    if spelled == "lb" and "lbf" in known:
        return "lbf"
    if spelled in (spelled.upper(), spelled.lower()) or text.istitle():
        # of prefixes only M and m differ by their case alone
        alike = {unit for unit in known if _spelled(unit).lower() == spelled.lower() and not unit.startswith("M")}
        if alike:
            return min(alike)
    # the range of an accelerometer, as loggers have it in place of a unit: "Z (100g)"
    if "m/s^2" in known and range_of(text) is not None and (match := _RANGE.fullmatch(text)):
        return find_unit(match[2], known)
    return find_unit(text.lower(), known) if text != text.lower() and text == text.upper() else None


def range_of(unit: str | None) -> float | None:
    """Return the range of an accelerometer [m/s^2] that precedes its unit, as in "100g"; None where none does.

    A number near that of a g, or below 1, is a factor of the numbers and no range.
    """
    match = _RANGE.fullmatch(unit or "")
    known = find_unit(match[2], ACCELERATION_UNITS) if match else None
    if match is None or known is None or float(match[1]) < 1.0 or abs(float(match[1]) / STANDARD_GRAVITY - 1.0) < 0.02:
        return None
    return float(match[1]) * ACCELERATION_UNITS[known]


def is_unit(text: str) -> bool:
    """Tell whether a text is a unit of any quantity, also of one that this project does not use."""
    return any(find_unit(text, units) is not None for units in (*UNITS.values(), dict.fromkeys(_ELSEWHERE, 1.0)))


@lru_cache(maxsize=4096)  # tables are read again and again while they are edited
def split_unit(cell: str) -> tuple[str, str | None]:
    """Split a column's heading into its name and its unit, None where it states none.

    The unit stands in brackets, "x [mm]"; or, where it is a known one, in parentheses, "x (mm)", behind a slash, "x / mm", a
    comma or the word in.
    """
    text = cell.strip()
    if match := re.fullmatch(r"(.*?)\s*\[([^\]]*)\]", text, re.DOTALL):
        return match[1], match[2].strip()
    if text.endswith(")"):
        depth = 0
        for place in range(len(text) - 1, -1, -1):
            depth += {")": 1, "(": -1}.get(text[place], 0)
            if depth == 0:
                unit = text[place + 1 : -1].strip()
                if is_unit(unit):
                    return text[:place].rstrip().removesuffix("/").rstrip(), unit
                break
    if "/" in text or "," in text or " in " in text:
        match = re.fullmatch(r"(.+?)(?:\s+/\s*|,\s*|\s+in\s+)(\S+)", text) or re.fullmatch(r"([^/]+)/([^/\s]+)", text)
        if match and is_unit(match[2]) and not is_unit(text):
            return match[1].strip(), match[2]
    return text, None


def underscored_unit(name: str, known: Mapping[str, float]) -> tuple[str, str | None]:
    """Split a name such as time_ms or z_m_s2, which cannot hold other signs, into its name and its unit; None without one."""
    for place in (match.start() for match in re.finditer("(?<=.)_", name)):
        behind = name[place + 1 :].replace("_per_", "/")
        if unit := find_unit(behind, known) or find_unit(behind.replace("_", "/", 1), known):
            return name[:place], unit
    return name, None


@cache
def _by_spelling(known: tuple[str, ...]) -> dict[str, str]:
    return {_spelled(unit): unit for unit in reversed(known)}


@cache
def _spelled(unit: str) -> str:
    """Return a unit in one spelling: ASCII, no sign of multiplication or power, words as symbols."""
    text = unicodedata.normalize("NFKC", unit).strip().replace("\u03bc", "u").replace("\u2212", "-").replace("'s", "")
    text = re.sub(r"[A-Za-z]+", lambda match: _WORDS.get(match[0].lower(), match[0]), _RMS.sub("", text))
    text = re.sub(r"[\^\s*\u00b7\u22c5\u00d7]|(?<=[A-Za-z])\.(?=[A-Za-z])", "", text).replace("/s/s", "/s2")
    return re.sub(r"\((\w+)\)", r"\1", re.sub(r"^([A-Za-z]+)s-([12])$", r"\1/s\2", text)).replace("/s1", "/s")


def in_si(value: float, factor: float) -> float:
    """Return a value of a data sheet times its unit, to twelve digits: 6.8 mm are 0.0068 m, not 0.006799999999999999 m."""
    return float(f"{value * factor:.12g}")


def in_unit(value: Number, unit: str) -> Number:
    """Convert SI values to a displayed unit: one of `_PER_SI`, such as "mm" or "kN", or "g"; others are left as they are."""
    if unit == "g":
        return value / STANDARD_GRAVITY
    return _PER_SI[unit] * value if unit in _PER_SI else value


def force_unit(largest: float) -> str:
    """Choose the unit for forces from the largest one [N]: kN, or N below 1 kN."""
    return "N" if abs(largest) < 1e3 else "kN"


def force_text(force: float) -> str:
    """Write a force [N] to three digits: "4.1 kN", "6 N"."""
    unit = force_unit(force)
    return f"{in_unit(force, unit):.3g} {unit}"


def significant(value: float, digits: int = 3) -> str:
    """Format a number to some significant digits, without an exponent or cut integers: 0.00123, 1.23, 123, 12345."""
    if value == 0.0 or abs(value) < 1e-9:  # nothing that is shown in mm, kN or g is that small and not rounding
        return "0"
    rounded = abs(float(f"{value:.{digits - 1}e}"))  # 9.9999 is 10.0, not 10.00
    decimals = max(digits - 1 - math.floor(math.log10(rounded)), 0)
    return f"{value:z.{min(decimals, 6)}f}"


def instant_text(time: float) -> str:
    """Format an instant [s] for a sentence: "61.2 ms", "1.2345 s"."""
    return f"{1e3 * time:.1f} ms" if time < 1.0 else f"{time:.4f} s"


def duration_text(value: float, digits: int = 3) -> str:
    """Format a duration [s] in ms, from 1 s on in s, to some significant digits: 11 ms, 1.59 s, 3600 s."""
    text, unit = significant(1e3 * value, digits), "ms"
    if abs(float(text)) >= 1e3:
        text, unit = significant(value, digits), "s"
    return f"{text.rstrip('0').rstrip('.') if '.' in text else text} {unit}"


def rough_duration_text(value: float) -> str:
    """Format a duration [s] as people wait for it, to two digits: 42 s, 7 min, 3.5 h."""
    size, unit = (1.0, "s") if value < 100.0 else (60.0, "min") if value < 6000.0 else (3600.0, "h")
    return f"{float(f'{value / size:.2g}'):g} {unit}"
