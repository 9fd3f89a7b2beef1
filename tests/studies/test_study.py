"""What a study says before it runs: names, distributions, samples, and what cannot be."""

import dataclasses
import re
from statistics import NormalDist

import numpy as np
import pytest
import scipy.stats
from one_scale import one_scale

import wirerope_mj as wr
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.studies import definition
from wirerope_mj.studies.results.varied import distribution_text
from wirerope_mj.studies.vary.distributions import distribution_from_dict, distribution_to_dict

G = wr.STANDARD_GRAVITY
PULSE = wr.HalfSine(peak=10.0 * G, duration=0.011, direction="z", start=0.01)
WHOLE = {"duration": 0.05, "timestep": 1e-3, "motion": PULSE}


def table_study(vary, **others):
    return wr.Study(**{"model": "shock_table.xml", "variants": 8, "vary": vary, **WHOLE, **others})


def floor_study(vary, **others):
    return table_study(vary, **{"model": "floating_floor.xml", **others})


def values(study, name):
    return np.asarray(study.table()[name])


def unbent():
    law = wr.BoucWen(alpha=1e5, beta=75.0, gamma=0.0, n=1.0, k=2e4)
    return {"wr12_400": wr.Isolator(name="unbent", axial=law, roll=law, shear=law)}


def with_spread():
    """An isolator whose axial stiffness and sharpness scatter together, by 0.8; not coupled, for then n may not differ."""
    isolator = one_scale("wr16_400")["wr16_400"]
    a, n = 0.05 * isolator.axial.alpha, 0.02
    spread = wr.Spread(parameters=("axial.alpha", "axial.n"), covariance=((a * a, 0.8 * a * n), (0.8 * a * n, n * n)))
    return dataclasses.replace(isolator, spread=spread, coupling=None, loop=None)


def test_a_normal_distribution_has_its_mean_and_deviation():
    study = table_study({"mount/m1/axial/alpha": wr.Normal(1.0, 0.1, relative=True)}, variants=4096)
    found = values(study, "mount/m1/axial/alpha")
    # Sobol points: the error of a mean falls like 1/n; 4096 of them gave 2e-6 and 3e-4 of the deviation
    assert found.mean() == pytest.approx(1.0, abs=1e-4)
    assert found.std() == pytest.approx(0.1, rel=2e-3)


def test_a_normal_distribution_that_is_cut_off_stays_within_and_keeps_its_shape():
    found = wr.Normal(2.0, 1.0, low=1.0, high=2.0).values(np.array([0.0, 0.5, 1.0]))
    assert found[0] == pytest.approx(1.0, abs=1e-12)
    assert found[2] == pytest.approx(2.0, abs=1e-12)
    # half of the probability that lies between mean - deviation and mean
    normal = NormalDist()
    assert found[1] == pytest.approx(2.0 + normal.inv_cdf(0.5 * (normal.cdf(-1.0) + 0.5)), abs=1e-9)


@pytest.mark.parametrize("sampling", ["sobol", "latin-hypercube", "random"])
def test_samples_are_the_same_again_and_others_with_another_seed(sampling):
    vary = {"body/block/mass": wr.Uniform(40.0, 60.0), "motion/level": wr.Uniform(0.5, 1.5)}
    first, again, other = (table_study(vary, sampling=sampling, seed=seed).table() for seed in (3, 3, 4))
    assert first.equals(again)
    assert not first.equals(other)
    assert first.column_names == ["variant", "body/block/mass", "motion/level"]


def test_the_first_variants_of_a_larger_study_are_those_of_a_smaller_one():
    vary = {"motion/level": wr.Normal(1.0, 0.2)}
    assert table_study(vary, variants=30).table().slice(0, 7).equals(table_study(vary, variants=7).table())


