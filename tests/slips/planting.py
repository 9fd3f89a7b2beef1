"""Slips planted into inputs that are right: what is written wrongly, in which inputs, and the words that name the cause."""

import re
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import rest_travel_verdicts, rested_verdicts, static_load_verdicts
from wirerope_mj.content.blocks import Statement
from wirerope_mj.content.statics import statics_content
from wirerope_mj.engine.statics import model_warnings, static_table
from wirerope_mj.engine.system import System
from wirerope_mj.mounts.isolator.implausible import isolator_warnings
from wirerope_mj.runs.new_model import build_model, tables_in


@dataclass(frozen=True)
class Base:
    """An input as it should be: texts by the names of their files, and the file that is asked about; "" = the folder."""

    name: str
    files: Mapping[str, str]
    asked: str = ""
    #: what reads the file that is asked about, and may list sentences; None: `said` knows models, tables and isolators
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
    file = base.asked or slip.file or "mounts.csv"
    text = slip.plant(base.files[file])
    assert text != base.files[file], f"{slip.name}: nothing of {file} of {base.name} was changed"
    return Outcome(slip, base, told(replace(base, files={**base.files, file: text}), folder))


def told(base: Base, folder: Path) -> list[str]:
    """Write an input into an empty folder and return what is said of it."""
    for name, text in base.files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return said(folder / base.asked, base.ask)


def said(path: Path, ask: Callable[[Path], object] | None = None) -> list[str]:
    """Return the sentences on what is wrong or implausible about an input."""
    sentences = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            answer = _sentences(path) if ask is None else ask(path)
            sentences += answer if isinstance(answer, list | Iterator) else []
        except (wr.WireRopeError, ValueError) as error:
            sentences.append(str(error))
    return [str(warning.message) for warning in caught] + sentences


def _sentences(path: Path) -> Iterator[str]:
    if path.is_dir():
        yield from _of_system(build_model("payload", tables_in(path)).system)
    elif path.suffix == ".toml":
        yield from isolator_warnings(wr.load_isolator(path))
    else:
        yield from _of_system(wr.load_system(path))


def _of_system(system: System) -> Iterator[str]:
    if found := model_warnings(system):
        yield from found
        return  # with such a slip an equilibrium is searched for long
    table = static_table(system)
    isolators = {name: mount.isolator for name, mount in system.mounts.items()}
    verdicts = rested_verdicts(table) + static_load_verdicts(table) + rest_travel_verdicts(isolators, table, system.bottoms)
    for section in statics_content(system.name, table, verdicts, {}).sections:
        for block in section.blocks:
            if isinstance(block, Statement) and (block.tone == "exceeded" or block.id in {"statics-virgin", "statics-relaxed"}):
                yield block.text
