"""What differs between runs, as numbers: peaks beside each other."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wirerope_mj.assessment.verdicts import MountPeak, mount_peaks
from wirerope_mj.engine.response import Peak, Response
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.views.recording.overlay_parts import Part, has
from wirerope_mj.views.recording.overlay_runs import Overlay

_BLOCK = 64  # columns that are compared at once


@dataclass(frozen=True, kw_only=True)
class PeakRow:
    """A peak in every run, in the order of the runs; None where a run does not have it.

    Attributes:
        label: whose it is.
        values: in the row's unit.
        times: instants [s]; NaN where the peak has none.
        words: what is said beside a value, such as the kind of travel.
    """

    label: str
    values: tuple[float | None, ...]
    times: tuple[float | None, ...]
    words: tuple[str, ...]

    def difference(self, number: int) -> float | None:
        """Return the difference of a run to the first, as a share of the first's; None if that makes no sense."""
        first, value = self.values[0], self.values[number]
        if first is None or value is None or not np.isfinite([first, value]).all() or (first == 0.0 != value):
            return None
        return 0.0 if value == first else value / first - 1.0


def acceleration_rows(overlay: Overlay, axis: int | None = None) -> list[PeakRow]:
    """Return the peak accelerations [g], norms or sizes along an axis: of what is shared, then of what one run has alone."""
    alone = [thing for things in overlay.alone.values() for thing in things if isinstance(thing, Part)]
    rows = []
    for part in (*overlay.parts, *alone):
        peaks = [part.peak(run.response) if has(run.response, part) else None for run in overlay.runs]
        rows.append(_row(part.label, peaks, axis, STANDARD_GRAVITY))
    return rows


def mount_rows(overlay: Overlay, quantity: str, axis: int | None, unit: float) -> list[PeakRow]:
    """Return the peak "deflection" or "force" of the mounts in units of `unit`, in the order of `worst_first`."""
    rows = []
    for name in worst_first(overlay):
        entries = [run.response.peaks.mounts.get(name) for run in overlay.runs]
        peaks = [getattr(entry, quantity) if entry else None for entry in entries]
        rows.append(_row(name, peaks, axis, unit))
    return rows


def travel_rows(overlay: Overlay) -> list[PeakRow]:
    """Return the largest share of a rated travel of the mounts; NaN where none is rated."""
    found = [{row.name: row for row in mount_peaks(run.response)} for run in overlay.runs]
    return [_travel_row(name, [mounts.get(name) for mounts in found]) for name in worst_first(overlay)]


def largest_travel_row(overlay: Overlay) -> PeakRow | None:
    """Return the largest share of a rated travel of any mount of each run; None if nothing is rated."""
    worst = [(mount_peaks(run.response) or [None])[0] for run in overlay.runs]  # type: ignore[list-item]
    if not any(row is not None and row.share is not None for row in worst):
        return None
    row = _travel_row("largest of any mount", worst)
    names = tuple(
        f"{mount.name}, {word}" if mount and word else "" for mount, word in zip(worst, row.words, strict=True)
    )
    return PeakRow(label=row.label, values=row.values, times=row.times, words=names)


def worst_first(overlay: Overlay) -> list[str]:
    """Return the mounts of all runs by the largest share of a rated travel in any run, those that are not rated last."""

    def largest(name: str) -> float:
        rows = [run.selection.shares[run.selection.mounts.index(name)] for run in overlay.having(name)]
        return float(np.nan_to_num(rows, nan=-1.0).max())

    mounts = dict.fromkeys(name for run in overlay.runs for name in run.selection.mounts)
    return sorted(mounts, key=largest, reverse=True)


def identical(a: Response, b: Response) -> bool:
    """Return whether every sample and every peak of two responses has the same bits."""
    names = a.samples.names
    if names != b.samples.names or a.time.size != b.time.size or not a.peaks.same_as(b.peaks):
        return False
    return all(
        a.samples.columns(first, min(first + _BLOCK, len(names))).tobytes()
        == b.samples.columns(first, min(first + _BLOCK, len(names))).tobytes()
        for first in range(0, len(names), _BLOCK)
    )


def _row(label: str, peaks: list[Peak | None], axis: int | None, unit: float) -> PeakRow:
    sizes = [None if peak is None else _size(peak, axis) for peak in peaks]
    return PeakRow(
        label=label,
        values=tuple(None if size is None else size[0] / unit for size in sizes),
        times=tuple(None if size is None else size[1] for size in sizes),
        words=("",) * len(peaks),
    )


def _size(peak: Peak, axis: int | None) -> tuple[float, float]:
    """Return size and instant of the largest norm, or of the extreme of a component that is farther from zero."""
    if axis is None:
        return peak.value, peak.time
    low, high = float(peak.minimum[axis]), float(peak.maximum[axis])
    return (high, float(peak.maximum_time[axis])) if high >= -low else (-low, float(peak.minimum_time[axis]))


def _travel_row(label: str, rows: Sequence[MountPeak | None]) -> PeakRow:
    shares = [None if row is None else (np.nan if row.share is None else row.share) for row in rows]
    words = [
        "" if row is None or row.share is None else max(row.shares, key=lambda rating: row.shares[rating] or 0.0)
        for row in rows
    ]
    return PeakRow(label=label, values=tuple(shares), times=(np.nan,) * len(rows), words=tuple(words))
