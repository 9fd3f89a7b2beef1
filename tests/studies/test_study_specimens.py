"""Studies of specimens: what a few of them tell, the shipped twins, and the floor that stands on them."""

import dataclasses
import runpy
from pathlib import Path

import numpy as np
import pytest
from test_study import table_study

import wirerope_mj as wr
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts.identification import joint_spread
from wirerope_mj.mounts.identification.specimens import own_parameters
from wirerope_mj.mounts.laws import LAWS, Masing
from wirerope_mj.runs.study import load_study_file
from wirerope_mj.studies.vary.quantities import quantities
from wirerope_mj.studies.vary.sampling import deviation_bounds, known_specimens, rank, specimen_messages

TWINS = catalogue_folder() / "twins" / "five_twins_wr16_400.toml"
BUILD = Path(__file__).parents[2] / "docs" / "specimens" / "build.py"


@pytest.fixture(scope="module")
def twins():
    return wr.load_isolator(TWINS)


@pytest.fixture(scope="module")
def built():
    """Return the script's names, the twins that it makes, and what it finds of them along shear."""
    names = runpy.run_path(str(BUILD))
    origin = wr.load_isolator(names["ORIGIN_FILE"])
    made = names["made"](origin, names["scatter"]())
    return names, made, names["_found"]("shear", origin, [twin.shear for twin in made])


def test_the_twins_say_that_they_are_no_measurement(twins):
    assert twins.provenance.kind == "illustrative"
    assert "no mount was measured" in twins.provenance.source
    assert any("no source" in sentence for sentence in twins.provenance.assumed)


def test_the_shipped_file_is_what_the_script_makes(built, twins):
    names, _, found = built
    # Another processor's last bits, or a search that ends elsewhere in the noise: far below the scatter.
    for row in found.rows:
        assert getattr(twins.shear, row.parameter) == pytest.approx(row.nominal, abs=0.05 * row.deviation)
    places = [twins.spread.parameters.index(f"shear.{row.parameter}") for row in found.rows]
    shipped = np.array(twins.spread.covariance)[np.ix_(places, places)]
    np.testing.assert_allclose(shipped, found.covariance, rtol=0.05)
    assert names["_provenance"]() == twins.provenance


def test_what_was_made_of_the_twins_is_found_again(built):
    _, made, found = built
    rows = {row.parameter: row for row in found.rows}
    for parameter in ("alpha", "k1", "k3"):
        true = np.array([getattr(twin.shear, parameter) for twin in made])
        # 0.2 % of noise; the shape of the loops is shared, and its error common to all.
        np.testing.assert_allclose(rows[parameter].values, true, rtol=0.02)
        assert rows[parameter].deviation == pytest.approx(true.std(ddof=1), rel=0.05)
        assert rows[parameter].fit_error < 0.05 * rows[parameter].deviation


def test_a_larger_loop_is_softer_as_rods_are(built):
    names, *_ = built
    origin = wr.load_isolator(names["ORIGIN_FILE"])
    (large,) = names["made"](origin, np.array([[1.1, 1.0, 1.0]]))
    for axis in ("axial", "shear"):
        x = 0.02 * np.sin(np.linspace(0.0, 10.0, 400))
        ours, theirs = large.axes[axis].trace(1.1 * x), origin.axes[axis].trace(x)
        np.testing.assert_allclose(ours.force, theirs.force / 1.1**2, rtol=0.0, atol=1e-6 * np.abs(theirs.force).max())


def test_the_scatter_of_axes_tested_together_is_kept_together(built):
    *_, found = built
    both = joint_spread({"shear": found, "roll": found})
    n = len(found.rows)
    assert both.parameters[n] == f"roll.{found.rows[0].parameter}"
    covariance = np.array(both.covariance)
    for block in (covariance[:n, :n], covariance[n:, n:], covariance[:n, n:]):  # the same values on both axes here
        np.testing.assert_allclose(block, found.covariance, rtol=1e-9)
    with pytest.raises(ValueError, match="the same specimens on every axis, got none"):
        joint_spread({})


def test_rank_tells_how_many_specimens_there_were(twins):
    assert rank(twins.spread) == 4
    assert known_specimens(twins.spread) == 5
    full = wr.Spread(parameters=("axial.alpha", "axial.n"), covariance=((1e8, 1.0), (1.0, 1e-4)))
    assert known_specimens(full) is None  # any number above two
    still = wr.Spread(parameters=("axial.alpha", "axial.n"), covariance=((1e8, 0.0), (0.0, 0.0)))
    assert rank(still) == 1


