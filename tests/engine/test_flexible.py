"""Flexible parts by modes: a panel as one, engines that agree, energy, a deck's own spectrum, and what is refused."""

import math
from contextlib import nullcontext

import mujoco
import numpy as np
import pytest
from house import hysteresis, sdof, sdof_text

import wirerope_mj as wr
from wirerope_mj.assessment.durability.mission import deflection_rates
from wirerope_mj.content.judged_run import judged_run
from wirerope_mj.engine.control import installed
from wirerope_mj.engine.flexible import FlexiblePart, Panel, load_flexible, save_flexible
from wirerope_mj.engine.simulation.engines import unsupported_system
from wirerope_mj.engine.simulation.run import highest_frequency, missing_modes
from wirerope_mj.engine.statics.loading import Loading
from wirerope_mj.engine.system import on_deck
from wirerope_mj.foundation.errors import ModelError

# the decks of a few modes here are held against others with as few
pytestmark = pytest.mark.filterwarnings("ignore:the modes of the deck")

G = wr.STANDARD_GRAVITY
PULSE = wr.HalfSine(peak=100.0, duration=0.011, direction="z", start=0.02)
PANEL = Panel(frequency=10.0, mass=8.0, damping=0.04)


def one_mode(mass=8.0, frequency=10.0, damping=0.04, point=(0.0, 0.0, 0.2)):
    """Return a part that moves as one mass, with a point at the mount of `sdof`."""
    return wr.FlexiblePart(
        frequencies=[frequency], damping=damping, participation=[[0.0, 0.0, math.sqrt(mass)]],
        shapes={"m1": [[0.0, 0.0, 1.0 / math.sqrt(mass)]]}, points={"m1": point},
    )  # fmt: skip


def soft():
    return sdof(wr.BoucWen(**hysteresis(alpha=2e4, z_max=40.0), k=4e3), gravity=G)


def random_part(system, body, *, modes, seed, participates):
    """Return a part with a point at every mount's site on a body, and shapes of any direction."""
    rng, points = np.random.default_rng(seed), {}
    data = mujoco.MjData(system.model)
    mujoco.mj_kinematics(system.model, data)
    sites = {site for mount in system.mounts.values() for site in (mount.payload_site, mount.base_site)}
    sites |= {system.model.site(s).name for s in range(system.model.nsite) if "point/" in system.model.site(s).name}
    for site in sorted(sites):
        if system.model.body(system.model.site(site).bodyid[0]).name == body:
            points[site] = (data.site(site).xpos - data.body(body).xpos) @ data.body(body).xmat.reshape(3, 3)
    return wr.FlexiblePart(
        frequencies=rng.uniform(8.0, 60.0, modes), damping=rng.uniform(0.01, 0.05, modes), points=points,
        participation=rng.normal(size=(modes, 3)) * 5.0 if participates else np.zeros((modes, 3)),
        shapes={name: rng.normal(size=(modes, 3)) * 0.03 for name in points},
    )  # fmt: skip


@pytest.fixture(scope="module")
def bending_cabinet():
    """Return the cabinet on a deck of three modes, itself of two."""
    rigid = wr.load_system("cabinet")
    system = wr.on_deck(rigid, random_part(rigid, "deck", modes=3, seed=1, participates=True))
    return wr.with_flexible(system, random_part(rigid, "rack", modes=2, seed=2, participates=False), body="rack")


@pytest.mark.quick
@pytest.mark.parametrize(
    "motion",
    [
        PULSE,
        wr.VelocityStep(velocity=1.0, direction="z", start=0.02),
        wr.Sine(frequency=9.0, acceleration=1.0, direction="z"),
    ],
)
@pytest.mark.parametrize("initial", ["settled", "relaxed", "unloaded"])
def test_a_part_of_one_rigid_mode_is_the_panel_of_that_mass(motion, initial):
    how = {"duration": 0.2, "timestep": 1e-4, "initial": initial, "engine": "mujoco"}
    panel, part = (wr.simulate(wr.on_deck(soft(), deck), motion, **how) for deck in (PANEL, one_mode()))
    expected = panel.mounts["m1"].deflection
    # the panel stands on a drive of 1e10 kg, which its reaction moves by 1e-9
    np.testing.assert_allclose(part.mounts["m1"].deflection, expected, rtol=0.0, atol=1e-8 * np.abs(expected).max())


@pytest.mark.quick
def test_a_part_of_one_rigid_mode_has_the_panels_modes():
    panel, part = (wr.modes(wr.on_deck(soft(), deck)) for deck in (PANEL, one_mode()))
    np.testing.assert_allclose(part.frequencies, panel.frequencies, rtol=1e-8)
    np.testing.assert_allclose(part.participation, panel.participation, atol=1e-8)
    assert part.descriptions[1] == "deck bends in its mode 1 + bounce z"


