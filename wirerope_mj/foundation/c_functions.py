"""Kernels' calls of a C function that a program brings along, by its address.

    double function(const double *p, double x, double v, const double *z, double *zdot)

The address is looked up anew in every process and is written to no file. Lanes call no such function: they get NaN.
"""

import ctypes
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload
from numba.np.arrayobj import make_array

from wirerope_mj.foundation.lane_types import DOUBLE, INLINED, LANES

SIGNATURE = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, *2 * [ctypes.c_void_p])


@intrinsic
def _call(typingctx: Any, address: Any, p: Any, i: Any, x: Any, v: Any, z: Any, j: Any, zdot: Any, k: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        def pointer(array: int) -> Any:
            kind, value = sig.args[array], args[array]
            data = make_array(kind)(context, builder, value).data if isinstance(kind, types.Array) else value
            return builder.gep(data, [args[array + 1]])

        signature = ir.FunctionType(DOUBLE, [DOUBLE.as_pointer(), DOUBLE, DOUBLE, *2 * [DOUBLE.as_pointer()]])
        function = builder.inttoptr(args[0], signature.as_pointer())
        return builder.call(function, [pointer(1), args[3], args[4], pointer(5), pointer(7)])

    index = types.intp
    return types.float64(index, p, index, types.float64, types.float64, z, index, zdot, index), build


def called(p: Any, i: int, x: float, v: float, z: Any, j: int, zdot: Any, k: int) -> float:
    """Call the function whose address is p[i] with pointers to p[i + 1], z[j] and zdot[k]; the arrays are contiguous."""
    places = (p[i + 1 :].ctypes.data, x, v, z[j:].ctypes.data, zdot[k:].ctypes.data)
    return float(SIGNATURE(int(p[i]))(*places))


@overload(called, jit_options=INLINED)
def _overload_called(p, i, x, v, z, j, zdot, k):  # type: ignore[no-untyped-def]
    if x == LANES:
        return lambda p, i, x, v, z, j, zdot, k: x * np.nan
    return lambda p, i, x, v, z, j, zdot, k: _call(int(p[i]), p, i + 1, x, v, z, j, zdot, k)
