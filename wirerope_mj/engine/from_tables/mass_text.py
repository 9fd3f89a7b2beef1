"""Mass properties in texts as SolidWorks prints them: one part or several, in five languages, with the notation they state.

A part has its mass, its centre of mass and a tensor of inertia. That is Lxx to Lzz about the centre of mass; else Ixx to Izz at
the output coordinate system; else the principal moments Px, Py, Pz with their axes. SolidWorks prints products of inertia as
+sum x y dm unless it is told to use "negative tensor notation"; what of a text is redundant shows which it is.
"""

import re
import unicodedata
import warnings
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from wirerope_mj.engine.from_tables.layout import MassProperties, why_impossible
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import RecordError, RecordWarning, why_unread
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.regular_files import read_text
from wirerope_mj.foundation.units import LENGTH_UNITS, UNITS

TENSOR, POSITIVE = "tensor", "positive"  # notations of products of inertia: elements of the tensor, or +sum x y dm
_SIGNS = {TENSOR: 1.0, POSITIVE: -1.0}
_POUND = UNITS["mass"]["lb"]
# Units by the words that programs in English, German, French, Italian and Spanish write, in letters of ASCII.
_MASSES = {
    r"(kilo|chilo)gram\w*|kg": 1.0, r"gram\w*|g": 1e-3, r"milligram\w*|mg": 1e-6, r"tonnes?|tonnellate|toneladas|t": 1e3,
    r"pounds?|lbm?|lbs|pfund|livres?|libbre|libras": _POUND, r"ounces?|oz|unzen|onces?|onzas": _POUND / 16.0,
    r"slugs?": 14.593902937206,
}  # fmt: skip
_LENGTHS = {
    r"mil+imet\w+|mm": 1e-3, r"[cz]entimet\w+|cm": 1e-2, r"met(er|re|ri|ro)\w*|m": 1.0,
    r"inch(es)?|in|zoll|pouces?|pollici|pulgadas?": LENGTH_UNITS["in"], r"feet|foot|ft|fuss|pieds?|piedi|pies": 0.3048,
}  # fmt: skip
_NUMBER = r"([-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?)"
_N = rf"{_NUMBER}(?!\d|[.,]\d)"
_INERTIA = re.compile(r"\(\s*([a-z]+)\s*\*\s*([a-z0-9^ ]+?)\s*\)")  # unit of moments of inertia
_SQUARE = re.compile(r"square|quadrat\w{0,2}\b|quadrat|car+es?\b|cuadrados?|\^?2")
_CENTRE = (
    r"cent(?:er|re) of (?:mass|gravity)|massenmittelpunkt|(?:massen)?schwerpunkt|centre de (?:masse|gravite)|"
    r"centro di (?:massa|gravita)|baricentro|centro de (?:masa|gravedad)"
)
_OUTPUT = r"output coordinate|ausgabe-?koordinaten|coordonnees de sortie|coordinate di output|coordenadas de salida"
_MASS = re.compile(rf"^[ \t]*(?:mass|masse|massa|masa)\b[ \t]*(?:\([^)\n]*\))?[ \t]*=[ \t]*{_N}[ \t]*([a-z]+)", re.MULTILINE)
_HEADING = re.compile(
    r"^[ \t]*(?:(?:mass|physical) properties (?:of|for)|mass\w*eigenschaften (?:von|fur)|proprietes de masse de|"
    r"proprieta di massa di|propiedades (?:de masa|fisicas) de)\b[ \t]*(.*)", re.MULTILINE
)  # fmt: skip
_SYSTEM = re.compile(
    r"^[ \t]*(?:coordinate system|koordinatensystem|systeme de coordonnees|sistema di coordinate|sistema de coordenadas)"
    r"[ \t]*:[ \t]*(.*?)[ \t]*$", re.MULTILINE
)  # fmt: skip
_NOTATION = re.compile(r"^.*\b(?:tensor\w*|notation\w*|notazione|notacion)\b.*$", re.MULTILINE)
_OTHERS = {
    r"calculated using \w+ integral|mass moments of inertia with respect to": "Inventor",
    r"inertia tensor:|center of gravity with respect to": "Creo", r"\bi[ox]*xg\b|inertia matrix / g": "CATIA",
    r"products of inertia \(": "NX",
}  # fmt: skip
_HOW = (
    'Export the mass properties of SolidWorks as text, with "Mass = .. kilograms", "Center of mass" and "Moments of inertia", '
    "or write a table of masses."
)
_OFF = 1.0 - np.eye(3)
_ROUGH = 0.25  # of products, by which figures of few digits may miss those that they are compared with
_FEW = 0.03  # of the principal moments' range: products below are the rounding of axes of two digits
_DIGITS = 1e-4  # of the trace of a tensor, which its printed digits leave open


