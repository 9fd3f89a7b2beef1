"""The headline of a run, read from its folder."""

import json
from pathlib import Path

from wirerope_mj.foundation.errors import RecordError, why_unread
from wirerope_mj.runs.folder import SUMMARY

_REMEDY = "Take the file from another copy of the folder, or repeat the run."


def read_headline(folder: str | Path) -> str:
    """Return the headline in a run's summary.json, "" for a run that has none: older ones, and a response saved alone.

    Raises:
        RecordError: the summary cannot be read.
    """
    path = Path(folder) / SUMMARY
    if not path.is_file():
        return ""
    try:
        summary = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise RecordError(f"{path}: {why_unread(error)}") from None
    except json.JSONDecodeError as error:
        raise RecordError(
            f"{path}, line {error.lineno}, column {error.colno}: this is not the summary of a run, nor JSON. {_REMEDY}"
        ) from None
    except (UnicodeDecodeError, RecursionError):
        raise RecordError(f"{path}: this is not the summary of a run, nor JSON in UTF-8. {_REMEDY}") from None
    if not isinstance(summary, dict):
        raise RecordError(f"{path}: this is not the summary of a run, which has names and values in braces. {_REMEDY}")
    return str(summary.get("headline", ""))
