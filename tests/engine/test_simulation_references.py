"""Simulations against independent solutions: one degree of freedom split at its events, a rigid floor in NumPy."""

import numpy as np
import pytest
from house import both_engines, deck, hysteresis, mjcf, quiet, sdof
from references import Pulse, RigidFloor, damped_step, matrix, oscillator

import wirerope_mj as wr

G = wr.STANDARD_GRAVITY
MASS = 3.5
LAW = {**hysteresis(alpha=1e5, z_max=300.0), "k1": 2e4, "k3": 5e6}
DURATION = 0.25
MOTIONS = {"half-sine": wr.HalfSine, "sawtooth": wr.Sawtooth}


engine = both_engines()


def shaken(shape, timestep, *, sample_rate=1000.0):
    system = sdof(wr.SymmetricBoucWen(**LAW, k2=0.0), mass=MASS)
    motion = MOTIONS[shape](peak=50 * G, duration=0.011, direction="z", start=0.0123)
    return wr.simulate(system, motion, duration=DURATION, timestep=timestep, initial="unloaded", sample_rate=sample_rate)


def solved(shape, times):
    return oscillator(mass=MASS, **LAW, pulse=Pulse(shape, 50 * G, 0.011, 0.0123), times=times)


def errors(r, ref):
    """Return the largest errors of samples and refined peaks, each relative to the peak of its quantity."""
    m = r.mounts["m1"]
    force = LAW["k1"] * ref.x + LAW["k3"] * ref.x**3 + ref.z
    pairs = {
        "deflection": (m.deflection[:, 2], ref.x),
        "z": (m.hysteretic_state[:, 2], ref.z),
        "force": (m.force[:, 2], force),
        "acceleration": (r.bodies["mass"].acceleration[:, 2], -force / MASS),
        "velocity": (r.bodies["mass"].velocity[:, 2] - r.base.velocity[:, 2], ref.v),
    }
    found = {name: np.abs(a - b).max() / np.abs(b).max() for name, (a, b) in pairs.items()}
    peaks = r.peaks.mounts["m1"]
    found["peak deflection"] = abs(peaks.deflection.value / ref.peak_x - 1.0)
    found["peak force"] = abs(peaks.force.value / ref.peak_force - 1.0)
    found["peak acceleration"] = abs(r.peaks.bodies["mass"].acceleration.value * MASS / ref.peak_force - 1.0)
    return found


@pytest.mark.parametrize("shape", ["half-sine", "sawtooth"])
def test_one_degree_of_freedom_is_within_1e_4_of_the_event_split_solution(shape):
    r = shaken(shape, 1e-4)
    ref = solved(shape, r.time)
    found = errors(r, ref)
    print(shape, {k: f"{v:.1e}" for k, v in found.items()})
    assert max(found.values()) < 1e-4, found
    # The mass is left behind by an upward pulse: a wrong sign of the drive or of the force cannot hide.
    assert r.mounts["m1"].deflection[np.argmax(np.abs(ref.x)), 2] < 0.0


@pytest.mark.parametrize("shape", ["half-sine", "sawtooth"])
def test_the_observed_order_of_convergence_is_about_two_or_better(shape):
    steps = np.array([1e-3, 5e-4, 2.5e-4, 1.25e-4, 6.25e-5])
    found = []
    for step in steps:
        r = shaken(shape, step)
        ref = solved(shape, r.time)
        found.append(max(errors(r, ref)[name] for name in ("deflection", "z", "velocity")))
    order = np.polyfit(np.log(steps), np.log(found), 1)[0]
    print(shape, order, found)
    # Where a kink falls inside its step scatters each error by a factor of a few, over a factor of 16 in the step.
    assert order > 1.8


