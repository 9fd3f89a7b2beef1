"""Mounts that resist turning: torque and energy, tilt under an offset load, momenta, rocking frequencies, files."""

import math
import warnings
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from house import deck, hysteresis, mjcf, quiet, rotation

import wirerope_mj as wr
from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.control.mounts import righting_torque
from wirerope_mj.engine.simulation.stability import eigenvalues
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.studies.vary.quantity import without_force

pytestmark = pytest.mark.quick

G = wr.STANDARD_GRAVITY
STATE = mujoco.mjtState.mjSTATE_INTEGRATION
SPRING = wr.KelvinVoigt(k=4e3, c=0.0)
TURNS = wr.Rotation(roll=11.0, shear=7.0, axial=3.0)


def spring(turns, law=SPRING):
    return wr.Isolator(name="i", roll=law, shear=law, axial=law, rotation=turns)


def unit(rng):
    q = rng.normal(size=4)
    return q / np.linalg.norm(q)


def times(a, b):
    found = np.empty(4)
    mujoco.mju_mulQuat(found, a, b)
    return found


def turned(vector):
    """Return the unit quaternion of a rotation vector."""
    size = np.linalg.norm(vector)
    return np.concatenate([[math.cos(size / 2)], np.sin(size / 2) * vector / size])


def test_the_torque_is_the_gradient_of_the_energy():
    rng = np.random.default_rng(3)
    step, worst = 1e-5, 0.0
    for _ in range(50):
        stiffness, modelled = rng.uniform(0.0, 10.0, 3), unit(rng)
        payload, base = unit(rng), unit(rng)
        torque = np.array(righting_torque(base, payload, modelled, stiffness))

        def energy(turn, payload=payload, base=base, modelled=modelled, stiffness=stiffness):  # of the payload, base's axes
            inverse = base * [1, -1, -1, -1]
            relative = times(inverse, times(times(base, turned(turn)), times(inverse, payload)))
            e = times(relative, modelled * [1, -1, -1, -1])
            return 2.0 * stiffness @ e[1:] ** 2

        gradient = [(energy(step * e) - energy(-step * e)) / (2 * step) for e in np.eye(3)]
        worst = max(worst, np.abs(torque + gradient).max())
        opposite = np.array(righting_torque(base, -payload, modelled, stiffness))
        np.testing.assert_array_equal(torque, opposite)  # the other quaternion of the same orientation
    # Central differences of 1e-5 rad of an energy of 20 J, rounded to 4e-15: 4e-10 N m, and as much of their own error.
    print("torque against gradient", worst)
    assert worst < 4e-9


def offset_load(turns, offset, height, mass=2.0):
    """Return a body on one mount whose centre of mass stands aside of it and above it [m]."""
    world = deck({"b": 'pos="0 0 .2"'}, slides="z") + (
        f'<body name="load" pos="0 0 .2"><freejoint/><inertial pos="{offset} 0 {height}" mass="{mass}" '
        'diaginertia=".02 .03 .04"/><site name="p"/></body>'
    )
    base = '<tuple name="base"><element objtype="body" objname="deck"/></tuple>'
    return wr.load_system(mjcf(world, [("m", "p", "b", "i")], gravity=G, custom=base), isolators={"i": spring(turns)})


@pytest.mark.parametrize("turns", [TURNS, replace(TURNS, shear=700.0)])
@pytest.mark.parametrize("height", [0.0, 0.08])
def test_an_offset_load_tilts_to_the_closed_form(turns, height):
    offset, mass = 0.15, 2.0
    system = offset_load(turns, offset, height, mass)
    found = wr.static_table(system).virgin.payloads["load"].rotation
    # About the mount: m g (e cos t + h sin t) = K sin t.
    exact = math.atan2(mass * G * offset, turns.shear - mass * G * height)
    print("tilt", np.degrees(found), "closed form", math.degrees(exact))
    # Newton's method stops at 1e-11 of gravity, which turns this load by 1e-11.
    np.testing.assert_allclose(found, [0.0, exact, 0.0], rtol=0, atol=1e-9)
    if turns.shear == 700.0 and height == 0.0:
        small = mass * G * offset / turns.shear
        assert found[1] == pytest.approx(small, rel=small**2 / 3 + 1e-8)  # tan t = t + t^3 / 3
    else:
        assert height or exact > 0.35  # 20 degrees: sine, tangent and angle are not the same here


