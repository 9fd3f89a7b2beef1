"""Energy over a shock, and momentum of bodies that only a mount joins."""

import mujoco
import numpy as np
import pytest
from free_bodies import free_pair, momenta, spinning
from house import both_engines, deck, hysteresis, mjcf, quiet, rotation, sdof
from scipy.integrate import cumulative_simpson

import wirerope_mj as wr

G = wr.STANDARD_GRAVITY
STATE = mujoco.mjtState.mjSTATE_INTEGRATION
CORNERS = np.array([[0.8, 0.5, -0.1], [0.8, -0.6, -0.1], [-0.7, 0.5, -0.1], [-0.7, -0.6, -0.1]])
INERTIA = np.array([40.0, 55.0, 80.0])
MASS = 300.0
LAWS = {
    "roll": {**hysteresis(alpha=6e4, z_max=300.0, n=1.0), "k": 3e4},
    "shear": {**hysteresis(alpha=8e4, z_max=350.0, n=1.5), "k": 4e4},
    "axial": {**hysteresis(alpha=2e5, z_max=600.0, n=1.2), "k": 1e5},
}


engine = both_engines()


def platform():
    """Return a rigid platform on four Bouc-Wen mounts, with its centre of mass off the middle."""
    sites = {f"d{i}": f'pos="{c[0]} {c[1]} {c[2] + 1}"' for i, c in enumerate(CORNERS)}
    own = "".join(f'<site name="p{i}" pos="{c[0]} {c[1]} {c[2]}"/>' for i, c in enumerate(CORNERS))
    inertial = f'<inertial pos="0 0 0" mass="{MASS}" diaginertia="{INERTIA[0]} {INERTIA[1]} {INERTIA[2]}"/>'
    world = deck(sites) + f'<body name="platform" pos="0 0 1"><freejoint/>{inertial}{own}</body>'
    isolator = wr.Isolator(name="a", **{axis: wr.BoucWen(**law) for axis, law in LAWS.items()})
    return wr.load_system(
        mjcf(world, [(f"m{i}", f"p{i}", f"d{i}", "a") for i in range(4)], gravity=G), isolators={"a": isolator}
    )


def test_the_base_does_the_work_that_is_stored_and_dissipated():
    shock = wr.HalfSine(peak=20 * G, duration=0.011, direction=(2.0, -1.0, 2.0), start=0.01)
    r = wr.simulate(platform(), shock, duration=0.3, timestep=5e-5, sample_rate=20_000.0)
    body = r.bodies["platform"]
    turn = rotation(body.orientation)
    spin = np.einsum("tji,tj->ti", turn, body.angular_velocity)
    kinetic = 0.5 * MASS * (body.velocity**2).sum(1) + 0.5 * (INERTIA * spin**2).sum(1)
    potential = MASS * G * body.position[:, 2]
    alpha, beta, gamma, n, k = (np.array([law[key] for law in LAWS.values()]) for key in ("alpha", "beta", "gamma", "n", "k"))
    elastic, loss, supplied = np.zeros(r.time.size), np.zeros(r.time.size), np.zeros(r.time.size)
    for i, corner in enumerate(CORNERS):
        m = r.mounts[f"m{i}"]
        x, z = m.deflection, m.hysteretic_state
        rate = body.velocity + np.cross(body.angular_velocity, turn @ corner) - r.base.velocity
        elastic += (0.5 * k * x**2 + 0.5 * z**2 / alpha).sum(1)
        # z v - z zdot / alpha with the law's own zdot: what does not go into z^2 / (2 alpha).
        loss += (z / alpha * (gamma + beta * np.sign(rate) * np.sign(z)) * np.abs(z) ** n * rate).sum(1)
        supplied += -(m.force * r.base.velocity).sum(1)
    work, dissipated = (cumulative_simpson(p, x=r.time, initial=0.0) for p in (supplied, loss))
    energy = kinetic + potential + elastic
    balance = work - (energy - energy[0]) - dissipated
    peak = np.abs(work).max()
    print("energy balance", np.abs(balance).max() / peak, "peak", peak, "dissipated", dissipated[-1])
    # 1e-8 at 5e-5 s, where every reversal costs O(h^2); a wrong sign or a factor of 2 in any term is 1e-1 or more.
    assert np.abs(balance).max() < 1e-4 * peak
    assert dissipated[-1] > 0.05 * peak
    assert kinetic.max() > 0.1 * peak