def read_mass_text(path: Path, *, products: str = "") -> list[tuple[str, MassProperties]]:
    """Read names and mass properties of the parts in a text, about their centres of mass, in the output coordinate system.

    `products` is the notation of products of inertia, "tensor" or "positive"; "" where the text is to say it.

    Raises:
        RecordError: something is missing, in unknown units, contradicts itself, or parts are in several coordinate systems.
    """
    try:
        lines = read_text(path).splitlines()
    except OSError as error:
        raise RecordError(f"{path}: the mass properties cannot be read: {why_unread(error)}") from None
    # small letters of ASCII
    folded = [unicodedata.normalize("NFKD", line.casefold()).encode("ascii", "ignore").decode() for line in lines]
    text = "\n".join(folded)
    numbers = re.findall(r"=\s*[-+]?(\d[\d.,]*\d|\d)", text)
    commas = [number for number in numbers if "," in number]
    if commas and (
        any("." in number for number in numbers) or all(re.fullmatch(r"\d{1,3}(,\d{3})+", number) for number in commas)
    ):
        raise RecordError(
            f'{path}: "{short(commas[0])}" holds a comma: of thousands, or of decimals? Write all numbers with decimal points, '
            "and without signs of thousands."
        )
    text = re.sub(r"(?<=\d),(?=\d)", ".", text) if commas else text
    program = next((name for words, name in _OTHERS.items() if re.search(words, text)), "")
    masses = list(_MASS.finditer(text))
    if program or not masses:
        fault = f"this is a text of {program}, which is not read" if program else "the mass is not found in this text"
        raise RecordError(f"{path}: {fault}. {_HOW}")
    systems = {match[1] for match in _SYSTEM.finditer(text)}
    if len(systems) > 1:
        raise RecordError(
            f"{path}: its parts are in several coordinate systems, {short(', '.join(sorted(systems)))}. Export all in one, "
            "that of the table of mounts."
        )
    parts: dict[str, MassProperties] = {}
    assumed = False
    for number, match in enumerate(masses):
        begin = masses[number - 1].end() if number else 0
        end = masses[number + 1].start() if number + 1 < len(masses) else len(text)
        name = path.stem if len(masses) == 1 else f"part {number + 1}"
        if len(masses) > 1 and (headings := list(_HEADING.finditer(text, begin, match.start()))):
            line = lines[text.count("\n", 0, headings[-1].start(1))]
            name = " ".join(line.split()[len(headings[-1][0].split()) - len(headings[-1][1].split()) :]) or name
        behind = _HEADING.search(text, match.end(), end)
        where = str(path) if len(masses) == 1 else f"{path}: {short(name)}"
        name = name if name not in parts else f"{name} ({number + 1})"
        mass = float(match[1]) * _unit(where, match[2], _MASSES)
        parts[name], guessed = _part(where, text[match.start() : behind.start() if behind else end], mass, products)
        assumed |= guessed
    if assumed:
        warnings.warn(
            f"{path}: the text does not say the sign of its products of inertia; they are taken as +sum x y dm, as SolidWorks "
            "prints them unless told otherwise. `--products tensor` takes them as elements of the tensor.",
            RecordWarning, stacklevel=2,
        )  # fmt: skip
    return list(parts.items())