def test_bounds_of_a_deviation_are_those_of_the_tables():
    # Chi-squared with 4 degrees of freedom: 0.4844 and 11.143 at 2.5 and 97.5 %.
    assert deviation_bounds(5) == pytest.approx((np.sqrt(4 / 11.143), np.sqrt(4 / 0.4844)), rel=1e-4)
    low, high = deviation_bounds(1000)
    assert low == pytest.approx(1.0, abs=0.05)
    assert high == pytest.approx(1.0, abs=0.05)


def test_other_specimens_scatter_about_those_that_were_tested(twins):
    others = [wr.redrawn(twins, seed=seed) for seed in range(400)]
    assert {rank(one.spread) for one in others[:20]} == {4}
    place = twins.spread.parameters.index("axial.alpha")
    variance = twins.spread.covariance[place][place]
    found = np.array([one.spread.covariance[place][place] for one in others])
    # The covariance of a sample is unbiased, and 4 s^2 / sigma^2 chi-squared: a mean of 4 and a variance of 8, so that the
    # mean of 400 has a standard error of sqrt(8 / 16 / 400) = 3.5 %; their deviation one of about 10 %.
    assert found.mean() == pytest.approx(variance, rel=0.12)
    assert found.std() == pytest.approx(variance / np.sqrt(2.0), rel=0.35)
    means = np.array([one.axial.alpha for one in others])
    # The mean of five; standard errors of 400: 5 % of the deviation, 3.5 % for the deviation itself.
    assert means.mean() == pytest.approx(twins.axial.alpha, abs=4 * 0.05 * np.sqrt(variance / 5.0))
    assert means.std() == pytest.approx(np.sqrt(variance / 5.0), rel=0.15)
    assert wr.redrawn(twins, seed=3) == others[3]


def test_without_spread_or_number_there_is_nothing_to_draw(twins):
    with pytest.raises(ValueError, match="has no \\[spread\\]"):
        wr.redrawn(dataclasses.replace(twins, spread=None), seed=1)
    full = wr.Spread(parameters=("axial.alpha",), covariance=((1e6,),))
    with pytest.raises(ValueError, match="`specimens` must be given"):
        wr.redrawn(dataclasses.replace(twins, spread=full), seed=1)
    assert wr.redrawn(dataclasses.replace(twins, spread=full), seed=1, specimens=3).axial.alpha != twins.axial.alpha


def test_every_mount_of_the_floor_is_a_specimen_of_its_own(twins):
    study = load_study_file("floor_specimens").make(variants=16)
    assert study.base.mounts["m01"].isolator.axial == twins.axial
    assert study.base.mounts["h1"].isolator.axial != twins.axial
    system, row = study.system(5), study.row(5)
    laws = {system.mounts[f"m{number:02d}"].isolator.axial for number in range(1, 17)}
    assert len(laws) == 16
    assert system.mounts["m03"].isolator.shear.k1 == row["mount/m03/shear/k1"]
    (text,) = specimen_messages(study.quantities)
    assert "15 parameters scatter along 4 directions, so they come from 5 specimens" in text
    assert "0.6 to 2.9 times" in text


def test_a_calibrated_spread_is_called_so_and_no_scatter_of_specimens(twins, tmp_path):
    calibrated = dataclasses.replace(twins, spread=dataclasses.replace(twins.spread, calibrated=True))
    calibrated.save(tmp_path / "calibrated.toml")
    read = wr.load_isolator(tmp_path / "calibrated.toml")
    assert read.spread == calibrated.spread
    system = wr.load_system("floating_floor", isolators={"wr16_400": read})
    (text,) = specimen_messages(quantities({"mount/m01/spread": wr.Specimens()}, system, []))
    assert "what its calibration leaves open" in text
    assert "come from" not in text


def test_the_assumed_scatter_of_a_catalogue_part_is_no_scatter_of_specimens():
    system = wr.load_system("floating_floor")
    (text,) = specimen_messages(quantities({"mount/m01/spread": wr.Specimens()}, system, []))
    assert text.startswith("Specimens of Enidine WR16-400 (catalogue): none were tested")


def test_the_floor_takes_the_users_own_specimens(twins, tmp_path):
    spread = wr.Spread(parameters=("axial.alpha",), covariance=((1e8,),))
    own = dataclasses.replace(twins, name="ours", spread=spread)
    own.save(tmp_path / "ours.toml")
    study = load_study_file("floor_specimens").make(isolator=tmp_path / "ours.toml", variants=16, mass=0.0, level=0.0)
    assert study.base.mounts["m16"].isolator.name == "ours"
    assert study.table().num_columns == 1 + 16 + 2  # one parameter of each mount, and the centre of mass
    plain = dataclasses.replace(own, spread=None)
    plain.save(tmp_path / "plain.toml")
    with pytest.raises(wr.ModelError, match="isolator 'ours' of mount 'm01' has no \\[spread\\]"):
        load_study_file("floor_specimens").make(isolator=tmp_path / "plain.toml")


