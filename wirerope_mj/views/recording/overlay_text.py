"""Texts beside laid-over runs: what differs in a few lines, and the peaks side by side as tables."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeGuard

import numpy as np

from wirerope_mj.assessment.verdicts import mount_peaks
from wirerope_mj.foundation.plain_text import markdown
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.views.recording.histories import LATE
from wirerope_mj.views.recording.overlay_apart import Apart
from wirerope_mj.views.recording.overlay_differences import (
    PeakRow,
    acceleration_rows,
    identical,
    largest_travel_row,
    mount_rows,
    travel_rows,
)
from wirerope_mj.views.recording.overlay_parts import BASE, Part
from wirerope_mj.views.recording.overlay_runs import Overlay
from wirerope_mj.views.recording.paths import AXES, entity

PEAKS, SUMMARY = "peaks", "differences"
PEAK_TEXTS = {"accelerations": "Accelerations", "mounts": "Mounts", "apart": "Farthest apart"}
"""Texts with the tables below /peaks: entities and titles."""

_WIDEST = 24
"""Characters of an input that still fit into a column; the viewer breaks no line in a table."""

Inputs = Mapping[str, Mapping[str, str]]
"""What was given to each run, by the run's name: names of inputs and their values as text."""


def log_overlay_texts(rec: Any, overlay: Overlay, inputs: Inputs) -> None:
    """Log what differs, and the tables of peaks."""
    import rerun as rr

    texts = {
        entity(SUMMARY): summary_markdown(overlay, inputs),
        entity(PEAKS, "accelerations"): acceleration_tables(overlay),
        entity(PEAKS, "mounts"): mount_tables(overlay),
        entity(PEAKS, "apart"): apart_tables(overlay),
    }
    for path, text in texts.items():
        rec.log(path, rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN), static=True)


def percent(row: PeakRow, number: int) -> str:
    """Return the difference of a run to the first in words: "=", "+12.3 %", or "-" where there is none."""
    difference = row.difference(number)
    if difference is None:
        return "-"
    return "=" if row.values[number] == row.values[0] else f"{100.0 * difference:+.1f} %"


def different_inputs(overlay: Overlay, inputs: Inputs) -> list[tuple[str, tuple[str, ...]]]:
    """Return what was given to the runs and is not the same for all: name, and the value of each run ("-" if none)."""
    keys = dict.fromkeys(key for run in overlay.runs for key in inputs.get(run.name, {}))
    rows = [(key, tuple(inputs.get(run.name, {}).get(key, "-") for run in overlay.runs)) for key in keys]
    return [(key, values) for key, values in rows if len(set(values)) > 1]


def findings(overlay: Overlay) -> list[str]:
    """Return in sentences what differs, where and when, or that nothing does; what cannot be compared comes last."""
    first, *others = overlay.runs
    lines = [
        f"{run.name} is moved by {1e3 * run.moved:+.4g} ms to the shock of {first.name}." for run in others if run.moved
    ]
    for run in others:
        if identical(first.response, run.response):
            lines.append(f"{run.name} and {first.name} are identical: every sample and every peak has the same bits.")
            continue
        own = [entry for entry in overlay.apart if entry.run == run.name and np.isfinite(entry.share)]
        lines += [
            _base_sentence(entry, first.name) for entry in overlay.apart if (entry.thing, entry.run) == (BASE, run.name)
        ]
        for kind in (Part, str):
            entry = next((entry for entry in own if isinstance(entry.thing, kind) and entry.thing != BASE), None)
            if entry is not None:
                lines.append(_apart_sentence(entry, first.name))
    lines += _exceeded(overlay)
    for name, things in overlay.alone.items():
        if things:
            lines.append(f"Only in {name}: {_listed(things)}.")
    return lines


def summary_markdown(overlay: Overlay, inputs: Inputs) -> str:
    """Return what was given differently, the main figures, and where and when the runs differ."""
    names = [run.name for run in overlay.runs]
    given = different_inputs(overlay, inputs)
    differing = [(key, *values) for key, values in given if max(map(len, values)) <= _WIDEST]
    long = [
        f"{key}: {'; '.join(f'{n}: {v}' for n, v in zip(names, values, strict=True))}"
        for key, values in given
        if max(map(len, values)) > _WIDEST
    ]
    parts = ["### What differs"]
    rows = [row for row in acceleration_rows(overlay)[:2]]
    figures = [(f"{row.label}, peak [g]", *_values(row, "{:.2f}")) for row in rows]
    travel = largest_travel_row(overlay)
    if travel is not None:
        shares = [f"{100 * value:.0f}" if _known(value) else "-" for value in travel.values]
        figures.append(("most of rated travel [%]", *shares))
    parts.append(_table(["", *names], [*differing, *figures]))
    parts.append("\n".join(f"- {markdown(line)}" for line in (*findings(overlay), *long)))
    return "\n\n".join(part for part in parts if part)


def acceleration_tables(overlay: Overlay) -> str:
    """Return the peak accelerations side by side: norms, then components."""
    parts = ["### Peak accelerations [g]\n" + _peak_table(overlay, acceleration_rows(overlay), "{:.2f}", times=True)]
    for number, axis in enumerate("xyz"):
        rows = acceleration_rows(overlay, number)
        parts.append(f"### Along {axis} [g]\n" + _peak_table(overlay, rows, "{:.2f}", times=True))
    return "\n\n".join(parts)