@pytest.mark.parametrize(("turns", "free"), [(None, 3), (wr.Rotation(), 3), (replace(TURNS, axial=0.0), 1), (TURNS, 0)])
def test_what_the_rotation_resists_is_not_said_to_be_free(turns, free):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", wr.ModelWarning)
        found = wr.equilibrium(offset_load(turns, 0.0, -0.02))
        frequencies = wr.modes(offset_load(turns, 0.0, -0.02)).frequencies
    print(found.free)
    if free == 1:
        assert "rotation about z" in found.free[0]
        assert "rotation about x" not in found.free[0]
    # Without turning stiffness the load still hangs: its centre of mass is below the mount, only the turn about z is free.
    assert len(found.free) == (0 if free == 0 else 1)
    assert np.isfinite(frequencies).all()
    assert (frequencies > 0.0).sum() == (6 if free == 0 else 5)


def test_modes_of_a_tilted_load_are_those_of_its_small_motions():
    """The frequencies against the slopes of MuJoCo's own accelerations about a large tilt."""
    system = offset_load(TURNS, 0.15, 0.05)
    found = wr.modes(system)
    rest = wr.equilibrium(system)
    model, data = system.model, mujoco.MjData(system.model)
    free = np.delete(np.arange(model.nv), system.assembly.driven_dofs)
    mujoco.mj_setState(model, data, rest.state.values, STATE)
    qpos, columns, step = data.qpos.copy(), [], 1e-5

    def accelerations(dof, size):
        velocity = np.zeros(model.nv)
        velocity[dof] = size
        data.qpos[:], data.qvel[:] = qpos, 0.0
        mujoco.mj_integratePos(model, data.qpos, velocity, 1.0)
        mujoco.mj_forward(model, data)
        return data.qacc[free].copy()

    with installed(model, data):
        columns = [(accelerations(dof, -step) - accelerations(dof, step)) / (2 * step) for dof in free]
    own = np.sort(np.sqrt(np.linalg.eigvals(np.stack(columns, axis=1)).real)) / (2 * np.pi)
    print(found.frequencies, own)
    # Central differences of 1e-5 and of 1e-6: both are within 1e-8 of the stiffness.
    np.testing.assert_allclose(found.frequencies, own, rtol=1e-6)


SIX = [(x, y) for x in (-0.9, 0.1, 0.8) for y in (-0.4, 0.4)]


def frame(turns, *, turned_sites=()):
    """Return a plate on six mounts at the height of its centre of mass; some mounts stand turned by 90 degrees about z."""
    quat = {number: ' quat=".7071067811865476 0 0 .7071067811865476"' for number in turned_sites}
    sites = {f"b{i}": f'pos="{x} {y} .5"{quat.get(i, "")}' for i, (x, y) in enumerate(SIX)}
    own = "".join(f'<site name="p{i}" pos="{x} {y} 0"{quat.get(i, "")}/>' for i, (x, y) in enumerate(SIX))
    world = deck(sites) + (
        f'<body name="plate" pos="0 0 .5"><freejoint/><inertial pos="0 0 0" mass="200" diaginertia="20 45 60"/>{own}</body>'
    )
    law = {axis: wr.KelvinVoigt(k=k, c=0.0) for axis, k in (("roll", 2e4), ("shear", 3e4), ("axial", 5e4))}
    isolator = wr.Isolator(name="i", **law, rotation=turns)
    mounts = [(f"m{i}", f"p{i}", f"b{i}", "i") for i in range(6)]
    return wr.load_system(mjcf(world, mounts), isolators={"i": isolator})


@pytest.mark.parametrize("turned_sites", [(), (1, 4)])
def test_rocking_of_six_mounts_rises_by_the_hand_calculation(turned_sites):
    turns = wr.Rotation(roll=900.0, shear=2500.0, axial=400.0)

    def rocking(turns):
        found = wr.modes(frame(turns, turned_sites=turned_sites))
        return found.frequencies[[word.startswith("rocking about x") for word in found.descriptions]]

    (before,), (after,) = rocking(None), rocking(turns)
    k, ixx = 5e4, 20.0
    plain = sum(k * y * y for _, y in SIX)
    # About the world's x: roll of a mount as drawn, shear of one that is turned by 90 degrees about z.
    extra = sum(turns.shear if i in turned_sites else turns.roll for i in range(6))
    assert before == pytest.approx(math.sqrt(plain / ixx) / (2 * math.pi), rel=1e-8)
    change, hand = 100.0 * (after / before - 1.0), 100.0 * (math.sqrt(1.0 + extra / plain) - 1.0)
    print(f"rocking {before:.4f} -> {after:.4f} Hz, {change:.4f} % (by hand {hand:.4f} %)")
    assert hand > 5.0
    assert change == pytest.approx(hand, abs=1e-4)  # differences of 1e-6 rad: 1e-8 of the stiffness
    fastest = np.abs(eigenvalues(frame(turns, turned_sites=turned_sites)).imag)
    assert np.abs(fastest / (2 * math.pi) - after).min() < 1e-6 * after  # what the time step is chosen from


