"""Variants computed side by side, without systems of their own, against the same variants in a batch of systems."""

import numpy as np
import pytest
from house import deck, mjcf
from one_scale import one_scale
from small_search import beam_study

import wirerope_mj as wr
from wirerope_mj.engine.simulation.stability import slowest_period
from wirerope_mj.engine.system.varied import sprung_joints
from wirerope_mj.studies.engines import compute as engine
from wirerope_mj.studies.engines.together import NONE, together
from wirerope_mj.studies.vary.variants import Maker

SHOCK = wr.HalfSine(peak=60.0, duration=0.011, direction="z", start=0.005)
STUDIES = {
    "laws of coupled mounts": {
        "mount/m*/axial/alpha": wr.Normal(1.0, 0.1, relative=True, each=True),
        "mount/m*/roll/k1": wr.Normal(1.0, 0.1, relative=True, each=True),
    },
    "one law of two that are coupled, checked one by one": {"mount/m01/axial/beta": wr.Normal(1.0, 1e-12, relative=True)},
    "b and c, whose product alone acts": {"mount/m*/axial/c": wr.Normal(1.0, 0.1, relative=True)},
    "body": {
        "body/floor/mass": wr.Normal(1.0, 0.05, relative=True),
        "body/floor/centre_shift/x": wr.Normal(0.0, 0.02),
        "body/floor/centre_shift/z": wr.Normal(0.0, 0.02),
    },
    "places": {"mount/m01,m02/position_shift/x": wr.Normal(0.0, 0.01)},
    "level": {"motion/level": wr.Normal(1.0, 0.1)},
}


def study_of(vary, **more):
    settings = {"motion": SHOCK, "duration": 0.03, "timestep": 1e-3, "variants": 11, "sampling": "random", "seed": 4}
    return wr.Study(vary=vary, **{"model": "floating_floor", **settings, **more})


def table(study, rows, *, side_by_side=True):
    """Return the table of some rows, in lanes without systems, or as a batch of systems."""
    with pytest.MonkeyPatch.context() as patch:
        if not side_by_side:
            patch.setattr(engine, "together", lambda *_: NONE)
        return engine.compute(study.work, engine.Chunk(number=0, rows=rows)).table


def require_equal(one, other):
    assert one.schema == other.schema
    for name in one.column_names:
        first, second = (part[name].to_numpy(zero_copy_only=False) for part in (one, other))
        np.testing.assert_array_equal(first, second, err_msg=name)


@pytest.mark.parametrize("name", STUDIES)
def test_variants_have_the_bits_that_a_batch_of_their_systems_has(name):
    study = study_of(STUDIES[name], isolators=one_scale("wr16_400", "wr12_400"))
    rows = study.table().to_pylist()
    assert together(study.work, rows).indices.tolist() == list(range(11))
    require_equal(table(study, rows), table(study, rows, side_by_side=False))


@pytest.mark.slow
@pytest.mark.parametrize(
    "vary",
    [
        {
            "mount/m*/axial/alpha": wr.Normal(1.0, 0.1, relative=True, each=True),
            "body/floor/mass": wr.Normal(1.0, 0.05, relative=True),
        },
        {
            "mount/m*/roll/laws[0].k1": wr.Normal(1.0, 0.1, relative=True),
            "mount/m02/shear/laws[0].alpha": wr.Normal(1.0, 0.1, relative=True),
        },
        {"mount/m*/axial/stiffness": wr.Normal(1.0, 0.1, relative=True, each=True)},
        {"mount/m*/axial/friction": wr.Normal(1.0, 0.1), "mount/m*/roll/yield": wr.Normal(1.0, 0.1)},
        {"mount/m*/isolator": wr.Choice("enidine_wr16_400", "enidine_wr12_400", "CB1400-30")},
    ],
    ids=["all scales", "one scale", "stiffness", "friction and yield", "parts of other heights and energies"],
)
def test_laws_of_several_scales_stand_side_by_side_too(vary):
    study = study_of(vary, variants=3)
    rows = study.table().to_pylist()
    assert together(study.work, rows).indices.size == 3
    require_equal(table(study, rows), table(study, rows, side_by_side=False))


@pytest.mark.parametrize("initial", ["relaxed", "unloaded"])
def test_variants_begin_where_the_batch_begins(initial):
    study = study_of(STUDIES["body"], initial=initial, variants=3)
    rows = study.table().to_pylist()
    assert together(study.work, rows).indices.size == 3
    require_equal(table(study, rows), table(study, rows, side_by_side=False))


def test_a_base_that_moves_from_the_start_carries_all_along():
    motion = wr.Sine(frequency=20.0, acceleration=10.0, direction="z")
    study = study_of(STUDIES["body"], motion=motion, variants=3)
    rows = study.table().to_pylist()
    assert together(study.work, rows).indices.size == 3
    require_equal(table(study, rows), table(study, rows, side_by_side=False))


@pytest.mark.slow
def test_company_does_not_matter():
    study = study_of({key: value for vary in STUDIES.values() for key, value in vary.items() if "beta" not in key})
    rows = study.table().to_pylist()
    every = table(study, rows)
    for some in ([5], [9, 1, 2], list(range(10, -1, -1))):
        require_equal(table(study, [rows[i] for i in some]), every.take(some))


