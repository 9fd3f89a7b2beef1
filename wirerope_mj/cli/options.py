"""Options of commands: integers, accuracy and step, those of a scenario's or a study's function; exit codes and messages."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, get_args, get_origin, get_type_hints

from cyclopts import App, Parameter, Token
from cyclopts.exceptions import CoercionError, CycloptsError, UnusedCliTokensError

# Exit codes: an input is wrong; Ctrl-C, as shells count it; a replay gives other numbers.
BAD_INPUT, INTERRUPTED, DIFFERENT = 2, 130, 1
_NUMBERS = {int: "an integer", float: "a number without a unit, with a decimal point"}


def integers(hint: Any, tokens: Sequence[Token]) -> int | list[int]:
    """Return the integer or the integers of an option."""
    several = get_origin(hint) is list
    numbers = []
    for token in tokens:
        try:
            numbers.append(int(token.value))
        except ValueError:
            name = f"`{token.keyword}` " if several else ""  # the parser names options of one value itself
            raise ValueError(f"{name}must be an integer, got {token.value}.") from None
    return numbers if several else numbers[0]


Integer = Annotated[int, Parameter(converter=integers)]  # Option that accepts an integer
# Option that accepts one integer or several; and so numbers, and texts.
Integers = Annotated[list[int], Parameter(consume_multiple=True, negative=(), converter=integers)]
Numbers = Annotated[list[float] | None, Parameter(consume_multiple=True, negative=())]
Texts = Annotated[list[str] | None, Parameter(consume_multiple=True, negative=())]
Repeated = Annotated[list[str] | None, Parameter(negative=())]  # Text, once each time that the option is written
RepeatedPaths = Annotated[list[Path] | None, Parameter(negative=())]
Flag = Annotated[bool, Parameter(negative=())]  # Option that is there or not
Deck = Annotated[str | None, Parameter(help=(
    '"10 Hz 800 kg 4 %": a deck panel of that mass under all mounts, tuned alone to that frequency along z, with that '
    "damping ratio (2 % if none is said), in place of the rigid deck; or the folder of a flexible part."
))]  # fmt: skip


def own_option(name: str, kind: Any, default: Any, help_text: str, **parameter_options: Any) -> inspect.Parameter:
    """Return an option of the command itself: its name, type, default, and what --help says."""
    annotation = _integer(Annotated[kind, Parameter(help=help_text, **parameter_options)], kind)
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)


def _integer(annotation: Any, kind: Any) -> Any:
    """Return the annotation of an option; of an integer, one that refuses 2.5 instead of cutting it to 2."""
    return Annotated[annotation, Parameter(converter=integers)] if int in (kind, *get_args(kind)) else annotation


def file_command(
    takes: str, first: str, epilogue: str, own: Sequence[inspect.Parameter], lists: Callable[[], None] | None = None
) -> Callable[[Callable[[str, Sequence[str]], None]], App]:
    """Make a command of a function of a file's name and of all that stands behind it, unread: its options, the file says.

    The help of the command itself lists those that are there whatever the file is, `own`. `takes` is what the command takes,
    `first` says so where an option comes first, `lists` prints what ships for --list.
    """
    unread = Parameter(parse=False, show=True)
    listed = [option.replace(annotation=Annotated[option.annotation, unread]) for option in own]

    def made(function: Callable[[str, Sequence[str]], None]) -> App:
        name = function.__name__

        def command(*tokens: Annotated[str, Parameter(show=False, allow_leading_hyphen=True)]) -> int:
            if not tokens or tokens[0] in ("--help", "-h"):
                from wirerope_mj.cli.app import app

                app.help_print([name])
                return 0 if tokens else BAD_INPUT
            if tokens[0] == "--list" and lists is not None:
                lists()
            elif tokens[0].startswith("-"):
                raise ValueError(f"{first} {' '.join(tokens)}")
            else:
                function(tokens[0], tokens[1:])
            return 0

        signature = inspect.signature(command)
        command.__signature__ = signature.replace(  # type: ignore[attr-defined]
            parameters=[*signature.parameters.values(), *listed]
        )
        command.__annotations__ |= {option.name: option.annotation for option in listed}
        command.__doc__ = function.__doc__
        usage = f"Usage: wirerope {name} {takes} [OPTIONS]"
        made_app = App(
            name=name, usage=usage, help_epilogue=epilogue, help_flags=[], version_flags=[], suppress_keyboard_interrupt=False
        )  # fmt: skip
        made_app.default(command)
        return made_app

    return made


def run_with_options(
    title: str,
    function: Callable[..., Any],
    own: Sequence[inspect.Parameter],
    action: Callable[[dict[str, Any], dict[str, Any]], None],
    tokens: Sequence[str],
) -> None:
    """Read `tokens` as options of a file's `function`, whose docstring says them, and of the command, and act on both."""

    def command(**options: Any) -> None:
        values = {option.name: options.pop(option.name, option.default) for option in own}
        action(options, values)

    hints = get_type_hints(function)
    declared = inspect.signature(function).parameters.values()
    kinds = {option.name: hints.get(option.name, type(option.default)) for option in declared}
    options = [option.replace(annotation=_integer(kinds[option.name], kinds[option.name])) for option in declared]
    command.__signature__ = inspect.Signature([*options, *own])  # type: ignore[attr-defined]
    command.__annotations__ = {option.name: option.annotation for option in [*options, *own]}
    command.__doc__ = function.__doc__
    app = App(name=title, version_flags=[], suppress_keyboard_interrupt=False)
    app.default(command)
    app(list(tokens), exit_on_error=False, print_error=False, result_action="return_value")


