"""Numbers side by side: one source for one system and for several, each in a lane of the processor's vector registers.

A `Lanes` value is a vector of `WIDTH` floats that Numba lowers to LLVM's vectors; `Rows` is an array of them in memory, made
by `rows` from an array of the shape (n, WIDTH). Jitted functions use both as they would use a float and an array of
floats, so that one source serves scalars and lanes. Branches are what differs: a comparison of lanes gives a mask, and
`where` chooses with it. With JIT disabled the same sources are plain Python, on floats and on NumPy's rows.

Every lane is computed by the same instructions whatever stands in the others, so that a system has the same bits alone, padded
by copies of itself, and in any company.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload

from wirerope_mj.foundation.jit import inlined
from wirerope_mj.foundation.lane_choices import count as count
from wirerope_mj.foundation.lane_choices import lane as lane
from wirerope_mj.foundation.lane_choices import picked as picked
from wirerope_mj.foundation.lane_choices import ranked as ranked
from wirerope_mj.foundation.lane_choices import rows as rows
from wirerope_mj.foundation.lane_choices import some, where
from wirerope_mj.foundation.lane_choices import spread as spread
from wirerope_mj.foundation.lane_choices import table as table
from wirerope_mj.foundation.lane_choices import with_lane as with_lane
from wirerope_mj.foundation.lane_types import INLINED, LANES, LONGS, VECTOR, WIDTH, constant
from wirerope_mj.foundation.lane_types import MASK as MASK
from wirerope_mj.foundation.lane_types import ROWS as ROWS


@intrinsic
def _bits(typingctx: Any, value: Any) -> Any:
    """Return the vector's bits as integers in a vector of floats' clothes: 2^k by its exponent, k a whole float."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        magic = builder.fadd(args[0], constant(6755399441055744.0))  # 1.5 * 2^52: the low bits hold k
        exponent = builder.add(builder.bitcast(magic, LONGS), ir.Constant(LONGS, [1023] * WIDTH))
        return builder.bitcast(builder.shl(exponent, ir.Constant(LONGS, [52] * WIDTH)), VECTOR)

    return LANES(LANES), build


@intrinsic
def _split(typingctx: Any, value: Any) -> Any:
    """Return exponent k and fraction f of positive normal numbers, 2^k f with 1 <= f < 2."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        bits = builder.bitcast(args[0], LONGS)
        shifted = builder.lshr(bits, ir.Constant(LONGS, [52] * WIDTH))
        # As in `_bits`, the other way round: an integer below 2^51 in the low bits of 2^52.
        magic = builder.bitcast(builder.or_(shifted, ir.Constant(LONGS, [0x4330000000000000] * WIDTH)), VECTOR)
        exponent = builder.fsub(magic, constant(4503599627370496.0 + 1023.0))
        fraction = builder.and_(bits, ir.Constant(LONGS, [0x000FFFFFFFFFFFFF] * WIDTH))
        fraction = builder.or_(fraction, ir.Constant(LONGS, [0x3FF0000000000000] * WIDTH))
        return context.make_tuple(builder, sig.return_type, (exponent, builder.bitcast(fraction, VECTOR)))

    return types.UniTuple(LANES, 2)(LANES), build


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


@inlined
def _sin_cos_lanes(x):  # type: ignore[no-untyped-def]
    """Return sin(x) and cos(x) to 1e-15 for |x| < 1e5: the series of what is left of whole quarter turns."""
    k = math.floor(x * 0.6366197723675814 + 0.5)
    r = ((x - k * 1.5707963267341256) - k * 6.077100506303966e-11) - k * 2.0222662487959506e-21
    t = r * r
    s = -1 / 39916800.0 + t * (1 / 6227020800.0 - t * (1 / 1307674368000.0))
    s = r * (1.0 + t * (-1 / 6.0 + t * (1 / 120.0 + t * (-1 / 5040.0 + t * (1 / 362880.0 + t * s)))))
    c = -1 / 3628800.0 + t * (1 / 479001600.0 - t * (1 / 87178291200.0 - t * (1 / 20922789888000.0)))
    c = 1.0 + t * (-0.5 + t * (1 / 24.0 + t * (-1 / 720.0 + t * (1 / 40320.0 + t * c))))
    odd, quarter = k - 2.0 * math.floor(0.5 * k), k - 4.0 * math.floor(0.25 * k)
    sine, cosine = where(odd == 0.0, s, c), where(odd == 0.0, c, s)
    return where(quarter >= 2.0, -sine, sine), where((quarter == 1.0) | (quarter == 2.0), -cosine, cosine)


@inlined
def _sin_lanes(x):  # type: ignore[no-untyped-def]
    return _sin_cos_lanes(x)[0]


@inlined
def _cos_lanes(x):  # type: ignore[no-untyped-def]
    return _sin_cos_lanes(x)[1]


def _elementary(function: Any, lanes: Callable[[Any], Any]) -> None:
    @overload(function, jit_options=INLINED)
    def implementation(x):  # type: ignore[no-untyped-def]
        return (lambda x: lanes(x)) if x == LANES else None


_elementary(math.exp, _exp_lanes)
_elementary(math.log, _log_lanes)
_elementary(math.expm1, _expm1_lanes)
_elementary(math.tanh, _tanh_lanes)
_elementary(math.sin, _sin_lanes)
_elementary(math.cos, _cos_lanes)


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
            result = where(other, where(x > 0.0, grown, 0.0 * x), result)  # NaN stays NaN
    return result


@inlined
def _power_scalar(x, n):  # type: ignore[no-untyped-def]
    if n == 1.0:
        return x
    if n == 2.0:
        return x * x
    return x**n


@overload(power, jit_options=INLINED)
def _overload_power(x, n):  # type: ignore[no-untyped-def]
    if x == LANES:
        return lambda x, n: _power_lanes(x, n)
    return lambda x, n: _power_scalar(x, n)


def raised(x: Any, n: Any) -> Any:
    """Return x^n of x >= 0 as `power` does, but of a scalar by the library's function for n = 2, too: x x has other bits."""
    return x**n


@overload(raised, jit_options=INLINED)
def _overload_raised(x, n):  # type: ignore[no-untyped-def]
    if x == LANES:
        return lambda x, n: _power_lanes(x, n)
    return lambda x, n: x if n == 1.0 else x**n


def over(a: Any, b: float) -> Any:
    """Return a / b, b a number that all lanes have: in lanes by its reciprocal, a division less for all but one."""
    return a * (1.0 / b) if isinstance(a, np.ndarray) else a / b


@overload(over, jit_options=INLINED)
def _overload_over(a, b):  # type: ignore[no-untyped-def]
    if a == LANES:
        return lambda a, b: a * (1.0 / b)
    return lambda a, b: a / b
