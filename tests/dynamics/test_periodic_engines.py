"""Periodic motions by the kernel and by MuJoCo: the same numbers, and MuJoCo wherever the kernel's equations end."""

import numpy as np
import pytest
from house import deck, mjcf, sdof

import wirerope_mj as wr
from wirerope_mj.dynamics.periodic import flow as flows
from wirerope_mj.dynamics.periodic.flow import KernelFlow, MujocoFlow
from wirerope_mj.dynamics.periodic.orbit import OrbitSearch
from wirerope_mj.dynamics.periodic.shooting import close, monodromy, shot
from wirerope_mj.dynamics.periodic.variational import variational_of

HARDENING = wr.SymmetricBoucWen(alpha=1.0, beta=0.5, gamma=0.5, n=1.0, k1=0.5, k2=0.0, k3=0.3)
STOP = 6e-3  # clearance of the mass above the deck [m]


@pytest.fixture
def by_both(monkeypatch):
    """Call something twice: as it is, and with MuJoCo for every system."""

    def both(compute):
        own = compute()
        with monkeypatch.context() as patched:
            patched.setattr(flows, "unsupported_system", lambda system: "MuJoCo is asked for")
            return own, compute()

    return both


def mass_over_deck(*, friction=""):
    """Return a mass on one mount, 6 mm above a deck on which it lands where it moves further."""
    plate = '<geom type="box" size=".2 .2 .01" contype="1" conaffinity="1"/>'
    soft = 'contype="1" conaffinity="1" solref="-40000 -300" solimp=".001 .001 .001"'
    world = (
        deck({"b": 'pos="0 0 .2"'}, slides="z", inside=plate)
        + f'<body name="mass" pos="0 0 {0.11 + STOP}"><joint type="slide" axis="0 0 1" {friction}/>'
        f'<geom type="box" size=".1 .1 .1" mass="3.5" {soft}/><site name="p" pos="0 0 {0.09 - STOP}"/></body>'
    )
    isolators = {"a": wr.Isolator(name="a", axial=wr.KelvinVoigt(k=4000.0, c=10.0))}
    return wr.load_system(mjcf(world, [("m1", "p", "b", "a")]), isolators=isolators)


def search_of(system):
    return OrbitSearch(system, direction="z", history="relaxed", accuracy=1e-4)


@pytest.mark.parametrize("model", ["floating_floor", "cabinet"])  # 72 unknowns, which fill their lanes, and 42
def test_the_kernel_steps_a_model_as_mujoco_does(by_both, model):
    def computed():
        search = search_of(wr.load_system(f"models/{model}.xml"))
        flow = search.flow
        with flow.ready():
            drive = search.drive(8.0, 1.0)
            x = search.settled(search.coordinates.rest(), drive, 2)
            at_start = shot(flow, x, drive)
            matrices = monodromy(flow, at_start), variational_of(flow).matrix(at_start)
            kind = type(flow), flow.taken
            return kind, x, at_start, matrices

    (kind, x, track, matrices), (other_kind, other_x, other, other_matrices) = by_both(computed)
    assert (kind[0], other_kind[0]) == (KernelFlow, MujocoFlow)
    assert kind[1] == other_kind[1]
    # Rounding of either over the steps, 1e-12 of the ranges; accelerations and forces take it times their stiffness.
    # MuJoCo's deck gives way to the floor's weight over the drive's inertia of 1e10: 1e-10 m/s in a stage table.
    np.testing.assert_allclose(x / track.scale, other_x / track.scale, atol=1e-10)
    for name in ("qpos", "qvel", "act", "sensors"):
        one, two = getattr(track.track, name), getattr(other.track, name)
        assert np.abs(one - two).max() < (1e-8 if name == "qvel" else 1e-9) * np.abs(two).max()
    # Difference quotients of 1e-5 make of rounding, 1e-11 at the end of the cabinet's period, 1e-6.
    for one, two in zip(matrices, other_matrices, strict=True):
        assert np.abs(one - two).max() < 2e-6 * np.abs(two).max()


