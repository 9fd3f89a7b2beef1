"""What the functions of this package are given, looked at before anything is computed."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, get_args

import numpy as np

from wirerope_mj.mounts.identification.residuals import Data, Residual
from wirerope_mj.mounts.identification.stages import Method
from wirerope_mj.mounts.laws import Law, Loop

CONSTRAINTS = ("beta>gamma", "beta=gamma", "beta<gamma")


def require_loops(loops: Any, name: str = "loops") -> None:
    """Raise ValueError unless `loops` is a sequence of loops, at least one."""
    if isinstance(loops, str | Path):
        raise ValueError(
            f"`{name}` must be loops, got the path {str(loops)!r}; read_cycles({str(loops)!r}) reads them."
        )
    if isinstance(loops, Loop):
        raise ValueError(f"`{name}` must be a sequence of loops, got a single one; put it into brackets.")
    if not isinstance(loops, Sequence):
        raise ValueError(f"`{name}` must be a sequence of loops, got {loops!r}.")
    if not loops:
        raise ValueError(f"`{name}` must hold at least one closed loop.")
    for place, loop in enumerate(loops):
        if not isinstance(loop, Loop):
            raise ValueError(f"`{name}` must hold loops, got {_short(loop)} at place {place}.")


def require_choice(name: str, value: Any, choices: Sequence[str]) -> None:
    """Raise ValueError unless `value` is one of the choices."""
    if value not in choices:
        raise ValueError(f"`{name}` must be one of {', '.join(map(repr, choices))}, got {value!r}.")


def require_options(
    *,
    method: Any,
    data: Any,
    constraint: Any,
    noise: Any,
    grid: bool,
    start: Any,
    fixed: Any,
    extra_residuals: Any,
) -> None:
    """Raise ValueError unless the options of `identify` are known and go together."""
    require_choice("method", method, get_args(Method))
    require_choice("data", data, get_args(Data))
    if constraint is not None:
        require_choice("constraint", constraint, CONSTRAINTS)
    if noise is not None and not (_is_number(noise) and noise > 0.0):
        raise ValueError(f"`noise` must be a finite number > 0, or None for what the fit leaves, got {noise!r}.")
    if start is None and not grid:
        raise ValueError("`grid` is False and there is no `start`: a search has nowhere to begin.")
    if method == "frequency" and (start is None or data != "loops"):
        raise ValueError(
            "`method='frequency'` needs a law to `start` at and `data='loops'`: places of the grid are searched by forces."
        )
    if not isinstance(fixed, Mapping):
        raise ValueError(f"`fixed` must be a mapping of names to values, got {fixed!r}.")
    for name, value in fixed.items():
        if not _is_number(value):
            raise ValueError(f"`fixed` must give finite numbers, got {value!r} for {name!r}.")
    if not isinstance(extra_residuals, Sequence) or not all(callable(one) for one in extra_residuals):
        raise ValueError(f"`extra_residuals` must be a sequence of functions of a law, got {extra_residuals!r}.")


def require_finite(extra_residuals: Sequence[Residual], law: Law) -> None:
    """Raise ValueError if one of the extra residuals is not finite for a law."""
    for place, residual in enumerate(extra_residuals):
        values = np.asarray(residual(law), dtype=np.float64)
        if not np.isfinite(values).all():
            raise ValueError(f"`extra_residuals[{place}]` gives numbers that are not finite, at the start {law!r}.")


def require_kind(law: Any, name: str = "law") -> None:
    """Raise ValueError unless `law` is a class of laws."""
    if not (isinstance(law, type) and issubclass(law, Law)):
        raise ValueError(f"`{name}` must be a class of laws such as BoucWen, got {_short(law)}.")


def _is_number(value: Any) -> bool:
    """Return whether a value is a finite number and no text or boolean."""
    return isinstance(value, int | float | np.number) and not isinstance(value, bool) and math.isfinite(float(value))


def _short(value: Any) -> str:
    """Return a value in a few words."""
    return (
        f"a {type(value).__name__}"
        if isinstance(value, Loop | Sequence) and not isinstance(value, str)
        else repr(value)
    )
