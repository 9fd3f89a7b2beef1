"""A scenario: a question, the model and the motion that answer it, and the Python file whose options make them."""

import ast
import inspect
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from importlib.util import module_from_spec, spec_from_file_location
from numbers import Integral, Real
from pathlib import Path, PurePath
from types import UnionType
from typing import Any, Self

from wirerope_mj.engine.flexible import Deck
from wirerope_mj.engine.simulation.stepper import falls_by_gravity
from wirerope_mj.engine.system import Changes, load_system
from wirerope_mj.engine.system.on_deck import deck_text, with_gravity, with_rotation
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError, WireRopeError, why_unread
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.foundation.plain_text import quoted, short
from wirerope_mj.foundation.regular_files import regular
from wirerope_mj.foundation.resources import model_source, scenarios_folder
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import Isolator

_PACKAGE = Path(__file__).resolve().parents[1]
# Types of defaults, what an option with such a default may be, and what it is called; a bool is an int as well.
_OPTION_KINDS: tuple[tuple[type, type | UnionType, str], ...] = (
    (bool, bool, "true or false"), (int, Integral, "an integer"), (float, Real, "a number"),
    (str, str | PurePath, "text"),
)  # fmt: skip


def defines(path: Path, name: str) -> bool:
    """Tell whether a Python file defines the function `name`; the file is not executed."""
    try:
        tree = ast.parse(regular(path).read_text(encoding="utf-8"))
    except (SyntaxError, ValueError, OSError):
        return False  # whoever executes it says what is wrong
    return any(isinstance(node, ast.FunctionDef) and node.name == name for node in tree.body)


@dataclass(frozen=True, kw_only=True)
class OptionFile:
    """A Python file with one function, whose keyword arguments are the options."""

    name: str
    path: Path
    function: Callable[..., object]

    @classmethod
    def load(cls, name_or_path: str | Path, shipped: Mapping[str, Path], kind: str) -> Self:
        """Load the file at a path, or the shipped one of that name; `kind` is the name of its function.

        ModelError if there is neither, or the file has no such function with keyword options only.
        """
        path = Path(name_or_path)
        if not path.is_file():
            if str(name_or_path) not in shipped:
                near = get_close_matches(path.stem.replace("-", "_"), shipped, n=1, cutoff=0.5)
                meant = f" Did you mean {near[0]}?" if near else ""
                raise ModelError(
                    f"there is no {kind} {str(name_or_path)!r}.{meant} The package ships {', '.join(shipped) or 'none'}; "
                    "anything else must be the path of a Python file."
                )
            path = shipped[str(name_or_path)]
        return cls(name=path.stem, path=path.resolve(), function=load_function(path, kind))

    @property
    def question(self) -> str:
        return (self.function.__doc__ or "").strip().split("\n", 1)[0]

    @property
    def defaults(self) -> Entries:
        return {name: option.default for name, option in inspect.signature(self.function).parameters.items()}

    def made(self, options: Entries) -> tuple[object, Entries]:
        """Call the function with options; returns its result, and all options with their values or defaults.

        ModelError if an option is unknown or of another kind, or the function fails; says in which line.
        """
        values = self.defaults
        for option, value in options.items():
            if option not in values:
                raise ModelError(f"{self.path}: no option {option!r}; the options are {', '.join(values)}.")
            default = values[option]  # None says nothing of its kind
            known, accepted, kind = next((row for row in _OPTION_KINDS if isinstance(default, row[0])), (object, object, ""))
            if not isinstance(value, accepted) or (isinstance(value, bool) and known not in (bool, object)):
                text = f"option `{option}` must be {kind}, as its default {default!r} is, got {value!r}."
                raise ModelError(f"{self.path}: {text}")
        values |= options
        return guarded(self.path, lambda: self.function(**values)), values


def load_function(path: Path, name: str) -> Callable[..., object]:
    """Return the function `name` of a Python file; its docstring is the file's, followed by its own arguments.

    ModelError if the file cannot be read or has no such function with keyword options only; says in which line.
    """
    spec = spec_from_file_location(path.stem, path.resolve())
    if path.suffix != ".py" or spec is None or spec.loader is None:
        raise ModelError(f"{path}: a {name} is a Python file; its name ends with .py.")
    try:
        content = regular(path).read_bytes()
    except OSError as error:
        raise ModelError(f"{path}: this {name} cannot be read: {why_unread(error)}") from None
    if b"\0" in content:
        raise ModelError(f"{path}: this is not text; a {name} is a Python file, saved as text in UTF-8.")
    module, loader = module_from_spec(spec), spec.loader
    guarded(path, lambda: loader.exec_module(module))
    function = getattr(module, name, None)
    if not inspect.isfunction(function):
        raise ModelError(f"{path}: there is no function `{name}` here; a {name} is what `def {name}(*, ...)` returns.")
    for option, parameter in inspect.signature(function).parameters.items():
        if parameter.kind is not parameter.KEYWORD_ONLY or parameter.default is parameter.empty:
            raise ModelError(f"{path}: `{option}` of `{name}` must be a keyword-only argument with a default.")
    # The question stands above the file; of the function's own docstring, the options are for the reader of --help.
    _, arguments, options = (inspect.getdoc(function) or "").partition("Args:")
    function.__doc__ = f"{(inspect.getdoc(module) or '').strip()}\n\n{arguments}{options}".strip()
    return function