@pytest.mark.parametrize(
    ("sampling", "variants"),
    [("sobol", 100), ("latin-hypercube", 100), ("random", 100), ("sobol-indices", 128), ("grid", None), ("list", None)],
)
def test_inputs_drawn_block_by_block_are_those_drawn_at_once(sampling, variants, monkeypatch):
    vary = {"body/block/mass": wr.Uniform(40.0, 60.0, points=12), "motion/level": wr.Uniform(0.5, 1.5, points=12)}
    whole = table_study(vary, sampling=sampling, variants=variants)
    monkeypatch.setattr(definition, "BLOCK", 7)
    blocks = table_study(vary, sampling=sampling, variants=variants)
    assert blocks.table().equals(whole.table())
    assert blocks.rows(5, 4).equals(whole.table().slice(5, 4))
    assert blocks.row(8) == whole.row(8)
    assert list(blocks._extreme_motions()) == list(whole._extreme_motions())


def test_a_latin_hypercube_has_one_sample_in_every_slice():
    study = table_study({"motion/level": wr.Uniform(1.0, 2.0)}, variants=50, sampling="latin-hypercube")
    assert sorted(np.floor((values(study, "motion/level") - 1.0) * 50.0)) == list(range(50))


def test_a_grid_holds_all_combinations():
    vary = {"motion/level": wr.Uniform(0.5, 1.5, points=3), "mount/m1/failed": wr.Choice(False, True)}
    study = table_study(vary, sampling="grid", variants=None)
    assert study.size == 6
    assert values(study, "motion/level").tolist() == [0.5, 0.5, 1.0, 1.0, 1.5, 1.5]
    assert study.table()["mount/m1/failed"].to_pylist() == [False, True] * 3


def test_a_group_shares_one_sample_or_each_has_its_own():
    single = {"isolators": one_scale("wr16_400")}
    shared = floor_study({"mount/m0?/axial/alpha": wr.Normal(1.0, 0.1, relative=True)}, **single)
    assert shared.table().column_names == ["variant", "mount/m0?/axial/alpha"]
    own = floor_study({"mount/m0?/axial/alpha": wr.Normal(1.0, 0.1, relative=True, each=True)}, **single)
    assert own.table().column_names == ["variant", *(f"mount/m0{n}/axial/alpha" for n in range(1, 10))]
    for study in (shared, own):
        system, base, row = study.system(3), study.base, study.row(3)
        for name in ("m01", "m09"):
            factor = row.get(f"mount/{name}/axial/alpha", row.get("mount/m0?/axial/alpha"))
            nominal = base.mounts[name].isolator.axial
            assert system.mounts[name].isolator.axial == dataclasses.replace(nominal, alpha=factor * nominal.alpha)
        assert system.mounts["m10"].isolator == base.mounts["m10"].isolator


def test_masses_centres_and_positions_are_those_of_the_row():
    vary = {
        "body/floor/mass": wr.Uniform(1000.0, 3000.0), "body/floor/centre_shift/y": wr.Normal(0.0, 0.02),
        "mount/m1?/position_shift/z": wr.Uniform(-1e-3, 1e-3, each=True),
    }  # fmt: skip
    study = floor_study(vary)
    system, base, row = study.system(5), study.base, study.row(5)
    body, nominal = system.model.body("floor"), base.model.body("floor")
    assert body.mass[0] == pytest.approx(row["body/floor/mass"], rel=1e-15)
    assert (body.ipos - nominal.ipos)[1] == pytest.approx(row["body/floor/centre_shift/y"], rel=1e-12)
    shift = system.mounts["m13"].position - base.mounts["m13"].position
    np.testing.assert_allclose(shift, [0.0, 0.0, row["mount/m13/position_shift/z"]], atol=1e-15)


def test_level_and_direction_make_the_motion():
    vary = {
        "motion/level": wr.Choice(2.0), "motion/azimuth": wr.Choice(90.0), "motion/elevation": wr.Choice(30.0),
    }  # fmt: skip
    study = table_study(vary, sampling="grid", variants=None)
    middle = study.motion(0).acceleration(0.0155)[0]
    np.testing.assert_allclose(middle, 20.0 * G * np.array([0.0, np.sqrt(0.75), 0.5]), atol=1e-9)


def test_a_record_is_chosen_among_several():
    motions = [PULSE, wr.Scaled(PULSE, 3.0)]
    study = table_study({"motion/record": wr.Choice(0, 1)}, motion=None, motions=motions, sampling="grid", variants=None)
    assert [study.motion(n) for n in range(2)] == motions


