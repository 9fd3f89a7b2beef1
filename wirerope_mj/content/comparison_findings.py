"""What differs between runs, in sentences: which is better, where and when they differ, which limits which one exceeds."""

from collections.abc import Mapping, Sequence

import numpy as np

from wirerope_mj.assessment.comparison import BASE, Comparison, HistoryDifference, PeakRow, acceleration_rows, identical
from wirerope_mj.assessment.comparison.runs import ComparedRun, Component, Subject
from wirerope_mj.assessment.criteria import COMBINED, EXCEEDED
from wirerope_mj.assessment.criteria.summary import against_limit
from wirerope_mj.assessment.criteria.verdict import TRAVEL, most_used
from wirerope_mj.content.blocks import Statement
from wirerope_mj.content.numbers import listed, several, with_unit
from wirerope_mj.foundation.units import STANDARD_GRAVITY

# Inputs of each run, by the run's name: names of inputs and their values as text.
Inputs = Mapping[str, Mapping[str, str]]
_TOGETHER = 1.0  # instants of two shocks that are one [ms]
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


def better_run(comparison: Comparison) -> Statement:
    """Say which run is better: the one that exceeds fewer checks, then the one that uses less of what is most critical.

    Where nothing is judged it is the one with the smaller peak acceleration of the payload.
    """
    first, *others = comparison.runs
    if others and all(identical(first.response, run.response) for run in others):
        return Statement(id="better", text="The runs are identical: none is better.", values={"better": None})
    used = {run.name: most_used(run.verdicts) for run in comparison.runs}
    if not all(used.values()):
        return _smaller_acceleration(comparison)
    exceeded = {run.name: sum(row.verdict == EXCEEDED for row in run.verdicts) for run in comparison.runs}
    ranks = {name: (count, used[name].utilisation or 0.0) for name, count in exceeded.items()}  # type: ignore[union-attr]
    best = min(ranks, key=lambda name: ranks[name])
    parts = []
    for run in comparison.runs:
        over, row = ranks[run.name][0], used[run.name]
        assert row is not None
        checks = f"{several(over, 'check')} exceeded, " if over else ""
        parts.append(f"{run.name}: {checks}most critical {against_limit(row)}")
    tie = sum(rank == ranks[best] for rank in ranks.values()) > 1
    text = "None is better" if tie else f"{best} is better"
    return Statement(id="better", text=f"{text}. {'; '.join(parts)}.", values={"better": None if tie else best})


def _smaller_acceleration(comparison: Comparison) -> Statement:
    rows = [row for row in acceleration_rows(comparison) if row.label != BASE.label and None not in row.values]
    if not rows:
        return Statement(id="better", text="No limit is stated: none is better.", values={"better": None})
    row, names = rows[0], [run.name for run in comparison.runs]
    best = names[int(np.argmin(np.array(row.values, dtype=np.float64)))]
    sizes = "; ".join(f"{name}: {with_unit(value, 'g')}" for name, value in zip(names, row.values, strict=True))
    text = f"Limits are not stated in every run; {best} has the smallest peak acceleration of {row.label}. {sizes}."
    return Statement(id="better", text=text, values={"better": best})


def comparison_lines(comparison: Comparison) -> list[str]:
    """Return in sentences what differs, where and when, or that nothing does; what cannot be compared comes last."""
    first, *others = comparison.runs
    lines = [f"{run.name} is moved by {1e3 * run.moved:+.4g} ms to the shock of {first.name}." for run in others if run.moved]
    for run in others:
        if late := _shock_later(first, run):
            lines.append(
                f"The base of {run.name} moves {late} than that of {first.name}: --align shock lays both shocks together."
            )
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
    lines += [*_over(comparison, TRAVEL, "Travel along single axes"), *_over(comparison, COMBINED.kind, "Combined travel")]
    for name, subjects in comparison.alone.items():
        if subjects:
            lines.append(f"Only in {name}: {_listed(subjects)}.")
    return lines


def _shock_later(first: ComparedRun, other: ComparedRun) -> str:
    """Return by how much the first event of a run is later or earlier than another's, "50 ms later"; "" if it is not."""
    if not (first.response.events and other.response.events):
        return ""
    apart = 1e3 * (other.response.events[0][0] - first.response.events[0][0])
    return f"{abs(apart):.4g} ms {'later' if apart > 0.0 else 'earlier'}" if abs(apart) > _TOGETHER else ""


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


def _over(comparison: Comparison, kind: str, what: str) -> list[str]:
    """Say which mounts exceed 100 % by one ruler in which runs, where that is not the same for all."""
    over = {
        run.name: list(
            dict.fromkeys(row.subject for row in run.verdicts if row.criterion.kind == kind and row.verdict == EXCEEDED)
        )
        for run in comparison.runs
    }
    if len({frozenset(names) for names in over.values()}) == 1:
        return []
    by_run = "; ".join(f"{name}: {listed(names) or 'none'}" for name, names in over.items())
    return [f"{what} exceeds 100 %: {by_run}."]


def _listed(subjects: Sequence[Subject]) -> str:
    """Return components and mounts, each kind behind its name."""
    components = [subject for subject in subjects if isinstance(subject, Component)]
    kinds = {
        ("body", "bodies"): [one.name for one in components if one.kind != "point"],
        ("point", "points"): [one.name for one in components if one.kind == "point"],
        ("mount", "mounts"): [one for one in subjects if isinstance(one, str)],
    }
    return "; ".join(f"{kind[len(names) > 1]} {', '.join(names)}" for kind, names in kinds.items() if names)