def guarded(path: Path, action: Callable[[], object]) -> object:
    """Call `action`; ModelError with file and line if the code of the file fails."""
    try:
        return action()
    except SyntaxError as error:
        line = f", line {error.lineno}" if error.lineno else ""
        quoted = f"`{short(error.text.strip())}`" if error.text else "this"
        fault = "is not text in UTF-8. Save it in UTF-8" if "codec" in error.msg else f"is not Python: {error.msg}"
        raise ModelError(f"{path}{line}: {quoted} {fault}.") from error
    except Exception as error:
        frames = traceback.extract_tb(error.__traceback__)
        own_frames = [frame for frame in frames if Path(frame.filename) == path.resolve()]
        line = f", line {own_frames[-1].lineno}" if own_frames else ""
        said = isinstance(error, ValueError) and bool(own_frames) and str(own_frames[-1].line).startswith("raise ")
        if isinstance(error, WireRopeError) or said or _PACKAGE in Path(frames[-1].filename).parents:
            raise ModelError(f"{path}{line}: {error}") from error  # the message says what is wrong, and is meant to
        quoted = f"`{short(own_frames[-1].line or '')}` ends with " if own_frames else ""
        raise ModelError(f"{path}{line}: {quoted}{type(error).__name__}: {error}") from error


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
            for entry in getattr(self, name):
                if not isinstance(entry, kind):
                    raise ValueError(f"`{name}` of a Scenario must hold {kind.__name__}s only, got {quoted(entry)}.")
        for name in ("simulate", "options", "isolators"):
            for key in getattr(self, name) or ():
                if not isinstance(key, str):
                    raise ValueError(f"the keys of `{name}` of a Scenario must be text, got {quoted(key)}.")

    def model_source(self) -> str | Path:
        """Return the MJCF text, or the path of the model file; ModelError names where it was looked for."""
        return model_source(self.model, folder=self.folder, asker=f"scenario {self.name!r}")

    def on_deck(self, deck: Deck) -> "Scenario":
        """Put a flexible deck under all mounts of the model, which becomes text."""
        system = load_system(self.model_source(), isolators=self.isolators)
        options = {**self.options, "deck": deck.description}
        return replace(self, model=deck_text(system, deck), isolators=system.isolators, options=options)

    def on_its_floor(self) -> "Scenario":
        """Turn gravity against the floor onto which the motion falls, and add hinges to a base that it rotates.

        The model is text then, where one of them is needed.
        """
        up = self.motion.up
        if up is None and not self.motion.rotates:
            return self
        system = turned = load_system(self.model_source(), isolators=self.isolators)
        if up is not None and not falls_by_gravity(system, up):
            turned = with_gravity(turned, up=up)
        if self.motion.rotates:
            turned = with_rotation(turned)
        return self if turned is system else replace(self, model=turned.mjcf, isolators=turned.isolators)


class ScenarioFile(OptionFile):
    """A file with one function `scenario(*, ...) -> Scenario`, whose keyword arguments are the options."""

    def make(self, **options: object) -> Scenario:
        """Return the scenario of some options; the others have their defaults.

        ModelError if an option is unknown, or the function does not return a Scenario, or fails; says in which line.
        """
        scenario, values = self.made(options)
        if not isinstance(scenario, Scenario):
            raise ModelError(f"{self.path}: `scenario` must return a wirerope_mj.Scenario, got {quoted(scenario)}.")
        return replace(scenario, name=self.name, options=values, folder=self.path.parent)


def shipped_scenarios() -> dict[str, Path]:
    return {path.stem: path for path in sorted(scenarios_folder().glob("*.py"))}


def load_scenario(name_or_path: str | Path) -> ScenarioFile:
    """Return the scenario file at a path, or the shipped one of that name.

    Raises:
        ModelError: there is no such scenario, or the file has no function `scenario` with keyword options only.
    """
    return ScenarioFile.load(name_or_path, shipped_scenarios(), "scenario")
