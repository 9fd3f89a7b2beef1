"""A scenario: a question, the model and the base motion that answer it, and the file that makes them from options."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import UnionType
from typing import Any

from wirerope_mj.engine.flexible import Deck
from wirerope_mj.engine.system import Changes, load_system
from wirerope_mj.engine.system.on_deck import deck_text
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.foundation.plain_text import quoted
from wirerope_mj.foundation.resources import model_source, scenarios_folder
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.runs.option_file import OptionFile

# What each attribute of a scenario must be, and what a message calls it.
_KINDS: dict[str, tuple[type | UnionType, str]] = {
    "question": (str, "text"),
    "model": (str | Path, "the path of a model, its name, or its text"),
    "motion": (BaseMotion, "a base motion, such as HalfSine(...)"),
    "simulate": (Mapping, 'a table of arguments, such as {"duration": 1.0}'),
    "isolators": (Mapping | None, "a table of isolators by name, or None"),
    "name": (str, "text"), "options": (Mapping, "a table of options by name"),
    "folder": (Path | None, "a Path, or None"), "changes": (list | tuple, "a list of Changes"),
    "combined_travel": (bool, "True or False"), "limits": (list | tuple, "a list of PayloadLimits"),
}  # fmt: skip


@dataclass(frozen=True)
class Scenario:
    """A question and everything that a simulation of it needs."""

    question: str  #: what the run should answer
    #: MJCF file, or MJCF text. A relative path starts at the scenario file's folder (without a file at the current one), then
    #: at the models that ship with the package; `.xml` may be left out.
    model: str | Path
    motion: BaseMotion  #: base motion
    #: arguments of `wirerope_mj.simulate` besides system and motion; `duration` must be among them
    simulate: Mapping[str, Any]
    #: isolators in memory by the name that follows `isolator/` in the model; they go before files
    isolators: Mapping[str, Isolator] | None = None
    name: str = "scenario"  #: names the run
    options: Mapping[str, Any] = field(default_factory=dict)  #: values of the options that made it, by name
    folder: Path | None = None  #: where a relative model path starts
    #: what the system differs by from the model, as `changes` of what `wirerope_mj.varied` returns says it
    changes: Sequence[Changes] = ()
    #: whether mounts are judged on all axes at once, by this project's own rule, if the model does not forbid it
    combined_travel: bool = True
    #: what the payload can bear, in place of what the model states for the same subjects
    limits: Sequence[PayloadLimit] = ()

    def __post_init__(self) -> None:
        for name, (kind, said) in _KINDS.items():
            value = getattr(self, name)
            if not isinstance(value, kind):
                raise ValueError(f"`{name}` of a Scenario must be {said}, got {quoted(value, 80)}.")
        for name, kind in (("limits", PayloadLimit), ("changes", Changes)):
            for one in getattr(self, name):
                if not isinstance(one, kind):
                    raise ValueError(f"`{name}` of a Scenario must hold {kind.__name__}s only, got {quoted(one)}.")
        for name in ("simulate", "options", "isolators"):
            for key in getattr(self, name) or ():
                if not isinstance(key, str):
                    raise ValueError(f"the keys of `{name}` of a Scenario must be text, got {quoted(key)}.")

    def model_source(self) -> str | Path:
        """Return the MJCF text, or the path of the model file; ModelError names where it was looked for."""
        return model_source(self.model, folder=self.folder, asker=f"scenario {self.name!r}")

    def on_deck(self, deck: Deck) -> "Scenario":
        """Put a deck that bends under all mounts of the model, which is text then."""
        system = load_system(self.model_source(), isolators=self.isolators)
        options = {**self.options, "deck": deck.description}
        return replace(self, model=deck_text(system, deck), isolators=system.isolators, options=options)


class ScenarioFile(OptionFile):
    """A file with one function `scenario(*, ...) -> Scenario`, whose keyword arguments are the options."""

    def make(self, **options: object) -> Scenario:
        """Return the scenario of some options; the others have their defaults.

        ModelError if an option is unknown, or the function does not return a Scenario, or fails; says in which line.
        """
        made, values = self.made(options)
        if not isinstance(made, Scenario):
            raise ModelError(f"{self.path}: `scenario` must return a wirerope_mj.Scenario, got {quoted(made)}.")
        return replace(made, name=self.name, options=values, folder=self.path.parent)


def shipped_scenarios() -> dict[str, Path]:
    """Return the scenarios that ship with the package, by name."""
    return {path.stem: path for path in sorted(scenarios_folder().glob("*.py"))}


def load_scenario(name_or_path: str | Path) -> ScenarioFile:
    """Return the scenario file at a path, or the shipped one of that name.

    Raises:
        ModelError: there is no such scenario, or the file has no function `scenario` with keyword options only.
    """
    return ScenarioFile.load(name_or_path, shipped_scenarios(), "scenario")