@pytest.mark.slow
def test_kernel_and_mujoco_agree_on_a_cabinet_that_bends_on_a_deck_that_bends(bending_cabinet):
    assert unsupported_system(bending_cabinet) == ""
    motion = wr.HalfSine(peak=100.0, duration=0.011, direction=(1.0, 0.5, 1.0), start=0.02)
    one, other = (
        wr.simulate(bending_cabinet, motion, duration=0.15, timestep=1e-4, engine=engine) for engine in ("kernel", "mujoco")
    )
    for name, point in other.points.items():
        for kind in ("acceleration", "velocity", "relative_displacement"):
            expected = getattr(point, kind)
            got = getattr(one.points[name], kind)
            np.testing.assert_allclose(got, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())
    for name, mount in other.mounts.items():
        np.testing.assert_allclose(
            one.mounts[name].deflection, mount.deflection, rtol=0.0, atol=1e-9 * np.abs(mount.deflection).max()
        )


@pytest.mark.slow
def test_a_points_motion_is_the_derivative_of_where_it_is(bending_cabinet):
    motion = wr.HalfSine(peak=50.0, duration=0.02, direction=(1.0, 0.5, 1.0), start=0.02)
    r = wr.simulate(bending_cabinet, motion, duration=0.12, timestep=1e-4, sample_rate=1e4)
    for point in r.points.values():
        for rate, of in ((point.velocity, point.position), (point.acceleration, point.velocity)):
            differences = (of[2:] - of[:-2]) / 2e-4
            smooth = (r.time[1:-1] < 0.0195) | (r.time[1:-1] > 0.0405)  # no corner of the pulse within
            # second order of a step of 0.1 ms at 60 Hz: (2 pi 60 1e-4)^2 / 6 = 2e-4, of what turns and hardens more
            np.testing.assert_allclose(rate[1:-1][smooth], differences[smooth], atol=2e-3 * np.abs(rate).max())


def energy(system, state):
    """Return kinetic and potential energy of a system of linear mounts without gravity [J]."""
    model, data = system.model, mujoco.MjData(system.model)
    mujoco.mj_setState(model, data, state.values, mujoco.mjtState.mjSTATE_INTEGRATION)
    with installed(model, data):
        mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    springs = sum(0.5 * model.jnt_stiffness[mode] * data.qpos[model.jnt_qposadr[mode]] ** 2 for mode in range(model.njnt))
    user = system.assembly.tables.user.mount_rows(system.assembly.user(data.userdata))
    free = np.delete(np.arange(model.nv), system.assembly.driven_dofs)
    v = data.qvel[free]
    return 0.5 * v @ mass[np.ix_(free, free)] @ v + springs + 0.5 * float(np.sum(user[:, 0] * user[:, 1]))


def test_what_bends_keeps_its_energy_on_linear_mounts_without_dampers():
    rigid = wr.load_system("cabinet")
    law = wr.KelvinVoigt(k=2e5, c=0.0)
    linear = {name: wr.Isolator(name=name, axial=law, shear=law, roll=law) for name in rigid.isolators}
    text = rigid.mjcf.replace("0 0 -9.80665", "0 0 0")
    system = wr.load_system(text, isolators=linear)
    for body, seed in (("deck", 3), ("rack", 4)):
        part = random_part(rigid, body, modes=3, seed=seed, participates=body == "deck")
        part = wr.FlexiblePart(
            frequencies=part.frequencies, damping=0.0, shapes=part.shapes, points=part.points,
            participation=part.participation,
        )  # fmt: skip
        system = wr.on_deck(system, part) if body == "deck" else wr.with_flexible(system, part, body=body)
    still = wr.Sine(frequency=1.0, acceleration=1e-12, direction="z")
    pushed = wr.simulate(system, PULSE, duration=0.04, timestep=5e-5, initial="unloaded").final_state
    before = wr.simulate(system, still, duration=0.001, timestep=5e-5, initial=pushed).final_state
    after = wr.simulate(system, still, duration=0.201, timestep=5e-5, initial=pushed).final_state
    one, other = energy(system, before), energy(system, after)
    assert one > 1.0
    # RK4 at this step loses (omega h)^6 / 144 a step: below 1e-7 in 4000 steps at the fastest mode of 80 Hz
    assert other == pytest.approx(one, rel=1e-6)