NUMERICS = (
    own_option(
        "accuracy", float | None, None,
        "error allowed, as a fraction of the peaks; the step is chosen for it: 1e-4 by default",
    ),
    own_option(
        "timestep", float | None, None, "largest step [s], in place of one that is chosen; no error is estimated then"
    ),
)  # fmt: skip


def with_numerics(simulate: Mapping[str, Any], *, accuracy: float | None, timestep: float | None) -> dict[str, Any]:
    """Return arguments of `simulate` with the accuracy or the step that was asked for in place of their own.

    ValueError if both are given, or one is out of range.
    """
    if accuracy is not None and timestep is not None:
        raise ValueError(
            "`--accuracy` and `--timestep` exclude each other: a step is either chosen for an accuracy or given. Give one."
        )
    if accuracy is not None and not 0.0 < accuracy < 1.0:
        raise ValueError(f"`--accuracy` is a fraction of the peaks, above 0 and below 1, got {accuracy:g}.")
    if timestep is not None:
        from wirerope_mj.foundation.arguments import positive

        positive("--timestep", timestep, unit="s")
    given = {name: value for name, value in (("accuracy", accuracy), ("timestep", timestep)) if value is not None}
    kept = {name: value for name, value in simulate.items() if not given or name not in ("accuracy", "timestep")}
    return kept | given


def option_message(error: CycloptsError, arguments: Sequence[str]) -> str:
    """Word an error of the parser: what is wrong with the arguments of a command, and the help that says what it takes."""
    return f"{_fault(error)} `{_command(arguments)} --help` says what there is."


def _fault(error: CycloptsError) -> str:
    if isinstance(error, CoercionError) and error.token is not None and error.target_type in _NUMBERS:
        name = error.token.keyword or (error.argument.name if error.argument is not None else "the argument")
        return f"`{name}` must be {_NUMBERS[error.target_type]}, got {error.token.value!r}."
    if isinstance(error, UnusedCliTokensError):
        left = ", ".join(map(repr, error.unused_tokens or []))
        return (
            f"{left} belongs to no option or argument: a text with spaces needs quotes, and most options "
            "are written again before each further value, as `--limit A --limit B`."
        )
    return str(error)


def _command(arguments: Sequence[str]) -> str:
    """Return the command as it is called, with the scenario or study whose options are meant."""
    parts = ["wirerope", *arguments[:1]]
    if list(arguments[:1]) in (["run"], ["study"]) or list(arguments[:2]) == ["isolators", "fit"]:
        parts += arguments[1:2]
    return " ".join(part for part in parts if not part.startswith("-"))
