"""What a study's `summary.json` says, and the same asked of its result."""

import json
import math

import numpy as np
import pytest
from small_search import beam_search
from table_study import VARY, table_study

import wirerope_mj as wr

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps


def summary_of(result):
    return json.loads((result.folder / "summary.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """Return a finished study of 120 variants."""
    vary = {**VARY, "motion/level": wr.Uniform(1.0, 5.0)}
    return table_study(variants=120, vary=vary, timestep=2.5e-4).run(tmp_path_factory.mktemp("drawn") / "out", workers=1)


def test_of_drawn_variants_the_summary_has_what_the_tables_give(drawn):
    found = summary_of(drawn)
    assert (found["variants"], found["failed"]) == (120, 0)
    travel = np.asarray(drawn.table["travel"])
    beyond = int((travel > 1.0).sum())
    of = found["measures"]["travel"]
    assert of["q95"] == pytest.approx(np.quantile(travel, 0.95), rel=1e-12)  # six of 120 lie beyond; rounding
    assert (of["largest"], of["variant"]) == (travel.max(), int(np.argmax(travel)))
    assert (of["limit"], of["beyond"], of["of"], of["confidence"]) == (1.0, beyond, 120, 0.95)
    assert of["low"] < of["probability"] == beyond / 120 < of["high"]
    assert "limit" not in found["measures"]["acceleration"]


def test_percentiles_that_no_table_gives_are_not_in_the_summary(tmp_path):
    found = summary_of(table_study(variants=40).run(tmp_path / "out", workers=1))
    assert set(found["measures"]["acceleration"]) == {"nominal", "median", "largest", "variant"}


def test_of_a_grid_there_are_no_probabilities(tmp_path):
    study = table_study(vary={"motion/level": wr.Uniform(0.5, 1.5, points=5)}, variants=None, sampling="grid", duration=0.5)
    of = summary_of(study.run(tmp_path / "out", workers=1))["measures"]["travel"]
    assert set(of) == {"nominal", "smallest", "median", "largest", "variant", "limit", "beyond", "of"}
    assert of["smallest"] < of["median"] < of["largest"]


def test_indices_are_in_the_summary_with_their_intervals(tmp_path):
    result = table_study(sampling="sobol-indices").run(tmp_path / "out", workers=1)
    of = summary_of(result)["measures"]["travel"]
    assert set(of["indices"]) == set(VARY)
    found = wr.sobol_indices(result, "travel").factors[0]
    assert of["indices"][found.name]["total"] == found.total
    assert of["indices"][found.name]["first_interval"] == list(found.first_interval)
    assert (of["base_rows"], of["of"]) == (8, 16)
    independent = np.flatnonzero(np.arange(40) % 5 < 2)
    assert of["variant"] in independent
    assert result.worst("travel", 1)["variant"][0].as_py() == of["variant"]


def test_of_a_search_there_is_its_front_and_no_percentile(tmp_path):
    result = beam_search(generations=2).run(tmp_path / "out", workers=1)
    found = summary_of(result)
    assert "measures" not in found
    assert [one["variant"] for one in found["front"]] == result.front["variant"].to_pylist()
    assert found["front"][0]["travel"] == result.front["travel"][0].as_py()
    assert found["knee"] == result.knee
    assert found["within_limits"] == result.feasible.sum()


def test_a_result_is_asked_for_its_worst_variants_percentiles_and_chances(drawn):
    travel = np.asarray(drawn.table["travel"])
    rows = drawn.worst("travel", 3)
    assert rows["variant"].to_pylist() == np.argsort(-travel)[:3].tolist()
    assert rows.column_names == drawn.table.column_names
    middle, high = drawn.quantiles("travel", (0.5, 0.99))
    assert middle == pytest.approx(np.median(travel), rel=1e-12)  # rounding
    assert math.isnan(high)
    found = drawn.exceedance("travel")
    assert (found.count, found.n, found.failed) == (int((travel > 1.0).sum()), 120, 0)
    assert drawn.exceedance("acceleration", 0.0).count == 120
    with pytest.raises(ValueError, match="`limit` must be given for 'acceleration'"):
        drawn.exceedance("acceleration")
    with pytest.raises(ValueError, match="there is no measure 'speed'"):
        drawn.worst("speed")
    with pytest.raises(ValueError, match="`probabilities` must be from 0 to 1"):
        drawn.quantiles("travel", (95,))
