"""Laws in parallel where others use them: studies, specimens, smoothing, files, a coupling."""

import math
from dataclasses import replace

import numpy as np
import pytest
from house import sdof
from laws_for_tests import example
from table_study import PULSE, table_study

import wirerope_mj as wr
from wirerope_mj.dynamics.periodic.laws import smoothed, width_indices
from wirerope_mj.dynamics.single_mass.cycle import steady_cycle
from wirerope_mj.mounts.laws.wrapped import with_width
from wirerope_mj.studies.engines import compute as engine
from wirerope_mj.studies.engines.together import NONE
from wirerope_mj.studies.vary.vary_option import available_lines

TWO = wr.Parallel(
    laws=[
        wr.AsymmetricBoucWen.from_normalised(z_max=z, x_y=x, sigma=0.6, n=n, k1=k, k2=0.0, k3=0.0, b=math.e, c=8.0)
        for z, x, n, k in ((360.0, 6e-3, 1.6, 3e4), (45.0, 0.4e-3, 1.0, 0.0))
    ]
)
PATH = 8e-3 * np.sin(np.linspace(0.0, 7.0, 300))
SPREAD = wr.Spread(
    parameters=("axial.laws[0].alpha", "axial.laws[1].alpha", "axial.laws[1].n"),
    covariance=((9e6, 1e6, 0.0), (1e6, 4e6, 0.0), (0.0, 0.0, 1e-3)),
)
ROPE = wr.Isolator(name="rope", axial=TWO, spread=SPREAD)


def of_rope(vary, **more):
    given = {"vary": vary, "isolators": {"wr12_400": ROPE}, "duration": 0.03, "sampling": "list", "variants": None}
    return table_study(**{**given, **more})


@pytest.mark.quick
def test_factors_are_on_force_friction_and_the_deflection_over_which_it_builds_up():
    plain = TWO.trace(PATH)
    stiffer, wider, slower = (
        replace(TWO, **TWO.completed({name: 1.3})).trace(path)
        for name, path in (("stiffness", PATH), ("friction", PATH), ("yield", 1.3 * PATH))
    )
    tight = {"rtol": 0, "atol": 1e-9 * np.abs(plain.force).max()}  # series are summed to rounding
    np.testing.assert_allclose(stiffer.force, 1.3 * plain.force, **tight)
    np.testing.assert_allclose(wider.hysteretic_state, 1.3 * plain.hysteretic_state, **tight)
    np.testing.assert_allclose(slower.hysteretic_state, plain.hysteretic_state, **tight)
    for law, other in zip(TWO.laws, replace(TWO, **TWO.completed({"yield": 1.3})).laws, strict=True):
        assert other.normalised.x_y == pytest.approx(1.3 * law.normalised.x_y, rel=1e-12)
        assert other.z_max == pytest.approx(law.z_max, rel=1e-12)


@pytest.mark.quick
def test_columns_of_parameters_and_factors_hold_as_each_of_their_entries_does():
    """Of whole columns a study asks once; 1 is the model's own factor, and of a parameter of one law a value."""
    keys = [*TWO.factors, *(f"laws[1].{name}" for name in ("alpha", "beta", "n", "b"))]
    for pair in [(key,) for key in keys] + [(one, other) for one in keys for other in keys if one < other]:
        for last in (-1.0, 0.0, 0.4, 0.97, 2.5):
            entries = [1.0, 1.1, last]
            columns = {key: np.array(entries) * (1.0 if key in TWO.factors else TWO.parameter(key)) for key in pair}
            each = True
            for number in range(len(entries)):
                try:
                    laws = TWO.completed({key: float(column[number]) for key, column in columns.items()})["laws"]
                    each = each and math.isinf(min(law.finite_travel for law in laws))
                except ValueError:
                    each = False
            assert TWO.certainly_valid(columns) == each, (pair, last)


@pytest.mark.quick
def test_a_parameter_that_all_laws_have_is_a_factor_and_one_that_is_zero_in_all_is_none():
    assert TWO.factors == ("stiffness", "friction", "yield", "alpha", "beta", "gamma", "n", "k1", "b", "c")
    assert [law.c for law in TWO.completed({"c": 0.5})["laws"]] == [4.0, 4.0]
    both = TWO.completed({"alpha": 2.0, "laws[1].alpha": 7.0})["laws"]
    assert [law.alpha for law in both] == [2.0 * TWO.laws[0].alpha, 14.0]


@pytest.mark.quick
@pytest.mark.parametrize("name", ["bouc-wen", "ozdemir", "enhanced-dry-friction", "masing"])
def test_friction_builds_up_over_a_multiple_of_the_deflection(name):
    law = example(name)
    slower, plain = law.multiplied("yield", 2.5).trace(2.5 * PATH), law.trace(PATH)
    np.testing.assert_allclose(slower.hysteretic_state, plain.hysteretic_state, rtol=1e-9, atol=1e-9)
    assert law.multiplied("yield", 1.0) == law


