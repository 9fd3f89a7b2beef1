"""Errors of the project: what is wrong, where, what exists, what to try; and results that are absent."""

import errno
from dataclasses import dataclass

from wirerope_mj.foundation.plain_text import short


class WireRopeError(Exception):
    """Base of every error that the project raises on purpose, besides ValueError for a bad argument."""


class ModelError(WireRopeError):
    """A model, an isolator file or a scenario does not describe a system that can be simulated."""


class ModelWarning(UserWarning):
    """A model can be simulated, but what it describes is perhaps not what was meant."""


class RecordError(WireRopeError):
    """A measured record or a results folder cannot be read as what it should be."""


class DiskFullError(RecordError):
    """There is no space left where a result is written."""


class RecordWarning(UserWarning):
    """A measured record can be used, but something about it is suspicious or had to be changed."""


class ClusterWarning(UserWarning):
    """A study waits for a cluster."""


class StudyWarning(UserWarning):
    """A study can be computed, but perhaps does not vary what was meant."""


class AccuracyWarning(UserWarning):
    """A response is less accurate than requested, or depends on data that are hardly known, as of struck stops."""


class FontWarning(UserWarning):
    """A picture or a document shows boxes in place of letters that no font of this machine has."""


class SimulationError(WireRopeError):
    """A simulation cannot start, or ended before its time."""


class BudgetError(WireRopeError):
    """What was asked for takes more memory, disk or time than there is."""


class ConvergenceError(WireRopeError):
    """An iteration ended without a solution."""


def error_text(error: Exception) -> str:
    """Return the message of an error; a file name that is too long is shortened."""
    if isinstance(error, OSError) and error.errno == errno.ENAMETOOLONG:
        return f"{short(str(error.filename))!r} is too long for the name of a file."
    return str(error)


def why_unread(error: OSError) -> str:
    """Return the system's reason for not reading a file, and the remedy, to end a message with."""
    if isinstance(error, FileNotFoundError) or error.errno == errno.ENAMETOOLONG:
        return "there is no such file. Check its name and folder."
    if isinstance(error, IsADirectoryError):
        return "this is a folder. Name a file in it."
    if isinstance(error, PermissionError):
        return "you have no permission to read it. Change its permissions, or copy it to where you may read."
    if error.errno == errno.ENODEV:
        return "this is not a regular file but a pipe or a device. Write its content into a file, and name that."
    return f"the system cannot read it ({error.strerror}). Copy it to another place, and try again."


@dataclass(frozen=True, kw_only=True)
class Absent:
    """An absent result, and a sentence that says why it could not be computed."""

    reason: str