def test_specimens_scatter_together():
    vary = {"mount/m*/spread": wr.Specimens()}
    study = floor_study(vary, variants=2048, isolators={"wr16_400": with_spread()})
    alpha, n = values(study, "mount/m07/axial/alpha"), values(study, "mount/m07/axial/n")
    # 2048 points in 32 dimensions: the standard error of a correlation of 0.8 is 0.36 / sqrt(2048) = 0.008
    assert np.corrcoef(alpha, n)[0, 1] == pytest.approx(0.8, abs=0.03)
    assert alpha.std() / alpha.mean() == pytest.approx(0.05, rel=0.05)
    assert n.mean() == pytest.approx(1.0, abs=0.002)
    assert abs(np.corrcoef(alpha, values(study, "mount/m08/axial/alpha"))[0, 1]) < 0.1
    system = study.system(4)
    assert system.mounts["m07"].isolator.axial.alpha == alpha[4]


def test_what_has_failed_carries_nothing_and_the_others_carry_its_share():
    vary = {"mount/m*/failed": wr.Choice("", "m06")}
    study = floor_study(vary, sampling="grid", variants=None)
    sound, broken = (wr.equilibrium(study.system(n)).mounts for n in range(2))
    assert sound["m06"].force[2] < -1000.0
    assert abs(broken["m06"].force).max() < 1e-6
    assert broken["m07"].force[2] < sound["m07"].force[2]
    assert sum(m.force[2] for name, m in broken.items() if name.startswith(("m", "r"))) < -30000.0


@pytest.mark.parametrize(
    ("vary", "message"),
    [
        ({"mount/x*/axial/alpha": wr.Normal(1, 0.1)}, "there is no mount 'x\\*'. There is: m1"),
        (
            {"mount/m1/axial/height": wr.Normal(1, 0.1)},
            r"has 2 laws on its axial axis; name a parameter of one, laws\[0\]",
        ),
        (
            {"mount/m1/heave/alpha": wr.Normal(1, 0.1)},
            "there is no quantity 'mount/m1/heave/alpha'. What can vary: mount",
        ),
        ({"body/table/height": wr.Normal(1, 0.1)}, "there is no quantity 'body/table/height'"),
        ({"body/box/mass": wr.Normal(1, 0.1)}, "there is no moving body with a mass .*'box'. There is: block"),
        ({"motion/speed": wr.Normal(1, 0.1)}, "there is no quantity 'motion/speed'"),
        ({"mount/m1/failed": wr.Choice("m2")}, "there is no mount 'm2' there; choose from"),
        ({"mount/m1/position_shift/w": wr.Normal(0, 0.1)}, "there is no axis 'w'; there are x, y, z"),
    ],
)
def test_a_name_that_does_not_exist_is_refused_with_what_does(vary, message):
    with pytest.raises(wr.ModelError, match=message):
        table_study(vary)


@pytest.mark.parametrize(
    ("pattern", "parameter", "expected"),
    [
        ("*", "alpha", ["m1"]),  # the four stops have none, and are not meant
        ("s*", "k", ["s1", "s2", "s3", "s4"]),
        ("s[12]", "gap_below", ["s1", "s2"]),
        ("s3", "k", ["s3"]),
    ],
)
def test_a_pattern_means_stops_only_where_it_matches_nothing_else(pattern, parameter, expected):
    study = table_study({f"mount/{pattern}/axial/{parameter}": wr.Normal(1.0, 0.1, relative=True, each=True)})
    columns = [name for name in study.table().column_names if name.startswith("mount/")]
    assert columns == [f"mount/{mount}/axial/{parameter}" for mount in expected]


def test_an_isolator_without_spread_has_no_specimens():
    bare = dataclasses.replace(wr.load_isolator(models_folder() / "isolators/enidine_wr12_400.toml"), spread=None)
    with pytest.raises(wr.ModelError, match="of mount 'm1' has no \\[spread\\]"):
        table_study({"mount/m1/spread": wr.Specimens()}, isolators={"wr12_400": bare})