@pytest.mark.quick
def test_a_law_without_friction_has_no_yield():
    assert wr.KelvinVoigt(k=1e5, c=10.0).multiplied("yield", 2.0) == wr.KelvinVoigt(k=1e5, c=10.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "value", "change"),
    [
        ("laws[1].n", 1.2, {"laws[1].n": 1.2}),
        ("laws[0].alpha", 7e4, {"laws[0].alpha": 7e4}),
        ("friction", 1.3, {"friction": 1.3}),
        ("yield", 0.8, {"yield": 0.8}),
        ("stiffness", 1.1, {"stiffness": 1.1}),
        ("alpha", 1.1, {f"laws[{n}].alpha": 1.1 * law.alpha for n, law in enumerate(TWO.laws)}),
    ],
)
def test_a_study_varies_one_law_of_several_or_all_of_them(tmp_path, name, value, change):
    result = of_rope({f"mount/m1/axial/{name}": wr.Choice(value)}).run(tmp_path / "study", workers=1)
    system = wr.load_system("shock_table", isolators={"wr12_400": ROPE})
    other = replace(ROPE, axial=replace(TWO, **TWO.completed(change)), spread=None)
    alone = wr.simulate(wr.varied(system, isolators={"m1": other}), PULSE, duration=0.03, timestep=1e-3)
    assert result.table["force/m1"].to_pylist() == [pytest.approx(alone.peaks.mounts["m1"].force.value, rel=1e-9)]
    unchanged = wr.simulate(system, PULSE, duration=0.03, timestep=1e-3)
    assert alone.peaks.mounts["m1"].force.value != pytest.approx(unchanged.peaks.mounts["m1"].force.value, rel=1e-4)


def test_variants_side_by_side_have_the_bits_of_a_batch(monkeypatch):
    vary = {
        "mount/m1/axial/friction": wr.Normal(1.0, 0.1),
        "mount/m1/axial/laws[1].alpha": wr.Normal(1.0, 0.1, relative=True),
    }
    one = of_rope(vary, sampling="random", variants=6, timestep=1e-3)
    rows = one.table().to_pylist()
    first = engine.compute(one.work, engine.Chunk(number=0, rows=rows)).table
    monkeypatch.setattr(engine, "together", lambda *_: NONE)
    other = engine.compute(one.work, engine.Chunk(number=0, rows=rows)).table
    for column in first.column_names:
        np.testing.assert_array_equal(
            first[column].to_numpy(zero_copy_only=False), other[column].to_numpy(zero_copy_only=False), err_msg=column
        )
    assert len(set(first["force/m1"].to_pylist())) == 6


def test_specimens_scatter_in_the_parameters_of_each_law():
    drawn = of_rope({"mount/m1/spread": wr.Specimens()}, sampling="random", variants=400, seed=1).table()
    values = np.array([drawn[f"mount/m1/{name.replace('.', '/', 1)}"].to_pylist() for name in SPREAD.parameters])
    # 400 samples know a standard deviation to 3.5 %, a correlation of 1/6 to 0.05: three times that.
    np.testing.assert_allclose(values.std(axis=1), np.sqrt(np.diag(SPREAD.covariance)), rtol=0.11)
    assert np.corrcoef(values)[0, 1] == pytest.approx(1.0 / 6.0, abs=0.15)


def test_specimens_are_redrawn_with_their_laws_in_parallel(tmp_path):
    again = wr.redrawn(ROPE, seed=3, specimens=8)
    assert again.axial.laws[0].alpha != TWO.laws[0].alpha
    assert again.axial.laws[0].n == TWO.laws[0].n
    assert again.axial.laws[1].n == pytest.approx(1.0, abs=4.0 * math.sqrt(1e-3 / 8))
    ROPE.save(tmp_path / "rope.toml")
    assert wr.load_isolator(tmp_path / "rope.toml") == ROPE


def test_what_can_vary_of_several_laws_is_listed():
    lines = available_lines(sdof(TWO), PULSE)
    assert any("mount/NAME/axial/stiffness, mount/NAME/axial/friction, mount/NAME/axial/yield" in line for line in lines)
    assert [line.strip().partition("  ")[0] for line in lines if "laws[" in line] == [
        "mount/NAME/axial/laws[0].PARAMETER", "mount/NAME/axial/laws[1].PARAMETER",
    ]  # fmt: skip


