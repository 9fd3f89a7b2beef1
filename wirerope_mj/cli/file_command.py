"""Commands that take a Python file or a folder, whose own options are those of the command, too."""

import inspect
from collections.abc import Callable, Sequence
from typing import Annotated, Any, get_type_hints

from cyclopts import App, Parameter

from wirerope_mj.cli.options import BAD_INPUT, whole_integers


def file_command(
    takes: str, first: str, epilogue: str, own: Sequence[inspect.Parameter], lists: Callable[[], None] | None = None
) -> Callable[[Callable[[str, Sequence[str]], None]], App]:
    """Make a command whose function gets the name of a file and unparsed what is behind it, options that the file defines.

    The help of the command itself lists `own`, the options that do not depend on the file. `takes` names the file in the usage
    line, `first` begins the error if an option stands in its place, `lists` prints what ships, for --list.
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
        )
        made_app.default(command)
        return made_app

    return made


def run_with_options(
    title: str, function: Callable[..., object], own: Sequence[inspect.Parameter],
    action: Callable[[dict[str, Any], dict[str, Any]], None], tokens: Sequence[str],
) -> None:  # fmt: skip
    """Parse `tokens` into options of a file's `function`, whose docstring is the help, and `own` ones; `action` gets both."""

    def command(**options: object) -> None:
        values = {option.name: options.pop(option.name, option.default) for option in own}
        action(options, values)

    hints = get_type_hints(function)
    declared = inspect.signature(function).parameters.values()
    kinds = {option.name: hints.get(option.name, type(option.default)) for option in declared}
    options = [option.replace(annotation=whole_integers(kinds[option.name], kinds[option.name])) for option in declared]
    command.__signature__ = inspect.Signature([*options, *own])  # type: ignore[attr-defined]
    command.__annotations__ = {option.name: option.annotation for option in [*options, *own]}
    command.__doc__ = function.__doc__
    app = App(name=title, version_flags=[], suppress_keyboard_interrupt=False)
    app.default(command)
    app(list(tokens), exit_on_error=False, print_error=False, result_action="return_value")
