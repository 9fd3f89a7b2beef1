"""Forces on the payload: closed forms, SciPy, Newton's and Euler's equations, batches, and what is refused."""

import math

import numpy as np
import pytest
import scipy
from free_bodies import free_block

import wirerope_mj as wr
from wirerope_mj.assessment.criteria.loads import foundation_force
from wirerope_mj.cli import main
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.motions import motion_from_dict

K, C, MASS = 2e5, 600.0, 50.0
MASS_OF_BLOCK = 80.0
G = wr.STANDARD_GRAVITY


def one_mass(gravity=0.0):
    """Return a mass on a linear mount, with a site for forces that is turned by a quarter about y."""
    text = f"""
<mujoco><option gravity="0 0 {-gravity}"/><worldbody>
  <body name="base"><joint type="slide" axis="0 0 1"/><geom size=".2 .2 .02" type="box" contype="0" conaffinity="0"/>
    <site name="base/m1"/></body>
  <body name="block"><joint type="slide" axis="0 0 1"/>
    <geom type="box" size=".1 .1 .1" mass="{MASS}" contype="0" conaffinity="0"/>
    <site name="block/m1"/><site name="force/engine" pos="0 0 .1"/><site name="force/turned" euler="0 90 0"/></body>
</worldbody><custom><text name="isolator/a" data="a"/><tuple name="mount/m1"><element objtype="site" objname="block/m1"/>
  <element objtype="site" objname="base/m1"/><element objtype="text" objname="isolator/a"/></tuple></custom></mujoco>"""
    return wr.load_system(text, isolators={"a": wr.Isolator(name="a", axial=wr.KelvinVoigt(k=K, c=C))})


@pytest.fixture(scope="module")
def system():
    return one_mass()


@pytest.mark.parametrize("frequency", [4.0, 9.0, 10.07, 25.0])
def test_force_transmissibility_of_a_linear_mount_is_the_closed_form(system, frequency):
    period = 1.0 / frequency
    duration = np.ceil(5.0 / period) * period  # the transient has e^-30 of its size left
    force = wr.HarmonicForce(site="engine", frequency=frequency, force=(0, 0, 100.0))
    response = wr.simulate(system, force, duration=duration, accuracy=1e-7, sample_rate=2000.0)
    omega, last = 2 * np.pi * frequency, response.time > duration - 2.00001 * period
    waves = np.stack([np.sin(omega * response.time[last]), np.cos(omega * response.time[last])], axis=1)
    amplitude = np.hypot(*np.linalg.lstsq(waves, response.mounts["m1"].force[last, 2], rcond=None)[0])
    carried = K + 1j * omega * C
    assert amplitude / 100.0 == pytest.approx(abs(carried / (carried - MASS * omega**2)), rel=1e-6)
    assert response.numerics.engine == "kernel"


@pytest.mark.parametrize("direction", ["z", (0, 0, -1)])
def test_a_blow_gives_its_impulse(system, direction):
    blow = wr.Blow(site="engine", impulse=40.0, duration=1e-4, direction=direction, start=0.01)
    time = np.linspace(0.01, 0.0101, 2001)
    assert scipy.integrate.simpson(blow.load("engine", time)[:, 2], x=time) == pytest.approx(
        40.0 if direction == "z" else -40.0
    )
    response = wr.simulate(system, blow, duration=0.05, accuracy=1e-5, sample_rate=20_000.0)
    omega, ratio = np.sqrt(K / MASS), C / (2.0 * np.sqrt(K * MASS))
    first = 40.0 / (MASS * omega) * np.exp(-ratio / np.sqrt(1 - ratio**2) * np.arccos(ratio))  # peak of a free oscillation
    assert np.abs(response.mounts["m1"].deflection[:, 2]).max() == pytest.approx(first, rel=1e-4)


def test_the_medium_weight_machine_is_two_masses_until_the_table_is_stopped():
    stiffness, table, equipment, gravity, impulse = 2e5, 2041.0, 300.0, G, 3300.0
    linear = wr.Isolator(name="linear", **{axis: wr.KelvinVoigt(k=stiffness, c=500.0) for axis in ("axial", "shear", "roll")})
    system = wr.load_system(models_folder() / "templates" / "medium_weight_machine.xml", isolators={"wr16_400": linear})
    response = wr.simulate(system, wr.Blow(site="hammer", impulse=impulse, duration=1e-3, direction="z"), duration=0.05)
    at_rest = equipment * gravity / (4 * stiffness)

    def rates(t, state):
        blow = math.pi * impulse / 2e-3 * math.sin(math.pi * t / 1e-3) if t < 1e-3 else 0.0
        seat = (table + equipment) * gravity if t == 0.0 else 0.0
        held = 4 * (stiffness * (state[2] - state[0]) + 500.0 * (state[3] - state[1]))
        return [state[1], (blow + seat + held) / table - gravity, state[3], -held / equipment - gravity]

    solved = scipy.integrate.solve_ivp(rates, (0.0, 0.05), (0.0, 0.0, -at_rest, 0.0), rtol=1e-9, atol=1e-12, max_step=1e-4)
    travel = solved.y[2] - solved.y[0]
    assert response.mounts["m1"].deflection[:, 2].min() == pytest.approx(travel.min(), rel=2e-3)


