"""Command-line options made from the signature of a scenario's or a study's function."""

import inspect
from collections.abc import Callable, Sequence
from typing import Annotated, Any, get_args, get_type_hints

from cyclopts import App, Parameter

from wirerope_mj.cli.integers import integers


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
