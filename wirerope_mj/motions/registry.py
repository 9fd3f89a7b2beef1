"""The registry of motions: every class, by the name under which it is stored, by phrases and sentences, and in files of levels.

A motion joins by its line in `REGISTERED`, whose order is that of commands' options and of messages.
"""

import inspect
import re
import shutil
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from typing import Annotated

from wirerope_mj.foundation.arguments import nonzero
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ConvergenceError, ModelError, ModelWarning
from wirerope_mj.foundation.faults import each
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.quantities import parse_phrase
from wirerope_mj.foundation.regular_files import file_inside
from wirerope_mj.foundation.resources import scenarios_folder
from wirerope_mj.foundation.structure import Among, Key, Place, structure
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.foundation.units import PHRASE_UNITS
from wirerope_mj.motions.double_pulses import DoubleHalfSine, DoubleTriangle
from wirerope_mj.motions.drop import Drop, RotationalDrop
from wirerope_mj.motions.harmonic import Sine, Unbalance
from wirerope_mj.motions.motion import BaseMotion, SumOfMotions
from wirerope_mj.motions.payload_forces import Blow, ForceTable, HarmonicForce
from wirerope_mj.motions.phrases import SpokenMotion
from wirerope_mj.motions.pulses import HalfSine, Sawtooth, StruckPlate, Trapezoid, VelocityStep
from wirerope_mj.motions.random_vibration import RandomVibration
from wirerope_mj.motions.records.record import Record
from wirerope_mj.motions.scaled import Scaled, Turned
from wirerope_mj.motions.ship_motion import ShipMotion
from wirerope_mj.motions.shock_machines import DecayingSine, ShockTableImpact
from wirerope_mj.motions.spectrum_match import SpectrumMatch
from wirerope_mj.motions.sweep import Sweep
from wirerope_mj.motions.target_spectra import DesignSpectrum
from wirerope_mj.motions.vibration_lines import VibrationLines

REGISTERED: tuple[type[BaseMotion] | type[DesignSpectrum] | type[SpectrumMatch], ...] = (
    HalfSine,
    Sawtooth,
    Trapezoid,
    VelocityStep,
    DesignSpectrum,  # stored as its double half-sine
    DoubleHalfSine,
    DoubleTriangle,
    Drop,
    RotationalDrop,
    ShockTableImpact,
    DecayingSine,
    StruckPlate,
    Sine,
    Sweep,
    RandomVibration,
    VibrationLines,
    ShipMotion,
    SpectrumMatch,  # stored as its lines
    Unbalance,
    HarmonicForce,
    Blow,
    ForceTable,
    Record,
    Scaled,
    Turned,
    SumOfMotions,
)
# The motions by the name under which they are stored.
BY_KIND: dict[str, type[BaseMotion]] = {motion.kind: motion for motion in REGISTERED if issubclass(motion, BaseMotion)}
# The phrases by their names, of the base and then of forces on the payload, each with its own motion to make.
SPOKEN_MOTIONS: dict[str, SpokenMotion] = {
    form.name: replace(form, make=partial(form.make, motion)) for motion in REGISTERED for form in motion.phrases
}


