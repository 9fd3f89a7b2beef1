"""A result that could not be computed, and why."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Absent:
    """A result that this run does not have, and a sentence that says why."""

    reason: str
