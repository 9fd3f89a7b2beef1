"""Rms and 3-sigma accelerations of random vibration as a table."""

from collections.abc import Sequence

from wirerope_mj.assessment.criteria import Verdict
from wirerope_mj.foundation.tables import Cell, Column, Table

_AXES = ("x", "y", "z")


def random_table(verdicts: Sequence[Verdict]) -> Table | None:
    """Return a row for every body and point, or None where there is nothing."""
    values = {(row.subject, str(row.criterion)): row.value for row in verdicts}
    names = list(dict.fromkeys(row.subject for row in verdicts))
    if not names:
        return None
    kinds = ("rms", "3-sigma")
    rows: list[list[Cell]] = [
        [name, *(values.get((name, f"{kind} acceleration along {axis}")) for kind in kinds for axis in _AXES)]
        for name in names
    ]
    columns = [Column(align="left"), *(Column(f"{kind} {axis}", "g", ".3f") for kind in kinds for axis in _AXES)]
    note = "Of the stationary part, from where the response has settled in it; standard errors stand in summary.json."
    return Table(title="Random vibration: rms and 3-sigma accelerations", columns=columns, rows=rows, note=note)