def test_orbits_are_the_same_by_either(by_both):
    system = sdof(HARDENING, mass=1.0)
    own, other = by_both(lambda: wr.periodic_orbit(system, frequency=0.2, acceleration=0.3, direction="z", tolerance=1e-11))
    # Newton's method ends within the tolerance, over 1 - 0.9 of the least damped multiplier.
    np.testing.assert_allclose(own.state.values, other.state.values, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(own.floquet_multipliers, other.floquet_multipliers, atol=1e-9)
    assert (own.iterations, own.model_steps, own.stable) == (other.iterations, other.model_steps, other.stable)


@pytest.mark.parametrize("smoothing", [None, 0.03])
def test_branches_are_the_same_by_either(by_both, smoothing):
    system = sdof(HARDENING, mass=1.0)
    own, other = by_both(
        lambda: wr.follow_branch(
            system, start=0.15, stop=0.2, acceleration=1.0, direction="z", payload="mass", tolerance=1e-10,
            smoothing=smoothing,
        )
    )  # fmt: skip
    assert own.frequency.size == other.frequency.size > 10
    # Where the points stand along the branch follows from difference quotients, to 1e-9; the branch itself does not.
    np.testing.assert_allclose(own.frequency, other.frequency, rtol=1e-8)
    np.testing.assert_allclose(own.amplitude, other.amplitude, rtol=1e-8)
    np.testing.assert_allclose(own.smoothing_width, other.smoothing_width, rtol=1e-8)
    assert own.model_steps == other.model_steps


def test_a_mass_that_lands_on_its_deck_is_mujocos(by_both):
    system = mass_over_deck()
    own, other = by_both(lambda: wr.periodic_orbit(system, frequency=5.0, acceleration=1.7, direction="z"))
    with pytest.warns(wr.AccuracyWarning, match="were struck"):
        assert own.response.mounts["m1"].deflection[:, 2].min() < -STOP
    np.testing.assert_allclose(own.state.values, other.state.values, atol=1e-10)
    np.testing.assert_allclose(own.floquet_multipliers, other.floquet_multipliers, atol=1e-9)
    assert own.model_steps > other.model_steps  # the kernel's that were given up


def test_only_a_copy_that_lands_is_handed_on():
    search = search_of(mass_over_deck())
    with search.flow.ready():
        gentle, drive = search.drive(5.0, 0.5), search.drive(5.0, 2.0)
        search.flow.follow(search.coordinates.rest(), gentle)
        assert search.flow._fallback is None
        starts = np.array([[0.0, 0.0], [2.0 * STOP, 0.0]])
        ends = search.flow.ends(starts, gentle)
        assert search.flow._fallback.taken == gentle.steps
        with (mujoco := MujocoFlow(search.coordinates, search.system)).ready():
            np.testing.assert_allclose(ends, mujoco.ends(starts, gentle), atol=1e-10)
        landed = search.flow.follow(starts[1], drive)
    assert np.isfinite(landed.end).all()


@pytest.mark.slow
def test_a_branch_that_comes_to_land_goes_on(by_both):
    system = mass_over_deck()
    own, other = by_both(
        lambda: wr.follow_branch(
            system, start=1.0, stop=2.5, frequency=5.0, direction="z", payload="mass", tolerance=1e-8,
            largest_step=0.1,
        )
    )  # fmt: skip
    assert own.complete
    np.testing.assert_allclose(own.amplitude, other.amplitude, rtol=1e-6)


def test_dry_friction_in_a_joint_is_mujocos():
    assert isinstance(search_of(mass_over_deck(friction='frictionloss="1"')).flow, MujocoFlow)


def test_a_copy_that_grows_without_bound_ends_as_no_number():
    search = search_of(sdof(HARDENING, mass=1.0))
    with search.flow.ready():
        ends = search.flow.ends(np.array([[0.0, 0.0, 0.0], [1e8, 0.0, 0.0]]), search.drive(0.2, 0.3))
    assert np.isfinite(ends[0]).all()
    assert np.isnan(ends[1]).all()


def test_a_found_motion_is_one_of_mujoco():
    """An orbit of the kernel closes under MuJoCo, too."""
    search = search_of(sdof(HARDENING, mass=1.0))
    with search.flow.ready():
        drive = search.drive(0.2, 0.3)
        x = search.settled(search.coordinates.rest(), drive, 20)
        found = close(search.flow, shot(search.flow, x, drive), tolerance=1e-11, iterations=10)
    with (flow := MujocoFlow(search.coordinates, search.system)).ready():
        assert shot(flow, found.x, drive).residual < 1e-10  # rounding over 128 steps
