"""Options that are whole numbers: 4.5 is refused, not cut to 4."""

from collections.abc import Sequence
from typing import Annotated, Any, get_origin

from cyclopts import Parameter, Token


def whole_numbers(hint: Any, tokens: Sequence[Token]) -> int | list[int]:
    """Return the whole number or numbers of an option."""
    several = get_origin(hint) is list
    found = []
    for token in tokens:
        try:
            found.append(int(token.value))
        except ValueError:
            name = f"`{token.keyword}` " if several else ""  # the parser names options of one value itself
            raise ValueError(f"{name}must be a whole number, got {token.value}.") from None
    return found if several else found[0]


Whole = Annotated[int, Parameter(converter=whole_numbers)]
"""A whole number."""

WholeNumbers = Annotated[list[int], Parameter(consume_multiple=True, negative=(), converter=whole_numbers)]
"""One or several of them."""
