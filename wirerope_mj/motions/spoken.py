"""Base motions, and forces on the payload, from phrases and sentences."""

import re
import warnings
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path

from wirerope_mj.foundation.errors import ConvergenceError, ModelWarning
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.quantities import UNITS, Phrase, parse_phrase
from wirerope_mj.motions.motion import BaseMotion
from wirerope_mj.motions.phrases import SpokenMotion
from wirerope_mj.motions.registry import SPOKEN_MOTIONS


def motion_from_phrase(kind: str, text: str, *, folder: Path | None = None, along: str = "") -> BaseMotion:
    """Make the base motion that a phrase says; along several axes, as in "xyz", the sum of one along each.

    `kind` is one of `SPOKEN_MOTIONS`; the relative path of a file starts in `folder`, the current one by default;
    a phrase without a direction is `along` one, if that is given.

    Raises:
        ValueError: the phrase is not understood, or says too little or too much; ends with an example.
        RecordError: a file that it names cannot be read.

    Warns:
        ModelWarning: a shock pulse lasts more than a second, or the rms of a random vibration is beyond 50 g.
    """
    spoken = SPOKEN_MOTIONS[kind]
    try:
        begun, rest = (None, text) if spoken.begins is None else spoken.begins(text, folder or Path())
        phrase = parse_phrase(rest, words=spoken.words)
        if along and spoken.directed and not phrase.directions:
            phrase = replace(phrase, directions=(along,))
        _check(spoken, phrase)
        directions = phrase.directions if spoken.directed else ("z",)
        made = [spoken.make(phrase, direction, n, begun) for n, direction in enumerate(directions)]
    except ValueError as error:
        raise ValueError(f'{kind} "{short(text)}": {error} It is written like "{spoken.example}".') from None
    except ConvergenceError as error:
        raise ConvergenceError(f'{kind} "{short(text)}": {error}') from None
    if doubt := made[0].doubt:
        warnings.warn(f'{kind} "{short(text)}": {doubt}', ModelWarning, stacklevel=2)
    return sum(made[1:], start=made[0])


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
    near = [one for word in text.split() for one in get_close_matches(word.lower(), SPOKEN_MOTIONS, n=1)]
    meant = f" Did you mean {near[0]}?" if near else ""
    raise ValueError(
        f'"{short(text)}" names no kind of motion: {", ".join(SPOKEN_MOTIONS)}.{meant} It is written like '
        '"half-sine 15 g 11 ms z".'
    )


def _check(spoken: SpokenMotion, phrase: Phrase) -> None:
    """Raise ValueError unless a phrase says as much as its kind needs, and no more."""
    for quantity in dict.fromkeys((*spoken.needs, *phrase.quantities)):
        there, needed = len(phrase.quantities.get(quantity, ())), spoken.needs.get(quantity, 0)
        if there <= spoken.may.get(quantity, -1):
            continue
        are = "is none" if there == 0 else "is one" if there == 1 else f"are {there}"
        if there < needed:
            article = "an" if quantity[0] in "au" else "a"
            counted = f"{article} {quantity}" if needed == 1 else f"{needed} values of {quantity}"
            raise ValueError(f"{counted} must stand there ({', '.join(UNITS[quantity])}), and there {are}.")
        if there > needed:
            raise ValueError(f"there {are} of {quantity}, and {needed or 'none'} is expected.")
    for word in spoken.needed_words:
        if word not in phrase.named:
            raise ValueError(f'"{word}" and its value must stand there.')
    if spoken.directed and not phrase.directions:
        raise ValueError("a direction must stand there: x, y, z, several as in xyz, -z or a vector such as 1,1,0.")
    if phrase.directions and not spoken.directed:
        raise ValueError("a direction stands there, and none is expected: the columns of its table say it.")
