"""The static load of every variant against its rating: what `judge` says of its response, and limits of searches."""

import json
import math

import numpy as np
import pytest
from house import sdof_text
from small_search import beam_study

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import starting_load_verdicts
from wirerope_mj.content.study_statements import statements
from wirerope_mj.mounts.isolator import Limits, Travel

G = wr.STANDARD_GRAVITY
QUIET = wr.HalfSine(peak=10.0, duration=0.011, direction="z", start=0.02)
PLACES = {"mount/*/fitted": wr.Choice(False, True, each=True)}


def rated_beam(**given):
    """A study of the beam of the small search, whose mounts have a rated static load of 40 N."""
    law = wr.BoucWen(alpha=8e3, beta=400.0, gamma=100.0, n=1.0, k=3e3)
    limits = Limits(static_load=40.0, travel=Travel(compression=0.04, tension=0.04))
    isolator = wr.Isolator(name="a", axial=law, limits=limits)
    return beam_study(isolators={"a": isolator}, motion=QUIET, duration=0.05, **given)


def sdof_study(*, initial="settled", gravity=G, rated=40.0, vary=None):
    """A mass of 3.5 kg on a spring of 5 kN/m."""
    isolator = wr.Isolator(name="a", axial=wr.KelvinVoigt(k=5e3, c=20.0), limits=Limits(static_load=rated))
    return wr.Study(
        model=sdof_text(gravity=gravity), isolators={"a": isolator}, motion=QUIET, duration=0.05, timestep=1e-3,
        initial=initial, sampling="list", vary=vary or {"body/mass/mass": wr.Choice(1.0, 2.0, relative=True)},
    )  # fmt: skip


@pytest.mark.parametrize("initial", ["settled", "relaxed"])
def test_a_mass_on_one_mount_loads_it_by_its_weight(tmp_path, initial):
    table = sdof_study(initial=initial).run(tmp_path / "out", workers=1).table
    # statics stops at accelerations of 1e-11 g; the weight along the axis is exact
    expected = [3.5 * G / 40.0, 7.0 * G / 40.0]
    assert table["static_load"].to_pylist() == pytest.approx(expected, rel=1e-9)
    assert table["static_load/m1"].to_pylist() == table["static_load"].to_pylist()


@pytest.mark.parametrize("changes", [{"initial": "unloaded"}, {"rated": None}, {"gravity": -G}])
def test_what_does_not_begin_at_rest_is_not_rated_or_hangs_is_not_judged(tmp_path, changes):
    table = sdof_study(**changes).run(tmp_path / "out", workers=1).table
    assert table["status"].to_pylist() == ["done"] * 2
    for name in ("static_load", "static_load/m1"):
        assert np.isnan(np.asarray(table[name])).all()


def test_the_static_loads_of_designs_are_the_verdicts_on_their_responses(tmp_path):
    study = rated_beam(vary=PLACES, variants=16)
    result = study.run(tmp_path / "out", workers=1)
    judged = 0
    for row in result.table.to_pylist():
        if row["status"] != "done":
            assert math.isnan(row["static_load"])
            continue
        verdicts = [one for one in starting_load_verdicts(study.response(row["variant"])) if one.limit is not None]
        shares = {f"static_load/{one.subject}": one.value / one.limit for one in verdicts}
        unjudged = [f"static_load/{name}" for name in study.base.mounts if f"static_load/{name}" not in shares]
        assert {name: row[name] for name in shares} == pytest.approx(shares, rel=1e-12)  # rounding alone
        assert all(math.isnan(row[name]) for name in unjudged)  # those that are not fitted, or hang
        assert row["static_load"] == pytest.approx(max(shares.values()), rel=1e-12)
        judged += len(shares)
    assert judged > 20


def test_a_search_recommends_no_design_beyond_the_rated_static_load(tmp_path):
    def search(limits):
        study = rated_beam(vary=PLACES, variants=8, seed=3)
        return wr.Search(study, minimise=("mounts",), limits=limits, generations=4, start=[{"mount/*/fitted": True}])

    few = search({}).run(tmp_path / "few", workers=1).front
    enough = search({"static_load": 1.0}).run(tmp_path / "enough", workers=1).front
    assert max(few["static_load"].to_pylist()) > 1.0
    assert enough.num_rows
    assert max(enough["static_load"].to_pylist()) <= 1.0
    assert min(enough["mounts"].to_pylist()) > min(few["mounts"].to_pylist())


def test_a_static_load_beyond_its_rating_is_said_and_one_within_is_not(tmp_path):
    said = statements(sdof_study().run(tmp_path / "heavy", workers=1))
    assert any("rated static load): beyond 100 % in 1 of 2 variants" in line for line in said)
    said = statements(sdof_study(rated=400.0).run(tmp_path / "light", workers=1))
    assert not any("static load" in line for line in said)


def test_the_summary_knows_the_static_load(tmp_path):
    sdof_study().run(tmp_path / "out", workers=1)
    found = json.loads((tmp_path / "out" / "summary.json").read_text())["measures"]["static_load"]
    assert found["variant"] == 1
    assert found["largest"] == pytest.approx(7.0 * G / 40.0, rel=1e-9)  # as above
