"""Values, shifts and factors of a study: the name says which is meant, and what looks like another is not taken silently."""

import json
import shutil
import tomllib

import house
import numpy as np
import pyarrow.parquet as pq
import pytest
import tomli_w
from genset import CENTRE, genset_study, genset_text
from table_study import rows, table_study

import wirerope_mj as wr
from wirerope_mj.content.study import varied_table
from wirerope_mj.content.study_statements import statements
from wirerope_mj.runs.study import what_can_vary, write_study_report
from wirerope_mj.studies.folder import TABLE
from wirerope_mj.studies.inputs_file import STUDY, identity
from wirerope_mj.studies.results.study_summary import summary_of
from wirerope_mj.studies.results.varied import varied_of
from wirerope_mj.studies.vary.vary_option import read_vary
from wirerope_mj.views.terminal import print_table

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

VALUE = {"body/genset/centre/z": wr.Normal(CENTRE, 0.03)}
SHIFT = {"body/genset/centre_shift/z": wr.Normal(0.0, 0.03)}
OLD = {"body/genset/centre/z": wr.Normal(0.0, 0.03)}


def heights(study):
    return [float(study.system(n).model.body("genset").ipos[2]) for n in range(study.size)]


def cells(vary, **others):
    """Return the rows of the table of what varies, by name."""
    return {row[0]: row[1:] for row in varied_table(genset_study(vary, variants=2, **others)).rows}


def test_a_position_and_its_shift_are_the_same_variants():
    value, shift = genset_study(VALUE, variants=16), genset_study(SHIFT, variants=16)
    assert heights(value) == pytest.approx(np.asarray(value.table()["body/genset/centre/z"]), abs=1e-15)
    assert heights(shift) == pytest.approx(heights(value), abs=1e-15)  # two roundings of numbers below 1
    assert np.mean(heights(value)) == pytest.approx(CENTRE, abs=0.01)  # 16 balanced points of a deviation of 0.03


@pytest.mark.slow
def test_the_genset_leaves_its_travel_as_often_whichever_way_its_centre_is_said(tmp_path):
    value = genset_study(VALUE).run(tmp_path / "value")
    shift = genset_study(SHIFT).run(tmp_path / "shift")
    a, b = (np.asarray(one.table["travel"]) for one in (value, shift))
    np.testing.assert_allclose(a, b, rtol=1e-9)  # positions that differ by 1e-16 m, over 4000 steps of a smooth motion
    found = value.exceedance("travel")
    assert found == shift.exceedance("travel")
    assert (found.count, found.n) == (25, 500)
    assert (found.low, found.high) == pytest.approx((0.0326, 0.0729), abs=5e-5)  # Clopper-Pearson of 25 in 500


def test_a_position_that_looks_like_a_shift_is_refused_and_both_names_are_said():
    with pytest.raises(ValueError, match=r"centre/z' is the position .* 0\.35 m .*say 'body/genset/centre_shift/z'"):
        genset_study(OLD)
    with pytest.raises(ValueError, match=r"with shifts that bring it there, -0\.34 m"):
        genset_study({"body/genset/centre/z": wr.Uniform(0.0, 0.02)})
    with pytest.raises(ValueError, match="values around 0.01 m"):
        genset_study({"body/genset/centre/z": wr.Choice(0.0, 0.01, 0.02)})


def test_a_centre_that_stands_at_the_origin_may_be_said_either_way():
    value, shift = (
        genset_study({f"body/genset/{one}/x": wr.Normal(0.0, 0.02)}, variants=4) for one in ("centre", "centre_shift")
    )
    for n in range(4):
        assert value.system(n).model.body("genset").ipos[0] == shift.system(n).model.body("genset").ipos[0] != 0.0