@pytest.mark.quick
@pytest.mark.parametrize("parameter", ["height", "laws", "laws[1]", "laws[2].alpha", "laws[x].alpha"])
def test_a_name_that_no_law_of_several_has_is_refused(parameter):
    with pytest.raises(wr.ModelError, match=r"has 2 laws on its axial axis; name a parameter of one, laws\[0\]"):
        of_rope({f"mount/m1/axial/{parameter}": wr.Choice(1.0)})
    with pytest.raises(wr.ModelError, match="law asymmetric-bouc-wen of mount 'm1' has no parameter 'k'"):
        of_rope({"mount/m1/axial/laws[0].k": wr.Choice(1.0)})


def test_a_value_out_of_the_range_of_one_law_is_refused():
    with pytest.raises(wr.ModelError, match="`alpha` must be > 0"):
        of_rope({"mount/m1/axial/laws[1].alpha": wr.Choice(1e5, -1.0)}).table()
    with pytest.raises(wr.ModelError, match="`factor` must be > 0"):
        of_rope({"mount/m1/axial/yield": wr.Choice(1.0, 0.0)}).table()


def test_each_of_several_laws_is_smoothed():
    stop = wr.Stop(gap_below=0.03, k=1e6)
    law = with_width(wr.Parallel(laws=[*TWO.laws, stop]), 0.01)
    assert [one.name for one in law.laws] == ["smoothed", "smoothed", "stop"]
    assert with_width(stop, 0.01) == stop
    time = np.linspace(0.0, 3.0, 1201)
    x, rate = 5e-3 * np.sin(2.0 * np.pi * time), 0.01 * np.pi * np.cos(2.0 * np.pi * time)
    smooth = with_width(TWO, 0.02 * 0.01 * np.pi).trace(x, time=time, rate=rate)
    # A blend over a fiftieth of the velocity amplitude: errors of its square, times the curvature of the small scale.
    assert np.abs(smooth.force - TWO.trace(x).force).max() < 1e-2 * np.abs(smooth.force).max()
    assert np.abs(smooth.force - TWO.trace(x).force).max() > 0.0
    system = smoothed(sdof(TWO), 0.02)
    assert system.model.numeric_data[width_indices(system)].tolist() == [0.02, 0.02]
    orbits = [
        wr.periodic_orbit(sdof(TWO), frequency=20.0, acceleration=5.0, direction="z", smoothing=smoothing)
        for smoothing in (None, 0.01)
    ]
    assert orbits[1].smoothing_width > 0.0
    sizes = [np.abs(orbit.response.mounts["m1"].deflection).max() for orbit in orbits]
    assert sizes[1] == pytest.approx(sizes[0], rel=1e-2)


@pytest.mark.slow
def test_specimens_of_several_scales_give_a_spread():
    rng, specimens = np.random.default_rng(5), []
    for factor in (0.9, 1.0, 1.1):
        law = replace(TWO, **TWO.completed({"friction": factor}))
        loops = []
        for loop in wr.cyclic_test(law, [0.4e-3, 1e-3, 2e-3, 5e-3, 12e-3], points_per_cycle=120):
            force = loop.force + 1e-3 * 0.5 * np.ptp(loop.force) * rng.standard_normal(loop.force.size)
            force[-1] = force[0]
            loops.append(replace(loop, force=force))
        specimens.append(loops)
    fits = wr.identify_specimens(specimens, law=wr.AsymmetricBoucWen, scales=2, shared=["n_large", "n_small", "sigma"])
    rows = {row.parameter: row for row in fits.rows}
    assert rows["laws[1].alpha"].deviation / rows["laws[1].alpha"].mean == pytest.approx(0.1, rel=0.1)
    assert rows["laws[1].alpha"].fit_error < rows["laws[1].alpha"].deviation
    isolator = wr.Isolator(name="three", axial=fits.law, spread=fits.spread("axial"))
    assert "axial.laws[0].alpha" in isolator.spread.parameters
    of_rope({"mount/m1/spread": wr.Specimens()}, isolators={"wr12_400": isolator}, sampling="random", variants=3).table()


@pytest.mark.quick
def test_small_cycles_about_an_operating_point_close_on_every_scale():
    time = np.linspace(0.0, 1.0, 129)
    sliders = wr.Masing(stiffness=[1e4, 2e4], slip_force=[0.1, 0.5])
    law = wr.Parallel(laws=[*TWO.laws, sliders])
    x, rate = -2e-3 + 2e-5 * np.sin(2.0 * np.pi * time), 4e-5 * np.pi * np.cos(2.0 * np.pi * time)
    states = steady_cycle(law, x, rate, period=1.0).loop.internal_states
    # Two hundred cycles forget 1 % of what the ramp to -2 mm left in the large scale, 60 N of it in a cycle of 2.4 N.
    np.testing.assert_allclose(states[-1], states[0], rtol=0, atol=1e-12)
    assert (np.abs(states[:, :2].mean(axis=0)) < 1e-3 * np.ptp(states[:, :2], axis=0)).all()
