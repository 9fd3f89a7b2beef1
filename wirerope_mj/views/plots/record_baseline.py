"""What a baseline correction did to a measured record, as a picture."""

from pathlib import Path
from typing import Any

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import BaseMotion, Record
from wirerope_mj.views.plots.plain_figure import PlainFigure

_BINS = 2000
"""Stretches that a long acceleration is drawn in, each by its extremes: more than the picture has points across."""

_AFTER_END = 0.05
"""Share of the record's length by which velocity and displacement are drawn on: the base coasts at what is left."""

_MEASURED, _PLAYED = "#d95f0e", "#08519c"

_WORDS = {
    "none": "no baseline correction",
    "rest": "baseline: the level at rest taken off",
    "mean": "baseline: the mean taken off",
    "velocity": "baseline: the constant taken off that leaves no final velocity",
    "highpass": "baseline: high-pass filter without phase",
}


def records_of(motion: BaseMotion) -> list[Record]:
    """Return the measured records in a motion."""
    return [part for part in motion.parts if isinstance(part, Record)]


def baseline_words(record: Record) -> str:
    """Return what was done to the baseline of a record, for instance "baseline: the mean taken off"."""
    words = _WORDS[record.baseline]
    return words if record.highpass is None else f"{words}, {record.highpass:g} Hz"


def save_record_baseline(record: Record, path: str | Path, *, title: str = "") -> None:
    """Write a picture of acceleration, velocity and displacement along every moving axis, as measured and as played.

    A record without a baseline correction is drawn once: where it takes the base shows whether it needs one.
    """
    measured = record.as_measured()
    axes = [axis for axis in range(3) if measured.samples[:, axis].any()] or [2]
    figure = PlainFigure(figsize=(1.0 + 5.0 * len(axes), 8.0), layout="constrained", dpi=110)
    panels = figure.subplots(3, len(axes), sharex=True, squeeze=False)
    words = f"{record.path.name}, {baseline_words(record)}"
    figure.suptitle("\n".join([*filter(None, [title]), words]), fontsize=12, fontweight="bold")
    lines = [(measured, _MEASURED, "as measured")] if record.baseline != "none" else []
    for part, colour, label in [*lines, (record, _PLAYED, "as played")]:
        _draw(panels, axes, part, colour, label)
    for column, axis in enumerate(axes):
        panels[0, column].set_title("xyz"[axis])
        panels[2, column].set_xlabel("time [s]")
        for row, name in enumerate(("acceleration [g]", "velocity [m/s]", "displacement [m]")):
            panel = panels[row, column]
            panel.grid(color="0.92")
            panel.margins(x=0.0)
            if column == 0:
                panel.set_ylabel(name)
        panels[1, column].legend(fontsize=8, loc="best")
    figure.savefig(path)


def _draw(panels: Any, axes: list[int], record: Record, colour: str, label: str) -> None:
    """Draw one version of the record; the legend says how fast and how far the base ends."""
    end = record.end + _AFTER_END * record.duration
    times = np.linspace(record.start, end, _BINS)
    velocity, displacement = record.velocity(times), record.displacement(times)
    # Rounding leaves some 1e-15 m/s, which would be printed as if it were something.
    last_v, last_x = (np.round(part(record.end)[0], 9) + 0.0 for part in (record.velocity, record.displacement))
    for column, axis in enumerate(axes):
        time, acceleration = _extremes(record.time, record.samples[:, axis] / STANDARD_GRAVITY)
        panels[0, column].plot(time, acceleration, color=colour, lw=0.8)
        words = f"{label}: ends at {last_v[axis]:+.3g} m/s, {last_x[axis]:+.3g} m"
        panels[1, column].plot(times, velocity[:, axis], color=colour, lw=1.2, label=words)
        panels[2, column].plot(times, displacement[:, axis], color=colour, lw=1.2)
        for row in (1, 2):
            panels[row, column].axvline(record.end, color="0.7", lw=0.8, ls=":")


def _extremes(time: Array, values: Array) -> tuple[Array, Array]:
    """Return the line itself, or the extremes of its stretches if it is long."""
    if time.size <= 2 * _BINS:
        return time, values
    size = -(-time.size // _BINS)
    count = time.size // size
    stretches = values[: count * size].reshape(count, size)
    lowest = np.arange(count) * size + stretches.argmin(axis=1)
    highest = np.arange(count) * size + stretches.argmax(axis=1)
    rows = np.unique(np.concatenate([lowest, highest, [0, time.size - 1]]))
    return time[rows], values[rows]
