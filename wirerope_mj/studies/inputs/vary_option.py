"""Quantities that vary, from lines of text: "mount/m*/axial/alpha = Normal(1, 0.1, relative, each)"."""

import ast
import inspect
from collections.abc import Sequence
from typing import Any, get_args

from wirerope_mj.studies.inputs.distributions import Distribution

EXAMPLE = "mount/m*/axial/alpha = Normal(1, 0.1, relative, each)"
_GROUP = "group"  # The argument of every distribution that is a string
_KINDS: dict[str, Any] = {kind.__name__: kind for kind in get_args(Distribution)}


def read_vary(texts: Sequence[str]) -> dict[str, Distribution]:
    """Return distributions by the names of quantities, from texts "NAME = Normal(1, 0.1, relative)".

    A distribution is written as in Python, with numbers, strings in quotes, True and False; nothing is evaluated. A flag such
    as `relative` may stand for `relative=True`, and a group without quotes: `group=ropes`.

    Raises:
        ValueError: a text is not of this form, or the distribution cannot be; says what there is.
    """
    distributions: dict[str, Distribution] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise ValueError(f'what varies must be written like "{EXAMPLE}", got {text!r}.')
        if name in distributions:
            raise ValueError(f"{name!r} is said twice; a quantity has one distribution.")
        distributions[name] = _distribution(name, value)
    return distributions


def signatures() -> list[str]:
    """Return how each distribution is written."""
    return [_signature(kind) for kind in _KINDS]


def _distribution(name: str, text: str) -> Distribution:
    try:
        call = ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError):
        raise ValueError(f"{name!r}: {text!r} cannot be read; write it like {EXAMPLE.partition('= ')[2]}.") from None
    function = call.func if isinstance(call, ast.Call) else call
    kind = function.id if isinstance(function, ast.Name) else ""
    if kind not in _KINDS:
        raise ValueError(f"{name!r}: {text!r} is no distribution; there are {', '.join(signatures())}.")
    positional: list[Any] = []
    named: dict[str, Any] = {}
    if isinstance(call, ast.Call):
        for one in call.args:
            if any(isinstance(part, ast.Name) and part.id in ("nan", "inf") for part in ast.walk(one)):
                raise ValueError(f"{name!r}: numbers must be finite, got {ast.unparse(one)}.")
            if isinstance(one, ast.Name):
                named[_flag(name, kind, one.id)] = True
            else:
                positional.append(_value(name, one))
        named |= {one.arg or "**": _keyword(name, one) for one in call.keywords}
    return _made(name, kind, positional, named)


def _made(name: str, kind: str, positional: Sequence[Any], named: dict[str, Any]) -> Distribution:
    for flag in _flags(kind):
        if not isinstance(named.get(flag, False), bool):
            raise ValueError(f"{name!r}: `{flag}` must be True or False, got {named[flag]!r}.")
    try:
        inspect.signature(_KINDS[kind]).bind(*positional, **named)
    except TypeError as error:
        fault = str(error).replace("positional arguments", "values").replace("an unexpected keyword", "an unknown")
        raise ValueError(f"{name!r}: {fault}; it is written {_signature(kind)}.") from None
    try:
        distribution: Distribution = _KINDS[kind](*positional, **named)
    except ValueError as error:
        raise ValueError(f"{name!r}: {error}") from None
    return distribution


def _flag(name: str, kind: str, flag: str) -> str:
    flags = _flags(kind)
    if flag not in flags:
        there = " and ".join(flags) or "none"
        raise ValueError(
            f"{name!r}: {kind} has no flag {flag!r}; it has {there}. A string as a value stands in quotes."
        )
    return flag


def _flags(kind: str) -> list[str]:
    """Return the arguments that are true or false."""
    parameters = inspect.signature(_KINDS[kind]).parameters
    return [name for name, parameter in parameters.items() if isinstance(parameter.default, bool)]


def _keyword(name: str, keyword: ast.keyword) -> Any:
    """Return the value of a keyword argument; a group may stand without quotes, since it is always a string."""
    if keyword.arg == _GROUP and isinstance(keyword.value, ast.Name):
        return keyword.value.id
    return _value(name, keyword.value)


def _value(name: str, node: ast.expr) -> Any:
    try:
        return ast.literal_eval(node)
    except ValueError:
        raise ValueError(
            f"{name!r}: {ast.unparse(node)!r} must be a number, a string in quotes, True, False or a list of them."
        ) from None


def _signature(kind: str) -> str:
    """Return how a distribution is written: `Normal(mean, deviation, relative, each, low=, high=)`."""
    flags, parts = _flags(kind), []
    for name, parameter in inspect.signature(_KINDS[kind]).parameters.items():
        if parameter.kind is parameter.VAR_POSITIONAL:
            parts.append("value, value, ...")
        elif name in flags or parameter.default is parameter.empty:
            parts.append(name)
        else:
            parts.append(f"{name}=")
    return f"{kind}({', '.join(parts)})"
