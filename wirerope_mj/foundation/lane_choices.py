"""Choices between lanes, and their entries in memory: functions that take numbers or lanes.

See `wirerope_mj.foundation.lanes`.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload
from numba.np.arrayobj import make_array

from wirerope_mj.foundation.lane_types import INDEX, INLINED, LANES, LONG, MASK, ROWS, VECTOR, WIDTH, TableType, spread_out


@intrinsic
def _rows(typingctx: Any, array: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return make_array(sig.args[0])(context, builder, args[0]).data

    return ROWS(array), build


@intrinsic
def _table(typingctx: Any, array: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return make_array(sig.args[0])(context, builder, args[0]).data

    return TableType(array.dtype)(array), build


@intrinsic
def _spread(typingctx: Any, value: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return spread_out(context, builder, types.float64, LANES, args[0])

    return LANES(types.float64), build


@intrinsic
def _chosen(typingctx: Any, mask: Any, one: Any, other: Any) -> Any:
    return LANES(MASK, LANES, LANES), lambda context, builder, sig, args: builder.select(*args)


@intrinsic
def _any(typingctx: Any, mask: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        bits = builder.bitcast(args[0], ir.IntType(WIDTH))
        return builder.icmp_unsigned("!=", bits, ir.Constant(ir.IntType(WIDTH), 0))

    return types.boolean(MASK), build


@intrinsic
def _one(typingctx: Any, value: Any, number: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.extract_element(args[0], builder.trunc(args[1], INDEX))

    return types.float64(LANES, types.intp), build


@intrinsic
def _with_one(typingctx: Any, value: Any, number: Any, one: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.insert_element(args[0], args[2], builder.trunc(args[1], INDEX))

    return LANES(LANES, types.intp, types.float64), build


def rows(array: Any) -> Any:
    """Return an array (..., WIDTH), contiguous, as an array of lanes; the array must outlive what is returned."""
    return array.reshape(-1, WIDTH)


@overload(rows, jit_options=INLINED)
def _overload_rows(array):  # type: ignore[no-untyped-def]
    return lambda array: _rows(array)


def table(array: Any) -> Any:
    """Return a contiguous array of int64 or float64 that is only read, at indices >= 0; it must outlive what is returned."""
    return array


@overload(table, jit_options=INLINED)
def _overload_table(array):  # type: ignore[no-untyped-def]
    return lambda array: _table(array)


def spread(value: float) -> Any:
    """Return lanes that all hold one number."""
    return np.full(WIDTH, value)


@overload(spread, jit_options=INLINED)
def _overload_spread(value):  # type: ignore[no-untyped-def]
    return lambda value: _spread(value)


def lane(value: Any, number: int) -> Any:
    """Return one of the lanes; of a scalar that scalar."""
    return value[number] if isinstance(value, np.ndarray) else value


@overload(lane, jit_options=INLINED)
def _overload_lane(value, number):  # type: ignore[no-untyped-def]
    if value == LANES:
        return lambda value, number: _one(value, number)
    return lambda value, number: value


def with_lane(value: Any, number: int, one: float) -> Any:
    """Return lanes with another number in one of them."""
    changed = value.copy()
    changed[number] = one
    return changed


@overload(with_lane, jit_options=INLINED)
def _overload_with_lane(value, number, one):  # type: ignore[no-untyped-def]
    return lambda value, number, one: _with_one(value, number, one)


def where(condition: Any, one: Any, other: Any) -> Any:
    """Return `one` where a condition holds and `other` elsewhere; both are computed."""
    if isinstance(condition, np.ndarray):
        return np.where(condition, one, other)
    return one if condition else other


@overload(where, jit_options=INLINED)
def _overload_where(condition, one, other):  # type: ignore[no-untyped-def]
    if condition == MASK:
        return lambda condition, one, other: _chosen(condition, one, other)
    return lambda condition, one, other: one if condition else other


def some(condition: Any) -> Any:
    """Return whether a condition holds in any lane."""
    return bool(np.any(condition))


@overload(some, jit_options=INLINED)
def _overload_some(condition):  # type: ignore[no-untyped-def]
    if condition == MASK:
        return lambda condition: _any(condition)
    return lambda condition: condition


def count(p: Any, i: int) -> int:
    """Return an integer among parameters; all lanes have the same."""
    return int(p[i][0] if isinstance(p[i], np.ndarray) else p[i])


@overload(count, jit_options=INLINED)
def _overload_count(p, i):  # type: ignore[no-untyped-def]
    if p == ROWS:
        return lambda p, i: int(_one(p[i], 0))
    return lambda p, i: int(p[i])


@intrinsic
def _gathered(typingctx: Any, p: Any, i: Any, offset: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        pointer, first, offsets = args
        offsets = builder.fptosi(offsets, ir.VectorType(INDEX, WIDTH))
        result = ir.Constant(VECTOR, ir.Undefined)
        for number in range(WIDTH):
            at = ir.Constant(INDEX, number)
            row = builder.add(first, builder.sext(builder.extract_element(offsets, at), LONG))
            address = builder.add(builder.mul(row, ir.Constant(LONG, WIDTH)), ir.Constant(LONG, number))
            result = builder.insert_element(result, builder.load(builder.gep(pointer, [address])), at)
        return result

    return LANES(ROWS, types.intp, LANES), build


def picked(p: Any, i: int, offset: Any) -> Any:
    """Return p[i + offset], the offset a whole number that lanes may differ in."""
    if isinstance(offset, np.ndarray):
        return np.array([p[i + int(one), number] for number, one in enumerate(offset)])
    return p[i + offset]


@overload(picked, jit_options=INLINED)
def _overload_picked(p, i, offset):  # type: ignore[no-untyped-def]
    if p == ROWS:
        return lambda p, i, offset: _gathered(p, i, offset)
    return lambda p, i, offset: p[i + offset]


def ranked(p: Any, i: int, n: int, x: Any) -> Any:
    """Return how many of the n numbers from p[i] on, which ascend, are at or below x."""
    if isinstance(x, np.ndarray):
        return np.sum(p[i : i + n] <= x, axis=0).astype(np.float64)
    return int(np.searchsorted(p[i : i + n], x, side="right"))


@overload(ranked, jit_options=INLINED)
def _overload_ranked(p, i, n, x):  # type: ignore[no-untyped-def]
    if p == ROWS:

        def total(p, i, n, x):  # type: ignore[no-untyped-def]
            rank = 0.0
            for entry in range(n):
                rank += where(p[i + entry] <= x, 1.0, 0.0)
            return rank

        return total

    def search(p, i, n, x):  # type: ignore[no-untyped-def]
        low, high = 0, n
        while low < high:
            middle = (low + high) // 2
            if p[i + middle] <= x:
                low = middle + 1
            else:
                high = middle
        return low

    return search
