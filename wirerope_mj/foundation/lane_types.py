"""Numba's types of lanes, of masks and of arrays of lanes, their operators, and how they stand in memory.

See `wirerope_mj.foundation.lanes`.
"""

import math
import operator
from collections.abc import Callable
from typing import Any, ClassVar

from llvmlite import ir
from numba import types
from numba.core.imputils import lower_builtin, lower_cast
from numba.core.typeconv import Conversion
from numba.core.typing.arraydecl import GetItemBuffer, SetItemBuffer
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import models, register_model

# Lanes of a vector: a register of AVX2, half of one of AVX-512. Fixed, for results must not depend on a machine's choice.
WIDTH = 4

DOUBLE, LONG, INDEX = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
# LLVM's types of a float, of integers and of vectors of them.
VECTOR, LONGS = ir.VectorType(DOUBLE, WIDTH), ir.VectorType(LONG, WIDTH)
# How functions of lanes are compiled: into their callers, divisions by zero as in NumPy.
INLINED = {"forceinline": True, "error_model": "numpy"}
# Products may be fused with the sums that they are part of; nothing else may be reordered.
_CONTRACT = ("contract",)


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


class TableType(types.Type):
    """Numba's type of an array of integers or floats that is only read: its address.

    An array that is handed on costs the counting of its references, and a look at the sign of each index.
    """

    def __init__(self, element: types.Type) -> None:
        self.element = element
        super().__init__(name=f"Table({element})")


LANES, MASK, ROWS = LanesType(), MaskType(), RowsType()


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, VECTOR)


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, ir.VectorType(ir.IntType(1), WIDTH))


@register_model(RowsType)
class _RowsModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, DOUBLE.as_pointer())


@register_model(TableType)
class _TableModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, (DOUBLE if kind.element == types.float64 else LONG).as_pointer())


def constant(value: float) -> ir.Constant:
    """Return a number in every lane."""
    return ir.Constant(VECTOR, [value] * WIDTH)


@lower_cast(types.Float, LanesType)
@lower_cast(types.Integer, LanesType)
def spread_out(context: Any, builder: Any, source: Any, target: Any, value: Any) -> Any:
    """Build a vector with one number in every lane."""
    number = context.cast(builder, value, source, types.float64)
    one = builder.insert_element(ir.Constant(VECTOR, ir.Undefined), number, ir.Constant(INDEX, 0))
    zeros = ir.Constant(ir.VectorType(INDEX, WIDTH), [0] * WIDTH)
    return builder.shuffle_vector(one, ir.Constant(VECTOR, ir.Undefined), zeros)


class _First(AbstractTemplate):
    """An operator that Numba tries before its own, which take most of the time of compiling before they decline."""

    metadata: ClassVar = {"target": "cpu"}  # its own are generic


def _number(kind: Any) -> bool:
    return isinstance(kind, types.Float | types.Integer | LanesType)


def _operator(function: Any, result: Any, build: Callable[[Any, Any, Any], Any]) -> None:
    """Let an operator take lanes on one of its sides at least."""

    class Template(_First):
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
    class Template(_First):
        def generic(self, args: Any, kws: Any) -> Any:
            return signature(MASK, MASK, MASK) if tuple(args) == (MASK, MASK) else None

    infer_global(function)(Template)

    @lower_builtin(function, MaskType, MaskType)
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return getattr(builder, instruction)(*args)


_mask_operator(operator.and_, "and_")
_mask_operator(operator.or_, "or_")


def _unary(function: Any, build: Callable[[Any, Any], Any]) -> None:
    class Template(_First):
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
        return builder.call(known or ir.Function(builder.module, ir.FunctionType(VECTOR, [VECTOR]), full), [value])

    return build


_unary(operator.neg, lambda b, x: b.fneg(x))
_unary(abs, _call("fabs"))
_unary(math.sqrt, _call("sqrt"))
_unary(math.floor, _call("floor"))


class _GetItem(_First):
    def generic(self, args: Any, kws: Any) -> Any:
        if len(args) != 2 or not isinstance(args[1], types.Integer):
            return GetItemBuffer(self.context).generic(args, kws)
        if isinstance(args[0], TableType):
            return signature(args[0].element, args[0], types.intp)
        return signature(LANES, ROWS, types.intp) if args[0] == ROWS else GetItemBuffer(self.context).generic(args, kws)


class _SetItem(_First):
    def generic(self, args: Any, kws: Any) -> Any:
        ok = len(args) == 3 and args[0] == ROWS and isinstance(args[1], types.Integer) and _number(args[2])
        return signature(types.none, ROWS, types.intp, LANES) if ok else SetItemBuffer(self.context).generic(args, kws)


infer_global(operator.getitem)(_GetItem)
infer_global(operator.setitem)(_SetItem)


def _address(builder: Any, pointer: Any, index: Any) -> Any:
    first = builder.mul(index, ir.Constant(LONG, WIDTH))
    return builder.bitcast(builder.gep(pointer, [first]), VECTOR.as_pointer())


@lower_builtin(operator.getitem, RowsType, types.Integer)
def _load(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.load(_address(builder, *args), align=8)


@lower_builtin(operator.getitem, TableType, types.Integer)
def _read(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.load(builder.gep(args[0], [args[1]]))


@lower_builtin(operator.setitem, RowsType, types.Integer, LanesType)
def _store(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    builder.store(args[2], _address(builder, args[0], args[1]), align=8)
    return context.get_dummy_value()
