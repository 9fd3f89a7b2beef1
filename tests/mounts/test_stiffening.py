"""Stiffening over the first cycles: the factor, every law in another unit of force, and one answer from file to study."""

import math
import tomllib
from dataclasses import replace

import numpy as np
import pytest
from examples_drawn import examples
from house import deck, mjcf, sdof_text
from hypothesis import given
from hypothesis import strategies as st
from laws_for_tests import STRATEGIES, example, path_through, smooth_path, turning_points
from scipy.optimize import brentq
from table_study import PULSE, table_study

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.dynamics.periodic.laws import smoothed
from wirerope_mj.engine.system.model_files import write_model
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts import laws
from wirerope_mj.mounts.laws.wrapped import smoothable
from wirerope_mj.runs.repeat import replay
from wirerope_mj.studies.measures import measures
from wirerope_mj.studies.vary.quantity import acts, without_force
from wirerope_mj.studies.vary.vary_option import available_lines

G = wr.STANDARD_GRAVITY
ROPE = wr.BoucWen(alpha=2e4, beta=30.0, gamma=10.0, n=1.0, k=5e3)
SETTLED = wr.Stiffening(after_50=0.2, cycles=20.0)


def mount(stiffening=None, law=ROPE):
    return wr.Isolator(name="a", axial=law, stiffening=stiffening)


def one_mass(device, *, mass=3.5, gravity=0.0):
    return wr.load_system(sdof_text(mass=mass, gravity=gravity), isolators={"a": device})


def loop_mount(stiffening=None):
    """Return an isolator with all that makes a force: three laws, the coupling's energy, and resistance to turning."""
    shape = {"sigma": 0.7, "n": 1.4}
    return wr.Isolator(
        name="loop",
        roll=laws.SymmetricBoucWen.from_normalised(z_max=60.0, x_y=2e-3, **shape, k1=2e4, k2=-1e5, k3=3e7),
        shear=ROPE,
        axial=laws.AsymmetricBoucWen.from_normalised(z_max=80.0, x_y=1e-3, **shape, k1=4e4, k2=1e5, k3=2e7, b=math.e, c=20.0),
        coupling="loop",
        loop=wr.LoopCoupling(roll=0.02, compression=0.015, tension=0.015, coefficients=[[9.0, -4.5], [-2.4, 2.7]]),
        rotation=wr.Rotation(roll=300.0, shear=500.0, axial=200.0),
        stiffening=stiffening,
    )


def plate(device, *, heavier=1.0):
    """Return a free plate on four such mounts; its mass and moments of inertia are multiplied by `heavier`."""
    feet = [(x, y) for x in (-0.3, 0.25) for y in (-0.2, 0.2)]
    own = "".join(f'<site name="p{i}" pos="{x} {y} -.1"/>' for i, (x, y) in enumerate(feet))
    moments = " ".join(f"{heavier * moment!r}" for moment in (2.0, 3.0, 4.0))
    inertial = f'<inertial pos=".02 .03 0" mass="{60.0 * heavier!r}" diaginertia="{moments}"/>'
    world = deck({f"b{i}": f'pos="{x} {y} .2"' for i, (x, y) in enumerate(feet)})
    world += f'<body name="plate" pos="0 0 .3"><freejoint/>{inertial}{own}</body>'
    mounts = [(f"m{i}", f"p{i}", f"b{i}", "i") for i in range(4)]
    return wr.load_system(mjcf(world, mounts, gravity=G), isolators={"i": device})


def run(system, **changes):
    return wr.simulate(system, PULSE, **{"duration": 0.1, "timestep": 5e-4, **changes})


def columns(response):
    return response.samples.columns(0, len(response.samples.names))


