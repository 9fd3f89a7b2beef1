"""A run beside the one before it and beside tests: what differs, and their curves, for the right column."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from wirerope_mj.assessment.comparison import compare_runs
from wirerope_mj.assessment.correlation import correlate
from wirerope_mj.assessment.criteria.verdict import ACCELERATION, most_used
from wirerope_mj.content.blocks import Block, Chart, Statement
from wirerope_mj.content.comparison import accelerations_table, figures_table, travel_tables
from wirerope_mj.content.correlation import channel_panel
from wirerope_mj.content.histories import TOTAL, overlay_histories
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.selection import worst_names
from wirerope_mj.motions import Measured

_ROWS = 8  # of a table: those that a reader compares; the report of a run has them all
_CHANNELS = 4  # measured channels whose curves are drawn


def compared_blocks(runs: Mapping[str, JudgedRun], tests: Sequence[Measured] = ()) -> Iterator[Block]:
    """Yield tables and curves of a run, the last one, beside the run before it and tests."""
    name, now = list(runs.items())[-1]
    correlations = [correlate(now.response, test) for test in tests]
    channels = [channel for test in correlations for channel in test.responses][:_CHANNELS]
    panels = [replace(panel, title=f"{panel.title} {panel.ylabel}") for panel in (channel_panel(c, name) for c in channels)]
    if len(runs) > 1:
        comparison = compare_runs(
            {name: run.response for name, run in runs.items()}, verdicts={name: run.verdicts for name, run in runs.items()}
        )
        for table in (figures_table(comparison), accelerations_table(comparison), *travel_tables(comparison)):
            yield replace(table, shown=min(_ROWS, len(table.rows)))
        # the most critical mount along its governing axis, and the most critical acceleration, or else the largest
        worst = most_used(row for row in now.verdicts if row.criterion.kind == ACCELERATION)
        parts = [worst.subject] if worst else worst_names(now.response)[:1]
        along = (worst.criterion.axis if worst else "") or TOTAL
        drawn = overlay_histories(comparison, now.selection)
        keys = [("deflection", *now.selection.axes[:1], now.selection.governing or "")]
        keys += [("acceleration", along, kind, part) for kind in ("body", "point") for part in parts]
        panels += [drawn[key] for key in keys if key in drawn]
    if correlations:
        yield Statement("tests", items=tuple(f"{test.name}: {test.statement}" for test in correlations))
    if panels:
        yield Chart(
            id="compared", rows=[[panel] for panel in panels], height=150.0, caption="Now, before, and as measured.",
            alt="Histories now, before, and as measured.",
        )  # fmt: skip