def test_a_shift_that_looks_like_a_position_is_warned_of():
    study = genset_study({"body/genset/centre_shift/z": wr.Normal(CENTRE, 0.03)}, variants=64)
    with pytest.warns(wr.StudyWarning, match=r"is a shift, .* of what stands at 0\.35 m .* say 'body/genset/centre/z'"):
        study.table()
    study = genset_study({"mount/m3/position_shift/x": wr.Uniform(0.75, 0.85)}, variants=4)
    with pytest.warns(wr.StudyWarning, match=r"m3/position_shift/x is a shift, .* of what stands at 0\.8 m"):
        study.table()


def test_the_old_name_of_a_mounts_shift_is_refused_with_todays():
    with pytest.raises(wr.ModelError, match=r"'mount/m1/position/x'.*shifts \[m\].*'mount/m1/position_shift/x'"):
        genset_study({"mount/m1/position/x": wr.Normal(0.0, 0.01)})


def test_a_value_meant_where_a_factor_is_said_is_warned_of():
    study = genset_study({"body/genset/mass": wr.Normal(1200.0, 60.0, relative=True)}, variants=4)
    with pytest.warns(wr.StudyWarning, match="mass is a factor, from .* on 1200 kg in the model; .* leave out `relative`"):
        study.table()


TURNED = house.mjcf(
    house.deck({"b": 'pos="0 0 .2"'})
    + '<body name="box" pos="0 0 .2" euler="0 90 0"><freejoint/><inertial pos=".1 0 .05" mass="3" diaginertia=".1 .2 .2"/>'
    + '<geom size=".1"/><site name="p"/></body>'
    + '<body name="lid" pos="0 0 .5"><freejoint/><inertial pos="0 0 .02" mass="1" diaginertia=".1 .1 .1"/></body>',
    [("m1", "p", "b", "enidine_wr12_400")],
)


def turned_study(vary, **others):
    return table_study(
        vary=vary, model=TURNED, variants=2, motion=wr.HalfSine(peak=10.0, duration=0.011, direction="z"), **others
    )


def test_a_centre_is_said_in_the_bodys_axes_and_a_shift_of_it_in_the_worlds():
    value = turned_study({"body/box/centre/x": wr.Uniform(0.08, 0.12)})
    for n in range(2):
        where = value.row(n)["body/box/centre/x"]
        # The body's x points down in the world: the shift goes there and back through a rotation.
        assert value.system(n).model.body("box").ipos == pytest.approx([where, 0.0, 0.05], abs=1e-16)
    shift = turned_study({"body/box/centre_shift/z": wr.Uniform(-0.01, 0.01)})
    assert shift.system(0).model.body("box").ipos[0] == pytest.approx(0.1 - shift.row(0)["body/box/centre_shift/z"], abs=1e-16)
    said = {one.name: one.model for study in (value, shift) for one in varied_of(study)}
    assert said == {"body/box/centre/x": "0.1 m", "body/box/centre_shift/z": "shifted from -0.1 m"}


@pytest.mark.parametrize(
    ("old", "new"),
    [("<freejoint/>", '<freejoint align="true"/>'), ("<mujoco>", '<mujoco><compiler alignfree="true"/>')],
)
def test_a_body_whose_origin_mujoco_has_moved_into_its_centre_takes_shifts_alone(old, new):
    model = genset_text().replace(old, new)
    with pytest.raises(ValueError, match="has moved the origin of body 'genset' .* say shifts: 'body/genset/centre_shift/z'"):
        genset_study(VALUE, variants=2, model=model)
    moved = genset_study(SHIFT, variants=2, model=model)
    assert heights(moved) == pytest.approx(np.asarray(moved.table()["body/genset/centre_shift/z"]), abs=1e-15)


def test_one_position_for_bodies_that_stand_apart_and_two_ways_for_one_body_are_refused():
    with pytest.raises(ValueError, match=r"one position for bodies .* 0\.02 to 0\.05 m .*name one body, or say shifts"):
        turned_study({"body/box,lid/centre/z": wr.Uniform(0.02, 0.05)})
    both = {"body/box/centre/z": wr.Normal(0.05, 0.01), "body/box/centre_shift/x": wr.Normal(0.0, 0.01)}
    with pytest.raises(ValueError, match="is a position and .*centre_shift/x' a shift of the same body 'box'"):
        turned_study(both)
    with pytest.raises(ValueError, match=r"is a position \[m\] and cannot be relative"):
        turned_study({"body/box/centre/z": wr.Normal(1.0, 0.1, relative=True)})