def test_the_factor_grows_with_the_logarithm_of_the_cycles():
    assert wr.Stiffening(after_50=0.3).factor == 1.0
    assert wr.Stiffening(after_50=0.3, cycles=50).factor == 1.3
    assert wr.Stiffening(after_50=0.0, cycles=1e6).factor == 1.0
    # ln 7.07 = ln 50 / 2, and twice as far on the logarithm is twice the gain; to the rounding of sums near 1.
    assert wr.Stiffening(after_50=0.3, cycles=math.sqrt(50.0)).factor == pytest.approx(1.15, abs=1e-15)
    assert wr.Stiffening(after_50=0.3, cycles=2500.0).factor == pytest.approx(1.6, abs=1e-15)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"after_50": -0.1}, r"`after_50` must be a finite number from 0 to 1, got -0\.1"),
        ({"after_50": 20.0}, r"`after_50` must be a finite number from 0 to 1, got 20"),
        ({"after_50": True}, "`after_50` must be a finite number from 0 to 1, got True"),
        ({"after_50": 0.2, "cycles": 0.5}, r"`cycles` must be a finite number >= 1, got 0\.5"),
        ({"after_50": 0.2, "cycles": math.inf}, "`cycles` must be a finite number >= 1, got inf"),
        ({"after_50": 0.2, "cycles": "50"}, "`cycles` must be a finite number >= 1, got '50'"),
    ],
)
def test_values_out_of_range_are_named(values, words):
    with pytest.raises(ValueError, match=words):
        wr.Stiffening(**values)


@pytest.mark.parametrize("name", sorted(laws.LAWS))
@given(points=turning_points, factor=st.floats(1.0, 2.0), data=st.data())
@examples(25)
def test_a_scaled_law_draws_the_same_loop_in_another_unit_of_force(name, points, factor, data):
    law = data.draw(STRATEGIES[name])
    assert_scaled(law, factor, points)
    if smoothable(law):
        assert_scaled(laws.Smoothed(law=law, width=0.1), factor, points)


def assert_scaled(law, factor, points):
    scaled = law.scaled(factor)
    if law.rate_independent:
        path, others = path_through(points, per_segment=6), {}
    else:
        path, time, rate = smooth_path(points, per_segment=6)
        others = {"time": time, "rate": rate}
    found, nominal = scaled.trace(path, **others), law.trace(path, **others)
    # Rounding of terms of order one or of the largest, exponents up to 100 times that; what has no closed form or series is
    # integrated to 1e-8, twice.
    share = 2e-8 if law.name in ("bouc-wen-baber-noori", "scragged-bouc-wen", "smoothed") else 1e-12
    for key in ("force", "work", "hysteretic_state"):
        a, b = getattr(found, key), factor * getattr(nominal, key)
        np.testing.assert_allclose(a, b, rtol=0, atol=share * (1.0 + np.abs(b).max()))
    assert scaled.initial_stiffness == pytest.approx(factor * law.initial_stiffness, rel=1e-12)
    assert scaled.damping_coefficient == pytest.approx(factor * law.damping_coefficient, rel=1e-12)
    assert scaled.largest_force == pytest.approx(factor * law.largest_force, rel=1e-12)
    assert scaled.finite_travel == pytest.approx(law.finite_travel, rel=1e-9)  # a root found to 1e-15 m


@pytest.mark.parametrize("factor", [0.0, -1.0, math.inf, math.nan])
def test_a_law_is_scaled_by_a_number_above_zero(factor):
    with pytest.raises(ValueError, match="`factor` must be (a finite number|> 0)"):
        ROPE.scaled(factor)


def test_coupled_axes_scale_together():
    device, factor = loop_mount(SETTLED), SETTLED.factor
    path = np.random.default_rng(5).uniform(-0.01, 0.01, (30, 2))
    found, nominal = device.conditioned.coupled.trace(path), device.coupled.trace(path)
    # Integrated in the plane to 1e-11 of each of 30 lines.
    for key in ("force", "work"):
        a, b = getattr(found, key), factor * getattr(nominal, key)
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-9 * np.abs(b).max())
    assert device.conditioned.rotation == wr.Rotation(roll=factor * 300.0, shear=factor * 500.0, axial=factor * 200.0)


def test_without_the_table_or_after_one_cycle_nothing_changes():
    new = mount(wr.Stiffening(after_50=0.3))
    assert new.conditioned is new
    assert "stiffening" not in mount().to_dict()
    plain, first = one_mass(mount(), gravity=G), one_mass(new, gravity=G)
    assert first.assembly.tables.parameters.tobytes() == plain.assembly.tables.parameters.tobytes()
    assert first.assembly.tables.layout.tobytes() == plain.assembly.tables.layout.tobytes()
    assert columns(run(first)).tobytes() == columns(run(plain)).tobytes()


def test_the_catalogue_has_none():
    for path in sorted(catalogue_folder().glob("*.toml")):
        device = wr.load_isolator(path)
        assert device.stiffening is None
        assert device.conditioned is device


