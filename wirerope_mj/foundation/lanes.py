"""Numbers side by side: one source for one system and for eight, each in a lane of the processor's vector registers.

A `Lanes` value is a vector of `WIDTH` floats that Numba lowers to LLVM's `<8 x double>`; `Rows` is an array of them in memory,
made by `rows` from an array of the shape (n, WIDTH). Jitted functions use both as they would use a float and an array of
floats, so that one source serves scalars and lanes. Branches are what differs: a comparison of lanes gives a mask, and
`where` chooses with it. With JIT disabled lanes are NumPy's rows, and the same sources are the plain reference.

Every lane is computed by the same instructions whatever stands in the others, so that a system has the same bits alone, padded
by copies of itself, and in any company.
"""

import math
import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core.imputils import lower_builtin, lower_cast
from numba.core.typeconv import Conversion
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, models, overload, register_model
from numba.np.arrayobj import make_array

from wirerope_mj.foundation.jit import inlined

WIDTH = 8
"""Lanes of a vector: one register of AVX-512, two of AVX2. Fixed, because results must not depend on the machine's choice."""

_DOUBLE, _LONG, _INDEX = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
_VECTOR, _LONGS = ir.VectorType(_DOUBLE, WIDTH), ir.VectorType(_LONG, WIDTH)
_INLINED = {"forceinline": True, "error_model": "numpy"}
_CONTRACT = ("contract",)
"""Products may be fused with the sums that they are part of; nothing else may be reordered."""


class LanesType(types.Type):
    """Numba's type of a vector; a float becomes one with that float in every lane."""

    def __init__(self) -> None:
        super().__init__(name=f"Lanes{WIDTH}")

    def can_convert_from(self, typingctx: Any, other: types.Type) -> Any:
        """Take numbers, as a float variable takes integers."""
        return Conversion.safe if isinstance(other, types.Float | types.Integer) else None

    def unify(self, typingctx: Any, other: types.Type) -> Any:
        """Make a variable that is a number here and lanes there one of lanes."""
        return self if isinstance(other, types.Float | types.Integer) else None


class MaskType(types.Type):
    """Numba's type of a comparison of lanes."""

    def __init__(self) -> None:
        super().__init__(name=f"Mask{WIDTH}")


class RowsType(types.Type):
    """Numba's type of an array of lanes: its address, so that the array must outlive it."""

    def __init__(self) -> None:
        super().__init__(name=f"Rows{WIDTH}")


LANES, MASK, ROWS = LanesType(), MaskType(), RowsType()


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _VECTOR)


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, ir.VectorType(ir.IntType(1), WIDTH))


@register_model(RowsType)
class _RowsModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _DOUBLE.as_pointer())


def _constant(value: float) -> ir.Constant:
    return ir.Constant(_VECTOR, [value] * WIDTH)


@lower_cast(types.Float, LanesType)
@lower_cast(types.Integer, LanesType)
def _spread(context: Any, builder: Any, source: Any, target: Any, value: Any) -> Any:
    number = context.cast(builder, value, source, types.float64)
    one = builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), number, ir.Constant(_INDEX, 0))
    zeros = ir.Constant(ir.VectorType(_INDEX, WIDTH), [0] * WIDTH)
    return builder.shuffle_vector(one, ir.Constant(_VECTOR, ir.Undefined), zeros)


def _number(kind: Any) -> bool:
    return isinstance(kind, types.Float | types.Integer | LanesType)


