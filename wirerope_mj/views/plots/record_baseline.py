"""Picture of a measured record without its baseline correction and with it."""

from pathlib import Path
from typing import Any

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import Record
from wirerope_mj.views.plots.plain_figure import PlainFigure

_BINS = 2000
"""Intervals that a long acceleration is drawn in, each by its extremes: more than the picture has points across."""

_AFTER_END = 0.05
"""Fraction of the record's length by which velocity and displacement are drawn on: the base coasts at what is left."""

_MEASURED, _PLAYED = "#d95f0e", "#08519c"

_TEXTS = {
    "none": "no baseline correction",
    "rest": "baseline: the level at rest taken off",
    "mean": "baseline: the mean taken off",
    "velocity": "baseline: the constant taken off that leaves no final velocity",
    "highpass": "baseline: high-pass filter without phase",
}


def baseline_text(record: Record) -> str:
    """Return the baseline correction of a record, for instance "baseline: the mean taken off"."""
    text = _TEXTS[record.baseline]
    return text if record.highpass is None else f"{text}, {record.highpass:g} Hz"


def save_record_baseline(record: Record, path: str | Path, *, title: str = "") -> None:
    """Write a picture of acceleration, velocity and displacement along every moving axis, as measured and as played.

    A record without a baseline correction is drawn once: where it takes the base shows whether it needs one.
    """
    measured = record.as_measured
    axes = [axis for axis in range(3) if measured.samples[:, axis].any()] or [2]
    figure = PlainFigure(figsize=(1.0 + 5.0 * len(axes), 8.0), layout="constrained", dpi=110)
    panels = figure.subplots(3, len(axes), sharex=True, squeeze=False)
    subtitle = f"{record.path.name}, {baseline_text(record)}"
    figure.suptitle("\n".join([*filter(None, [title]), subtitle]), fontsize=12, fontweight="bold")
    lines = [(measured, _MEASURED, "as measured")] if record.baseline != "none" else []
    for version, colour, label in [*lines, (record, _PLAYED, "as played")]:
        _draw(panels, axes, version, colour, label)
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
    last_v, last_x = (np.round(of(record.end)[0], 9) + 0.0 for of in (record.velocity, record.displacement))
    for column, axis in enumerate(axes):
        time, acceleration = _extremes(record.time, record.samples[:, axis] / STANDARD_GRAVITY)
        panels[0, column].plot(time, acceleration, color=colour, lw=0.8)
        course = f"{label}: ends at {last_v[axis]:+.3g} m/s, {last_x[axis]:+.3g} m"
        panels[1, column].plot(times, velocity[:, axis], color=colour, lw=1.2, label=course)
        panels[2, column].plot(times, displacement[:, axis], color=colour, lw=1.2)
        for row in (1, 2):
            panels[row, column].axvline(record.end, color="0.7", lw=0.8, ls=":")


def _extremes(time: Array, values: Array) -> tuple[Array, Array]:
    """Return the line itself, or the extremes of its intervals if it is long."""
    if time.size <= 2 * _BINS:
        return time, values
    size = -(-time.size // _BINS)
    count = time.size // size
    intervals = values[: count * size].reshape(count, size)
    lowest = np.arange(count) * size + intervals.argmin(axis=1)
    highest = np.arange(count) * size + intervals.argmax(axis=1)
    rows = np.unique(np.concatenate([lowest, highest, [0, time.size - 1]]))
    return time[rows], values[rows]
