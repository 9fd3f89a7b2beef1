"""Options of commands: integers, accuracy and step, those of a scenario's or a study's function; exit codes and messages."""

import inspect
from collections.abc import Callable, Mapping, Sequence
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
# Option that accepts one integer or several.
Integers = Annotated[list[int], Parameter(consume_multiple=True, negative=(), converter=integers)]


def own_option(name: str, kind: Any, default: Any, help_text: str, **parameter_options: Any) -> inspect.Parameter:
    """Return an option of the command itself: its name, type, default, and what --help says."""
    annotation = Annotated[kind, Parameter(help=help_text, **parameter_options)]
    return inspect.Parameter(
        name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=_integer(annotation, kind)
    )


def _integer(annotation: Any, kind: Any) -> Any:
    """Return the annotation of an option; of an integer, one that refuses 2.5 instead of cutting it to 2."""
    if int in (kind, *get_args(kind)):
        return Annotated[annotation, Parameter(converter=integers)]
    return annotation


def listing_options(own: Sequence[inspect.Parameter]) -> Callable[[Callable[..., int]], Callable[..., int]]:
    """Return a decorator for a command that takes its arguments unread, so that its help lists the options `own`.

    Which other options there are says a file that is named on the command line; these are there whatever it is.
    """
    unread = Parameter(parse=False, show=True)
    listed = [option.replace(annotation=Annotated[option.annotation, unread]) for option in own]

    def decorated(function: Callable[..., int]) -> Callable[..., int]:
        signature = inspect.signature(function)
        parameters = [*signature.parameters.values(), *listed]
        function.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
        function.__annotations__ |= {option.name: option.annotation for option in listed}
        return function

    return decorated


def run_with_options(
    title: str,
    function: Callable[..., Any],
    own: Sequence[inspect.Parameter],
    action: Callable[[dict[str, Any], dict[str, Any]], None],
    tokens: Sequence[str],
) -> None:
    """Read `tokens` as options of `function` and of the command, and act on them.

    Args:
        title: of the command, for --help.
        function: of the file; its docstring says what its options are.
        own: options of the command itself, of other names.
        action: is given the values of the function's options and of the command's own.
        tokens: after the file's name on the command line.
    """

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


DECK = '"10 Hz 800 kg 4 %": a deck panel of that mass, frequency alone and damping ratio, in place of the rigid deck'
ACCURACY = "error allowed, as a fraction of the peaks; the step is chosen for it: 1e-4 by default"
TIMESTEP = "largest step [s], in place of one that is chosen; no error is estimated then"
NUMERICS = (
    own_option("accuracy", float | None, None, ACCURACY),
    own_option("timestep", float | None, None, TIMESTEP),
)


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
    """Word an error of the parser: what is wrong with the arguments, and the help that says what the command takes.

    Args:
        error: of the parser.
        arguments: the command and what stands behind it.
    """
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