def test_sag_and_frequency_by_hand():
    factor = 1.0 + 0.2 * math.log(20.0) / math.log(50.0)
    assert SETTLED.factor == pytest.approx(factor, rel=1e-15)
    bound, length, mass = 500.0, 0.025, 20.0  # z_m = alpha / (beta + gamma), x_y = 1 / (beta + gamma) with n = 1
    sag = brentq(lambda x: factor * (5e3 * x + bound * -math.expm1(-x / length)) - mass * G, 0.0, 0.1, xtol=1e-15, rtol=1e-14)
    settled = one_mass(mount(SETTLED), mass=mass, gravity=G)
    rest = wr.equilibrium(settled)
    assert rest.mounts["m1"].deflection[2] == pytest.approx(-sag, rel=1e-8)  # the engine's residual, 1e-9 of the load
    # About the unloaded state, whose tangent is alpha + k.
    found = wr.modes(one_mass(mount(SETTLED), mass=mass)).frequencies
    assert found[0] == pytest.approx(math.sqrt(factor * 2.5e4 / mass) / (2.0 * math.pi), rel=1e-6)
    first = wr.modes(one_mass(mount(), mass=mass)).frequencies
    assert found[0] / first[0] == pytest.approx(math.sqrt(factor), rel=1e-6)


def test_a_heavier_body_on_stiffer_mounts_moves_as_the_lighter_one():
    """Mass, moments of inertia, weight and every force times one factor: the accelerations are the same."""
    settled, first = plate(loop_mount(SETTLED), heavier=SETTLED.factor), plate(loop_mount())
    a, b = run(settled), run(first)
    body, other = a.bodies["plate"], b.bodies["plate"]
    # Rounding alone, over 200 steps; the driven deck is 1e10 kg.
    for name in ("velocity", "angular_velocity", "acceleration"):
        found, nominal = getattr(body, name), getattr(other, name)
        np.testing.assert_allclose(found, nominal, rtol=0, atol=1e-10 * np.abs(nominal).max())
        assert (np.abs(nominal).max(axis=0) > 1e-3).all()  # along and about every axis
    found, nominal = a.mounts["m0"].force, SETTLED.factor * b.mounts["m0"].force
    np.testing.assert_allclose(found, nominal, rtol=0, atol=1e-10 * np.abs(nominal).max())
    lighter = run(plate(loop_mount(SETTLED))).bodies["plate"]
    assert np.abs(lighter.velocity - other.velocity).max() > 0.01


def test_what_is_asked_of_a_system_is_the_stiffened_mount():
    law = example("vaiana-rosati")
    system = one_mass(mount(SETTLED, law))
    there = system.mounts["m1"]
    assert there.written == mount(SETTLED, law)
    assert there.isolator.axial == law.scaled(SETTLED.factor)
    assert there.isolator.conditioned is there.isolator  # not twice
    assert system.isolators == {"a": there.written}
    smooth = smoothed(system, 1e-3).mounts["m1"]
    assert smooth.isolator.axial.law == there.isolator.axial


@pytest.mark.slow
def test_variants_are_those_of_a_model_loaded_with_them(tmp_path):
    later = mount(wr.Stiffening(after_50=0.2, cycles=40.0))
    variant = wr.varied(one_mass(mount(SETTLED)), isolators={"m1": later})
    assert variant.mounts["m1"].written == later
    assert columns(run(variant)).tobytes() == columns(run(one_mass(later))).tobytes()
    moved = wr.varied(variant, masses={"mass": 1.2})
    assert moved.mounts["m1"].isolator == later.conditioned
    assert moved.mounts["m1"].written == later
    scenario = wr.Scenario(
        "",
        sdof_text(),
        PULSE,
        {"duration": 0.02, "timestep": 1e-3},
        isolators={"a": mount(SETTLED)},
        changes=moved.changes,
    )
    found = wr.run_scenario(scenario, tmp_path / "run")
    assert found.peaks.to_dict() == wr.simulate(moved, PULSE, duration=0.02, timestep=1e-3).peaks.to_dict()
    assert replay(tmp_path / "run").identical


