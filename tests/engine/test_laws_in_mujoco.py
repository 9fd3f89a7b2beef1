"""Every law as a mount axis in MuJoCo: the loops it draws there are those of its trace and of closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from free_bodies import free_pair, momenta, spinning
from house import deck, mjcf, quiet, sdof
from laws_for_tests import LOOPS, example
from scipy.integrate import solve_ivp

import wirerope_mj as wr
from wirerope_mj.mounts.laws import LAWS, BiaxialBoucWen, BoucWen

G = wr.STANDARD_GRAVITY
MASS = 20.0
PER_CYCLE = 400


def prescribed(law, amplitude):
    """Return a system whose mount deflects by minus the base's displacement: its payload weighs 1e12 kg.

    The payload hangs on a body that does not move, so that it does not share the base's initial velocity.
    """
    held = '<joint type="slide" axis="0 0 1" armature="1e12"/><geom size=".1" mass="1"/><site name="p"/>'
    world = deck({"b": ""}, slides="z") + f'<body name="wall"><body name="held">{held}</body></body>'
    limits = wr.Limits(travel=wr.Travel(compression=amplitude, tension=amplitude))  # some laws end beyond
    isolator = wr.Isolator(name="a", axial=law, limits=limits)
    return wr.load_system(mjcf(world, [("m1", "p", "b", "a")]), isolators={"a": isolator})


def cycles(law, amplitude, *, count, frequency=1.0, per_cycle=PER_CYCLE):
    """Return deflection, rate, force and z of the last of `count` cycles of amplitude sin(2 pi f t), one step per sample."""
    omega = 2.0 * np.pi * frequency
    motion = wr.Sine(frequency=frequency, acceleration=amplitude * omega**2, direction="z")
    rate = frequency * per_cycle
    r = wr.simulate(
        prescribed(law, amplitude),
        motion,
        duration=count / frequency,
        timestep=1.0 / rate,
        sample_rate=rate,
        initial="unloaded",
    )
    m, last = r.mounts["m1"], slice(-per_cycle - 1, None)
    x = m.deflection[last, 2]
    # The rig itself: 1e12 kg move by 1e-12 of the forces' second integral.
    np.testing.assert_allclose(x, amplitude * np.sin(omega * r.time[last]), atol=1e-9 * amplitude)
    return x, amplitude * omega * np.cos(omega * r.time[last]), m.force[last, 2], m.hysteretic_state[last, 2]


@pytest.mark.parametrize(("beta", "gamma", "n", "amplitude", "peak", "work"), LOOPS)
def test_loop_integrated_in_mujoco_has_the_closed_form_peak_and_work(beta, gamma, n, amplitude, peak, work):
    # Slowest memory of the start: exp(-2) per cycle, 4e-11 after 12.
    _, v, force, z = cycles(BoucWen(alpha=1, beta=beta, gamma=gamma, n=n), amplitude, count=12)
    # In time the integrand F v is smooth at the reversals: the trapezoidal rule errs by its kinks at z = 0 alone.
    area = (0.5 * (force[1:] * v[1:] + force[:-1] * v[:-1])).sum() / PER_CYCLE
    errors = {"z0": abs(z.max() / peak - 1.0), "W": abs(area / work - 1.0)}
    print(beta, gamma, n, amplitude, errors)
    assert max(errors.values()) < 1e-4, errors


SHAKING = wr.Sine(frequency=10.0, acceleration=3 * G, direction="z")


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(LAWS))
def test_every_law_draws_in_mujoco_the_loop_of_its_trace(name):
    law = example(name)
    settings = {"duration": 0.3, "timestep": 1e-4, "sample_rate": 10_000.0, "initial": "unloaded"}
    native, python = (
        wr.simulate(sdof(law, mass=MASS), SHAKING, callback=callback, engine="mujoco", **settings)
        for callback in ("native", "python")
    )
    m = native.mounts["m1"]
    x, force = m.deflection[:, 2], m.force[:, 2]
    rate = native.bodies["mass"].velocity[:, 2] - native.base.velocity[:, 2]
    trace = law.trace(x, time=native.time, rate=rate)
    error = np.abs(force - trace.force).max() / np.abs(force).max()
    z_error = np.abs(m.hysteretic_state[:, 2] - trace.hysteretic_state).max() / np.abs(force).max()
    print(name, "error", error, "z", z_error, "deflection", x.min(), x.max())
    assert max(error, z_error) < 1e-4
    np.testing.assert_allclose(python.mounts["m1"].force, m.force, rtol=0, atol=1e-10 * np.abs(force).max())
    # It moved both ways, far enough for friction to slip, so that the loop is one.
    assert x.min() < -5e-3
    assert x.max() > 5e-3


# Masing's states grow elastically within a step and are put back onto their yield surface after it.


def spring(law, x):
    """Return Ni's polynomial [N]."""
    return law.k * x + law.k2 * abs(x) * x + law.k3 * x**3