@pytest.mark.parametrize("parameter", ["k", "laws", "laws[1]", "laws[2].k"])
def test_of_laws_in_parallel_one_is_named(parameter):
    laws = [wr.KelvinVoigt(k=1e5, c=1e2), wr.Stop(gap_below=0.03, k=1e6)]
    isolators = {"wr12_400": wr.Isolator(name="a", axial=wr.Parallel(laws=laws))}
    vary = {f"mount/m1/axial/{parameter}": wr.Normal(1, 0.1, relative=True)}
    with pytest.raises(wr.ModelError, match=r"mount 'm1' has 2 laws on its axial axis; name a parameter of one, laws\[0\]"):
        table_study(vary, isolators=isolators)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: wr.Uniform(1.1, 0.9), "`low` must be less than `high`, got 1.1 and 0.9"),
        (lambda: wr.Normal(1.0, 0.0), "`deviation` must be > 0"),
        (lambda: wr.Normal(0.0, 1.0, low=38.0), "no value lies more than 37 standard deviations from its mean 0"),
        (lambda: wr.Normal(0.0, 1.0, high=-38.0), "must leave something of the distribution"),
        (lambda: table_study({"motion/azimuth": wr.Isotropic()}), "cannot be Isotropic; it is for motion/elevation"),
        (lambda: wr.Isotropic(low=-91.0), "must be from -90 to 90 degrees, got -91 and 90"),
        (lambda: wr.Isotropic(low=10.0, high=10.0), "`low` must be less than `high`"),
        (lambda: wr.Normal(1.0, np.nan), "`deviation` must be a finite number"),
        (lambda: wr.Choice(), "at least one value"),
        (lambda: wr.Choice(1.0, "m1"), "must all be numbers, booleans or strings"),
        (lambda: table_study({}), "`vary` must name at least one quantity"),
        (lambda: table_study({"motion/level": wr.Uniform(1, 2)}, variants=0), "`variants` must be an integer >= 1"),
        (lambda: table_study({"motion/level": wr.Uniform(1, 2)}, variants=None), "`variants` must be an integer"),
        (lambda: table_study({"motion/level": wr.Uniform(1, 2)}, sampling="halton"), "`sampling` must be one of 'sobol'"),
        (lambda: table_study({"motion/level": wr.Uniform(1, 2)}, sampling="grid"), "has no values for a grid"),
        (lambda: table_study({"motion/level": wr.Uniform(1, 2)}, motion=None), "either `motion` or `motions`"),
        (lambda: table_study({"motion/level": wr.Uniform(1, 2)}, motion=None, motions=[PULSE] * 2), "has no .*record"),
        (lambda: table_study({"motion/record": wr.Choice(0, 1)}), "there is one record, 0, got \\[0, 1\\]"),
        (lambda: table_study({"mount/m1/axial/gamma": wr.Normal(1, 0.1, relative=True)}, isolators=unbent()),
         "'mount/m1/axial/gamma' is 0 in the model, and 0 times anything is 0; give absolute values"),
        (lambda: table_study({"motion/level": wr.Choice(True)}), "must be a distribution of numbers"),
        (lambda: table_study({"motion/level": wr.Uniform(1, 2)}, duration=0.0), "`duration` must be > 0"),
        (lambda: table_study({"motion/level": wr.Uniform(1, 2)}, initial="rest"), "`initial` must be one of 'settled'"),
        (lambda: table_study({"mount/m1/axial/alpha": 1.1}), "must be a Normal, Uniform, Isotropic, Choice or Specimens"),
        (
            lambda: table_study(
                {"mount/*/axial/n": wr.Uniform(1, 1.2), "mount/m1/axial/n": wr.Uniform(1, 1.2)}
            ),
            "both say 'mount/m1/axial/n'",
        ),
    ],
)  # fmt: skip
def test_what_is_out_of_range_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_a_system_is_no_model_of_a_study():
    with pytest.raises(wr.ModelError, match="`model` must be a path, the name of a shipped model or MJCF text, got a System"):
        wr.Study(
            model=wr.load_system("shock_table"), motion=wr.VelocityStep(velocity=1.0, direction="z"), duration=0.1, vary={}
        )


