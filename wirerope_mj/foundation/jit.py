"""Compiling kernels, with a disk cache that no change of any kernel can outlive.

Numba's cache watches only the file of the function it compiled. Kernels here call kernels of other files, so that a change of
one would leave the others with its old code. The cache folder therefore carries a digest of all files that hold kernels, or
teach Numba new types.
"""

import hashlib
import os
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numba
import numpy as np

index = np.uint32
"""A table's entry as an index: unsigned, so that no code is compiled for indices from an array's end."""

_PACKAGE = Path(__file__).resolve().parents[1]


@cache
def cache_folder() -> str:
    """Return the folder of the compiled kernels: below NUMBA_CACHE_DIR if that is set, else in the user's cache."""
    digest = hashlib.sha256()
    for path in sorted(_PACKAGE.rglob("*.py")):
        source = path.read_bytes()
        if b"from wirerope_mj.foundation.jit import" in source or b"from numba.extending import" in source:
            digest.update(source)
    if numba.config.CACHE_DIR:
        root = Path(numba.config.CACHE_DIR)
    elif sys.platform == "win32":
        root = Path(os.environ.get("LOCALAPPDATA", Path.home())) / "wirerope_mj"
    else:
        root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "wirerope_mj"
    return str(root / digest.hexdigest()[:16])


def njit(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return `function` compiled on its first call, which lets other threads go on; x / 0 gives inf and NaN as in NumPy."""
    return _compiled(function, forceinline=False)


def inlined(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return `function` as `njit` does, compiled into its callers: handing on arrays costs as much as a small kernel."""
    return _compiled(function, forceinline=True)


def _compiled(function: Callable[..., Any], *, forceinline: bool) -> Callable[..., Any]:
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = cache_folder()  # read when the function is decorated, and only then
    try:
        return numba.njit(cache=True, error_model="numpy", forceinline=forceinline, nogil=True)(function)
    finally:
        numba.config.CACHE_DIR = before