def masing_oscillator(law, times, *, mass, omega, acceleration):
    """Return deflection and force at `times`, from rest relative to a base that accelerates by a sin(w t).

    Split where an element begins to slip or the motion turns: between them the force is linear in the deflection.
    """
    c, h = np.array(law.stiffness), np.array(law.slip_force)
    y, t, slips = np.zeros(2 + c.size), 0.0, np.zeros(c.size)
    out = np.empty((times.size, y.size))
    while t < times[-1]:

        def rates(t, y, slips=slips):
            force = spring(law, y[0]) + y[2:].sum()
            return [y[1], -force / mass - acceleration * math.sin(omega * t), *(c * y[1] * (slips == 0.0))]

        def turn(_t, y):
            return y[1]

        def slip(e, sign):
            def event(_t, state):
                return state[2 + e] - sign * h[e]

            event.terminal, event.direction = True, sign
            return event

        # From rest it follows the first push.
        forward = np.sign(y[1]) or np.sign(rates(t + 1e-9, y)[1])
        turn.terminal, turn.direction = True, -forward
        sticking = [(e, forward) for e in range(c.size) if slips[e] == 0.0]
        events = [turn, *(slip(e, sign) for e, sign in sticking)]
        run = solve_ivp(
            rates, (t, times[-1]), y, method="DOP853", rtol=1e-12, atol=1e-14, events=events, dense_output=True,
            first_step=1e-7,
        )  # fmt: skip
        assert run.success, run.message
        inner = (times >= t) & (times <= run.t[-1])
        if inner.any():
            out[inner] = run.sol(times[inner]).T
        t, y, slips = run.t[-1], run.y[:, -1].copy(), slips.copy()
        if run.t_events[0].size:
            slips[:], y[1] = 0.0, 0.0
        for (e, sign), hits in zip(sticking, run.t_events[1:], strict=True):
            if hits.size:
                slips[e], y[2 + e] = sign, sign * h[e]
    return out[:, 0], spring(law, out[:, 0]) + out[:, 2:].sum(axis=1)


def test_masing_in_mujoco_is_of_second_order():
    law, frequency = example("masing"), 10.0
    times = np.arange(0, 301) / 1000.0
    x, force = masing_oscillator(law, times, mass=MASS, omega=2.0 * np.pi * frequency, acceleration=3 * G)
    per_cycle, found = np.array([100, 200, 400, 800, 1600, 3200]), []
    for steps in per_cycle:
        r = wr.simulate(sdof(law, mass=MASS), SHAKING, duration=0.3, timestep=1.0 / (frequency * steps), initial="unloaded")
        m = r.mounts["m1"]
        errors = np.abs(m.force[:, 2] - force).max() / np.abs(force).max(), np.abs(m.deflection[:, 2] - x).max()
        found.append(max(errors[0], errors[1] / np.abs(x).max()))
    order = np.polyfit(np.log(1.0 / per_cycle), np.log(found), 1)[0]
    print("order", order, dict(zip(per_cycle.tolist(), found, strict=True)))
    # Where a reversal falls inside its step scatters each error, over a factor of 32 in the step.
    assert order > 1.7
    assert found[2] < 1e-4  # 400 steps per cycle


@pytest.mark.parametrize("callback", ["native", "python"])
def test_masing_restarted_from_its_final_state_goes_on_identically(callback):
    system, settings = sdof(example("masing"), mass=MASS), {"timestep": 5e-4, "callback": callback}
    whole = wr.simulate(system, SHAKING, duration=0.2, initial="unloaded", **settings)
    first = wr.simulate(system, SHAKING, duration=0.087, initial="unloaded", **settings)
    second = wr.simulate(system, SHAKING, duration=0.113, initial=first.final_state, **settings)
    last = slice(first.time.size, None)
    for quantity in ("deflection", "force", "hysteretic_state"):
        kept = getattr(whole.mounts["m1"], quantity)[last]
        assert getattr(second.mounts["m1"], quantity)[1:].tobytes() == kept.tobytes()
    # It slips: every element has been at its bound, and none beyond it where the state was kept.
    states = whole.mounts["m1"].internal_states
    assert len(states) == 3
    for values, bound in zip(states.values(), example("masing").slip_force, strict=True):
        assert np.abs(values).max() == pytest.approx(bound, rel=1e-12)


# Friction and relaxation at rest


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_a_load_below_the_friction_creeps_as_stated(share):
    smoothing, mass = 0.02, 20.0
    law = wr.TinkerCutchins(k1=0.0, f0=mass * G / share, smoothing=smoothing)
    r = wr.simulate(
        sdof(law, mass=mass, gravity=G), quiet(), duration=0.4, timestep=1e-4, initial="unloaded", sample_rate=100.0
    )
    x = r.mounts["m1"].deflection[:, 2]
    creep = (x[-1] - x[30]) / (r.time[-1] - r.time[30])
    # The start is forgotten with m smoothing / f0 / (1 - share^2) < 1e-2 s.
    assert creep == pytest.approx(-smoothing * math.atanh(share), rel=1e-6)


