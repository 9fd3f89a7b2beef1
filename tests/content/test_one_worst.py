"""One worst mount, also where its static load decides; limits of the payload with lines of their own; units of forces."""

import re

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.assessment.criteria.verdict import STATIC_LOAD, by_use
from wirerope_mj.content.job import job_headline
from wirerope_mj.content.judged_run import judged_run
from wirerope_mj.content.mounts import mount_blocks
from wirerope_mj.content.numbers import with_unit
from wirerope_mj.content.run import run_content
from wirerope_mj.content.scene_outline import worst_instant
from wirerope_mj.foundation.payload_limits import limit_from_text
from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.foundation.units import force_text
from wirerope_mj.runs.scenario_file import judged_by


@pytest.fixture(scope="module")
def run():
    """Return a floor under 2 g, of whose mounts the most critical is so by its weight, with two limits of the payload."""
    limits = [limit_from_text(text) for text in ("acceleration/rack_1 = 3 g", "acceleration/crew_4 = 0.1 g")]
    system = judged_by(wr.load_system("floating_floor"), combined_travel=True, limits=limits)
    motion = wr.HalfSine(peak=2.0 * wr.STANDARD_GRAVITY, duration=0.011, direction="x")
    return judged_run(system, motion, wr.simulate(system, motion, duration=1.0, timestep=5e-4))


def test_headline_ring_table_and_viewer_name_one_worst_also_by_its_static_load(run):
    order = list(by_use(run.verdicts))
    mounts = [name for name in order if name in run.selection.mounts]
    assert by_use(run.verdicts)[mounts[0]].criterion.kind == STATIC_LOAD
    without = [row for row in run.verdicts if row.subject in run.selection.mounts]
    assert f"most critical {mounts[0]} " in job_headline({"x": without}).text
    (table,) = mount_blocks(run)
    assert [row[0] for row in table.rows][: len(mounts)] == mounts
    assert run.selection.governing == mounts[0]
    assert [one.subject for one in run.selection.used] == [
        name for name in order if name in {u.subject for u in run.selection.used}
    ]
    assert run_content(run).verdict.values["most_critical"] == order[0] == worst_instant(run).ring[0]


def test_every_limit_of_the_payload_has_a_line(run):
    (said,) = (block for block in run_content(run).blocks("headline") if block.id == "verdicts")
    lines = [line for line in said.items if " g, limit " in line]
    assert re.fullmatch(r"Exceeded: crew_4 [\d.]+ g, limit 0.1 g \(\d+ %\) at [\d.]+ m?s\.", lines[0])
    assert re.fullmatch(r"Within: rack_1 [\d.]+ g, limit 3 g \(\d+ %\) at [\d.]+ m?s\.", lines[1])


@pytest.mark.quick
def test_forces_below_one_kilonewton_are_read_in_newtons():
    columns = (Column("mount", align="left"), Column("force", "kN", "z.2f"))
    weak = Table(title="", columns=columns, rows=[("m1", -6.0), ("m2", 15.0)])
    assert [column.title() for column in weak.columns] == ["mount", "force [N]"]
    assert [cells[1][0] for cells in weak.marks()] == ["-6.0", "15.0"]
    strong = Table(title="", columns=columns, rows=[("m1", -6.0), ("m2", 15e3)])
    assert [cells[1][0] for cells in strong.marks()] == ["-0.01", "15.00"]
    assert [force_text(6.0), force_text(4100.0)] == ["6 N", "4.1 kN"]
    assert [with_unit(6.0, "N"), with_unit(4100.0, "N")] == ["6.00 N", "4.10 kN"]
    assert np.isnan(float(Table(title="", columns=columns, rows=[("m1", np.nan)]).rows[0][1]))