def test_the_platform_dissipates_what_its_loops_enclose():
    law = wr.BoucWen(**hysteresis(alpha=1e5, z_max=200.0), k=3e4)
    shock = wr.HalfSine(peak=30 * G, duration=0.008, direction="z", start=0.01)
    r = wr.simulate(sdof(law), shock, duration=0.4, timestep=5e-5, initial="unloaded", sample_rate=20_000.0)
    m = r.mounts["m1"]
    x, z, force = m.deflection[:, 2], m.hysteretic_state[:, 2], m.force[:, 2]
    enclosed = 0.5 * ((force[1:] + force[:-1]) * np.diff(x)).sum()
    stored = 0.5 * law.k * x[-1] ** 2 + 0.5 * z[-1] ** 2 / law.alpha
    relative = r.bodies["mass"].velocity[-1, 2] - r.base.velocity[-1, 2]
    # In the base's frame, after the pulse, nothing but the mount takes energy from the mass.
    after = int(np.searchsorted(r.time, 0.018 + 1e-9))
    start = r.bodies["mass"].velocity[after, 2] - r.base.velocity[after, 2]
    taken = 0.5 * ((force[after + 1 :] + force[after:-1]) * np.diff(x[after:])).sum()
    lost = 0.5 * 3.5 * (start**2 - relative**2)
    # Trapezoids of 5e-5 s under a curve with corners: 1e-5 of the energy.
    assert taken == pytest.approx(lost, abs=1e-4 * 0.5 * 3.5 * start**2)
    assert enclosed - stored > 0.2 * 0.5 * 3.5 * start**2


@pytest.fixture(scope="module")
def tumbling():
    system = free_pair(wr.KelvinVoigt(k=4e3, c=8.0))
    return wr.simulate(system, quiet(), duration=0.5, timestep=1e-4, initial=spinning(system), sample_rate=10_000.0)


BUMPER = wr.Stop(gap_below=8e-3, gap_above=8e-3, k=4e4, rounding=1e-3, loss=0.3, reversal=1e-3, c=4.0)
CURVES = wr.Tabulated(
    deflection=[-0.1, 0.0, 0.05], upper=[-250.0, 8.0, 300.0], lower=[-280.0, -8.0, 250.0], yield_deflection=2e-3,
    extrapolate=True,
)  # fmt: skip


@pytest.mark.parametrize(
    "law",
    [
        wr.KelvinVoigt(k=4e3, c=8.0),
        wr.BoucWen(**hysteresis(alpha=4e3, z_max=8.0), k=2e3),
        CURVES,
        wr.Parallel(laws=[wr.KelvinVoigt(k=4e3, c=8.0), BUMPER]),
    ],
)
def test_a_free_pair_joined_by_one_mount_keeps_its_momenta(law):
    system = free_pair(law)
    r = wr.simulate(system, quiet(), duration=0.5, timestep=1e-4, initial=spinning(system))
    momentum, angular = momenta(r)
    moved = np.abs(r.mounts["m"].deflection).max()
    drift = [np.abs(q - q[0]).max() / np.linalg.norm(q[0]) for q in (momentum, angular)]
    # The pair must really interact: each body alone changes its momentum by half of what it has.
    alone = 3.0 * np.ptp(r.bodies["a"].velocity, axis=0).max()
    print("momenta", drift, "largest deflection", moved, alone)
    assert alone > 0.5
    assert moved > 0.01
    # Sums of forces vanish to rounding; angular momentum is quadratic in the state, so that RK4 keeps it to O(h^4).
    assert drift[0] < 1e-12
    assert drift[1] < 1e-10


def test_the_mount_sees_its_rate_from_a_rotating_base(tumbling):
    law = wr.KelvinVoigt(k=4e3, c=8.0)
    m = tumbling.mounts["m"]
    # The viscous part of the force shows the rate that the mount was given.
    rate = (m.force - law.k * m.deflection) / law.c
    h = 1e-4
    d = m.deflection
    numerical = (d[:-4] - 8 * d[1:-3] + 8 * d[3:-1] - d[4:]) / (12 * h)
    peak = np.linalg.norm(rate, axis=1).max()
    # Central differences of fourth order over 1e-4 s of a motion slower than 50 Hz: 1e-8 of the peak. Leaving out the base's
    # rotation would cost omega |d| = 3 rad/s x the deflection, here more than 1e-2 of the peak.
    error = np.abs(rate[2:-2] - numerical).max() / peak
    spin = np.linalg.norm(tumbling.bodies["b"].angular_velocity, axis=1)
    share = (spin * np.linalg.norm(d, axis=1)).max() / peak
    print("rate error", error, "what rotation contributes", share)
    assert error < 1e-6
    assert share > 1e-2