def test_a_run_up_of_an_unbalance_is_that_of_scipy(system):
    unbalance = wr.Unbalance(site="engine", unbalance=0.02, frequency=2.0, final_frequency=20.0, run_up=3.0, line="z")
    response = wr.simulate(system, unbalance, duration=4.0, accuracy=1e-7)

    def rate(time, state):
        rate_of_speed = 2 * np.pi * 18.0 / 3.0 if time < 3.0 else 0.0
        speed = 2 * np.pi * (2.0 + 18.0 * min(time / 3.0, 1.0))
        angle = 2 * np.pi * (2.0 * time + 3.0 * time**2) if time < 3.0 else 2 * np.pi * (33.0 + 20.0 * (time - 3.0))
        # minus the acceleration of 0.02 cos(angle), which SymPy or a pencil gives
        force = 0.02 * (speed**2 * np.cos(angle) + rate_of_speed * np.sin(angle))
        return [state[1], (force - K * state[0] - C * state[1]) / MASS]

    first = response.time <= 3.0
    options = {"rtol": 1e-10, "atol": 1e-13, "method": "DOP853"}
    up = scipy.integrate.solve_ivp(rate, (0, 3), [0, 0], t_eval=response.time[first], **options)
    on = scipy.integrate.solve_ivp(rate, (3, 4), up.y[:, -1], t_eval=response.time[~first], **options)
    expected = np.append(up.y[0], on.y[0])
    moved = response.bodies["block"].position[:, 2]
    assert np.abs(moved - expected).max() <= 1e-4 * np.abs(expected).max()
    assert np.abs(moved - expected).max() <= 1e-6 * np.abs(expected).max()  # what there is


def test_a_rotating_unbalance_turns_about_its_axis_with_the_shaft():
    force = wr.Unbalance(site="engine", unbalance=0.02, frequency=10.0, axis="z")
    quarter = 0.25 / 10.0
    size = 0.02 * (2 * np.pi * 10.0) ** 2
    loads = force.load("engine", [0.0, quarter, 2 * quarter])
    assert loads == pytest.approx(
        size * np.array([[1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0], [-1, 0, 0, 0, 0, 0]]), abs=1e-9 * size
    )


def test_the_inertia_force_is_minus_mass_times_acceleration_of_the_eccentric_mass():
    force = wr.Unbalance(
        site="engine",
        unbalance=1.0,
        frequency=3.0,
        final_frequency=9.0,
        run_up=2.0,
        axis=(1, 2, 3),
        order=2.0,
        phase=0.3,
    )
    time, h = np.linspace(0.1, 1.9, 50), 1e-5
    u, v = force._across

    def place(t):
        angle = 2.0 * 2 * np.pi * (3.0 * t + 1.5 * t**2) + 0.3
        return np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v

    acceleration = (place(time + h) - 2 * place(time) + place(time - h)) / h**2
    loads = force.load("engine", time)
    assert loads[:, :3] == pytest.approx(-acceleration, abs=2e-5 * np.abs(acceleration).max())
    assert np.abs(loads[:, :3] @ [1, 2, 3]).max() < 1e-9 * np.abs(loads).max()


def test_newton_and_euler_hold_for_a_free_body_under_force_and_moment():
    system = free_block()
    load = wr.HarmonicForce(site="engine", frequency=7.0, force=(300, -200, 500), moment=(40, -30, 20), phase=0.5)
    load += wr.HalfSine(peak=3 * G, duration=0.02, direction="z", start=0.1)
    response = wr.simulate(system, load, duration=0.4, timestep=2e-4)
    body, model = response.bodies["block"], system.model
    number = model.body("block").id
    site, rotation = model.site("force/engine"), scipy.spatial.transform.Rotation
    own = rotation.from_quat(body.orientation, scalar_first=True)
    inertial = rotation.from_quat(model.body_iquat[number], scalar_first=True)
    axes = own * rotation.from_quat(site.quat, scalar_first=True)
    applied = load.load("engine", response.time)
    force, moment = axes.apply(applied[:, :3]), axes.apply(applied[:, 3:])
    total = force + MASS_OF_BLOCK * np.array([0, 0, -9.81])
    arm = own.apply(site.pos - model.body_ipos[number])
    torque = moment + np.cross(arm, force)
    for n, mount in enumerate(response.mounts.values()):
        base_axes = rotation.from_quat(model.site(f"base/m{n}").quat, scalar_first=True)
        pull = -base_axes.apply(mount.force)
        total = total + pull
        torque = torque + np.cross(own.apply(model.site(f"block/m{n}").pos - model.body_ipos[number]), pull)
    principal = own * inertial
    spin = principal.inv().apply(body.angular_velocity)
    inertia = model.body_inertia[number]
    rate = principal.apply(inertia * principal.inv().apply(body.angular_acceleration) + np.cross(spin, inertia * spin))
    assert MASS_OF_BLOCK * body.acceleration == pytest.approx(total, abs=1e-8 * np.abs(total).max())
    assert rate == pytest.approx(torque, abs=1e-8 * np.abs(torque).max())