@pytest.mark.slow
@pytest.mark.parametrize(
    "vary",
    [
        {
            "mount/m*/failed": wr.Choice("", "m01", "m02"),
            "mount/m*/axial/stiffness": wr.Normal(1.0, 0.1, relative=True, each=True),
        },
        {
            "mount/m*,h*/fitted": wr.Choice(False, True, each=True),
            "mount/m01,m02/position_shift/x": wr.Normal(0.0, 0.01),
            "mount/m*/stiffness": wr.Normal(1.0, 0.1),
        },
    ],
    ids=["failed", "absent"],
)
def test_mounts_that_failed_or_are_absent_stand_side_by_side_too(vary):
    study = study_of(vary, variants=5)
    rows = study.table().to_pylist()
    assert together(study.work, rows).indices.size == 5
    found = table(study, rows)
    assert len(set(found["mounts"].to_pylist())) > 1
    for row in found.to_pylist():
        fitted = {name.split("/")[1]: value for name, value in row.items() if name.endswith("/fitted")}
        assert all(np.isfinite(row[f"deflection/{mount}/compression"]) == there for mount, there in fitted.items())
    require_equal(found, table(study, rows, side_by_side=False))


def test_a_stop_may_be_absent_which_needs_a_system_of_its_own():
    study = study_of({"mount/s01/fitted": wr.Choice(False, True)}, sampling="grid", variants=2)
    rows = study.table().to_pylist()
    assert [rows[i]["mount/s01/fitted"] for i in together(study.work, rows).indices] == [True]
    found = table(study, rows)
    assert found["status"].to_pylist() == ["done"] * 2
    assert found["mounts"].to_pylist() == [24.0] * 2


def test_variants_are_judged_by_the_ratings_of_their_own_isolators(tmp_path):
    law, ratings = wr.BoucWen(alpha=8e3, beta=400.0, gamma=100.0, n=1.0, k=3e3), {"a": 0.02, "b": 0.04}
    for name, travel in ratings.items():
        limits = wr.Limits(travel=wr.Travel(compression=travel, tension=travel), static_load=1e4 * travel)
        wr.Isolator(name=name, axial=law, limits=limits).save(tmp_path / f"{name}.toml")
    files = [str(tmp_path / f"{name}.toml") for name in ratings]
    study = beam_study(
        isolators={"a": wr.load_isolator(files[0])}, vary={"mount/m3/isolator": wr.Choice(*files)}, sampling="grid",
        variants=2, duration=0.05,
    )  # fmt: skip
    rows = study.table().to_pylist()
    assert together(study.work, rows).indices.size == 2
    found = table(study, rows)
    for name in ("travel/m3", "static_load/m3"):
        one, other = found[name].to_pylist()
        assert one == 2.0 * other > 0.0
    require_equal(found, table(study, rows, side_by_side=False))


def test_springs_of_joints_vary_side_by_side_too():
    world = deck({"b": 'pos="0 0 0"'}) + (
        '<body name="box"><joint type="slide" axis="0 0 1"/><inertial pos="0 0 0" mass="10" diaginertia="1 1 1"/>'
        '<site name="p"/><body name="rack"><joint name="foot" type="slide" axis="0 0 1" stiffness="4000" damping="10"/>'
        '<inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/></body></body>'
    )
    vary = {"joint/foot/frequency": wr.Uniform(5.0, 20.0), "body/rack/mass": wr.Uniform(1.0, 4.0)}
    study = study_of(
        vary, model=mjcf(world, [("m", "p", "b", "i")], gravity=9.80665),
        isolators={"i": wr.Isolator(name="i", axial=wr.KelvinVoigt(k=2e4, c=50.0))}, initial="unloaded", variants=3,
    )  # fmt: skip
    rows = study.table().to_pylist()
    assert together(study.work, rows).indices.size == 3
    require_equal(table(study, rows), table(study, rows, side_by_side=False))
    for row in rows:
        found = sprung_joints(Maker(study.work.system, study.work.motions, study.work.columns).system(row).model)["foot"]
        assert found == pytest.approx(row["joint/foot/frequency"], rel=1e-12)


@pytest.mark.slow
def test_what_is_too_heavy_says_so_and_leaves_the_others_as_they_are():
    study = study_of(
        {"body/floor/mass": wr.Uniform(0.9, 1.1, relative=True)},
        variants=3,
        isolators=one_scale("wr16_400", "wr12_400"),
    )
    rows = study.table().to_pylist()
    rows[1]["body/floor/mass"] = 1e7
    found = table(study, rows)
    assert found["status"].to_pylist() == ["done", "failed", "done"]
    assert found["message"][1].as_py()
    require_equal(found.take([0, 2]), table(study, [rows[0], rows[2]]))


def test_the_slowest_period_of_a_variant_is_that_of_its_own_system():
    """Found from the numbers in the lanes, so that no system is made to say whether a run is long enough."""
    vary = {**STUDIES["laws of coupled mounts"], **STUDIES["body"], "mount/m*/position_shift/x": wr.Normal(0.0, 0.2, each=True)}
    study = study_of(vary, isolators=one_scale("wr16_400", "wr12_400"))
    rows, make = study.table().to_pylist(), Maker(study.work.system, study.work.motions, study.work.columns)
    own = [slowest_period(make.system(row)) for row in rows]
    assert together(study.work, rows).slowest == pytest.approx(own, rel=1e-9)
    assert np.ptp(own) > 1e-3 * np.mean(own)
