"""The levels of x86-64 processors that kernels are shipped for."""

from functools import cache

import llvmlite.binding as llvm

_V2 = ("cx16", "popcnt", "sahf", "sse3", "ssse3", "sse4.1", "sse4.2")
_V3 = (*_V2, "avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "xsave")
LEVELS = {"x86-64-v3": _V3, "x86-64-v2": _V2}
"""Names of the levels as LLVM has them, the highest first, and the features that a processor of that level has.

Source: System V ABI, AMD64 supplement, table 3.1.
"""


@cache
def level() -> str | None:
    """Return the highest level of `LEVELS` that this machine's processor and operating system have, or None."""
    if not llvm.get_process_triple().startswith("x86_64"):
        return None
    present = {name for name, there in llvm.get_host_cpu_features().items() if there}
    return next((name for name, features in LEVELS.items() if present.issuperset(features)), None)