def free_pair(isolator):
    """Return two free bodies joined by one mount, whose sites stand askew; a deck stands apart and only names the base."""
    a = '<inertial pos="0 0 0" mass="3" diaginertia=".05 .08 .11"/>'
    b = '<inertial pos=".02 0 .01" mass="5" diaginertia=".2 .12 .25"/>'
    world = (
        '<body name="deck" pos="9 0 0"><joint type="slide" axis="0 0 1"/><geom size=".1"/></body>'
        f'<body name="a" pos="0 0 1.2"><freejoint/>{a}<site name="sa" pos=".1 .05 -.1" euler="20 -30 50"/></body>'
        f'<body name="b" pos="0 0 1"><freejoint/>{b}<site name="sb" pos=".1 .05 .1" euler="-40 15 70"/></body>'
    )
    base = '<tuple name="base"><element objtype="body" objname="deck"/></tuple>'
    return wr.load_system(mjcf(world, [("m", "sa", "sb", "i")], custom=base), isolators={"i": isolator})


def spinning(system):
    """Return a state in which both bodies drift apart and tumble."""
    values = wr.simulate(system, quiet(), duration=1e-3, timestep=1e-3, initial="unloaded").initial_state.values
    data = mujoco.MjData(system.model)
    mujoco.mj_setState(system.model, data, values, STATE)
    for name, velocity in (("a", [0.4, -0.3, 0.2, 2.0, -3.0, 1.5]), ("b", [-0.2, 0.5, 0.1, -1.0, 2.0, 2.5])):
        first = int(system.model.body(name).dofadr[0])
        data.qvel[first : first + 6] = velocity
    values = np.empty_like(values)
    mujoco.mj_getState(system.model, data, values, STATE)
    return wr.State(values=values, time=0.0)


PRINCIPAL = {"a": (3.0, np.array([0.05, 0.08, 0.11])), "b": (5.0, np.array([0.2, 0.12, 0.25]))}


def balance(system, timestep):
    """Return energy (n_t,), momentum, angular momentum (n_t, 3) and turn energy (n_t,) of the pair that tumbles."""
    r = wr.simulate(system, quiet(), duration=0.5, timestep=timestep, initial=spinning(system), sample_rate=round(1 / timestep))
    energy, momentum, angular = np.zeros(r.time.size), 0.0, 0.0
    for name, (mass, inertia) in PRINCIPAL.items():
        body = r.bodies[name]
        turn = rotation(body.orientation)
        spin = np.einsum("tji,tj->ti", turn, body.angular_velocity)
        energy += 0.5 * mass * (body.velocity**2).sum(1) + 0.5 * (inertia * spin**2).sum(1)
        momentum = momentum + mass * body.velocity
        angular = angular + mass * np.cross(body.position, body.velocity) + np.einsum("tij,tj->ti", turn, inertia * spin)
    # Both bodies stand straight in the modelled geometry, so that the mount's axes are those of its site on b.
    axes = rotation(system.model.site("sb").quat)
    relative = np.einsum("tji,tjk->tik", rotation(r.bodies["b"].orientation), rotation(r.bodies["a"].orientation))
    relative = np.einsum("ji,tjk,kl->til", axes, relative, axes)
    # 2 sum K q_i^2, the squares read from the matrix: 4 q_i^2 = 1 + 2 R_ii - trace.
    squares = 0.25 * (1.0 + 2.0 * np.einsum("tii->ti", relative) - np.einsum("tii->t", relative)[:, None])
    turns = system.mounts["m"].isolator.rotation
    stored = 2.0 * squares @ [turns.roll, turns.shear, turns.axial]
    energy += stored + 0.5 * SPRING.k * (r.mounts["m"].deflection ** 2).sum(1)
    return energy, momentum, angular, stored