def _operator(function: Any, result: Any, build: Callable[[Any, Any, Any], Any]) -> None:
    """Let an operator take lanes on one of its sides at least."""

    class Template(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            if len(args) == 2 and LANES in args and all(_number(kind) for kind in args):
                return signature(result, LANES, LANES)
            return None

    infer_global(function)(Template)

    @lower_builtin(function, LanesType, LanesType)
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return build(builder, *args)


def _arithmetic(name: str) -> Callable[[Any, Any, Any], Any]:
    return lambda builder, x, y: getattr(builder, name)(x, y, flags=_CONTRACT)


def _comparison(sign: str) -> Callable[[Any, Any, Any], Any]:
    return lambda builder, x, y: builder.fcmp_ordered(sign, x, y)


for _function, _instruction in {
    operator.add: "fadd", operator.sub: "fsub", operator.mul: "fmul", operator.truediv: "fdiv",
    operator.iadd: "fadd", operator.isub: "fsub", operator.imul: "fmul", operator.itruediv: "fdiv",
}.items():  # fmt: skip
    _operator(_function, LANES, _arithmetic(_instruction))
for _function, _sign in {
    operator.lt: "<", operator.le: "<=", operator.gt: ">", operator.ge: ">=", operator.eq: "==",
}.items():  # fmt: skip
    _operator(_function, MASK, _comparison(_sign))
_operator(operator.ne, MASK, lambda b, x, y: b.fcmp_unordered("!=", x, y))
# As Python's: the second only where it is beyond the first.
_operator(min, LANES, lambda b, x, y: b.select(b.fcmp_ordered("<", y, x), y, x))
_operator(max, LANES, lambda b, x, y: b.select(b.fcmp_ordered(">", y, x), y, x))


def _mask_operator(function: Any, instruction: str) -> None:
    class Template(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            return signature(MASK, MASK, MASK) if tuple(args) == (MASK, MASK) else None

    infer_global(function)(Template)

    @lower_builtin(function, MaskType, MaskType)
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return getattr(builder, instruction)(*args)


_mask_operator(operator.and_, "and_")
_mask_operator(operator.or_, "or_")


def _unary(function: Any, build: Callable[[Any, Any], Any]) -> None:
    class Template(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            return signature(LANES, LANES) if tuple(args) == (LANES,) else None

    infer_global(function)(Template)

    @lower_builtin(function, LanesType)
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return build(builder, args[0])


def _call(name: str) -> Callable[[Any, Any], Any]:
    def build(builder: Any, value: Any) -> Any:
        full = f"llvm.{name}.v{WIDTH}f64"
        known = builder.module.globals.get(full)
        return builder.call(known or ir.Function(builder.module, ir.FunctionType(_VECTOR, [_VECTOR]), full), [value])

    return build


_unary(operator.neg, lambda b, x: b.fneg(x))
_unary(abs, _call("fabs"))
_unary(math.sqrt, _call("sqrt"))
_unary(math.floor, _call("floor"))


class _GetItem(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        ok = len(args) == 2 and args[0] == ROWS and isinstance(args[1], types.Integer)
        return signature(LANES, ROWS, types.intp) if ok else None


class _SetItem(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        ok = len(args) == 3 and args[0] == ROWS and isinstance(args[1], types.Integer) and _number(args[2])
        return signature(types.none, ROWS, types.intp, LANES) if ok else None


infer_global(operator.getitem)(_GetItem)
infer_global(operator.setitem)(_SetItem)


def _address(builder: Any, pointer: Any, index: Any) -> Any:
    first = builder.mul(index, ir.Constant(_LONG, WIDTH))
    return builder.bitcast(builder.gep(pointer, [first]), _VECTOR.as_pointer())


@lower_builtin(operator.getitem, RowsType, types.Integer)
def _load(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.load(_address(builder, *args), align=8)


@lower_builtin(operator.setitem, RowsType, types.Integer, LanesType)
def _store(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    builder.store(args[2], _address(builder, args[0], args[1]), align=8)
    return context.get_dummy_value()


@intrinsic
def _rows(typingctx: Any, array: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return make_array(sig.args[0])(context, builder, args[0]).data

    return ROWS(array), build


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
def _bits(typingctx: Any, value: Any) -> Any:
    """Return the vector's bits as integers in a vector of floats' clothes: 2^k by its exponent, k a whole float."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        magic = builder.fadd(args[0], _constant(6755399441055744.0))  # 1.5 * 2^52: the low bits hold k
        exponent = builder.add(builder.bitcast(magic, _LONGS), ir.Constant(_LONGS, [1023] * WIDTH))
        return builder.bitcast(builder.shl(exponent, ir.Constant(_LONGS, [52] * WIDTH)), _VECTOR)

    return LANES(LANES), build


@intrinsic
def _split(typingctx: Any, value: Any) -> Any:
    """Return exponent k and fraction f of positive normal numbers, 2^k f with 1 <= f < 2."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        bits = builder.bitcast(args[0], _LONGS)
        shifted = builder.lshr(bits, ir.Constant(_LONGS, [52] * WIDTH))
        # As in `_bits`, the other way round: an integer below 2^51 in the low bits of 2^52.
        magic = builder.bitcast(builder.or_(shifted, ir.Constant(_LONGS, [0x4330000000000000] * WIDTH)), _VECTOR)
        exponent = builder.fsub(magic, _constant(4503599627370496.0 + 1023.0))
        fraction = builder.and_(bits, ir.Constant(_LONGS, [0x000FFFFFFFFFFFFF] * WIDTH))
        fraction = builder.or_(fraction, ir.Constant(_LONGS, [0x3FF0000000000000] * WIDTH))
        return context.make_tuple(builder, sig.return_type, (exponent, builder.bitcast(fraction, _VECTOR)))

    return types.UniTuple(LANES, 2)(LANES), build


@intrinsic
def _one(typingctx: Any, value: Any, number: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.extract_element(args[0], builder.trunc(args[1], _INDEX))

    return types.float64(LANES, types.intp), build


@intrinsic
def _with_one(typingctx: Any, value: Any, number: Any, one: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.insert_element(args[0], args[2], builder.trunc(args[1], _INDEX))

    return LANES(LANES, types.intp, types.float64), build


def rows(array: Any) -> Any:
    """Return an array (..., WIDTH), contiguous, as an array of lanes; the array must outlive what is returned."""
    return array.reshape(-1, WIDTH)


@overload(rows, jit_options=_INLINED)
def _overload_rows(array):  # type: ignore[no-untyped-def]
    return lambda array: _rows(array)


def lane(value: Any, number: int) -> Any:
    """Return one of the lanes; of a scalar that scalar."""
    return value[number] if isinstance(value, np.ndarray) else value


@overload(lane, jit_options=_INLINED)
def _overload_lane(value, number):  # type: ignore[no-untyped-def]
    if value == LANES:
        return lambda value, number: _one(value, number)
    return lambda value, number: value


def with_lane(value: Any, number: int, one: float) -> Any:
    """Return lanes with another number in one of them."""
    changed = value.copy()
    changed[number] = one
    return changed


@overload(with_lane, jit_options=_INLINED)
def _overload_with_lane(value, number, one):  # type: ignore[no-untyped-def]
    return lambda value, number, one: _with_one(value, number, one)


def where(condition: Any, one: Any, other: Any) -> Any:
    """Return `one` where a condition holds and `other` elsewhere; both are computed."""
    if isinstance(condition, np.ndarray):
        return np.where(condition, one, other)
    return one if condition else other


@overload(where, jit_options=_INLINED)
def _overload_where(condition, one, other):  # type: ignore[no-untyped-def]
    if condition == MASK:
        return lambda condition, one, other: _chosen(condition, one, other)
    return lambda condition, one, other: one if condition else other


def some(condition: Any) -> Any:
    """Return whether a condition holds in any lane."""
    return bool(np.any(condition))


@overload(some, jit_options=_INLINED)
def _overload_some(condition):  # type: ignore[no-untyped-def]
    if condition == MASK:
        return lambda condition: _any(condition)
    return lambda condition: condition


def count(p: Any, i: int) -> int:
    """Return an integer among parameters; all lanes have the same."""
    return int(np.ravel(p[i])[0])


@overload(count, jit_options=_INLINED)
def _overload_count(p, i):  # type: ignore[no-untyped-def]
    if p == ROWS:
        return lambda p, i: int(_one(p[i], 0))
    return lambda p, i: int(p[i])


@intrinsic
def _gathered(typingctx: Any, p: Any, i: Any, offset: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        pointer, first, offsets = args
        offsets = builder.fptosi(offsets, ir.VectorType(_INDEX, WIDTH))
        result = ir.Constant(_VECTOR, ir.Undefined)
        for number in range(WIDTH):
            at = ir.Constant(_INDEX, number)
            row = builder.add(first, builder.sext(builder.extract_element(offsets, at), _LONG))
            address = builder.add(builder.mul(row, ir.Constant(_LONG, WIDTH)), ir.Constant(_LONG, number))
            result = builder.insert_element(result, builder.load(builder.gep(pointer, [address])), at)
        return result

    return LANES(ROWS, types.intp, LANES), build


def picked(p: Any, i: int, offset: Any) -> Any:
    """Return p[i + offset], the offset a whole number that lanes may differ in."""
    if isinstance(offset, np.ndarray):
        return np.array([p[i + int(one), number] for number, one in enumerate(offset)])
    return p[i + offset]


@overload(picked, jit_options=_INLINED)
def _overload_picked(p, i, offset):  # type: ignore[no-untyped-def]
    if p == ROWS:
        return lambda p, i, offset: _gathered(p, i, offset)
    return lambda p, i, offset: p[i + offset]


def ranked(p: Any, i: int, n: int, x: Any) -> Any:
    """Return how many of the n numbers from p[i] on, which ascend, are at or below x."""
    if isinstance(x, np.ndarray):
        return np.sum(p[i : i + n] <= x, axis=0).astype(np.float64)
    return int(np.searchsorted(p[i : i + n], x, side="right"))


@overload(ranked, jit_options=_INLINED)
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


@inlined
def _exp_lanes(x):  # type: ignore[no-untyped-def]
    """Return exp(x) to 1e-15: 2^k by the exponent's bits times the series of what is left, |r| <= ln 2 / 2."""
    x = min(max(x, -708.0), 709.0)
    k = math.floor(x * 1.4426950408889634 + 0.5)
    r = (x - k * 0.6931471803691238) - k * 1.9082149292705877e-10
    p = 1 / 39916800.0 + r * (1 / 479001600.0 + r * (1 / 6227020800.0))
    p = 1 / 40320.0 + r * (1 / 362880.0 + r * (1 / 3628800.0 + r * p))
    p = 1 / 120.0 + r * (1 / 720.0 + r * (1 / 5040.0 + r * p))
    p = 1.0 + r * (1.0 + r * (0.5 + r * (1 / 6.0 + r * (1 / 24.0 + r * p))))
    return p * _bits(k)


@inlined
def _log_lanes(x):  # type: ignore[no-untyped-def]
    """Return ln(x) of positive normal numbers to 1e-15: k ln 2 + 2 artanh((f - 1) / (f + 1)), f within sqrt(2) of 1."""
    k, f = _split(x)
    low = f > 1.4142135623730951
    f, k = where(low, 0.5 * f, f), where(low, k + 1.0, k)
    s = (f - 1.0) / (f + 1.0)
    t = s * s
    p = 1 / 15.0 + t * (1 / 17.0 + t * (1 / 19.0 + t * (1 / 21.0)))
    p = 1 / 7.0 + t * (1 / 9.0 + t * (1 / 11.0 + t * (1 / 13.0 + t * p)))
    p = 1.0 + t * (1 / 3.0 + t * (1 / 5.0 + t * p))
    return k * 0.6931471803691238 + (2.0 * s * p + k * 1.9082149292705877e-10)


@inlined
def _expm1_lanes(x):  # type: ignore[no-untyped-def]
    """Return exp(x) - 1 to 1e-15: near zero by its series."""
    r = min(max(x, -0.5), 0.5)
    p = 1 / 3628800.0 + r * (1 / 39916800.0 + r * (1 / 479001600.0 + r * (1 / 6227020800.0 + r * (1 / 87178291200.0))))
    p = 1 / 720.0 + r * (1 / 5040.0 + r * (1 / 40320.0 + r * (1 / 362880.0 + r * p)))
    p = r * (1.0 + r * (0.5 + r * (1 / 6.0 + r * (1 / 24.0 + r * (1 / 120.0 + r * p)))))
    return where(abs(x) <= 0.5, p, _exp_lanes(x) - 1.0)


@inlined
def _tanh_lanes(x):  # type: ignore[no-untyped-def]
    """Return tanh(x) = sgn(x) (1 - e) / (1 + e), e = exp(-2 |x|), to 1e-15."""
    less = _expm1_lanes(-2.0 * abs(x))
    t = -less / (2.0 + less)
    return where(x >= 0.0, t, -t)


def _elementary(function: Any, lanes: Callable[[Any], Any]) -> None:
    @overload(function, jit_options=_INLINED)
    def implementation(x):  # type: ignore[no-untyped-def]
        return (lambda x: lanes(x)) if x == LANES else None


_elementary(math.exp, _exp_lanes)
_elementary(math.log, _log_lanes)
_elementary(math.expm1, _expm1_lanes)
_elementary(math.tanh, _tanh_lanes)


def power(x: Any, n: Any) -> Any:
    """Return x^n of x >= 0: without a library's function where n is 1 or 2, as it is in most fits, and 1.5."""
    if isinstance(x, np.ndarray):
        return x**n
    if n == 1.0:
        return x
    return x * x if n == 2.0 else x**n


@inlined
def _power_lanes(x, n):  # type: ignore[no-untyped-def]
    result = where(n == 2.0, x * x, x)
    other = (n != 1.0) & (n != 2.0)
    if some(other):
        result = where(n == 1.5, x * math.sqrt(x), result)
        other = other & (n != 1.5)
        if some(other):
            # Below the normal numbers x^n is taken for that of the least: 1e-308^n, or 0 at 0.
            grown = _exp_lanes(n * _log_lanes(max(x, 2.2250738585072014e-308)))
            result = where(other, where(x > 0.0, grown, 0.0), result)
    return result


@inlined
def _power_scalar(x, n):  # type: ignore[no-untyped-def]
    if n == 1.0:
        return x
    if n == 2.0:
        return x * x
    return x**n


@overload(power, jit_options=_INLINED)
def _overload_power(x, n):  # type: ignore[no-untyped-def]
    if x == LANES:
        return lambda x, n: _power_lanes(x, n)
    return lambda x, n: _power_scalar(x, n)


def raised(x: Any, n: Any) -> Any:
    """Return x^n of x >= 0 as `power` does, but of a scalar by the library's function for n = 2, too."""
    return x**n


@overload(raised, jit_options=_INLINED)
def _overload_raised(x, n):  # type: ignore[no-untyped-def]
    if x == LANES:
        return lambda x, n: _power_lanes(x, n)
    return lambda x, n: x if n == 1.0 else x**n