@pytest.mark.quick
def test_a_deck_without_equipment_has_the_spectrum_of_its_own_mode():
    # what stands on it has a ten-thousandth of a gram, and its mount is far above the mode
    text = sdof_text(mass=1e-7).replace('<site name="b"', '<site name="point/there" pos="0 0 .2"/><site name="b"')
    light = wr.load_system(text, isolators={"a": wr.Isolator(name="a", axial=wr.KelvinVoigt(k=0.4, c=1e-4))})
    mass, q = 8.0, 12.5
    for frequency in (8.0, 20.0, 45.0):
        part = one_mode(mass=mass, frequency=frequency, damping=0.5 / q)
        r = wr.simulate(wr.on_deck(light, part), PULSE, duration=0.3, timestep=5e-5, initial="unloaded")
        time = np.linspace(0.0, 0.3, 60_001)
        srs = wr.shock_response_spectrum(time, PULSE.acceleration(time)[:, 2], [frequency], q=q)
        # its samples are 5 us apart: the pulse between them bends by (pi h / T)^2 / 8 = 3e-7, its corners by less than 1e-4
        assert r.peaks.points["there"].acceleration.value == pytest.approx(srs.maximax[0], rel=2e-4)


@pytest.mark.quick
def test_a_part_comes_back_from_its_files(tmp_path):
    part = random_part(wr.load_system("cabinet"), "deck", modes=4, seed=5, participates=True)
    wr.save_flexible(part, tmp_path / "deck")
    again = wr.load_flexible(tmp_path / "deck")
    np.testing.assert_array_equal(again.frequencies, part.frequencies)
    np.testing.assert_array_equal(again.participation, part.participation)
    assert list(again.points) == list(part.points)
    for name in part.points:
        np.testing.assert_array_equal(again.shapes[name], part.shapes[name])


@pytest.mark.quick
@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"frequencies": [0.0]}, "rigid-body modes"), ({"frequencies": []}, "must be > 0"), ({"damping": 1.5}, "ratios from 0"),
        ({"participation": [[1.0, 2.0]]}, "rows of three"), ({"points": {}}, "both a place and shapes"),
        ({"shapes": {"m1": [[0.0, 1.0]]}}, "must have a place"), ({"shapes": {"m1": [[0.0, 0.0, math.nan]]}}, "must be finite"),
    ],
)  # fmt: skip
def test_a_part_that_is_none_is_refused(change, message):
    good = {
        "frequencies": [10.0],
        "damping": 0.02,
        "shapes": {"m1": [[0.0, 0.0, 1.0]]},
        "points": {"m1": [0.0, 0.0, 0.2]},
    }
    with pytest.raises(ValueError, match=message):
        wr.FlexiblePart(**(good | change))


@pytest.mark.quick
def test_a_part_that_does_not_fit_its_model_is_refused():
    with pytest.raises(ModelError, match="'b' on 'deck': no point within 1 mm"):
        wr.on_deck(soft(), one_mode(point=(0.0, 0.0, 200.0)))
    with pytest.raises(ModelError, match="no body 'rack'"):
        wr.with_flexible(soft(), one_mode(), body="rack")
    with pytest.raises(ModelError, match="bends already"):
        wr.on_deck(wr.on_deck(soft(), one_mode()), one_mode())


@pytest.mark.quick
@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('objtype="body" objname="deck"', 'objtype="site" objname="b"', "must hold the part's body"),
        ('name="shapes/b" data="0.0', 'name="shapes/b" data="1 0.0', "3 numbers; it has 4"),
        ('mass="1"', 'mass="2"', "mass of 1 kg"), ('axis="1.0 0.0 0.0"', 'axis="0 0 1"', "across gravity"),
    ],
)  # fmt: skip
def test_modes_that_are_written_wrongly_are_refused(old, new, message):
    system = wr.on_deck(soft(), one_mode())
    text = system.mjcf
    assert old in text
    text = text.replace(f"<element {old}", f"<element {new}") if "objtype" in old else text.replace(old, new)
    with pytest.raises(ModelError, match=message):
        wr.load_system(text, isolators=system.isolators)


@pytest.mark.slow
def test_rates_of_deflections_that_durability_uses_include_what_bends(bending_cabinet):
    motion = wr.HalfSine(peak=50.0, duration=0.02, direction=(1.0, 0.5, 1.0), start=0.02)
    r = wr.simulate(bending_cabinet, motion, duration=0.12, timestep=1e-4, sample_rate=1e4)
    for mount in r.scene.isolating:
        deflection = r.mounts[mount.name].deflection
        differences = (deflection[2:] - deflection[:-2]) / 2e-4
        rates = deflection_rates(r, mount)[1:-1]
        # central differences of 0.1 ms at 60 Hz: (2 pi 60 1e-4)^2 / 6 = 2e-4
        np.testing.assert_allclose(rates, differences, atol=2e-3 * np.abs(rates).max())


