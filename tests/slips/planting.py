"""Slips planted into inputs that are right: what is written wrongly, in which inputs, and the words that name the cause."""

import re
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import wirerope_mj as wr


@dataclass(frozen=True)
class Base:
    """An input as it should be: texts by the names of their files, and the file that is asked about; "" = the folder."""

    name: str
    files: Mapping[str, str | bytes]
    asked: str = ""
    #: what reads the file that is asked about, and may list sentences; None: `wirerope check`
    ask: Callable[[Path], object] | None = None


@dataclass(frozen=True)
class Slip:
    """A slip: the text of one file of each base becomes another, of which the words must name the cause."""

    name: str
    bases: tuple[Base, ...]
    plant: Callable[[str], str]
    words: str  #: regular expression, of which one sentence must hold a match
    file: str = ""  #: file that it is planted in; "" = the one that is asked about
    untold: str = ""  #: why it cannot be told from an input that is right; "" = it must be named


@dataclass(frozen=True)
class Outcome:
    """What was said of a slip in a base."""

    slip: Slip
    base: Base
    sentences: list[str]

    @property
    def named(self) -> bool:
        return any(re.search(self.slip.words, sentence) for sentence in self.sentences)


def planted(slip: Slip, base: Base, folder: Path) -> Outcome:
    """Write a base with the slip into an empty folder and ask about it."""
    file = slip.file or base.asked or "mounts.csv"
    text = slip.plant(base.files[file])
    assert text != base.files[file], f"{slip.name}: nothing of {file} of {base.name} was changed"
    return Outcome(slip, base, told(replace(base, files={**base.files, file: text}), folder))


def told(base: Base, folder: Path) -> list[str]:
    """Write an input into an empty folder and return what is said of it."""
    for name, text in base.files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    return said(folder / base.asked, base.ask)


def said(path: Path, ask: Callable[[Path], object] | None = None) -> list[str]:
    """Return the sentences on what is wrong or implausible about an input: those of `wirerope check`, or of what asks."""
    if ask is None:
        return [finding.text for finding in wr.check(path)]
    sentences = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            answer = ask(path)
            sentences += answer if isinstance(answer, list | Iterator) else []
        except (wr.WireRopeError, ValueError) as error:
            sentences.append(str(error))
    return [str(warning.message) for warning in caught] + sentences