def test_redrawn_studies_differ_and_come_again():
    file = load_study_file("floor_specimens")
    first, again, other = (file.make(variants=16, redraw=redraw) for redraw in (1, 1, 2))
    assert first.table().equals(again.table())
    assert not first.table().equals(other.table())
    assert first.base.mounts["m01"].isolator.axial != other.base.mounts["m01"].isolator.axial


def scattered(law, seed=0):
    """Return an isolator of five laws that differ by 3 %, with what `identify_specimens` would keep of them."""
    factors = 1.0 + 0.03 * np.random.default_rng(seed).standard_normal((5, 20))
    names = [key for key, value in own_parameters(law).items() if value and not key.endswith("_minus")]
    rows = [own_parameters(dataclasses.replace(law, **law.completed(
        {key: factor * law.parameter(key) for key, factor in zip(names, row, strict=False)}
    ))) for row in factors]  # fmt: skip
    values = np.array([list(row.values()) for row in rows])
    spread = wr.Spread(parameters=tuple(f"axial.{key}" for key in rows[0]), covariance=np.cov(values, rowvar=False).tolist())
    return wr.Isolator(name="scattered", axial=law, roll=law, shear=law, spread=spread)


def test_both_limit_curves_of_a_specimen_are_one_where_they_were_in_every_specimen():
    isolator = scattered(LAWS["vaiana-rosati"](kb=3e4, f0=150.0, alpha=300.0, b1=20.0, b2=60.0))
    study = table_study({"mount/m1/spread": wr.Specimens()}, isolators={"wr12_400": isolator}, variants=32)
    study.table()
    drawn = [study.system(variant).mounts["m1"].isolator.axial for variant in range(32)]
    drawn += [wr.redrawn(isolator, seed=seed).axial for seed in range(8)]
    for law in drawn:
        assert law.finite_travel == np.inf
        for key in ("kb", "f0", "alpha", "b1", "b2"):
            assert getattr(law, key) == getattr(law, f"{key}_minus") != getattr(isolator.axial, key)


def test_what_the_specimens_did_not_show_is_not_drawn(twins):
    study = table_study({"mount/m1/spread": wr.Specimens()}, isolators={"wr12_400": twins}, variants=256)
    values = np.array([study.table()[f"mount/m1/{name.replace('.', '/')}"] for name in twins.spread.parameters])
    scales = np.linalg.svd((values.T - values.mean(axis=1)) / values.std(axis=1) / 16.0)[1]
    # Four directions of five specimens; beyond them 1e-15 is rounding, and 1e-8 what roots of rounded eigenvalues would leave.
    assert scales[3] > 0.05  # the fourth is 0.07 of the scatter
    assert scales[4:].max() < 1e-13


def test_elements_of_a_masing_law_scatter_and_vary():
    law = Masing(stiffness=(6e4, 4e4), slip_force=(60.0, 100.0), k=2e4)
    isolator = scattered(law)
    assert isolator.spread.parameters[0] == "axial.stiffness[0]"
    shared = {"isolators": {"wr12_400": isolator}, "variants": 8}
    study = table_study({"mount/m1/spread": wr.Specimens()}, **shared)
    row = study.table().to_pylist()[3]
    drawn = study.system(3).mounts["m1"].isolator.axial
    assert drawn.stiffness == (row["mount/m1/axial/stiffness[0]"], row["mount/m1/axial/stiffness[1]"])
    assert drawn.slip_force[1] == row["mount/m1/axial/slip_force[1]"] != 100.0
    again = wr.redrawn(isolator, seed=1).axial
    assert again.stiffness[1] != 4e4
    one = table_study({"mount/m1/axial/slip_force[1]": wr.Uniform(0.9, 1.1, relative=True)}, **shared)
    factor = one.table()["mount/m1/axial/slip_force[1]"][0].as_py()
    assert one.system(0).mounts["m1"].isolator.axial.slip_force == (60.0, 100.0 * factor)
    with pytest.raises(ValueError, match=r"'mount/m1/axial/slip_force' is all the numbers of which 'mount/\*/axial/slip_f"):
        table_study({f"mount/{name}": wr.Uniform(0.9, 1.1, relative=True)
                     for name in ("m1/axial/slip_force", "*/axial/slip_force[1]")}, **shared)  # fmt: skip
    with pytest.raises(wr.ModelError, match=r"no parameter 'slip_force\[2\]'"):
        table_study({"mount/m1/axial/slip_force[2]": wr.Uniform(0.9, 1.1, relative=True)}, **shared)