@pytest.mark.parametrize("engine", ["kernel", "mujoco"])
def test_what_bends_about_mean_axes_changes_its_momentum_by_the_mounts_and_its_weight(engine):
    rigid = wr.load_system("cabinet")
    system = wr.with_flexible(rigid, random_part(rigid, "rack", modes=3, seed=2, participates=False), body="rack")
    r = wr.simulate(system, PULSE, duration=0.15, timestep=1e-4, engine=engine)
    masses = {name: float(system.model.body(name).mass[0]) for name in system.payloads}
    rate = sum(mass * r.bodies[name].acceleration for name, mass in masses.items())
    forces = sum(-mount.force @ system.mounts[name].axes.T for name, mount in r.mounts.items())
    left = rate - forces - sum(masses.values()) * system.model.opt.gravity
    assert np.abs(forces).max() > 2.0 * sum(masses.values()) * G  # the mounts work
    # Both are of one instant: they agree to rounding.
    assert np.abs(left).max() < 1e-9 * np.abs(rate).max()


def test_a_deck_with_too_few_modes_for_what_the_base_brings_says_so_with_residual_vectors_too(tmp_path):
    """A half-sine of 11 ms brings up to 57 Hz: 80 % of its energy lie below 0.625 over its duration, by its own transform."""
    f = np.linspace(0.0, 200.0, 400_001) * 0.011
    with np.errstate(divide="ignore", invalid="ignore"):
        energy = np.nan_to_num((np.cos(np.pi * f) / (1.0 - 4.0 * f * f)) ** 2, nan=(np.pi / 4.0) ** 2)
    highest = f[np.searchsorted(np.cumsum(energy), 0.8 * (np.cumsum(energy)[-1] + 0.0))] / 0.011
    assert highest_frequency(PULSE) == pytest.approx(highest, rel=0.02)  # lines of 4 Hz, an eighth of 1 over the run's time
    n = 12
    whole = FlexiblePart(
        frequencies=np.linspace(20.0, 240.0, n), damping=0.03, participation=np.tile([0.0, 0.0, 4.0], (n, 1)),
        points={"m1": (0.0, 0.0, 0.2)}, shapes={"m1": np.tile([0.0, 0.0, 0.05], (n, 1))},
    )  # fmt: skip
    plain = sdof(wr.KelvinVoigt(k=2e4, c=60.0), gravity=G)
    for part, missing in ((whole.below(50.0), True), (whole.below(50.0, residual=True), True), (whole.below(130.0), False)):
        save_flexible(part, tmp_path / "part", force=True)
        back = load_flexible(tmp_path / "part")
        assert back.residual.tolist() == part.residual.tolist()
        assert back.below(1e9).residual.sum() == 0  # residual vectors are no modes to keep
        system = on_deck(plain, back)
        said = missing_modes(system, PULSE)
        warned = pytest.warns(wr.AccuracyWarning, match=r"end at 40 Hz, and the base brings up to 5\d\.\d+ Hz")
        with warned if missing else nullcontext():
            wr.simulate(system, PULSE, duration=0.1, timestep=1e-4)
        assert bool(said) == missing
        assert missing_modes(system, wr.Sine(frequency=15.0, acceleration=1.0, direction="z")) == ()
    with pytest.warns(wr.AccuracyWarning, match="the modes of the deck"):
        wr.simulate_batch([on_deck(plain, whole.below(50.0))], PULSE, duration=0.1, timestep=1e-4)
    judged = judged_run(on_deck(plain, whole.below(50.0)), PULSE, wr.simulate(plain, PULSE, duration=0.1, timestep=1e-4))
    assert any("the modes of the deck" in text for text in judged.model_warnings)


def test_a_search_over_many_modes_ends_where_it_converged_and_says_when_its_budget_is_spent():
    rigid = wr.load_system("cabinet")
    system = wr.on_deck(rigid, random_part(rigid, "deck", modes=31, seed=1, participates=True))
    settled = wr.equilibrium(system)
    assert settled.residual < 1e-10 * G  # ten times the search's own tolerance, for another engine's rounding
    with system.assembly.scratch.data(system.model) as data:
        alone = Loading(system, "virgin", data)
        found = alone.solve()
        assert alone.tried > 3000  # where searches of any size once ended, and blamed what was at rest
        for name, mount in settled.mounts.items():
            np.testing.assert_allclose(found.mounts[name].force, mount.force, rtol=1e-6, atol=1e-3)
    with system.assembly.scratch.data(system.model) as data:
        short = Loading(system, "virgin", data)
        short.position_limit = 1000
        with pytest.raises(wr.ConvergenceError, match=r"ended after \d+ trial positions, with \d+ % of the weight"):
            short.solve()
