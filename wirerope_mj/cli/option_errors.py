"""Messages about options and arguments that the command line cannot read."""

from collections.abc import Sequence

from cyclopts.exceptions import CoercionError, CycloptsError, UnusedCliTokensError

_NUMBERS = {int: "an integer", float: "a number without a unit, with a decimal point"}


def option_message(error: CycloptsError, arguments: Sequence[str]) -> str:
    """Return what is wrong with the arguments of a command, and where it is said what it takes.

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
