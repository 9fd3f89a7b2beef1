"""Roll and axial of a rope loop coupled on two scales of friction, each with an ellipse of its own."""

import math
from dataclasses import replace

import numpy as np
import pytest
from house import deck, mjcf
from laws_for_tests import path_through
from stored_energy import stored_energy

import wirerope_mj as wr
from wirerope_mj.dynamics.modes.mount import loop_cycle, plane_cycle, plane_tangents
from wirerope_mj.dynamics.periodic.orbit import OrbitSearch
from wirerope_mj.dynamics.periodic.shooting import close, monodromy, shot
from wirerope_mj.dynamics.periodic.variational import variational_of
from wirerope_mj.engine.kernel.equations import equations
from wirerope_mj.engine.kernel.variants import Numbers
from wirerope_mj.engine.statics.find import equilibrium_solver
from wirerope_mj.engine.system import Changes
from wirerope_mj.mounts import laws

RNG = np.random.default_rng(7)
G = wr.STANDARD_GRAVITY
LOOP = wr.LoopCoupling(roll=0.02, compression=0.02, tension=0.01, coefficients=[[3.0, 2.0, 1.0], [1.0, -0.5, 0.2]])
SIZES = ((300.0, 2e-3), (60.0, 2e-4))
"""Bound [N] and yield deflection [m] of either scale."""


def parts(n, **elastic):
    """Return the laws of both scales, the polynomial in the first."""
    kind = laws.AsymmetricBoucWen if "c" in elastic else laws.SymmetricBoucWen
    own = {"k1": 0.0, "k2": 0.0, "k3": 0.0}
    shared = {name: elastic[name] for name in ("b", "c") if name in elastic}
    return tuple(
        kind.from_normalised(z_max=z, x_y=x, sigma=0.9, n=n, **(own | shared | (elastic if scale == 0 else {})))
        for scale, (z, x) in enumerate(SIZES)
    )


def device(n=2.0, scales=2, **others):
    """Return an isolator of one or two scales."""
    roll = parts(n, k1=4e4, k2=0.0, k3=2e7)[:scales]
    axial = parts(n, k1=9e4, k2=0.0, k3=1e7, b=math.e, c=8.0)[:scales]
    own = {"roll": laws.Parallel(laws=roll), "axial": laws.Parallel(laws=axial), "coupling": "loop", "loop": LOOP}
    if scales == 1:
        own |= {"roll": roll[0], "axial": axial[0]}
    return wr.Isolator(name="two scales", **(own | others))


def mass_on(isolator, mass=40.0, tilt=35.0):
    """Return a system of a mass on one tilted mount."""
    sites = {"b": f'euler="0 {tilt} 0"'}
    slides = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1"))
    body = f'<body name="mass" pos="0 0 0">{slides}<geom size=".1" mass="{mass}"/><site name="p" euler="0 {tilt} 0"/></body>'
    return wr.load_system(mjcf(deck(sites) + body, [("m", "p", "b", "i")], gravity=G), isolators={"i": isolator})


@pytest.mark.quick
@pytest.mark.parametrize("n", [1.0, 2.0, 1.4])
def test_each_axis_alone_keeps_its_own_law(n):
    law, path = device(n).coupled, path_through(RNG.uniform(-0.015, 0.015, 9), per_segment=3)
    for axis, own in enumerate(law.laws):
        line = np.zeros((path.size, 2))
        line[:, axis] = path
        trace, alone = law.trace(line), own.trace(path)
        np.testing.assert_allclose(trace.force[:, axis], alone.force, rtol=0, atol=1e-9 * np.ptp(alone.force))
        np.testing.assert_allclose(trace.work, alone.work, rtol=0, atol=1e-9 * np.ptp(alone.work))


@pytest.mark.quick
def test_every_scale_keeps_its_own_bound_and_no_closed_path_draws_work():
    law, turns = device().coupled, RNG.uniform(-0.015, 0.015, (40, 2))
    path = np.concatenate([np.zeros((1, 2)), turns, np.zeros((1, 2))])
    for scale in law.scales:
        bound = scale.rate_parameters()[2:4]
        sizes = np.hypot(*(scale.trace(path).hysteretic_state / bound).T)
        assert sizes.max() <= 1.0 + 1e-9
        assert sizes.max() > 0.9
    trace = law.trace(path)
    assert trace.work[-1] > 0.0
    assert trace.work.min() > -1e-9
    states = np.stack([scale.trace(path).hysteretic_state for scale in law.scales], axis=1)
    stored = stored_energy(law, path, states)
    assert stored[0] == 0.0
    assert (np.diff(trace.work - stored) >= -1e-9 * np.ptp(trace.work)).all()  # what is lost only grows


def test_a_second_scale_of_no_force_changes_nothing():
    """The kernels of both engines, against those of one scale."""
    faint = device(
        roll=laws.Parallel(laws=(parts(2.0, k1=4e4, k3=2e7)[0], parts(2.0)[1].scaled(1e-12))),
        axial=laws.Parallel(
            laws=(
                parts(2.0, k1=9e4, k3=1e7, b=math.e, c=8.0)[0],
                parts(2.0, b=math.e, c=8.0)[1].scaled(1e-12),
            )
        ),
    )
    shock = wr.HalfSine(peak=5.0 * G, duration=0.011, direction=[0.6, 0.0, 0.8])
    for engine in ("mujoco", "kernel"):
        two, one = (
            wr.simulate(mass_on(isolator), shock, duration=0.2, timestep=2e-4, engine=engine)
            for isolator in (faint, device(scales=1))
        )
        np.testing.assert_allclose(
            two.mounts["m"].force, one.mounts["m"].force, rtol=0, atol=1e-8 * np.abs(one.mounts["m"].force).max()
        )


