"""Versions of installed packages."""

from importlib.metadata import PackageNotFoundError, version


def version_of(package: str) -> str:
    """Return the version of a package, or "of a checkout": it is on the path, but was not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "of a checkout"