def test_kind_unit_and_nominal_value_stand_beside_every_distribution():
    vary = {
        "mount/*/axial/laws[0].k1": wr.Normal(3e5, 1e4), "mount/m[12]/position_shift/x": wr.Normal(0.0, 0.01, each=True),
        "body/genset/mass": wr.Uniform(0.9, 1.1, relative=True), "motion/elevation": wr.Isotropic(low=0.0),
        "mount/m2/fitted": wr.Choice(True, False), "mount/m*/failed": wr.Choice("", "m1"),
    }  # fmt: skip
    found = cells({**VALUE, **vary})
    assert found["body/genset/centre/z"] == (
        "value [m]",
        "0.35 m",
        "normal, mean 0.35, standard deviation 0.03",
        "common",
    )
    assert cells(SHIFT)["body/genset/centre_shift/z"][:3] == (
        "shift [m]",
        "shifted from 0.35 m",
        "normal, mean 0, standard deviation 0.03",
    )
    assert found["mount/*/axial/alpha"][:2] == ("factor", "1")
    assert found["mount/*/axial/laws[0].k1"][:2] == ("value [SI]", "2.772e+05")
    assert found["mount/m[12]/position_shift/x"][:2] == ("shift [m]", "shifted from -0.8 to 0 m")
    assert found["mount/m[12]/position_shift/x"][3] == "independent per mount"
    assert found["body/genset/mass"][:2] == ("factor", "1200 kg")
    assert found["motion/level"][:2] == ("factor", "1")
    assert found["motion/elevation"][:2] == ("value [°]", "16.7 °")  # atan 0.3
    assert found["mount/m2/fitted"][:2] == ("choice", "True")
    assert found["mount/m*/failed"][:2] == ("choice", "-")


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    return genset_study(SHIFT, variants=16).run(tmp_path_factory.mktemp("genset") / "study", workers=1)


def test_the_screen_the_page_the_summary_and_labels_say_what_stands_in_the_model(done, capsys, tmp_path):
    print_table(varied_table(done.study))
    out = capsys.readouterr().out
    for words in ("body/genset/centre_shift/z", "shift [m]", "0.35 m", "in the model"):
        assert words in out
    (page,) = write_study_report(done.folder, out=tmp_path / "page.html")
    assert "0.35 m" in page.read_text(encoding="utf-8")
    assert varied_table(done.study).rows[0][1:3] == ("shift [m]", "shifted from 0.35 m")
    varied = json.loads((done.folder / "summary.json").read_text(encoding="utf-8"))["varied"]
    assert varied[0] == {
        "name": "body/genset/centre_shift/z", "kind": "shift", "unit": "m", "nominal": CENTRE, "nominal_unit": "m",
        "distribution": "normal, mean 0, standard deviation 0.03",
    }  # fmt: skip
    labels = summary_of(done).labels
    assert labels["body/genset/centre_shift/z"] == "body genset centre_shift z [m]"
    assert labels["mount/m1/axial/alpha"] == "mount m1 axial alpha [factor]"


def test_the_listing_says_kinds_units_and_centres():
    text = what_can_vary(
        wr.Scenario(question="?", model=TURNED, simulate={}, motion=wr.HalfSine(peak=1.0, duration=0.01, direction="z"))
    )
    for words in (
        "box: 3 kg, centre (0.1, 0, 0.05) m", "body/NAME/mass  value [kg] or factor",
        "body/NAME/centre/AXIS  value [m] along the body's x, y, z",
        "body/NAME/centre_shift/AXIS  shift [m] along the world's x, y, z",
        "mount/NAME/position_shift/AXIS  shift [m] along the world's x, y, z",
        "axial/laws[0].PARAMETER  value [SI] or factor; ",
        "motion/level  factor",
    ):  # fmt: skip
        assert words in text


