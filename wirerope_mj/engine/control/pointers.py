"""Numba's way to the memory behind an address."""

from numba import carray, types
from numba.core import cgutils
from numba.extending import intrinsic

from wirerope_mj.foundation.jit import inlined

ANY_SIZE = 1 << 40  # nominal length of an array behind a pointer: the kernels index by the model's own tables


@intrinsic
def _as_pointer(typing_context, address):  # type: ignore[no-untyped-def]
    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        return builder.inttoptr(args[0], cgutils.voidptr_t)

    return types.voidptr(types.intp), codegen


@inlined
def float64_array(address):  # type: ignore[no-untyped-def]
    """Return the float64 array that starts at `address`."""
    return carray(_as_pointer(address), (ANY_SIZE,), types.float64)


@inlined
def int64_array(address):  # type: ignore[no-untyped-def]
    """Return the int64 array that starts at `address`."""
    return carray(_as_pointer(address), (ANY_SIZE,), types.int64)


@inlined
def int32_array(address):  # type: ignore[no-untyped-def]
    """Return the int32 array that starts at `address`."""
    return carray(_as_pointer(address), (ANY_SIZE,), types.int32)


@inlined
def int32_member(struct, offset):  # type: ignore[no-untyped-def]
    """Return the int32 array that the pointer at `offset` in a struct leads to."""
    return int32_array(int64_array(struct + offset)[0])


@inlined
def member(struct, offset, start=0):  # type: ignore[no-untyped-def]
    """Return the float64 array that the pointer at `offset` in a struct leads to, from its entry `start`."""
    return float64_array(int64_array(struct + offset)[0] + 8 * start)
