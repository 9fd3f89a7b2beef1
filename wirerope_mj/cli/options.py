"""Options that several commands take: integers, lists, decks, accuracy and step; exit codes, and the words for wrong ones."""

import inspect
from collections.abc import Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any, get_args, get_origin

from cyclopts import Parameter, Token
from cyclopts.exceptions import CoercionError, CycloptsError, UnusedCliTokensError

# Exit codes: an input is wrong; a replay gives other numbers.
BAD_INPUT, DIFFERENT = 2, 1
_NUMBERS = {int: "an integer", float: "a number without a unit, with a decimal point"}


def integers(hint: object, tokens: Sequence[Token]) -> int | list[int]:
    """Convert the texts of an option into an integer, or a list of them; ValueError for other texts."""
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
Force = Annotated[bool, Parameter(negative=(), help="replace what is there.")]
_ALL = "print every table, too; the files hold them in any case."
All = Annotated[bool, Parameter(name="--all", negative=(), help=_ALL)]
Model = Annotated[str, Parameter(help="path of an MJCF file with mounts, or the name of one that ships with the package.")]
Deck = Annotated[str | None, Parameter(help=(
    '"10 Hz 800 kg 4 %": a deck panel of that mass under all mounts, tuned alone to that frequency along z, with that '
    "damping ratio (2 % if none is said), in place of the rigid deck; or the folder of a flexible part."
))]  # fmt: skip

_ON_DECKS = "have the report say how the peaks move on decks of 8 to 25 Hz, which takes four more simulations."
Decks = Annotated[bool, Parameter(negative=(), help=_ON_DECKS)]


def own_option(name: str, kind: object, default: object, help_text: str, **parameter_options: Any) -> inspect.Parameter:
    """Make an option of the command itself from its name, type, default, and its text in --help."""
    annotation = whole_integers(Annotated[kind, Parameter(help=help_text, **parameter_options)], kind)
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)


def whole_integers(annotation: object, kind: object) -> object:
    """Make the annotation of an integer option refuse 2.5 instead of cutting it to 2; leave other annotations alone."""
    return Annotated[annotation, Parameter(converter=integers)] if int in (kind, *get_args(kind)) else annotation


NUMERICS = (
    own_option(
        "accuracy", float | None, None,
        "error allowed, as a fraction of the peaks; the step is chosen for it: 1e-4 by default",
    ),
    own_option(
        "timestep", float | None, None, "largest step [s], in place of one that is chosen; no error is estimated then"
    ),
)  # fmt: skip
ALL = own_option("all", bool, False, _ALL, negative=())
DECKS = own_option("decks", bool, False, _ON_DECKS, negative=())


def with_numerics(simulate: Mapping[str, Any], *, accuracy: float | None, timestep: float | None) -> dict[str, Any]:
    """Replace accuracy and time step among arguments of `simulate` by the one that was given, if any.

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


def dated(name: str) -> Path:
    """Name the folder of a result without `--out`: runs/NAME-DATE-TIME."""
    return Path("runs") / f"{name}-{datetime.now():%Y%m%d-%H%M%S}"


def option_message(error: CycloptsError, arguments: Sequence[str]) -> str:
    """Word an error of the parser: what is wrong with the arguments of a command, and the help that says what it takes."""
    fault, command = str(error), ["wirerope", *arguments[:1]]
    if isinstance(error, CoercionError) and error.token is not None and error.target_type in _NUMBERS:
        name = error.token.keyword or (error.argument.name if error.argument is not None else "the argument")
        fault = f"`{name}` must be {_NUMBERS[error.target_type]}, got {error.token.value!r}."
    elif isinstance(error, UnusedCliTokensError):
        left = ", ".join(map(repr, error.unused_tokens or []))
        fault = (
            f"{left} belongs to no option or argument: a text with spaces needs quotes, and most options "
            'are written again before each further value, as `--limit A --limit B`; motions may be listed in one text, "A; B".'
        )
    if list(arguments[:1]) in (["run"], ["study"]) or list(arguments[:2]) == ["isolators", "fit"]:
        command += arguments[1:2]  # the scenario or study whose options are meant
    called = " ".join(part for part in command if not part.startswith("-"))
    return f"{fault} `{called} --help` says what there is."