def test_a_point_on_a_tumbling_body_accelerates_as_its_positions_say(tumbling):
    h = 1e-4
    tip, body = tumbling.points["tip"], tumbling.bodies["a"]
    for part in (tip, body):
        x, v = part.position, part.velocity
        velocity = (x[:-4] - 8 * x[1:-3] + 8 * x[3:-1] - x[4:]) / (12 * h)
        acceleration = (v[:-4] - 8 * v[1:-3] + 8 * v[3:-1] - v[4:]) / (12 * h)
        # Fourth-order differences; 1e-6 leaves two orders above their own error.
        assert np.abs(velocity - v[2:-2]).max() < 1e-6 * np.abs(v).max()
        assert np.abs(acceleration - part.acceleration[2:-2]).max() < 1e-6 * np.abs(part.acceleration).max()
    w, alpha = tip.angular_velocity, tip.angular_acceleration
    arm = tip.position - body.position
    rigid = body.acceleration + np.cross(alpha, arm) + np.cross(w, np.cross(w, arm))
    # The same rigid-body formula in other words: equal to rounding.
    np.testing.assert_allclose(tip.acceleration, rigid, atol=1e-11 * np.abs(rigid).max())
    centripetal = np.linalg.norm(np.cross(w, np.cross(w, arm)), axis=1).max()
    assert centripetal > 0.05 * np.linalg.norm(rigid, axis=1).max()


def test_a_mount_on_a_hinge_of_the_base_turns_with_it():
    law = wr.KelvinVoigt(k=3e4, c=60.0)
    hinge = (
        '<body name="arm"><joint name="arm_hinge" type="hinge" axis="0 1 0" stiffness="900" damping=".5"/>'
        '<geom size=".1" mass="4"/><geom pos=".4 0 0" size=".1" mass="4"/><site name="b" pos=".4 0 .2"/></body>'
    )
    payload = '<body name="load" pos=".4 0 .3"><freejoint/><geom size=".1" mass="6"/><site name="p" pos="0 0 -.1"/></body>'
    text = mjcf(deck({}, inside=hinge) + payload, [("m", "p", "b", "i")])
    system = wr.load_system(text, isolators={"i": wr.Isolator(name="i", roll=law, shear=law, axial=law)})
    assert system.base == "deck"
    shock = wr.HalfSine(peak=10 * G, duration=0.02, direction="z", start=0.005)
    r = wr.simulate(system, shock, duration=0.2, timestep=1e-4, initial="unloaded", sample_rate=10_000.0)
    m, arm = r.mounts["m"], r.bodies["arm"]
    rate = (m.force - law.k * m.deflection) / law.c
    d = m.deflection
    numerical = (d[:-4] - 8 * d[1:-3] + 8 * d[3:-1] - d[4:]) / 12e-4
    smooth = (np.abs(r.time[2:-2] - 0.005) > 3e-4) & (np.abs(r.time[2:-2] - 0.025) > 3e-4)
    error = np.abs(rate[2:-2] - numerical)[smooth].max() / np.abs(rate).max()
    spin = np.abs(arm.angular_velocity[:, 1]).max()
    print("hinged base: rate error", error, "spin", spin)
    assert spin > 1.0
    # As above; the corners of the pulse, where differences fail, are left out.
    assert error < 1e-6
    # Euler's equation of the arm about its hinge: spring, damper, the mount's reaction at the payload's point, and the
    # inertia of two balls whose centre, 0.2 m out, the deck carries along.
    load = r.bodies["load"]
    force = np.einsum("tij,tj->ti", rotation(arm.orientation), m.force)
    place = load.position + rotation(load.orientation) @ [0.0, 0.0, -0.1] - r.base.displacement
    angle = 2.0 * np.arctan2(arm.orientation[:, 2], arm.orientation[:, 0])
    inertia = 2 * 0.4 * 4 * 0.1**2 + 4 * 0.4**2
    moment = np.cross(place, force)[:, 1] - 900.0 * angle - 0.5 * arm.angular_velocity[:, 1]
    moment += 8.0 * 0.2 * np.cos(angle) * r.base.acceleration[:, 2]
    inside = np.min(np.abs(r.time[:, None] - [0.005, 0.025]), axis=1) > 1e-9
    reached = inertia * arm.angular_acceleration[:, 1]
    # The deck is not moved by what pushes on 1e10 kg, to 1e-7; its integrated place differs by less.
    assert np.abs(reached - moment)[inside].max() < 1e-6 * np.abs(reached).max()
    np.testing.assert_allclose(6.0 * load.acceleration, -force, atol=1e-9 * np.abs(force).max())
