"""Causes of the last bits of a row: the versions of the packages that compute, and the code of this one."""

import hashlib
from functools import cache
from pathlib import Path

from wirerope_mj.foundation.resources import version_of

PACKAGES = ("wirerope-mj", "mujoco", "numpy", "scipy", "numba")  # Packages on which the last bit of a number may depend
_SHOWS = ("cli", "views", "runs")  # Wings that show what is there, and compute no row


@cache
def versions() -> dict[str, str]:
    """Return the versions of the packages that compute by name, and as "code" a digest of this package's own files.

    The digest tells a checkout that was changed from one that was not, which have the same version.
    """
    return {**{name: version_of(name) for name in PACKAGES}, "code": _code()}


def _code() -> str:
    package = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        relative = path.relative_to(package)
        if relative.parts[0] not in _SHOWS:
            digest.update(f"{relative.as_posix()}\n".encode() + path.read_bytes())
    return digest.hexdigest()[:16]
