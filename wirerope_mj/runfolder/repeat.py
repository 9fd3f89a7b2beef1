"""A run computed again from its folder alone."""

import tempfile
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from wirerope_mj.errors import RecordError
from wirerope_mj.excitation.motion import BaseMotion
from wirerope_mj.excitation.restore import motion_from_dict
from wirerope_mj.response import Response, load_response
from wirerope_mj.runfolder.folder import SCENARIO
from wirerope_mj.runfolder.model_files import missing_isolators
from wirerope_mj.runfolder.write import FORMAT, is_streamed
from wirerope_mj.simulation import simulate
from wirerope_mj.system import System, load_system

AGREES = 1e-9
"""Largest difference relative to a column's peak that another processor's rounding explains; a wrong input is far above."""

_BLOCK = 64  # columns that are compared at once


@dataclass(frozen=True, kw_only=True)
class Replay:
    """Whether a run computed again gives the same numbers.

    Attributes:
        identical: every sample and every peak has the same bits.
        largest_difference: of a sample, relative to the largest of its column; infinite where the columns differ.
        column: where it is; "" if all samples are identical.
        response: what was computed; None if its samples were streamed and are gone.
    """

    identical: bool
    largest_difference: float
    column: str
    response: Response | None

    @property
    def agrees(self) -> bool:
        """Whether the numbers are the same but for what rounding on another processor explains."""
        return self.identical or self.largest_difference <= AGREES


def replay(folder: str | Path, *, progress: bool = False) -> Replay:
    """Return the comparison of a run with itself computed again; nothing outside its folder is read.

    Raises:
        RecordError: the folder is not a complete run.
    """
    folder = Path(folder)
    content = _content(folder)
    system, motion = _inputs(folder, content)
    arguments = {key: value for key, value in content["simulate"].items() if key != "accuracy"}
    stored = load_response(folder)
    long = is_streamed(arguments)
    with tempfile.TemporaryDirectory() as place:
        again = simulate(system, motion, **arguments, out=place if long else None, progress=progress)
        difference, column = _difference(stored, again)
        same_peaks = stored.peaks.to_dict() == again.peaks.to_dict()
    return Replay(
        identical=not column and same_peaks,
        largest_difference=difference,
        column=column,
        response=None if long else again,
    )


def _content(folder: Path) -> dict[str, Any]:
    path = folder / SCENARIO
    if not path.is_file():
        raise RecordError(f"{folder}: this is not a run; there is no {SCENARIO} here.")
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
        if content["format"] != FORMAT:
            raise RecordError(f"{path}: format {content['format']} is not {FORMAT}; use the version that wrote it.")
        for table, key in (
            ("model", "file"),
            ("simulate", "duration"),
            ("simulate", "sample_rate"),
            ("motion", "kind"),
        ):
            content[table][key]
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError, KeyError, TypeError) as error:
        raise RecordError(f"{path}: this is not the scenario of a run ({type(error).__name__}: {error}).") from None
    return content


def _inputs(folder: Path, content: dict[str, Any]) -> tuple[System, BaseMotion]:
    """Return system and motion; RecordError if one of their files is not in the folder."""
    model = folder / content["model"]["file"]
    if not model.resolve().is_relative_to(folder.resolve()) or not model.is_file():
        raise RecordError(f"{folder}: the model {content['model']['file']!r} is not in the run's folder.")
    motion = {key: value for key, value in content["motion"].items() if key != "description"}
    for term in motion.get("terms", [motion]):
        if "path" in term and not (folder / term["path"]).resolve().is_relative_to(folder.resolve()):
            raise RecordError(f"{folder}: the record {term['path']!r} is not in the run's folder.")
    system = load_system(model)
    missing = missing_isolators(system, model.parent)
    if missing:  # the catalogue stepped in, which may have changed since
        raise RecordError(f"{folder}: the isolator file {missing[0]!r} is missing in {model.parent.name}/.")
    return system, motion_from_dict(motion, folder=folder)


def _difference(stored: Response, again: Response) -> tuple[float, str]:
    """Return the largest relative difference of a sample and its column."""
    names = stored.samples.names
    if names != again.samples.names or not np.array_equal(stored.time, again.time):
        return np.inf, "the columns or the sample instants themselves"
    worst, where = 0.0, ""
    for first in range(0, len(names), _BLOCK):
        a = stored.samples.columns(first, min(first + _BLOCK, len(names)))
        b = again.samples.columns(first, min(first + _BLOCK, len(names)))
        if np.array_equal(a, b):
            continue
        scale = np.maximum(np.abs(a).max(axis=0), np.finfo(float).tiny)
        share = np.abs(a - b).max(axis=0) / scale
        place = int(share.argmax())
        if share[place] > worst:
            worst, where = float(share[place]), names[first + place]
    return worst, where
