"""Two or more runs against the first of them: what they share by name, and where, when and by how much they differ."""

from wirerope_mj.assessment.comparison.runs import (
    BASE,
    Align,
    ComparedRun,
    Comparison,
    Component,
    HistoryDifference,
    PeakRow,
    acceleration_rows,
    combined_rows,
    compare_runs,
    difference,
    identical,
    largest_of,
    mount_rows,
    travel_rows,
)
