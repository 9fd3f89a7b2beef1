"""Base motions, and forces on the payload, from phrases."""

from pathlib import Path

from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.motions.motion import BaseMotion
from wirerope_mj.motions.phrases import UNITS, Phrase, parse_phrase
from wirerope_mj.motions.spoken_forces import FORCES
from wirerope_mj.motions.spoken_kind import SpokenMotion
from wirerope_mj.motions.spoken_motions import BASE_MOTIONS

SPOKEN_MOTIONS: dict[str, SpokenMotion] = BASE_MOTIONS | FORCES  # kinds of motion that a phrase says, by name


def motion_from_phrase(kind: str, text: str, *, folder: Path | None = None) -> BaseMotion:
    """Return the base motion that a phrase says; along several axes, as in "xyz", the sum of one along each.

    Args:
        kind: one of `SPOKEN_MOTIONS`.
        text: the phrase, such as "15 g 11 ms z at 50 ms".
        folder: where the relative path of a file starts; None: the current folder.

    Raises:
        ValueError: the phrase is not understood, or says too little or too much; ends with an example.
        RecordError: a file that it names cannot be read.
    """
    spoken = SPOKEN_MOTIONS[kind]
    try:
        begun, rest = (None, text) if spoken.begins is None else spoken.begins(text, folder or Path())
        phrase = parse_phrase(rest, words=spoken.words)
        _check(spoken, phrase)
        directions = phrase.directions if spoken.directed else ("z",)
        made = [spoken.make(phrase, direction, n, begun) for n, direction in enumerate(directions)]
    except ValueError as error:
        raise ValueError(f'{kind} "{short(text)}": {error} It is written like "{spoken.example}".') from None
    except ConvergenceError as error:
        raise ConvergenceError(f'{kind} "{short(text)}": {error}') from None
    return sum(made[1:], start=made[0])


def _check(spoken: SpokenMotion, phrase: Phrase) -> None:
    """Raise ValueError unless a phrase says as much as its kind needs, and no more."""
    for quantity in dict.fromkeys((*spoken.needs, *phrase.quantities)):
        there, needed = len(phrase.quantities.get(quantity, ())), spoken.needs.get(quantity, 0)
        if there <= spoken.may.get(quantity, -1):
            continue
        if there < needed:
            units = ", ".join(UNITS[quantity])
            raise ValueError(f"{_counted(needed, quantity)} must stand there ({units}), and there {_are(there)}.")
        if there > needed:
            raise ValueError(f"there {_are(there)} of {quantity}, and {needed or 'none'} is expected.")
    for word in spoken.needed_words:
        if word not in phrase.named:
            raise ValueError(f'"{word}" and its value must stand there.')
    if spoken.directed and not phrase.directions:
        raise ValueError("a direction must stand there: x, y, z, several as in xyz, -z or a vector such as 1,1,0.")
    if phrase.directions and not spoken.directed:
        raise ValueError("a direction stands there, and none is expected: the columns of its table say it.")


def _counted(number: int, quantity: str) -> str:
    return f"{'an' if quantity[0] in 'au' else 'a'} {quantity}" if number == 1 else f"{number} values of {quantity}"


def _are(number: int) -> str:
    return "is none" if number == 0 else "is one" if number == 1 else f"are {number}"