def motion_from_phrase(kind: str, text: str, *, folder: Path | None = None, along: str = "") -> BaseMotion:
    """Make the base motion of a phrase; along several axes, as in "xyz", the sum of a motion along each.

    `kind` is one of `SPOKEN_MOTIONS`; the relative path of a file starts in `folder`, the current one by default;
    a phrase without a direction has the direction `along`, if one is given.

    Raises:
        ValueError: the phrase is not understood, or says too little or too much; ends with an example.
        RecordError: a file that it names cannot be read.

    Warns:
        ModelWarning: no test has such a motion, as a pulse of more than a second, or a random vibration beyond 50 g rms.
    """
    spoken = SPOKEN_MOTIONS[kind]
    try:
        prefix, rest = (None, text) if spoken.begins is None else spoken.begins(text, folder or Path())
        phrase = parse_phrase(rest, words=spoken.words, takes=[*spoken.needs, *spoken.may])
        if along and spoken.directed and not phrase.directions:
            phrase = replace(phrase, directions=(along,))
        for quantity in dict.fromkeys((*spoken.needs, *phrase.quantities)):
            found, needed = len(phrase.quantities.get(quantity, ())), spoken.needs.get(quantity, 0)
            if found <= spoken.may.get(quantity, -1):
                continue
            are = "is none" if found == 0 else "is one" if found == 1 else f"are {found}"
            if found < needed:
                article = "an" if quantity[0] in "au" else "a"
                counted = f"{article} {quantity}" if needed == 1 else f"{needed} values of {quantity}"
                raise ValueError(f"{counted} must stand there ({', '.join(PHRASE_UNITS[quantity])}), and there {are}.")
            if found > needed:
                raise ValueError(f"there {are} of {quantity}, and {needed or 'none'} is expected.")
        for word in spoken.needed_words:
            if word not in phrase.named:
                raise ValueError(f'"{word}" and its value must stand there.')
        if spoken.directed and not phrase.directions:
            raise ValueError("a direction must stand there: x, y, z, several as in xyz, -z or a vector such as 1,1,0.")
        if phrase.directions and not spoken.directed:
            raise ValueError("a direction stands there, and none is expected: its parts or the columns of its table say it.")
        directions = phrase.directions if spoken.directed else ("z",)
        motions = [spoken.make(phrase, direction, n, prefix) for n, direction in enumerate(directions)]
    except ValueError as error:
        raise ValueError(f'{kind} "{short(text)}": {error} It is written like "{spoken.example}".') from None
    except ConvergenceError as error:
        raise ConvergenceError(f'{kind} "{short(text)}": {error}') from None
    if doubt := motions[0].doubt:
        warnings.warn(f'{kind} "{short(text)}": {doubt}', ModelWarning, stacklevel=2)
    return sum(motions[1:], start=motions[0])


# Kinds as people write them, with spaces, hyphens or neither; the first that a sentence holds counts.
_WRITTEN = {form.written: name for name, form in SPOKEN_MOTIONS.items() if form.written} | {
    name.replace("-", "[- ]?"): name for name in sorted(SPOKEN_MOTIONS, key=len, reverse=True)
}
_BARE_STEP = re.compile(r"\s*[-+.\deE]+ ?m/s\b[^a-z]*[-xyz]*\s*")  # a velocity alone, with a direction or without


def motion_from_words(text: str) -> BaseMotion:
    """Make the base motion of a sentence that names its kind anywhere: "half-sine 15 g 11 ms z", "2 m/s".

    Where no direction stands, and the kind needs one, it is z.

    Raises:
        ValueError: no kind of motion is named, or what else is said is not understood.
        RecordError: a file that it names cannot be read.
    """
    named = "velocity-step " * bool(_BARE_STEP.fullmatch(text)) + text
    for written, kind in _WRITTEN.items():
        if match := re.search(rf"(?<![\w-]){written}(?![\w-])", named, re.IGNORECASE):
            rest = f"{named[: match.start()]} {named[match.end() :]}".replace(", ", " ")
            rest = " ".join(part.removesuffix(",") for part in rest.split())
            return motion_from_phrase(kind, rest, along="z")
    guesses = [kind for word in text.split() for kind in get_close_matches(word.lower(), SPOKEN_MOTIONS, n=1)]
    meant = f" Did you mean {guesses[0]}?" if guesses else ""
    raise ValueError(
        f'"{short(text)}" names no kind of motion: {", ".join(SPOKEN_MOTIONS)}.{meant} It is written like '
        '"half-sine 15 g 11 ms z".'
    )


def motion_from_dict(stored: Entries, *, folder: str | Path | None = None) -> BaseMotion:
    """Make the motion that `BaseMotion.to_dict` stored; its numbers are the same to the last bit.

    Relative paths of records start in `folder`, the current one by default.

    Raises:
        ModelError: the kind of motion is unknown, or a parameter is missing or unknown.
        RecordError: the file of a record is missing or not a record.
        ValueError: A parameter is out of its range.
    """
    parameters = dict(stored)
    kind = parameters.pop("kind", None)
    if kind not in BY_KIND:
        raise ModelError(f"Unknown kind of motion {kind!r}; known kinds: {', '.join(BY_KIND)}.")
    make = BY_KIND[kind].maker()
    known = inspect.signature(make).parameters
    unknown = [name for name in parameters if name not in known]
    missing = [name for name, item in known.items() if item.default is item.empty and name not in parameters]
    for names, fault in ((unknown, "unknown"), (missing, "missing")):
        if names:
            raise ModelError(f"Motion {kind!r}: {fault} {', '.join(names)}; its parameters are {', '.join(known)}.")
    if "path" in parameters and folder is not None:
        parameters["path"] = Path(folder) / parameters["path"]
    if "motion" in parameters:
        parameters["motion"] = motion_from_dict(parameters["motion"], folder=folder)
    if "terms" in parameters:
        parameters["terms"] = tuple(motion_from_dict(term, folder=folder) for term in parameters["terms"])
    return make(**parameters)


