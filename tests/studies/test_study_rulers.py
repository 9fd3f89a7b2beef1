"""A study and a run measure travel and acceleration alike: what the one calls largest is what the other says."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.assessment.criteria.travel import travel_verdicts
from wirerope_mj.assessment.criteria.verdict import COMBINED
from wirerope_mj.content.study import measures_table, study_content, worst_table
from wirerope_mj.content.study_charts import study_charts
from wirerope_mj.studies.engines import compute
from wirerope_mj.studies.engines.together import NONE
from wirerope_mj.studies.results.measure import ALL, measure_of, values_of
from wirerope_mj.studies.results.study_summary import summary_of

PULSE = wr.HalfSine(peak=100.0, duration=0.011, direction="z", start=0.01)


@pytest.fixture(scope="module")
def study():
    return wr.Study(
        model="floating_floor.xml", motion=PULSE + wr.HalfSine(peak=80.0, duration=0.011, direction="x", start=0.01),
        duration=0.12, timestep=1e-4, variants=3, vary={"motion/level": wr.Uniform(0.7, 1.3)},
    )  # fmt: skip


@pytest.mark.parametrize("side_by_side", [True, False])
def test_combined_travel_of_a_variant_is_the_largest_verdict_of_its_run(study, tmp_path, monkeypatch, side_by_side):
    if not side_by_side:
        monkeypatch.setattr(compute, "together", lambda work, rows: NONE)
    result = study.run(tmp_path / "study", workers=1)
    for number in range(3):
        response = result.response(number)
        used = [row.utilisation for row in travel_verdicts(response) if row.criterion == COMBINED and row.limit is not None]
        # Both engines follow the travel at every step; a millionth is what their orders of summing may differ by.
        assert result.table["combined_travel"][number].as_py() == pytest.approx(max(used), rel=1e-6)
        peaks = response.peaks
        bodies = [peaks.bodies[name].acceleration.value for name in peaks.bodies if name != response.scene.base]
        points = [one.acceleration.value for one in peaks.points.values()]
        assert values_of(result.table, "acceleration")[number] == pytest.approx(max(bodies), rel=1e-6)
        assert values_of(result.table, ALL)[number] == pytest.approx(max(*bodies, *points), rel=1e-6)


def test_both_accelerations_and_both_travels_are_named(study, tmp_path):
    result = study.run(tmp_path / "study", workers=1)
    table = measures_table(summary_of(result))
    named = [row[0] for row in table.rows]
    assert {"travel [%]", "combined travel [%]", "acceleration [g]", "acceleration, all [g]"} <= set(named)
    assert "largest acceleration of a body;" in table.note
    assert "largest acceleration of bodies and points" in table.note
    assert (np.asarray(values_of(result.table, ALL)) >= values_of(result.table, "acceleration")).all()


@pytest.mark.slow
def test_pictures_and_tables_show_the_travel_that_the_headline_says(tmp_path):
    both = PULSE + wr.HalfSine(peak=80.0, duration=0.011, direction="x", start=0.01)
    vary = {"motion/level": wr.Uniform(0.7, 1.3)}
    long = wr.Study(model="floating_floor.xml", motion=both, duration=1.0, timestep=1e-4, variants=2, vary=vary)
    result = long.run(tmp_path / "study", workers=1)
    combined, single = (float(np.nanmax(values_of(result.table, name))) for name in ("combined_travel", "travel"))
    assert combined > single  # or the case is none
    summary = summary_of(result)
    said = study_content(summary).verdict
    assert f"; worst {100.0 * combined:.3g} % of combined travel, in variant " in said.text
    assert "payload not judged: no limit stated" in said.text
    assert said.values["used"] == combined
    assert summary.by == "combined_travel"
    assert worst_table(summary).title.startswith("Worst variants by combined travel")
    captions = [chart.caption for chart in study_charts(summary)]
    drawn = " ".join([*captions, *(f"{p.xlabel} {p.ylabel}" for c in study_charts(summary) for row in c.rows for p in row)])
    assert measure_of("combined_travel").text.lower() in drawn.lower()
    assert measure_of("travel").text.lower() not in drawn.lower()