def test_a_site_that_is_turned_turns_the_force(system):
    along_x = wr.HarmonicForce(site="turned", frequency=9.0, force=(-100.0, 0, 0))  # x of the site is -z of the world
    along_z = wr.HarmonicForce(site="engine", frequency=9.0, force=(0, 0, 100.0))
    one, other = (wr.simulate(system, force, duration=0.3, timestep=1e-3) for force in (along_x, along_z))
    assert one.bodies["block"].position == pytest.approx(other.bodies["block"].position, abs=1e-12)


def test_forces_and_base_motions_add_and_python_is_native(system):
    both = wr.HarmonicForce(site="engine", frequency=9.0, force=(0, 0, 100.0), duration=0.1) + wr.HalfSine(
        peak=5 * G, duration=0.011, direction="z", start=0.05
    )
    alone = [
        wr.simulate(system, term, duration=0.3, timestep=5e-4, engine="mujoco").bodies["block"].position for term in both.terms
    ]
    native, python = (
        wr.simulate(system, both, duration=0.3, timestep=5e-4, callback=kind, engine="mujoco") for kind in ("native", "python")
    )
    np.testing.assert_array_equal(native.bodies["block"].position, python.bodies["block"].position)
    # one frame and one engine, and the corners of the other motion cut other steps
    assert native.bodies["block"].position == pytest.approx(sum(alone), abs=1e-8)


def bent_block():
    """Return the free block with two modes of its own, which the force drives."""
    system, rng = free_block(), np.random.default_rng(5)
    sites = [name for n in range(system.model.nsite) if (name := system.model.site(n).name).startswith(("block/", "force/"))]
    part = wr.FlexiblePart(
        frequencies=[30.0, 45.0], damping=0.03, participation=np.zeros((2, 3)),
        points={name: system.model.site(name).pos for name in sites},
        shapes={name: rng.normal(size=(2, 3)) * 0.05 for name in sites},
    )  # fmt: skip
    return wr.with_flexible(system, part, body="block")


@pytest.mark.parametrize("make", [one_mass, free_block, bent_block])
def test_the_kernel_applies_forces_as_mujoco_does(make):
    """To rounding, 1e-9 of the largest: on what slides, what floats and turns, and what bends; sums with a base motion too."""
    load = wr.HarmonicForce(site="engine", frequency=7.0, force=(300, -200, 500), moment=(40, -30, 20), phase=0.5)
    load += wr.Blow(site="engine", impulse=20.0, duration=0.004, direction="z", start=0.03)
    load += wr.HalfSine(peak=3 * G, duration=0.02, direction="z", start=0.1)
    one, other = (wr.simulate(make(), load, duration=0.25, timestep=2e-4, engine=kind) for kind in ("kernel", "mujoco"))
    assert one.peaks.mounts.keys() == other.peaks.mounts.keys()
    for got, expected in [
        *((one.mounts[name].force, mount.force) for name, mount in other.mounts.items()),
        (one.bodies["block"].acceleration, other.bodies["block"].acceleration),
        (one.bodies["block"].angular_acceleration, other.bodies["block"].angular_acceleration),
    ]:
        np.testing.assert_allclose(got, expected, rtol=0.0, atol=1e-9 * max(np.abs(expected).max(), 1e-9))


def test_a_batch_gives_every_variant_its_own_force(system):
    forces = [wr.HarmonicForce(site="engine", frequency=f, force=(0, 0, 100.0)) for f in (5.0, 9.0)]
    forces.append(wr.HalfSine(peak=5 * G, duration=0.011, direction="z"))
    results = wr.simulate_batch([system] * 3, forces, duration=0.2, timestep=1e-3)
    for force, result in zip(forces, results, strict=True):
        alone = wr.simulate(system, force, duration=0.2, timestep=1e-3, corners=[0.011])
        assert result.peaks.mounts["m1"].force.value == pytest.approx(alone.peaks.mounts["m1"].force.value, rel=1e-9)