@pytest.fixture
def of_format_1(done, tmp_path):
    """Return the folder of a study as it was written before shifts were called so."""
    folder = tmp_path / "old"
    shutil.copytree(done.folder, folder)
    content = tomllib.loads((folder / STUDY).read_text(encoding="utf-8"))
    content["format"] = 1
    content["vary"][0]["name"] = "body/genset/centre/z"
    del content["id"]
    text = tomli_w.dumps({"id": identity(content), **content})
    (folder / STUDY).write_text(text, encoding="utf-8")
    table = pq.read_table(folder / TABLE)
    names = [name.replace("centre_shift", "centre") for name in table.column_names]
    pq.write_table(table.rename_columns(names), folder / TABLE)
    return folder


def test_a_folder_whose_centre_was_a_shift_is_read_as_one(of_format_1, done):
    old = wr.load_study(of_format_1)
    assert rows(old.table) == rows(done.table)
    assert old.study.table().equals(done.study.table())
    assert old.exceedance("travel") == done.exceedance("travel")
    assert heights(old.study) == heights(done.study)
    page, *_ = write_study_report(of_format_1)
    assert "body/genset/centre_shift/z" in page.read_text(encoding="utf-8").replace("<wbr>", "")


def test_a_folder_whose_centre_was_a_shift_does_not_go_on(of_format_1):
    with pytest.raises(wr.RecordError, match="an earlier version wrote .* `centre` and `position` were .* shifts"):
        genset_study(SHIFT, variants=16).run(of_format_1, resume=True)


def test_a_measure_that_does_not_exist_is_a_value_error_with_a_limit_of_its_own_too(done):
    with pytest.raises(ValueError, match="there is no measure 'relative/top'; there are acceleration"):
        done.exceedance("relative/top", 0.03)
    with pytest.raises(ValueError, match="`limit` must be a finite number, got nan"):
        done.exceedance("travel", float("nan"))


def test_a_group_is_a_word_with_or_without_quotes():
    (bare,), (quoted,) = (read_vary([f"a = Normal(1, 0.1, group={word})"]).values() for word in ("axial", "'axial'"))
    assert bare == quoted == wr.Normal(1.0, 0.1, group="axial")
    with pytest.raises(ValueError, match="'axial' must be a number"):
        read_vary(["a = Normal(1, 0.1, low=axial)"])


def test_a_body_that_stands_turned_is_told_without_an_axis_of_the_other_kind():
    with pytest.raises(ValueError, match="'body/box/centre_shift/AXIS', along the world's axes"):
        turned_study({"body/box/centre/z": wr.Normal(0.0, 0.001)})


def test_values_about_1_of_what_is_far_from_1_are_warned_of():
    with pytest.warns(wr.StudyWarning, match="factors on the model's value, say `relative`"):
        table_study(vary={"body/block/mass": wr.Normal(1.0, 0.1)}, variants=4).table()


def test_the_driven_base_has_no_mass_that_could_matter():
    with pytest.raises(wr.ModelError, match=r"no moving body with a mass .*'table'. There is: block"):
        table_study(vary={"body/table/mass": wr.Normal(1.0, 0.1, relative=True)}, variants=4)


@pytest.mark.slow
def test_a_study_says_in_how_many_variants_stops_were_struck(tmp_path, capsys):
    levels = wr.Choice([1.0, 6.0])
    result = table_study(vary={"motion/level": levels}, variants=2, sampling="grid", timestep=2.5e-4, duration=0.2).run(
        tmp_path / "study"
    )
    struck = np.asarray(result.table["struck"])
    assert sorted(struck > 0.0) == [False, True]
    (sentence,) = [one for one in statements(result) if one.startswith("Stops are struck in 1 of 2 variants")]
    assert "depend on stiffness and damping of the stops" in sentence
    assert json.loads((result.folder / "summary.json").read_text())["struck"] == 1
