"""A result that is not there, and why."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Absent:
    """A result that could not be had, and a sentence that says why."""

    reason: str