def test_zener_rests_on_its_relaxed_stiffness():
    law, mass = example("zener"), 20.0
    system = sdof(law, mass=mass, gravity=G)
    rest = wr.equilibrium(system)
    assert rest.mounts["m1"].deflection[2] == pytest.approx(-mass * G / law.k0, rel=1e-9)
    r = wr.simulate(system, quiet(), duration=0.2, timestep=1e-4)
    np.testing.assert_allclose(r.mounts["m1"].deflection[:, 2], -mass * G / law.k0, rtol=1e-9)
    # A dropped mass ends there too: its damper lets go of the load.
    dropped = wr.simulate(system, quiet(), duration=3.0, timestep=5e-4, initial="unloaded", sample_rate=100.0)
    assert dropped.mounts["m1"].deflection[-1, 2] == pytest.approx(-mass * G / law.k0, rel=1e-6)
    assert dropped.mounts["m1"].deflection[:, 2].min() < -1.3 * mass * G / law.k0


# Coupled roll and shear

PLANE = wr.BoucWen(alpha=6e4, beta=120.0, gamma=80.0, n=1.0, k=3e4)
AXIAL = wr.BoucWen(alpha=2e5, beta=200.0, gamma=100.0, n=1.0, k=1e5)


def platform(turn, coupling, *, shear=PLANE):
    """Return an eccentric platform on four mounts whose sites are turned by `turn` [degrees] about the vertical."""
    corners = [(0.8, 0.5), (0.8, -0.6), (-0.7, 0.5), (-0.7, -0.6)]
    sites = {f"d{i}": f'pos="{x} {y} .9" euler="0 0 {turn}"' for i, (x, y) in enumerate(corners)}
    own = "".join(f'<site name="p{i}" pos="{x} {y} -.1"/>' for i, (x, y) in enumerate(corners))
    body = f'<inertial pos="0 0 0.1" mass="300" diaginertia="40 55 80"/>{own}'
    world = deck(sites) + f'<body name="platform" pos="0 0 1"><freejoint/>{body}</body>'
    isolator = wr.Isolator(name="a", roll=PLANE, shear=shear, axial=AXIAL, coupling=coupling)
    text = mjcf(world, [(f"m{i}", f"p{i}", f"d{i}", "a") for i in range(4)], gravity=G)
    return wr.load_system(text, isolators={"a": isolator})


def test_a_coupled_mount_does_not_know_how_it_was_turned():
    shock = wr.HalfSine(peak=12 * G, duration=0.011, direction=(2.0, 1.0, 1.0), start=0.0075)
    seen = {}
    for coupling in ("biaxial", None):
        for turn in (0.0, 37.0):
            r = wr.simulate(platform(turn, coupling), shock, duration=0.2, timestep=2e-4)
            seen[coupling, turn] = r.bodies["platform"].acceleration
    scale = np.abs(seen["biaxial", 0.0]).max()
    difference = {c: np.abs(seen[c, 0.0] - seen[c, 37.0]).max() / scale for c in ("biaxial", None)}
    print(difference)
    # The same physics in other coordinates: rounding, grown over a thousand steps.
    assert difference["biaxial"] < 1e-9
    # Independent axes do know: their hysteresis depends on the direction.
    assert difference[None] > 1e-2


def test_coupled_mounts_draw_in_mujoco_what_their_law_draws():
    law = replace(PLANE, alpha=9e4, beta=270.0, gamma=180.0, k=2e4)  # z_max = 200 N against 300 N, the same sigma
    shock = wr.HalfSine(peak=12 * G, duration=0.011, direction=(2.0, 1.0, 0.5), start=0.0075)
    system = platform(20.0, "biaxial", shear=law)
    native, python = (
        wr.simulate(system, shock, duration=0.2, timestep=1e-4, sample_rate=10_000.0, callback=callback, engine="mujoco")
        for callback in ("native", "python")
    )
    for name, m in native.mounts.items():
        # The settled platform has no force in the plane, so its states begin at zero as the trace does.
        trace = BiaxialBoucWen(roll=PLANE, shear=law).trace(m.deflection[:, :2])
        scale = np.abs(m.force[:, :2]).max()
        error = np.abs(trace.force - m.force[:, :2]).max() / scale
        print(name, error)
        # Straight lines between samples against the steps of RK4: second order of 1e-4 s where the motion turns.
        assert error < 1e-4
        np.testing.assert_allclose(python.mounts[name].force, m.force, rtol=0, atol=1e-9 * scale)


def test_coupled_mounts_balance_momentum_and_angular_momentum():
    law = wr.BoucWen(alpha=4e3, beta=350.0, gamma=150.0, n=1.0, k=2e3)
    isolator = wr.Isolator(name="i", roll=law, shear=law, axial=law, coupling="biaxial")
    system = wr.load_system(free_pair(law).mjcf, isolators={"i": isolator})
    r = wr.simulate(system, quiet(), duration=0.5, timestep=1e-4, initial=spinning(system))
    momentum, angular = momenta(r)
    drift = [np.abs(q - q[0]).max() / np.linalg.norm(q[0]) for q in (momentum, angular)]
    print(drift)
    # Each body alone changes its momentum by half of what it has; together, as without coupling: rounding, and O(h^4).
    assert 3.0 * np.ptp(r.bodies["a"].velocity, axis=0).max() > 0.5
    assert drift[0] < 1e-12
    assert drift[1] < 1e-10
