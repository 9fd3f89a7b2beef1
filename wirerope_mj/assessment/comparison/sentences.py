"""Differences between runs in sentences, the same on the screen and in the recording."""

from collections.abc import Mapping, Sequence

import numpy as np

from wirerope_mj.assessment.comparison.compared import BASE, Component, Subject
from wirerope_mj.assessment.comparison.histories import HistoryDifference, identical
from wirerope_mj.assessment.comparison.peaks import PeakRow
from wirerope_mj.assessment.comparison.runs import Comparison
from wirerope_mj.assessment.criteria import mount_peaks
from wirerope_mj.foundation.units import STANDARD_GRAVITY

Inputs = Mapping[str, Mapping[str, str]]
"""Inputs of each run, by the run's name: names of inputs and their values as text."""

_LATE = 10.0  # instant from which seconds are read more easily than milliseconds [s]


def difference_text(row: PeakRow, number: int) -> str:
    """Return the difference of a run to the first as text: "=", "+12.3 %", or "-" where there is none."""
    difference = row.difference(number)
    if difference is None:
        return "-"
    return "=" if row.values[number] == row.values[0] else f"{100.0 * difference:+.1f} %"


def different_inputs(comparison: Comparison, inputs: Inputs) -> list[tuple[str, tuple[str, ...]]]:
    """Return the inputs that are not the same for all runs: name, and the value of each run ("-" if none)."""
    keys = dict.fromkeys(key for run in comparison.runs for key in inputs.get(run.name, {}))
    rows = [(key, tuple(inputs.get(run.name, {}).get(key, "-") for run in comparison.runs)) for key in keys]
    return [(key, values) for key, values in rows if len(set(values)) > 1]


def comparison_lines(comparison: Comparison) -> list[str]:
    """Return in sentences what differs, where and when, or that nothing does; what cannot be compared comes last."""
    first, *others = comparison.runs
    lines = [
        f"{run.name} is moved by {1e3 * run.moved:+.4g} ms to the shock of {first.name}." for run in others if run.moved
    ]
    for run in others:
        if identical(first.response, run.response):
            lines.append(f"{run.name} and {first.name} are identical: every sample and every peak has the same bits.")
            continue
        entries = [entry for entry in comparison.differences if entry.run == run.name]
        lines += [_base_sentence(entry, first.name) for entry in entries if entry.subject == BASE]
        riding = [entry for entry in entries if entry.subject != BASE and np.isfinite(entry.ratio)]
        for kind in (Component, str):
            largest = next((entry for entry in riding if isinstance(entry.subject, kind)), None)
            if largest is not None:
                lines.append(_sentence(largest, first.name))
    lines += _exceeded(comparison)
    for name, subjects in comparison.alone.items():
        if subjects:
            lines.append(f"Only in {name}: {_listed(subjects)}.")
    return lines


def subject_label(subject: Subject) -> str:
    """Return a component or a mount as tables and sentences call it."""
    return f"mount {subject}" if isinstance(subject, str) else subject.label


def size_text(entry: HistoryDifference) -> str:
    """Return a difference with its unit."""
    if isinstance(entry.subject, str):
        return f"{1e3 * entry.value:.3g} mm"
    return f"{entry.value / STANDARD_GRAVITY:.3g} g"


def ratio_text(entry: HistoryDifference) -> str:
    """Return a difference relative to the first run's peak."""
    return f"{100 * entry.ratio:.3g} %" if np.isfinite(entry.ratio) else "-"


def _base_sentence(entry: HistoryDifference, first: str) -> str:
    if entry.value == 0.0:
        return f"{entry.run}: the base moves as that of {first} does."
    return (
        f"{entry.run}: the acceleration of the base differs from that of {first} by up to {size_text(entry)}, "
        f"at {_instant(entry)}."
    )


def _sentence(entry: HistoryDifference, first: str) -> str:
    what = "deflections" if isinstance(entry.subject, str) else "accelerations"
    if entry.value == 0.0:
        return f"{entry.run}: {what} are those of {first}, bit for bit."
    return (
        f"{entry.run}: {what} differ most from those of {first} at {subject_label(entry.subject)}: by {size_text(entry)} at "
        f"{_instant(entry)}, {ratio_text(entry)} of {first}'s peak."
    )


def _instant(entry: HistoryDifference) -> str:
    return f"{1e3 * entry.time:.1f} ms" if entry.time < _LATE else f"{entry.time:.2f} s"


def _exceeded(comparison: Comparison) -> list[str]:
    """Return which mounts exceed their rated travel in which runs, where that is not the same for all."""
    over = {run.name: [peak.name for peak in mount_peaks(run.response) if peak.exceeded] for run in comparison.runs}
    if len({frozenset(names) for names in over.values()}) == 1:
        return []
    by_run = [f"in {name} by {', '.join(names) or 'none'}" for name, names in over.items()]
    return [f"Rated travel is exceeded {', '.join(by_run)}."]


def _listed(subjects: Sequence[Subject]) -> str:
    """Return components and mounts, each kind behind its name."""
    components = [subject for subject in subjects if isinstance(subject, Component)]
    kinds = {
        ("body", "bodies"): [one.name for one in components if one.kind != "point"],
        ("point", "points"): [one.name for one in components if one.kind == "point"],
        ("mount", "mounts"): [one for one in subjects if isinstance(one, str)],
    }
    return "; ".join(f"{kind[len(names) > 1]} {', '.join(names)}" for kind, names in kinds.items() if names)