def test_a_value_outside_a_laws_range_names_the_variant_before_anything_is_written(tmp_path):
    study = table_study({"mount/m1/axial/alpha": wr.Normal(1.0, 0.7, relative=True)}, variants=64)
    negative = int(np.argmax(np.asarray(study.rows(0, 64)["mount/m1/axial/alpha"]) <= 0.0))
    message = re.escape(f"variant {negative} of study 'study' cannot be: mount 'm1': [axial] `alpha` must be > 0, got -")
    message += r"[\d.]+: the law would not be passive\. `low=` cuts the distribution of mount/m1/axial/alpha off\."
    with pytest.raises(wr.ModelError, match=message):
        study.table()
    with pytest.raises(wr.ModelError, match=message):
        study.run(tmp_path / "study")
    assert not (tmp_path / "study").exists()


def test_a_direction_without_a_slide_and_a_level_of_zero_cannot_be():
    motion = dataclasses.replace(PULSE, direction="x")
    with pytest.raises(wr.ModelError, match="variant 1 .* cannot be: motion/level must be finite and not zero, got 0.0"):
        table_study({"motion/level": wr.Choice(1.0, 0.0)}, sampling="grid", variants=None, motion=motion).table()
    sdof = {"model": "sdof_shaker.xml", "sampling": "grid", "variants": None}
    with pytest.raises(wr.ModelError, match="variant 0 .* cannot be: the motion moves along x and"):
        table_study({"motion/azimuth": wr.Choice(30.0)}, **sdof).table()


@pytest.mark.parametrize(
    ("low", "high"),
    [(3.0, None), (7.5, None), (8.5, None), (8.5, 20.0), (-20.0, -8.5), (None, -8.5), (8.2, 8.4), (36.0, None)],
)
def test_the_tail_of_a_normal_distribution_is_that_of_its_integral(low, high):
    shares = np.array([0.0, 1e-3, 0.5, 0.999, 1.0 - 2.0**-53, 1.0])
    values = wr.Normal(5.0, 2.0, **{k: 5.0 + 2.0 * v for k, v in (("low", low), ("high", high)) if v is not None}).values(
        shares
    )
    assert np.isfinite(values).all()
    exact = scipy.stats.truncnorm(low or -np.inf, high or np.inf, loc=5.0, scale=2.0)
    np.testing.assert_allclose(values[1:4], exact.ppf(shares[1:4]), rtol=1e-13)
    assert (np.diff(values) >= 0.0).all()


def test_a_value_has_the_same_bits_however_many_there_are():
    shares = np.random.default_rng(1).random(1000)
    for distribution in (wr.Normal(0.0, 1.0), wr.Normal(0.0, 1.0, low=2.0), wr.Isotropic(low=-30.0)):
        values = distribution.values(shares)
        assert all(distribution.values(shares[:size])[-1] == values[size - 1] for size in (1, 2, 3, 7, 500))


def test_isotropic_directions_are_equally_likely_over_the_sphere():
    # Bands of equal height have equal areas on a sphere (Archimedes); 4096 points of a regular series: one more or less.
    shares = (np.arange(4096) + 0.5) / 4096
    heights = np.sin(np.radians(wr.Isotropic().values(shares)))
    assert np.histogram(heights, bins=8, range=(-1.0, 1.0))[0] == pytest.approx(512, abs=1)
    above = wr.Isotropic(low=0.0, high=90.0).values(np.array([0.0, 0.5, 1.0]))
    np.testing.assert_allclose(above, [0.0, 30.0, 90.0], atol=1e-5)  # asin is steep at 1: a root of rounding
    assert distribution_from_dict(distribution_to_dict(wr.Isotropic(low=5.0))) == wr.Isotropic(low=5.0)


def test_every_distribution_is_said_in_words():
    drawn = {
        wr.Normal(1.0, 0.1): "normal, mean 1, standard deviation 0.1",
        wr.Normal(1.0, 0.1, low=0.5): "normal, mean 1, standard deviation 0.1, from 0.5",
        wr.Uniform(0.0, 1.0): "uniform, from 0 to 1",
        wr.Isotropic(low=0.0): "directions equally likely over the sphere, from 0 to 90 above the horizon",
        wr.Choice(1.0, 2.0): "one of 1, 2",
        wr.Specimens(): "scatter that the isolator's file states",
    }
    assert {one: distribution_text(one) for one in drawn} == drawn