def mount_tables(overlay: Overlay) -> str:
    """Return what the mounts use of their rated travel, their deflections and forces, side by side."""
    parts = []
    travel = [row for row in travel_rows(overlay) if any(_known(value) for value in row.values)]
    if travel:
        parts.append("### Share of the rated travel [%]\n" + _peak_table(overlay, travel, "{:.0f}", scale=100.0))
    for quantity, unit, name in (("deflection", 1e-3, "mm"), ("force", 1e3, "kN")):
        for number, axis in reversed(list(enumerate(AXES))):
            rows = [row for row in mount_rows(overlay, quantity, number, unit) if any(row.values)]
            if rows:
                parts.append(f"### Largest {axis} {quantity} [{name}]\n" + _peak_table(overlay, rows, "{:.2f}"))
    return "\n\n".join(parts) or "There are no mounts."


def apart_tables(overlay: Overlay) -> str:
    """Return where and when the histories of each run are farthest from those of the first."""
    first = overlay.runs[0].name
    parts = []
    for run in overlay.runs[1:]:
        own = [entry for entry in overlay.apart if entry.run == run.name and entry.value > 0.0]
        rows = [(_label(e), _size(e), f"{1e3 * e.time:.1f}", _share(e)) for e in own]
        table = _table(["", "farthest apart", "at [ms]", f"of {first}'s peak"], rows)
        parts.append(f"### {markdown(run.name)} against {markdown(first)}\n{table or 'Histories do not differ.'}")
    return "\n\n".join(parts)


def _peak_table(
    overlay: Overlay, rows: Sequence[PeakRow], form: str, *, times: bool = False, scale: float = 1.0
) -> str:
    head = [""]
    for number, run in enumerate(overlay.runs):
        head += [run.name, *(["at [ms]"] if times else []), *([f"to {overlay.runs[0].name}"] if number else [])]
    body = []
    for row in rows:
        cells = [row.label]
        for number, (value, time, word) in enumerate(zip(row.values, row.times, row.words, strict=True)):
            shown = form.format(scale * value) if _known(value) else "-"
            cells += [f"{shown} {word}".strip(), *([f"{1e3 * time:.1f}" if _known(time) else "-"] if times else [])]
            cells += [percent(row, number)] if number else []
        body.append(tuple(cells))
    return _table(head, body)


def _listed(things: Sequence[Part | str]) -> str:
    """Return parts and mounts, each kind behind its name."""
    kinds = {
        "body": [thing.name for thing in things if isinstance(thing, Part) and thing.kind != "point"],
        "point": [thing.name for thing in things if isinstance(thing, Part) and thing.kind == "point"],
        "mount": [thing for thing in things if isinstance(thing, str)],
    }
    plural = {"body": "bodies", "point": "points", "mount": "mounts"}
    words = [
        f"{kind if len(names) == 1 else plural[kind]} {', '.join(names)}" for kind, names in kinds.items() if names
    ]
    return "; ".join(words)


def _exceeded(overlay: Overlay) -> list[str]:
    """Return which mounts exceed their rated travel in which runs, where that is not the same for all."""
    over = [
        [row.name for row in mount_peaks(run.response) if row.share is not None and row.share > 1.0]
        for run in overlay.runs
    ]
    if len({frozenset(names) for names in over}) == 1:
        return []
    words = [f"in {run.name} by {', '.join(names) or 'none'}" for run, names in zip(overlay.runs, over, strict=True)]
    return [f"Rated travel is exceeded {', '.join(words)}."]


def _base_sentence(entry: Apart, first: str) -> str:
    if entry.value == 0.0:
        return f"{entry.run}: the base moves as that of {first} does."
    return f"{entry.run}: the acceleration of the base differs from that of {first} by up to {_size(entry)}, at {_when(entry)}."


def _apart_sentence(entry: Apart, first: str) -> str:
    what = "deflections" if isinstance(entry.thing, str) else "accelerations"
    if entry.value == 0.0:
        return f"{entry.run}: {what} are those of {first}, bit for bit."
    return (
        f"{entry.run}: {what} differ most from those of {first} at {_label(entry)}: by {_size(entry)} at "
        f"{_when(entry)}, {_share(entry)} of {first}'s peak."
    )


def _label(entry: Apart) -> str:
    return f"mount {entry.thing}" if isinstance(entry.thing, str) else entry.thing.label


def _size(entry: Apart) -> str:
    if isinstance(entry.thing, str):
        return f"{1e3 * entry.value:.3g} mm"
    return f"{entry.value / STANDARD_GRAVITY:.3g} g"


def _when(entry: Apart) -> str:
    return f"{1e3 * entry.time:.1f} ms" if entry.time < LATE else f"{entry.time:.2f} s"


def _share(entry: Apart) -> str:
    return f"{100 * entry.share:.3g} %" if np.isfinite(entry.share) else "-"


def _values(row: PeakRow, form: str) -> list[str]:
    return [form.format(value) if _known(value) else "-" for value in row.values]


def _known(value: float | None) -> TypeGuard[float]:
    return value is not None and bool(np.isfinite(value))


def _cell(text: str) -> str:
    """Return a cell; what begins a list elsewhere is a sign here."""
    return text if text in ("-", "=") else markdown(text)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a Markdown table, its first column to the left; "" without rows."""
    if not rows:
        return ""
    texts = [[_cell(cell) for cell in row] for row in (head, *rows)]
    lines = [texts[0], [":--", *["--:"] * (len(head) - 1)], *texts[1:]]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