def copy_records(motions: Sequence[BaseMotion], folder: Path) -> dict[Path, str]:
    """Copy the files of some motions to `folder`/inputs and return their names there, relative to `folder`."""
    names: dict[Path, str] = {}
    for path in dict.fromkeys(path for motion in motions for path in motion.files):
        name, number = f"inputs/{path.name}", 1
        while name in names.values():
            number += 1
            name = f"inputs/{path.stem}-{number}{path.suffix}"
        (folder / "inputs").mkdir(exist_ok=True)
        shutil.copyfile(path, folder / name)
        names[path] = name
    return names


def check_records(motion: Entries, folder: Path) -> None:
    """Raise RecordError if a motion that `folder` holds, as `to_dict` stored it, names a record that is not in the folder."""
    if "path" in motion:
        file_inside(folder, motion["path"], "record")
    for part in (*motion.get("terms", []), *([motion["motion"]] if "motion" in motion else [])):
        check_records(part, folder)


@dataclass(frozen=True, kw_only=True)
class Level:
    """One motion in a file of levels: its phrase, and a factor."""

    phrase: Annotated[dict[str, str], Among(SPOKEN_MOTIONS)] = field(default_factory=dict)  #: phrase of the motion, by its kind
    factor: float | None = None  #: factor on the motion

    def __post_init__(self) -> None:
        if len(self.phrase) != 1:
            raise ValueError(f"it says one of {', '.join(SPOKEN_MOTIONS)}; got {', '.join(self.phrase) or 'nothing'}.")


@dataclass(frozen=True, kw_only=True)
class Levels:
    """A file of levels: motions of a test, all of which are added."""

    motions: Annotated[tuple[Level, ...], Key("motion")] = ()
    standard: str = ""  #: standard or specification that states the levels

    def __post_init__(self) -> None:
        if not self.motions:
            raise ValueError('there is no table [[motion]]; one says for instance half-sine = "15 g 11 ms z".')


def level_templates() -> dict[str, Path]:
    """Return the files of levels that come with the package, by name."""
    return {path.stem: path for path in sorted((scenarios_folder() / "levels").glob("*.toml"))}


_PER_CENT = 50.0  # factor from which it is questioned: classes and margins scale a level by 0.5 to 5


def motion_of_levels(path: Path) -> BaseMotion:
    """Return the sum of the motions of a file of levels.

    The file has `standard`, a text, and tables `[[motion]]`, each of which says one motion, `half-sine = "15 g 11 ms z"`, and
    maybe `factor`. A file that a phrase names lies beside it.

    Raises:
        ModelError: the file cannot be read, a key is unknown, or a level is still open; names the file and the motion.
        RecordError: a file that it names cannot be read.
    """
    place = Place(path)
    levels = structure(Levels, read_toml(path, "file of levels"), place)

    def motion_of(number: int) -> BaseMotion:
        level = levels.motions[number]
        ((kind, phrase),) = level.phrase.items()
        if level.factor is not None and abs(level.factor) >= _PER_CENT:
            doubt = f"factor {level.factor:g} seems to be in per cent: say {level.factor / 100.0:g}, or scale the level itself."
            warnings.warn(f'{path}: {kind} "{short(phrase)}": {doubt}', ModelWarning, stacklevel=2)
        try:
            motion = motion_from_phrase(kind, phrase, folder=path.parent)
            return motion if level.factor is None else Scaled(motion, nonzero("factor", level.factor))
        except ValueError as error:
            raise place.at("motion", number).fault(str(error)) from None

    motions = each(motion_of, range(len(levels.motions)))
    return sum(motions[1:], start=motions[0])
