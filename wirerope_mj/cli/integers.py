"""Options that are integers: 4.5 is refused, not truncated."""

from collections.abc import Sequence
from typing import Annotated, Any, get_origin

from cyclopts import Parameter, Token


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


Integer = Annotated[int, Parameter(converter=integers)]
"""Option that accepts an integer."""

Integers = Annotated[list[int], Parameter(consume_multiple=True, negative=(), converter=integers)]
"""Option that accepts one integer or several."""
