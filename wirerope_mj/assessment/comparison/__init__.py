"""Two or more runs against the first of them: what they share by name, and where, when and by how much they differ."""

from wirerope_mj.assessment.comparison.compared import BASE, ComparedRun, Component, HistoryDifference, difference, identical
from wirerope_mj.assessment.comparison.runs import (
    Align,
    Comparison,
    PeakRow,
    acceleration_rows,
    combined_rows,
    compare_runs,
    largest_of,
    mount_rows,
    travel_rows,
)