def test_both_engines_follow_the_law_in_the_plane():
    """The force of the mount along its path, against the law's own trace of the same deflections."""
    isolator = device()
    shock = wr.HalfSine(peak=5.0 * G, duration=0.011, direction=[0.6, 0.0, 0.8])
    for engine in ("mujoco", "kernel"):
        response = wr.simulate(mass_on(isolator), shock, duration=0.15, timestep=5e-5, engine=engine, sample_rate=20e3)
        mount = response.mounts["m"]
        start = wr.equilibrium(mass_on(isolator)).mounts["m"].deflection
        path = np.concatenate([np.zeros((1, 2)), start[None, [0, 2]], mount.deflection[:, [0, 2]]])
        own = isolator.coupled.trace(path).force[2:]
        error = np.abs(mount.force[:, [0, 2]] - own).max() / np.abs(own).max()
        print(engine, error)
        assert error < 2e-3  # samples of 5e-5 s joined by straight lines


def test_sag_of_one_axis_is_that_of_the_law():
    isolator, mass = device(), 40.0
    found = wr.equilibrium(mass_on(isolator, tilt=0.0)).mounts["m"].deflection[2]
    assert -isolator.axial.trace([0.0, found]).force[-1] == pytest.approx(mass * G, rel=1e-6)


def test_rests_that_are_found_together_are_those_of_one_model():
    """States of both scales carried by the kernel, against those of the path that the engine's equilibrium goes."""
    system = mass_on(device(shear=parts(2.0, k1=4e4)[0]))
    numbers = Numbers(system, equations(system))
    every = np.array([numbers.of(Changes(masses={"mass": factor})) for factor in (1.0, 1.5)])
    rests = equilibrium_solver(system).solve(every, "virgin")
    assert rests.found.all()
    own = wr.equilibrium(system).mounts["m"].deflection
    # Either ends where the force is within 1e-7 of the weight or so.
    np.testing.assert_allclose(rests.mounts[0, 0, 0], own, rtol=0, atol=1e-6 * np.abs(own).max())


def test_cycles_and_tangents_are_those_of_the_law_in_the_plane():
    law, rest, amplitude = device().coupled, np.array([1e-3, -4e-3]), np.array([8e-3, -5e-3])
    angle = 2.0 * np.pi * np.arange(2048) / 2048
    cycle = rest + np.cos(angle)[:, None] * amplitude
    force = law.trace(np.concatenate([np.zeros((1, 2)), np.tile(cycle, (6, 1))])).force[-2048:]
    measured = 2.0 * (np.exp(-1j * angle) @ force) / 2048
    found = plane_cycle(law, rest, np.abs(amplitude)) * amplitude + loop_cycle(law.loop, rest, amplitude) @ amplitude
    np.testing.assert_allclose(found, measured, rtol=1e-3)  # 256 samples of a loop with sharp tips
    end, step = np.array([5e-3, -4e-3]), 1e-8
    states = np.stack([scale.trace([[0.0, 0.0], end]).hysteretic_state[-1] for scale in law.scales], axis=1).ravel()
    turns = np.array([[1.0, 0.0], [0.0, -1.0]])  # both load on both scales
    for tangent, sign in zip(plane_tangents(law, end, states), (1.0, -1.0), strict=True):
        slopes = []
        for turn in turns:
            force = law.trace([[0.0, 0.0], end, end + sign * step * turn]).force[1:]
            slopes.append(np.diff(force, axis=0)[0] / (sign * step))
        slope = np.linalg.solve(turns, np.array(slopes)).T
        np.testing.assert_allclose(tangent, 0.5 * (slope + slope.T), rtol=0, atol=1e-4 * np.abs(slope).max())


@pytest.mark.slow
def test_the_variational_equation_has_the_states_of_both_scales():
    search = OrbitSearch(mass_on(device(shear=parts(2.0, k1=4e4)[0])), direction="z", history="relaxed", accuracy=1.5625e-6)
    with search.flow.ready():
        drive = search.drive(8.0, 3.0)
        x = search.settled(search.coordinates.rest(), drive, 20)
        found = close(search.flow, shot(search.flow, x, drive), tolerance=1e-6, iterations=10)
        columns, quick = monodromy(search.flow, found), variational_of(search.flow).matrix(found)
    # 5e-5; as for one scale both miss where a reversal stands within a step.
    assert np.abs(columns - quick).max() / np.abs(columns).max() < 3e-3


def test_the_file_keeps_both_scales(tmp_path):
    device().save(tmp_path / "two.toml")
    assert wr.load_isolator(tmp_path / "two.toml") == device()


@pytest.mark.quick
def test_scales_that_cannot_be_coupled_are_refused():
    with pytest.raises(ValueError, match="equally many laws in parallel to be coupled, got 2 and 1"):
        device(axial=parts(2.0, k1=9e4, k3=1e7)[0])
    with pytest.raises(ValueError, match="same n to be coupled"):
        device(roll=laws.Parallel(laws=parts(1.0, k1=4e4)))
    stop = laws.Stop(gap_below=0.01, k=1e6)
    with pytest.raises(ValueError, match=r"`axial` must be a Bouc-Wen law to be coupled"):
        device(axial=laws.Parallel(laws=(device().axial.laws[0], stop)))
    assert replace(device(), coupling=None, loop=None).coupled is None
