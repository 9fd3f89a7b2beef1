"""Variants whose runs end before their peaks are over: only limits that are exceeded already are judged."""

import math
from collections.abc import Callable, Sequence

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from wirerope_mj.assessment.criteria.ended import GROWS, TOO_EARLY, ends_early, quiet_from
from wirerope_mj.engine.simulation.stability import slowest_period
from wirerope_mj.foundation.arrays import Booleans, Entries
from wirerope_mj.studies.vary.quantities import MotionSettings
from wirerope_mj.studies.vary.variants import Maker, Work

# Factor on the nominal system's slowest period that covers all variants', so that none is computed if all mounts act.
_SLOWER = 2.0
# Ends of the names of quantities that take mounts away, and may free a mode of its stiffness.
_TAKEN_AWAY = ("/failed", "/fitted")


class Lengths:
    """Check of a study's runs: whether they last until their peaks are over, by `wirerope_mj.assessment.criteria.ended`."""

    def __init__(self, work: Work) -> None:
        self._make = Maker(work.system, work.motions, work.columns)
        self._of_motion = [column for column in work.columns if not column.targets]
        # What the rules of runs want to know of each motion: itself, begin and end of the run, and when it is over.
        self._asked: list[tuple[Entries, tuple[float, float], float]] = [
            (motion.to_dict(), (0.0, work.duration), motion.end if math.isfinite(motion.end) else math.nan)
            for motion in work.motions
        ]
        slowest = _SLOWER * slowest_period(work.system)
        far = [not self._early(number, slowest) for number in range(len(work.motions))]
        all_act = not any(column.name.endswith(_TAKEN_AWAY) for column in work.columns)
        self._enough = {number for number, holds in enumerate(far) if holds and all_act}

    def early(self, row: Entries, slowest: float = math.nan) -> str:
        """Return a note if the run of a variant ends before its peaks are over, else "".

        `slowest` is the period of its slowest mode [s]; NaN to look for it.
        """
        number = self._number(row)
        if number in self._enough:
            return ""
        return self._early(number, slowest_period(self._make.system(row)) if math.isnan(slowest) else slowest)

    def quiet_from(self, row: Entries) -> float:
        """Return the instant [s] after which no response of a variant may grow; infinite if growth is allowed to the end."""
        return quiet_from(*self._asked[self._number(row)])

    def _number(self, row: Entries) -> int:
        """Return the index of a variant's motion among those of the study."""
        return MotionSettings.of(self._of_motion, row).record

    def _early(self, number: int, slowest: float) -> str:
        """Return a note if a run under motion `number` ends too early for a mode of period `slowest` [s], else ""."""
        return ends_early(*self._asked[number], slowest)


_AT_REST = ("static_load", "mounts")  # Measures that no run has to go on for
_LISTED = ": "  # Before the kinds of measures that grow, at the end of a note


def growth_text(note: str, kinds: Sequence[str]) -> str:
    """Return the note on a variant for which kinds of measures such as "travel" still grow."""
    return f"{note}{_LISTED}{', '.join(kinds)}"


def ended_early(table: pa.Table, measure: str = "") -> Booleans:
    """Return the mask of variants whose runs end before their peaks have passed, (n,); all False for a measure at rest.

    With `measure`, True also for variants in which a measure of its kind still grows.
    """
    kind = measure.partition("/")[0]
    if "message" not in table.column_names or kind in _AT_REST:
        return np.zeros(table.num_rows, dtype=bool)

    def is_meant(text: str) -> bool:
        grows = bool(kind) and text.startswith(GROWS) and kind in text.rpartition(_LISTED)[2].split(", ")
        return grows or text.startswith(TOO_EARLY)

    return _saying(table, is_meant)


def still_growing(table: pa.Table) -> int:
    """Count the variants for which some measure still grows when their runs end."""
    if "message" not in table.column_names:
        return 0
    return int(np.count_nonzero(_saying(table, lambda text: text.startswith(GROWS))))


def _saying(table: pa.Table, is_meant: Callable[[str], bool]) -> Booleans:
    """Return the mask of variants for whose message `is_meant` is True, (n,)."""
    messages = table["message"]
    texts = [text for text in pc.unique(messages).to_pylist() if is_meant(text)]
    return np.asarray(pc.is_in(messages, pa.array(texts, pa.string())))


def why_early(table: pa.Table) -> str:
    """Return the note of the variant that needs the longest run among those that end too early; "" if none does."""
    return max(pc.unique(table["message"].filter(pa.array(ended_early(table)))).to_pylist(), key=_least, default="")


def _least(note: str) -> float:
    """Read from a note the least duration of a run that would be long enough [s]."""
    number, unit = note.rpartition("run at least ")[2].split()
    return float(number) * (1e-3 if unit == "ms" else 1.0)