@pytest.mark.parametrize(
    "force",
    [
        wr.Unbalance(site="engine", unbalance=0.02, frequency=2.0, final_frequency=20.0, run_up=3.0, axis=(0, 1, 1), order=0.5),
        wr.Unbalance(site="engine", unbalance=0.02, frequency=2.0, line="x", duration=3.0, phase=1.0, start=0.1),
        wr.HarmonicForce(site="engine", frequency=4.0, moment=(1, 2, 3)),
        wr.ForceTable(site="engine", times=[0, 1, 2], loads=[[0] * 6, [1, 2, 3, 4, 5, 6], [0] * 6], start=0.5),
    ],
)
def test_a_force_is_rebuilt_from_its_parameters(force):
    assert motion_from_dict(force.to_dict()) == force
    twice = motion_from_dict(wr.Scaled(force, 2.0).to_dict())
    assert twice.load("engine", [0.7]) == pytest.approx(2.0 * force.load("engine", [0.7]))
    assert force.description


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: wr.Unbalance(site="", unbalance=1, frequency=1, axis="x"), "`site`"),
        (lambda: wr.Unbalance(site="a", unbalance=1, frequency=1), "one of `axis`"),
        (lambda: wr.Unbalance(site="a", unbalance=1, frequency=1, axis="x", line="y"), "one of `axis`"),
        (lambda: wr.Unbalance(site="a", unbalance=0, frequency=1, axis="x"), "`unbalance`"),
        (lambda: wr.Unbalance(site="a", unbalance=1, frequency=0, axis="x"), "`frequency`"),
        (lambda: wr.Unbalance(site="a", unbalance=1, frequency=1, axis="x", run_up=1), "`final_frequency`"),
        (lambda: wr.Unbalance(site="a", unbalance=1, frequency=1, axis="x", final_frequency=2), "`run_up`"),
        (lambda: wr.HarmonicForce(site="a", frequency=1), "must not be zero"),
        (lambda: wr.HarmonicForce(site="a", frequency=1, force=(1, 2)), "`force`"),
        (lambda: wr.ForceTable(site="a", times=[0, 0], loads=[[0] * 6] * 2), "increase"),
        (lambda: wr.ForceTable(site="a", times=[0, 1], loads=[[0] * 3] * 2), "must fit"),
    ],
)
def test_arguments_out_of_range_are_named(make, said):
    with pytest.raises(ValueError, match=said):
        make()


def test_a_force_needs_a_site_of_the_model(system):
    with pytest.raises(ModelError, match="no site 'force/fan'.*engine, turned"):
        wr.simulate(system, wr.HarmonicForce(site="fan", frequency=1.0, force=(0, 0, 1)), duration=0.1)


def test_a_site_for_forces_must_be_on_what_moves():
    with pytest.raises(ModelError, match="fixed to the base"):
        wr.load_system(one_mass().mjcf.replace('<site name="base/m1"/>', '<site name="base/m1"/><site name="force/base"/>'),
                       isolators={"a": wr.Isolator(name="a", axial=wr.KelvinVoigt(k=K, c=C))})  # fmt: skip


@pytest.mark.slow
def test_a_run_with_an_unbalance_is_written_and_replayed_bit_for_bit(tmp_path):
    (tmp_path / "model.xml").write_text(one_mass(gravity=G).mjcf)
    one_mass().isolators["a"].save(tmp_path / "a.toml")
    text = (tmp_path / "model.xml").read_text().replace('data="a"', 'data="a.toml"')
    (tmp_path / "model.xml").write_text(text)
    arguments = ["--unbalance", "engine 20 kg.mm 5 to 20 Hz 0.5 s x", "--half-sine", "5 g 11 ms z", "--duration", "0.6"]
    assert main(["shock", str(tmp_path / "model.xml"), *arguments, "--out", str(tmp_path / "run")]) == 0
    assert wr.replay(tmp_path / "run").identical
    assert (tmp_path / "run" / "report.html").is_file()


def test_what_the_foundation_feels_is_weight_and_inertia_and_what_acts():
    system = free_block()
    load = wr.HarmonicForce(site="engine", frequency=7.0, force=(300, -200, 500))
    response = wr.simulate(system, load, duration=0.3, timestep=5e-4)
    rotation = scipy.spatial.transform.Rotation
    site = rotation.from_quat(system.model.site("force/engine").quat, scalar_first=True)
    body = response.bodies["block"]
    applied = (rotation.from_quat(body.orientation, scalar_first=True) * site).apply(load.load("engine", response.time)[:, :3])
    expected = applied - MASS_OF_BLOCK * (body.acceleration + np.array([0.0, 0.0, 9.81]))
    # The first sample is a corner, at which a force counts as it is 1e-10 s later.
    assert foundation_force(response)[1:] == pytest.approx(expected[1:], abs=1e-11 * np.abs(expected).max())