def _part(where: str, text: str, mass: float, products: str) -> tuple[MassProperties, bool]:
    """Read the mass properties of one part from its text, and whether the sign convention of its products was assumed."""
    if mass <= 0.0:
        raise RecordError(f"{where}: the mass must be > 0, got {mass:g} kg.")
    heading = re.search(rf"(?:{_CENTRE})[^\n]*\(\s*([a-z]+)\s*\)", text)
    places = [re.search(rf"\b{axis}\s*=\s*{_N}", text[heading.end() :] if heading else "") for axis in "xyz"]
    if heading is None or None in places:
        raise RecordError(f"{where}: the centre of mass is not found in this text. {_HOW}")
    centre = _unit(where, heading[1], _LENGTHS) * np.array([float(place[1]) for place in places if place])
    shift = mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    central, outer = None, None
    for letter in "li":
        try:
            if (tensor := _tensor(where, text, letter)) is not None:
                central, outer = (tensor[0], outer) if tensor[1] else (central, tensor[0])
        except RecordError:
            if central is None:  # else the text goes on with what is not needed
                raise
    principal = _principal(where, text)
    stated = {
        TENSOR if "negativ" in line[0] else POSITIVE
        for line in _NOTATION.finditer(text) if re.search("negativ|positiv", line[0])
    }  # fmt: skip
    shown = _shown_conventions(where, central, outer, principal, shift)
    said = {*stated, *shown, *([products] if products else [])}
    if len(said) > 1:
        words, figures = (" and ".join(sorted(notations)) or "not said" for notations in (stated, shown))
        raise RecordError(
            f"{where}: the notation of products of inertia is {words} by the words of the text, {figures} by its figures, "
            f"{products or 'not given'} by --products: export the text again, or leave the option out."
        )
    if central is not None or outer is not None:
        listed, moved = (central, 0.0) if central is not None else (outer, shift)
        meant = {name: np.where(np.eye(3), 1.0, sign) * listed - moved for name, sign in _SIGNS.items()}
    elif principal is not None:
        meant, said = dict.fromkeys(_SIGNS, principal), {TENSOR}
    else:
        raise RecordError(f"{where}: the moments of inertia taken at the center of mass are not found in this text. {_HOW}")
    possible = {name for name, tensor in meant.items() if not why_impossible(tensor)}
    said = said or (possible if len(possible) == 1 else set())
    inertia = meant[next(iter(said), POSITIVE)]
    if why := why_impossible(inertia):
        raise RecordError(f"{where}: no body has these moments of inertia: {why}.")
    matter = float(np.abs(inertia * _OFF).max()) > _DIGITS * inertia.trace()
    return MassProperties(mass, centre, inertia), matter and not said


def _shown_conventions(
    where: str, central: Array | None, outer: Array | None, principal: Array | None, shift: Array
) -> set[str]:
    """Return the sign conventions of products of inertia that agree with the redundant figures of a text.

    With a sign s of products P, the tensors s P about both points differ by the theorem of parallel axes, and that about the
    centre of mass is the one of the principal moments. RecordError where they belong to other points, masses or axes.
    """
    pairs: list[tuple[Array, Array, float]] = []
    if central is not None and outer is not None:
        moved = np.diag(outer - central - shift)
        if np.abs(moved).max() > 0.02 * np.abs(shift).max() + 10.0 * _DIGITS * outer.trace():
            raise RecordError(
                f"{where}: the moments of inertia at the output coordinate system are not those at the centre of mass moved by "
                "this mass and this centre: are they of one part, in one coordinate system?"
            )
        pairs.append((outer - central, shift, 2.0 * _DIGITS * outer.trace()))
    if principal is not None and (listed := central if central is not None else outer) is not None:
        meant = principal if central is not None else principal + shift
        ends = np.linalg.eigvalsh(principal)
        pairs.append((listed, meant, _FEW * float(np.ptp(ends))))
    notations = set[str]()
    for listed, meant, least in pairs:
        size = float(np.abs(meant * _OFF).max())
        near = [
            name for name, sign in _SIGNS.items() if np.abs((sign * listed - meant) * _OFF).max() < _ROUGH * size + least
        ]  # fmt: skip
        if size > 4.0 * least and len(near) == 1:
            notations.add(near[0])
    return notations


