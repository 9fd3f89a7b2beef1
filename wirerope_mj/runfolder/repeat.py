"""A run computed again from its folder alone."""

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wirerope_mj.response import Response, load_response
from wirerope_mj.runfolder.sources import scenario_content, system_and_motion
from wirerope_mj.runfolder.write import is_streamed
from wirerope_mj.simulation import simulate

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
    content = scenario_content(folder)
    system, motion = system_and_motion(folder, content)
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
