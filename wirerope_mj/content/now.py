"""What a run does at an instant: its worst mounts and accelerations, as values there or the largest of an interval."""

from collections.abc import Iterator

import numpy as np

from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.content.judged_run import RunResult
from wirerope_mj.content.numbers import with_unit
from wirerope_mj.content.selection import NAMED
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.tables import Cell, Column, Row, Table


def at_cursor(run: RunResult, row: int, stop: int) -> Iterator[Block]:
    """Yield accelerations, and deflections and forces of the worst mounts, at a sample.

    Where values stand for several samples, up to `stop`, they are the largest sizes of all of them: of what oscillates faster,
    as in a sweep, one sample would be any phase.
    """
    response, selection = run.response, run.selection
    rows, one = slice(row, stop), stop - row <= 1
    start, end = response.time[row], response.time[max(stop - 1, row)]
    when = f"{start:.4f} s" if one else f"{start:.3f} to {end:.3f} s, largest sizes"
    if run.sweep is not None:
        frequency = run.sweep.frequency([0.5 * (start + end)])
        when += f", {float(frequency[0]):.4g} Hz"
    parts: list[tuple[str, Array]] = [("base", response.base.acceleration)]
    parts += [(name, response.bodies[name].acceleration) for name in selection.bodies[:1]]
    parts += [(name, response.points[name].acceleration) for name in selection.points[:1]]
    largest = [(name, float(np.linalg.norm(values[rows], axis=1).max())) for name, values in parts]
    sizes = [f"{name} {with_unit(value, 'm/s^2')}" for name, value in largest]
    yield Statement(id="now", text=f"{when}: {'; '.join(sizes)}", tone="strong")
    courses = {one.subject: one.course for one in selection.used}
    table: list[Row] = []
    # Mounts that use most of their limits, then those that are deflected most.
    names = [one.subject for one in selection.used if one.subject in selection.mounts]
    names += [name for axis in selection.axes[:1] for name in selection.leading["deflection", axis]]
    for name in list(dict.fromkeys(names))[:NAMED]:
        mount = response.mounts[name]
        cells: list[Cell] = [name]
        for values in (mount.deflection[rows], mount.force[rows]):
            found = values[0] if one else np.abs(values).max(axis=0)
            cells += [float(found[axis]) for axis in (2, 1, 0)]
        cells.append(float(courses[name][rows].max()) if name in courses else None)
        table.append(cells)
    heads = ("axial, tension +" if one else "axial", "shear", "roll")
    columns = [Column(head, unit, form) for unit, form in (("mm", "z.1f"), ("kN", "z.2f")) for head in heads]
    yield Table(title="", columns=(Column(align="left"), *columns, Column("used", "%", "z.0f")), rows=table)