def _tensor(where: str, text: str, letter: str) -> tuple[Array, bool] | None:
    """Read the inertia tensor Lxx to Lzz, or Ixx to Izz, in SI, (3, 3), and whether it is about the centre of mass.

    Else they are at the origin of the output coordinate system. None where the text has none.
    """
    first = re.search(rf"\b{letter}xx\s*=", text)
    if first is None:
        return None
    letter, above = letter.upper(), list(_INERTIA.finditer(text, 0, first.start()))
    if not above:
        raise RecordError(f"{where}: the unit of {letter}xx is not found in this text, such as (grams * square millimeters).")
    about = text[above[-1].start() : first.start()]
    at_centre = re.search(_CENTRE, about) is not None
    if re.search("principal|hauptachsen|principaux|principali", about) or not (at_centre or re.search(_OUTPUT, about)):
        raise RecordError(
            f"{where}: {letter}xx to {letter}zz are to be taken at the center of mass, or at the output coordinate system, and "
            f"aligned with that; the text says {short(' '.join(about.partition(')')[2].split()) or 'nothing')!r}. {_HOW}"
        )
    tensor = np.empty((3, 3))
    for i, row in enumerate("xyz"):
        for j, column in enumerate("xyz"):
            number = re.search(rf"\b{letter}{row}{column}\s*=\s*{_N}", text, re.IGNORECASE)
            if number is None:
                raise RecordError(f"{where}: {letter}{row}{column} is not found in this text. {_HOW}")
            tensor[i, j] = float(number[1])
    if not np.allclose(tensor, tensor.T, rtol=1e-4, atol=1e-6 * tensor.trace()):  # the digits that are printed
        raise RecordError(
            f"{where}: the moments of inertia are not symmetric: {letter}xy and {letter}yx, for instance, differ."
        )
    return _moment(where, above[-1]) * 0.5 * (tensor + tensor.T), at_centre


def _principal(where: str, text: str) -> Array | None:
    """Read the principal moments Px, Py, Pz and their axes as a tensor in SI, (3, 3); None where the text has none."""
    axis = rf"{_NUMBER}\s*,\s*{_NUMBER}\s*,\s*{_NUMBER}"
    rows = list(re.finditer(rf"\bi[xyz]\s*=\s*\(\s*{axis}\s*\)\s*p[xyz]\s*=\s*{_N}", text))
    if len(rows) != 3 or not (above := list(_INERTIA.finditer(text, 0, rows[0].start()))):
        return None
    numbers = np.array([row.groups() for row in rows], dtype=float)
    axes = numbers[:, :3] / np.maximum(np.linalg.norm(numbers[:, :3], axis=1, keepdims=True), 1e-3)
    if not np.allclose(axes @ axes.T, np.eye(3), atol=0.05):  # axes of one digit say nothing
        return None
    return np.asarray(_moment(where, above[-1]) * axes.T @ np.diag(numbers[:, 3]) @ axes)


def _moment(where: str, unit: re.Match[str]) -> float:
    """Convert one unit of moments of inertia, such as grams * square millimeters, to kg m^2."""
    return _unit(where, unit[1], _MASSES) * _unit(where, _SQUARE.sub(" ", unit[2]).strip(), _LENGTHS) ** 2


def _unit(where: str, name: str, known: Mapping[str, float]) -> float:
    factor = next((factor for words, factor in known.items() if re.fullmatch(words, name)), None)
    if factor is None:
        listed = "grams, kilograms, tonnes, pounds" if known is _MASSES else "millimeters, centimeters, meters, inches, feet"
        raise RecordError(f'{where}: the unit "{name}" is unknown. Known units: {listed}.')
    return factor