def test_a_pair_joined_by_a_mount_keeps_energy_and_momenta_while_its_base_turns():
    system = free_pair(spring(TURNS))
    errors = []
    for timestep in (4e-4, 2e-4, 1e-4):
        energy, momentum, angular, stored = balance(system, timestep)
        errors.append(np.abs(energy / energy[0] - 1.0).max())
    drift = [np.abs(q - q[0]).max() / np.linalg.norm(q[0]) for q in (momentum, angular)]
    print("energy", errors, "momenta", drift, "share of the turn", stored.max() / energy[0])
    assert stored.max() > 0.1 * energy[0]  # the turning stiffness really takes part
    assert errors[-1] < 1e-6
    assert errors[0] > 8.0 * errors[1]  # RK4 loses energy with its fourth power at least
    assert drift[0] < 1e-12  # sums of opposite forces
    assert drift[1] < 1e-10  # RK4's own: quadratic in the state


def test_both_callbacks_make_the_same_torque():
    law = wr.BoucWen(**hysteresis(alpha=4e3, z_max=8.0), k=2e3)
    system = free_pair(spring(TURNS, law))
    start = spinning(system)
    native, python = (
        wr.simulate(system, quiet(), duration=0.05, timestep=1e-3, initial=start, callback=kind, engine="mujoco")
        for kind in ("native", "python")
    )
    a, b = (r.samples.columns(0, len(r.samples.names)) for r in (native, python))
    # The same kernels and the same engine: only the order of a few roundings may differ.
    assert np.abs(a - b).max() < 1e-10 * np.abs(a).max()
    free = wr.simulate(free_pair(spring(None, law)), quiet(), duration=0.05, timestep=1e-3, initial=start)
    assert np.abs(free.samples.columns(0, len(free.samples.names)) - a).max() > 1e-3


def test_without_stiffness_nothing_changes_by_a_bit():
    law = wr.BoucWen(**hysteresis(alpha=4e3, z_max=8.0), k=2e3)
    runs = []
    for turns in (None, wr.Rotation()):
        system = free_pair(spring(turns, law))
        r = wr.simulate(system, quiet(), duration=0.05, timestep=1e-3, initial=spinning(system))
        runs.append(r.samples.columns(0, len(r.samples.names)))
    np.testing.assert_array_equal(*runs)


def test_a_variant_has_the_bits_of_a_model_with_that_rotation():
    written = free_pair(spring(TURNS))
    variant = wr.varied(free_pair(spring(None)), isolators={"m": spring(TURNS)})
    np.testing.assert_array_equal(variant.assembly.tables.layout, written.assembly.tables.layout)
    np.testing.assert_array_equal(variant.model.numeric_data, written.model.numeric_data)
    moved = wr.varied(free_pair(spring(TURNS)), positions={"m": (0.01, 0.0, 0.0)})
    row = moved.assembly.tables.layout[at.HEADER :][: at.MOUNT_COLUMNS]
    np.testing.assert_allclose(row, written.assembly.tables.layout[at.HEADER :][: at.MOUNT_COLUMNS], rtol=0, atol=1e-15)


def test_a_mount_that_failed_turns_freely():
    assert without_force(spring(TURNS)).rotation is None


def test_the_rotation_is_kept_in_a_file(tmp_path):
    spring(TURNS).save(tmp_path / "i.toml")
    assert wr.load_isolator(tmp_path / "i.toml") == spring(TURNS)
    text = (tmp_path / "i.toml").read_text(encoding="utf-8")
    assert "[rotation]" in text
    short = text.replace("roll = 11.0\nshear = 7.0\n", "")
    (tmp_path / "i.toml").write_text(short, encoding="utf-8")
    assert wr.load_isolator(tmp_path / "i.toml").rotation == wr.Rotation(axial=3.0)
    for wrong, words in (
        ("axial = -3.0", r"line \d+: \[rotation\] `axial` must be a finite number >= 0 \[N m/rad\], got -3"),
        ("yaw = 3.0", "`yaw` is unknown"),
    ):
        (tmp_path / "i.toml").write_text(short.replace("axial = 3.0", wrong), encoding="utf-8")
        with pytest.raises(ModelError, match=words):
            wr.load_isolator(tmp_path / "i.toml")
    with pytest.raises(ValueError, match="`rotation` must be a Rotation, got"):
        spring(3.0)
