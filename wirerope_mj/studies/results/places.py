"""Where a measure is beyond its limit, in words, for studies in which little varies."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa

from wirerope_mj.foundation.arrays import Array

_NAMED = 8  # choices that are named
_FEW = 2  # inputs that are told of the largest value


def beyond_words(table: pa.Table, inputs: Sequence[str], values: Array, limit: float) -> str:
    """Return for which values of the only input a limit is exceeded; "" if none is, or several inputs vary.

    Of a number where the limit is first crossed, interpolated between two variants; of words which ones.

    Args:
        table: of a study.
        inputs: what was sampled in it.
        values: of a measure, (n,).
        limit: of the measure.
    """
    beyond = values > limit
    if len(inputs) != 1 or not beyond.any():
        return ""
    (name,) = inputs
    kind = table.schema.field(name).type
    if pa.types.is_floating(kind):
        return _crossing(name, np.asarray(table[name], dtype=np.float64), values, limit)
    words = [_word(value) for value, is_beyond in zip(table[name].to_pylist(), beyond, strict=True) if is_beyond]
    rest = len(words) - _NAMED
    return f" ({name}: {', '.join(words[:_NAMED])}{f' and {rest} more' if rest > 0 else ''})"


def inputs_words(row: dict[str, Any], inputs: Sequence[str]) -> str:
    """Return the inputs of a variant; "" if there are more than two."""
    if not 1 <= len(inputs) <= _FEW:
        return ""
    return f" ({', '.join(f'{name} {_word(row[name])}' for name in inputs)})"


def _crossing(name: str, x: Array, values: Array, limit: float) -> str:
    known = np.isfinite(values)
    x, values = x[known], values[known]
    order = np.argsort(x, kind="stable")
    x, values = x[order], values[order]
    first = int(np.argmax(values > limit))
    if first == 0:
        return f", already at {name} {x[0]:.4g}"
    share = (limit - values[first - 1]) / (values[first] - values[first - 1])
    at = x[first - 1] + share * (x[first] - x[first - 1])
    return f", first at {name} {at:.3g} (interpolated between {x[first - 1]:.4g} and {x[first]:.4g})"


def _word(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value) or "none"
