"""Phrases and options in words, what goes wrong with them at a keyboard, and which of their numbers do nothing."""

import re

import numpy as np
from hostile import pick

NUMBERS = (
    "nan",
    "inf",
    "-inf",
    "1e400",
    "-1e400",
    "1e-400",
    "-0",
    "0",
    "1e-308",
    "5e-324",
    "1e308",
    "-1",
    "9" * 30,
    "1e30",
    "1e-30",
    "9007199254740993",
    "1e9",
    "1e12",
    "1e-9",
    "1e-12",
    "1_0",
    "0x10",
    "1,5",
    "1e",
    ".",
    "+5",
    "5.",
    ".5",
    "0005",
    "1e5e5",
    "--5",
    "\u0661\u0662",
    "\uff11\uff15",
    "\u00bd",
    "",
    "10",
    "3",
    "12",
    "0.7",
    "20",
    "1",
    "2",
    "50",
    "4",
    "8",
    "0.3",
    "2.5e0",
    "1e6",
    "1e-6",
    "7e15",
    "12e3",
)
"""Numbers as they are written, or meant; in Arabic and in full-width digits, too."""

WORDS = (
    "x",
    "y",
    "z",
    "xyz",
    "-z",
    "+x",
    "xx",
    "zyx",
    "1,1,0",
    "0,0,0",
    "nan,1,1",
    "1e400,0,1",
    "1,1",
    "at",
    "at 50 ms",
    "at -1 s",
    "at 1e300 s",
    "seed",
    "seed 3",
    "seed -1",
    "seed 0.5",
    "rise 2 ms",
    "fall",
    "damping",
    "damping 5 %",
    "damping 100 %",
    "blow",
    "order 2",
    "for 3 s",
    "to",
    "?",
    "? g",
    "g",
    "G",
    "Hz",
    "kHz",
    "hz",
    "ms",
    "m/s",
    "mm",
    "%",
    "oct/min",
    "kg.mm",
    "N.m",
    "5to50",
    "\u200b",
    "\x1b[31m",
    "\u00fc",
    "a" * 300,
    "None",
    "--",
    ";",
    '"',
    "15 g",
    "11 ms",
    "3 Hz",
    "1 m/s",
    "1e3 s",
)

_NUMBER = re.compile(r"(?<![\w./,])-?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?(?![\w,]*[./]\w)(?!\w*,)")
"""A number that stands alone or before its unit: none of a vector, a name or a file."""


def muddled(rng: np.random.Generator, text: str) -> str:
    """Change one to three words of a phrase."""
    words = text.split(" ")
    for _ in range(pick(rng, (1, 1, 1, 1, 2, 2, 3))):
        place, kind = int(rng.integers(len(words))), int(rng.integers(10))
        if kind <= 4:
            numbers = [i for i, word in enumerate(words) if any(c.isdigit() for c in word)]
            if numbers:
                place = pick(rng, numbers)
                words[place] = _NUMBER.sub(lambda _: pick(rng, NUMBERS), words[place], count=1)
        elif kind == 5:
            words.insert(place, pick(rng, WORDS))
        elif kind == 6 and len(words) > 1:
            del words[place]
        elif kind == 7:
            words[place] = pick(rng, WORDS)
        elif kind == 8:
            words.insert(place, words[int(rng.integers(len(words)))])
        else:
            words = [words[i] for i in rng.permutation(len(words))]
    return " ".join(words)


def others(text: str) -> list[tuple[str, str]]:
    """Return each number of a phrase, and the phrase with another in its place: something must come of that."""
    found = []
    for match in _NUMBER.finditer(text):
        value = float(match[0])
        for other in ("7",) if value == 0.0 else (f"{value * 1.25:.9g}", f"{value + 1:.9g}"):
            found.append((match[0], f"{text[: match.start()]}{other}{text[match.end() :]}"))
    return found


def ignored(text: str, answer) -> str | None:
    """Return a complaint if a number of a phrase does nothing: another in its place is taken, and `answer(text)` is the same.

    Args:
        text: a phrase that is taken.
        answer: what is made of a phrase, as plain values; raises ValueError where it is refused.
    """
    mine, same = answer(text), dict[str, bool]()
    for number, other in others(text):
        try:
            theirs = answer(other)
        except Exception:  # refused, or else a case of its own
            same[number] = False
            continue
        same[number] = same.get(number, True) and theirs == mine
    silent = [number for number, unchanged in same.items() if unchanged]
    return f"{silent[0]} does nothing" if silent else None