def test_a_model_is_written_with_the_isolator_as_it_was(tmp_path):
    write_model(one_mass(mount(SETTLED)), tmp_path)
    text = (tmp_path / "a.toml").read_text(encoding="utf-8")
    assert tomllib.loads(text)["stiffening"] == {"after_50": 0.2, "cycles": 20.0}
    again = wr.load_system(tmp_path / "model.xml")
    assert columns(run(again)).tobytes() == columns(run(one_mass(mount(SETTLED)))).tobytes()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("after_50 = 0.2", "after_50 = 20", r"\[stiffening\] `after_50` must be a finite number from 0 to 1, got 20"),
        ("after_50 = 0.2\n", "", r"\[stiffening\] `after_50` is missing; needed: after_50"),
        ("cycles = 20.0", "cycles = 0", r"\[stiffening\] `cycles` must be a finite number >= 1, got 0"),
        ("cycles =", "cycle =", r"\[stiffening\] `cycle` is unknown; known: after_50, cycles. Did you mean `cycles`"),
    ],
)
def test_files_come_back_and_say_what_is_wrong(tmp_path, old, new, words):
    file = tmp_path / "i.toml"
    loop_mount(SETTLED).save(file)
    assert wr.load_isolator(file) == loop_mount(SETTLED)
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace("cycles = 20.0", ""), encoding="utf-8")
    assert wr.load_isolator(file).stiffening == wr.Stiffening(after_50=0.2)
    file.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(ModelError, match=rf"i\.toml, line \d+: {words}"):
        wr.load_isolator(file)


def test_an_isolator_takes_nothing_else_for_it():
    with pytest.raises(ValueError, match=r"`stiffening` must be a Stiffening, got 0\.2"):
        mount(0.2)


def test_the_command_shows_it(tmp_path, capsys):
    mount(SETTLED).save(tmp_path / "i.toml")
    assert main(["isolators", str(tmp_path / "i.toml")]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "stiffening: after_50 = 0.2, cycles = 20: all forces are 1.15316 times those of the laws" in shown


STUDY = {
    "mount/m1/stiffening/cycles": wr.Uniform(12.0, 50.0),
    "mount/m1/stiffening/after_50": wr.Uniform(0.5, 1.5, relative=True),
    "mount/m1/axial/alpha": wr.Normal(1.0, 0.1, relative=True),
}


def settled_study(vary=STUDY, device=None, **others):
    given = {"model": sdof_text(), "isolators": {"a": device or mount(wr.Stiffening(after_50=0.2))}, "variants": 12}
    return table_study(**{**given, "vary": vary, **others})


def test_a_study_finds_what_each_variant_is_alone(tmp_path):
    study = settled_study()
    result = study.run(tmp_path / "study", workers=1)
    assert result.failed == {}
    for row in result.table.to_pylist()[::5]:
        stiffening = wr.Stiffening(after_50=row["mount/m1/stiffening/after_50"] * 0.2, cycles=row["mount/m1/stiffening/cycles"])
        law = replace(ROPE, alpha=row["mount/m1/axial/alpha"] * ROPE.alpha)
        system = one_mass(mount(stiffening, law))
        response = wr.simulate(system, PULSE, duration=0.05, timestep=1e-3)
        found = measures(system, response.peaks, response.initial_state)
        assert {key: row[key] for key in found} == pytest.approx(found, rel=0.0, abs=0.0, nan_ok=True)
    assert np.ptp(np.asarray(result.table["acceleration"])) > 0.0


def test_a_failed_mount_makes_no_force_however_often_it_has_moved():
    assert without_force(mount(SETTLED)).stiffening is None
    vary = {"mount/m1/failed": wr.Choice(True), "mount/m1/stiffening/cycles": wr.Choice(30)}
    failed = settled_study(vary, mount(SETTLED), variants=1).system(0).mounts["m1"]
    assert not acts(failed.isolator)
    assert failed.isolator == without_force(mount())


@pytest.mark.parametrize(
    ("name", "distribution", "device", "words"),
    [
        ("cycles", wr.Uniform(1.0, 50.0), mount(), r"isolator 'a' of mount 'm1' has no \[stiffening\]"),
        ("number", wr.Uniform(1.0, 50.0), None, "stiffening has no 'number'; it has after_50, cycles"),
        ("cycles", wr.Uniform(0.1, 0.9), None, r"mount 'm1': \[stiffening\] `cycles` must be a finite number >= 1"),
    ],
)
def test_what_a_study_cannot_vary_is_said(name, distribution, device, words):
    with pytest.raises(ModelError, match=words):
        settled_study({f"mount/m1/stiffening/{name}": distribution}, device).table()


def test_the_listing_names_it_where_it_is():
    name = "mount/NAME/stiffening/cycles"
    assert any(name in line for line in available_lines(one_mass(mount(SETTLED)), PULSE))
    assert not any(name in line for line in available_lines(one_mass(mount()), PULSE))