FLOOR_POINTS = np.array(
    [
        [2, 1, 0.45],
        [2, -1, 0.45],
        [0, 1, 0.45],
        [0, -1, 0.45],
        [-2, 1, 0.45],
        [-2, -1, 0.45],
        [2.2, 0.1, 0.6],
        [-0.3, 1.2, 0.6],
    ]
)
FLOOR_AXES = np.array(
    [np.eye(3)] * 3
    + [[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]] * 2  # turned by 90 degrees about z
    + [[[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]]]  # leaning by 53 degrees about y
    + [[[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]]  # axial along -x
    + [[[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]]  # axial along -y
)
ROLL = {**hysteresis(alpha=1.2e5, z_max=700.0, n=1.4), "k1": 6e4, "k2": 2e5, "k3": 1e7}
SHEAR = {**hysteresis(alpha=1.5e5, z_max=900.0, n=1.0), "k1": 8e4, "k2": 0.0, "k3": 2e7}
AXIAL = {**hysteresis(alpha=4e5, z_max=1500.0, n=1.2), "k1": 3e5, "k2": -1e6, "k3": 4e7}
LAMBDA = 9.0
FLOOR_PULSES = [("z", 15 * G, 0.012, 0.031), ("x", -9 * G, 0.010, 0.036), ("y", 7 * G, 0.011, 0.0335)]
OFFSETS = {"corner": np.array([2.4, 1.3, 0.9])}


def parts():
    """Return (mass, centre, inertia about it) of floor and rack in the world frame, and the rack's rotation."""
    floor = (1800.0, np.array([0.3, -0.2, 0.8]), np.array([[900.0, 60, -40], [60, 2900.0, 30], [-40, 30, 3500.0]]))
    turn = matrix(np.array([np.cos(0.3), 0.0, np.sin(0.3) * 0.6, np.sin(0.3) * 0.8]))
    rack = (260.0, np.array([0.9, 0.5, 0.7]) + turn @ [0.1, 0.0, 0.3], turn @ np.diag([40.0, 50.0, 20.0]) @ turn.T)
    return floor, rack


def floor_system():
    """Return the eccentric floor with a rack welded to it."""
    (m, c, j), _ = parts()
    half = np.array([np.cos(0.3), 0.0, np.sin(0.3) * 0.6, np.sin(0.3) * 0.8])
    frame = [f'xyaxes="{" ".join(map(str, [*a[:, 0], *a[:, 1]]))}"' for a in FLOOR_AXES]
    place = [f'pos="{" ".join(map(str, p))}"' for p in FLOOR_POINTS]
    own = [f'pos="{" ".join(map(str, p - [0.0, 0.0, 0.5]))}"' for p in FLOOR_POINTS]
    sites = {f"d{i}": f"{place[i]} {frame[i]}" for i in range(8)}
    full = f"{j[0, 0]} {j[1, 1]} {j[2, 2]} {j[0, 1]} {j[0, 2]} {j[1, 2]}"
    corner = OFFSETS["corner"] - [0.0, 0.0, 0.5]
    world = deck(sites) + (
        f'<body name="floor" pos="0 0 .5"><freejoint/><inertial pos="{c[0]} {c[1]} {c[2] - 0.5}" mass="{m}" '
        f'fullinertia="{full}"/>'
        + "".join(f'<site name="f{i}" {own[i]}/>' for i in range(8))
        + f'<site name="point/corner" pos="{corner[0]} {corner[1]} {corner[2]}"/>'
        f'<body name="rack" pos=".9 .5 .2" quat="{" ".join(map(str, half))}">'
        '<inertial pos=".1 0 .3" mass="260" diaginertia="40 50 20"/></body></body>'
    )
    text = mjcf(world, [(f"m{i}", f"f{i}", f"d{i}", "a") for i in range(8)], gravity=G)
    axial = wr.AsymmetricBoucWen(**AXIAL, b=np.e**3, c=LAMBDA / 3)
    isolator = wr.Isolator(name="a", roll=wr.SymmetricBoucWen(**ROLL), shear=wr.SymmetricBoucWen(**SHEAR), axial=axial)
    return wr.load_system(text, isolators={"a": isolator})


def rigid_floor():
    """Return the same floor and rack as one rigid body."""
    both = parts()
    mass = sum(part[0] for part in both)
    centre = sum(m * c for m, c, _ in both) / mass
    inertia = np.zeros((3, 3))
    for m, c, j in both:
        r = c - centre
        inertia += j + m * (r @ r * np.eye(3) - np.outer(r, r))
    rows = [{**ROLL, "lam": 0.0}, {**SHEAR, "lam": 0.0}, {**AXIAL, "lam": LAMBDA}]
    law = {key: np.array([row[key] for row in rows]) for key in rows[0]}
    return RigidFloor(mass, inertia, centre, FLOOR_POINTS, FLOOR_AXES, law, G)


@pytest.fixture(scope="module")
def floor_runs():
    """Return the simulation of the floor at 1e-4 s and the reference at the same times."""
    axes = {"x": 0, "y": 1, "z": 2}
    motion = None
    for direction, peak, duration, start in FLOOR_PULSES:
        pulse = wr.HalfSine(peak=peak, duration=duration, direction=direction, start=start)
        motion = pulse if motion is None else motion + pulse
    r = wr.simulate(floor_system(), motion, duration=0.25, timestep=1e-4, initial="unloaded", sample_rate=1000.0)
    pulses = [(Pulse("half-sine", peak, d, s), np.eye(3)[axes[a]]) for a, peak, d, s in FLOOR_PULSES]
    corners = sorted({0.0, 0.25, *(s for *_, s in FLOOR_PULSES), *(s + d for _, _, d, s in FLOOR_PULSES)})
    model = rigid_floor()
    states = model.solve(pulses, r.time, corners=corners)
    deck_position = np.array([sum(p.displacement(t) * u for p, u in pulses) for t in r.time])
    deck_velocity = np.array([sum(p.velocity(t) * u for p, u in pulses) for t in r.time])
    return r, model, states, deck_position, deck_velocity


def relative(a, b):
    """Return the largest distance of two histories of vectors over the largest vector."""
    return np.linalg.norm(a - b, axis=-1).max() / np.linalg.norm(b, axis=-1).max()


@pytest.mark.slow
def test_an_eccentric_floor_on_eight_mounts_follows_newton_and_euler(floor_runs):
    r, model, states, deck_position, deck_velocity = floor_runs
    found = {}
    rows = [model.mounts(y, p, v) for y, p, v in zip(states, deck_position, deck_velocity, strict=True)]
    for i in range(8):
        m = r.mounts[f"m{i}"]
        found[f"deflection {i}"] = relative(m.deflection, np.array([row[0][i] for row in rows]))
        found[f"force {i}"] = relative(m.force, np.array([row[1][i] for row in rows]))
        found[f"z {i}"] = relative(m.hysteretic_state, states[:, 13:].reshape(-1, 8, 3)[:, i])
    rates = np.array([model.rates(y, p, v) for y, p, v in zip(states, deck_position, deck_velocity, strict=True)])
    turns = np.array([matrix(q / np.linalg.norm(q)) for q in states[:, 3:7]])
    spin, spin_rate = (np.einsum("tij,tj->ti", turns, w) for w in (states[:, 10:13], rates[:, 10:13]))
    (_, floor_centre, _), (_, rack_centre, _) = parts()
    offsets = {
        "floor": (r.bodies["floor"], floor_centre),
        "rack": (r.bodies["rack"], rack_centre),
        "corner": (r.points["corner"], OFFSETS["corner"]),
    }
    for name, (part, place) in offsets.items():
        arm = np.einsum("tij,j->ti", turns, place - model.centre)
        start = states[0, :3] + place - model.centre
        found[f"{name} position"] = relative(part.position - start, states[:, :3] + arm - start)
        found[f"{name} velocity"] = relative(part.velocity, states[:, 7:10] + np.cross(spin, arm))
        acceleration = rates[:, 7:10] + np.cross(spin_rate, arm) + np.cross(spin, np.cross(spin, arm))
        found[f"{name} acceleration"] = relative(part.acceleration, acceleration)
        found[f"{name} angular velocity"] = relative(part.angular_velocity, spin)
        found[f"{name} angular acceleration"] = relative(part.angular_acceleration, spin_rate)
    print({k: f"{v:.1e}" for k, v in sorted(found.items(), key=lambda item: -item[1])[:8]})
    print("largest deflection", max(np.abs(r.mounts[f"m{i}"].deflection).max() for i in range(8)), np.abs(spin).max())
    assert max(found.values()) < 1e-4, found
    corner = r.points["corner"]
    moved = corner.position - OFFSETS["corner"] - r.base.displacement
    # The point is measured from the deck as integrated, whose own error after two pulses is 1e-10 m.
    np.testing.assert_allclose(corner.relative_displacement, moved, atol=1e-9)


@pytest.mark.slow
def test_peaks_of_the_floor_are_those_of_the_reference(floor_runs):
    r, model, states, deck_position, deck_velocity = floor_runs
    rows = [model.mounts(y, p, v) for y, p, v in zip(states, deck_position, deck_velocity, strict=True)]
    for i in range(8):
        norm = np.linalg.norm([row[0][i] for row in rows], axis=1)
        top = int(np.argmax(norm))
        # Samples are 1 ms apart; the top of the smooth norm is found by a quartic through the five around it.
        window = np.arange(max(top - 2, 0), min(top + 3, norm.size))
        fit = np.polyfit(r.time[window] - r.time[top], norm[window], window.size - 1)
        extremes = np.roots(np.polyder(fit))
        real = extremes[(abs(extremes.imag) < 1e-9) & (abs(extremes.real) < 1e-3)].real
        peak = np.polyval(fit, real).max()
        assert r.peaks.mounts[f"m{i}"].deflection.value == pytest.approx(peak, rel=1e-4)


@pytest.mark.quick
def test_a_velocity_step_on_a_linear_mount_is_the_closed_form():
    k, c, velocity = 3e4, 120.0, 2.0
    system = sdof(wr.KelvinVoigt(k=k, c=c), mass=MASS)
    for start in (0.0, 0.0207):
        motion = wr.VelocityStep(velocity=velocity, direction="z", start=start)
        r = wr.simulate(system, motion, duration=0.4, timestep=1e-4, initial="unloaded")
        time = np.maximum(r.time - start, 0.0)
        x, v = damped_step(k=k, c=c, mass=MASS, velocity=velocity, time=time)
        after = r.time >= start
        x, v = np.where(after, x, 0.0), np.where(after, v, 0.0)
        # Smooth between the segments: RK4 of a 15 Hz mount errs by 1e-9 of the peak at 1e-4 s; the drive's finite inertia
        # of 1e10 kg is not seen.
        assert np.abs(r.mounts["m1"].deflection[:, 2] - x).max() < 1e-8 * np.abs(x).max()
        after = r.time > start + 1e-9  # at the instant itself the sample is the one before the jump
        relative_velocity = r.bodies["mass"].velocity[:, 2] - r.base.velocity[:, 2]
        assert np.abs(relative_velocity - v)[after].max() < 1e-8 * velocity
        force = k * x + c * v
        assert np.abs(r.mounts["m1"].force[:, 2] - force)[after].max() < 1e-7 * np.abs(force).max()


@pytest.mark.quick
def test_a_sine_starts_on_its_steady_oscillation_and_does_not_drift():
    frequency, level = 8.0, 5.0
    system = sdof(wr.BoucWen(**hysteresis(alpha=6e4, z_max=40.0), k=2e4), mass=MASS)
    motion = wr.Sine(frequency=frequency, acceleration=level, direction="z")
    r = wr.simulate(system, motion, duration=2.0, timestep=5e-4, initial="unloaded")
    steady = level / (2 * np.pi * frequency) ** 2
    base = r.bodies["deck"].position[:, 2] - r.bodies["deck"].position[0, 2] + r.base.displacement[0, 2]
    # Eight steps per degree of the sine: RK4's phase error over 16 periods is far below 1e-6 of the amplitude.
    np.testing.assert_allclose(base, -steady * np.sin(2 * np.pi * frequency * r.time), atol=1e-6 * steady)
    mass = r.bodies["mass"].position[:, 2]
    # 8 Hz lies below the mount's resonance (25 Hz): the mass follows the base and oscillates about where it was.
    assert np.abs(mass - mass[0]).max() < 3.0 * steady
    late = r.time > 1.0
    assert abs(mass[late].mean() - mass[~late].mean()) < 0.02 * steady


@pytest.mark.quick
@pytest.mark.parametrize(("start", "stop"), [(4.0, 16.0), (16.0, 4.0)])
def test_a_sweep_up_or_down_moves_the_base_as_the_motion_says(start, stop):
    system = sdof(wr.BoucWen(**hysteresis(alpha=6e4, z_max=40.0), k=2e4), mass=MASS)
    motion = wr.Sweep(start=start, stop=stop, rate=40.0, acceleration=5.0, direction="z")
    assert motion.duration == pytest.approx(3.0)
    r = wr.simulate(system, motion, duration=3.0, timestep=5e-4, initial="unloaded")
    largest = 5.0 / (2 * np.pi * 4.0) ** 2
    base = r.bodies["deck"].position[:, 2] - r.bodies["deck"].position[0, 2]
    # RK4's integration of the base at 125 steps per period or more against the exact integrals.
    wanted = r.base.displacement[:, 2] - r.base.displacement[0, 2]
    assert np.abs(base - wanted).max() < 1e-6 * largest
    assert np.abs(r.base.displacement[:, 2]).max() < 1.2 * largest
    assert np.abs(r.bodies["mass"].position[:, 2] - 0.3).max() < 4.0 * largest


@pytest.mark.parametrize("accuracy", [1e-3, 1e-4])
@pytest.mark.parametrize("shape", ["half-sine", "sawtooth"])
def test_a_step_that_was_chosen_keeps_the_accuracy_asked_for(shape, accuracy):
    system = sdof(wr.SymmetricBoucWen(**LAW, k2=0.0), mass=MASS)
    motion = MOTIONS[shape](peak=50 * G, duration=0.011, direction="z", start=0.0123)
    # 125 samples a second do not force the step.
    r = wr.simulate(system, motion, duration=DURATION, initial="unloaded", accuracy=accuracy, sample_rate=125.0)
    found = errors(r, solved(shape, r.time))
    worst = max(found["deflection"], found["acceleration"], found["peak deflection"], found["peak force"])
    print(shape, accuracy, "step", r.timestep, "estimated", r.estimated_error, "true", worst)
    assert r.estimated_error <= accuracy
    # The estimate compares h with h / 2 at the observed order; the truth may lie beyond it where a kink is missed by both.
    assert worst < 1.5 * accuracy
    assert r.numerics.accuracy == accuracy


@pytest.mark.quick
def test_only_the_motion_relative_to_the_base_counts():
    """After the pulse the base coasts: a state carried over to a base at rest goes on in the same way."""
    system = sdof(wr.SymmetricBoucWen(**LAW, k2=0.0), mass=MASS)
    shock = wr.HalfSine(peak=50 * G, duration=0.011, direction="z", start=0.003)
    first = wr.simulate(system, shock, duration=0.05, timestep=1e-4, initial="unloaded")
    coasting, resting = (
        wr.simulate(system, motion, duration=0.1, timestep=1e-4, initial=first.final_state) for motion in (shock, quiet())
    )
    assert np.abs(coasting.bodies["deck"].velocity[:, 2]).min() > 3.0
    assert np.abs(resting.bodies["deck"].velocity[:, 2]).max() < 1e-9
    a, b = coasting.mounts["m1"], resting.mounts["m1"]
    # Positions of half a metre and their differences of centimetres: rounding of 1e-16 m on 1e5 N/m, amplified a few times.
    np.testing.assert_allclose(b.deflection, a.deflection, rtol=0, atol=1e-11)
    np.testing.assert_allclose(b.force, a.force, rtol=0, atol=1e-6)


@pytest.mark.quick
def test_a_deck_whose_slides_are_turned_moves_along_the_world():
    law = wr.KelvinVoigt(k=2e4, c=30.0)
    slides = (
        '<joint name="u" type="slide" axis="1 1 0"/><joint name="v" type="slide" axis="0 1 0" stiffness="1e3" damping="50"/>'
        '<joint name="w" type="slide" axis="0 0 -1"/>'
    )
    world = (
        f'<body name="deck" euler="0 0 30">{slides}<geom size=".1" mass="5"/>'
        '<site name="b" pos="0 0 .2" euler="0 0 -30"/></body>'
        '<body name="mass" pos="0 0 .3"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>'
        '<joint type="slide" axis="0 0 1"/><geom size=".1" mass="3.5"/><site name="p" pos="0 0 -.1"/></body>'
    )
    straight = deck({"b": 'pos="0 0 .2"'}) + world[world.index('<body name="mass"') :]
    shock = wr.HalfSine(peak=20 * G, duration=0.011, direction=(1.0, -2.0, 3.0), start=0.003)
    runs = []
    for bodies in (world, straight):
        isolator = wr.Isolator(name="a", roll=law, shear=law, axial=law)
        system = wr.load_system(mjcf(bodies, [("m", "p", "b", "a")], gravity=G), isolators={"a": isolator})
        runs.append(wr.simulate(system, shock, duration=0.1, timestep=1e-4))
    turned, plain = runs
    velocity = turned.bodies["deck"].velocity - turned.base.velocity
    # RK4 of the pulse at 1e-4 s, 3e-10 of the velocity; springs on driven slides are taken off them.
    assert np.abs(velocity).max() < 1e-8
    np.testing.assert_allclose(turned.mounts["m"].force, plain.mounts["m"].force, rtol=0, atol=1e-5)


@pytest.mark.quick
def test_points_on_a_chain_of_joints_accelerate_as_their_positions_say():
    """Every kind of joint between the deck and a point: what is reported are derivatives of what is reported."""
    chain = (
        '<body name="box" pos="0 0 .3"><freejoint/><geom size=".2" mass="9"/><site name="p" pos=".05 0 -.1"/>'
        '<body name="arm" pos=".1 0 .2"><joint type="ball" damping=".02"/><geom pos="0 0 .2" size=".05" mass="1"/>'
        '<body name="rod" pos="0 0 .3"><joint axis="0 1 0"/><joint axis="1 0 0" pos="0 .02 0"/>'
        '<geom pos=".1 .1 .2" size=".04" mass=".5"/><body name="ring" pos="0 0 .1">'
        '<joint type="slide" axis="1 0 1" stiffness="80"/>'
        '<geom size=".03" mass=".2"/><site name="point/ring" pos=".02 .01 .03"/></body></body></body></body>'
    )
    law = wr.KelvinVoigt(k=2e4, c=60.0)
    isolator = wr.Isolator(name="a", roll=law, shear=law, axial=law)
    text = mjcf(deck({"b": 'pos=".05 0 .2"'}) + chain, [("m", "p", "b", "a")], gravity=G)
    system = wr.load_system(text, isolators={"a": isolator})
    # Smooth from the first instant: a sine, released with the deck's own velocity.
    motion = wr.Sine(frequency=9.0, acceleration=30.0, direction=(1.0, 2.0, 2.0))
    h = 1e-4
    r = wr.simulate(system, motion, duration=0.4, timestep=h, initial="unloaded", sample_rate=1 / h)
    pairs = {"velocity": "position", "acceleration": "velocity", "angular_acceleration": "angular_velocity"}
    for name, part in (*r.bodies.items(), ("point/ring", r.points["ring"])):
        for upper, lower in pairs.items():
            q, rate = getattr(part, lower), getattr(part, upper)
            numerical = (q[:-4] - 8 * q[1:-3] + 8 * q[3:-1] - q[4:]) / (12 * h)
            error = np.abs(numerical - rate[2:-2]).max() / max(np.abs(rate).max(), 1e-9)
            # Fourth-order differences of a chain that swings at some 10 Hz; a missing Coriolis term is percents.
            assert error < 1e-6, (name, upper, error)
    assert np.abs(r.bodies["ring"].angular_velocity).max() > 1.0
