"""The headline of a run, read from its folder."""

import json
from pathlib import Path

from wirerope_mj.errors import RecordError
from wirerope_mj.runfolder.folder import SUMMARY


def read_headline(folder: str | Path) -> str:
    """Return the headline in a run's summary.json, "" for a run that has none: older ones, and a response saved alone.

    Raises:
        RecordError: the summary cannot be read.
    """
    path = Path(folder) / SUMMARY
    if not path.is_file():
        return ""
    try:
        return str(json.loads(path.read_text(encoding="utf-8")).get("headline", ""))
    except (OSError, ValueError, AttributeError) as error:
        raise RecordError(f"{path}: this is not the summary of a run ({type(error).__name__}: {error}).") from None
