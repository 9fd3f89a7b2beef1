"""Every law as a mount axis in MuJoCo: the loops it draws there are those of its trace and of closed forms."""

import numpy as np
import pytest
from house import deck, mjcf, sdof
from laws_for_tests import example
from test_laws import LOOPS

import wirerope_mj as wr
from wirerope_mj.laws import LAWS, BoucWen

G = wr.STANDARD_GRAVITY
MASS = 20.0
PER_CYCLE = 400


def prescribed(law):
    """Return a system whose mount deflects by minus the base's displacement: its payload weighs 1e12 kg.

    The payload hangs on a body that does not move, so that it does not share the base's initial velocity.
    """
    held = '<joint type="slide" axis="0 0 1" armature="1e12"/><geom size=".1" mass="1"/><site name="p"/>'
    world = deck({"b": ""}, slides="z") + f'<body name="wall"><body name="held">{held}</body></body>'
    return wr.load_system(mjcf(world, [("m1", "p", "b", "a")]), isolators={"a": wr.Isolator(name="a", axial=law)})


def cycles(law, amplitude, *, count, frequency=1.0, per_cycle=PER_CYCLE):
    """Return deflection, rate, force and z of the last of `count` cycles of amplitude sin(2 pi f t), one step per sample."""
    omega = 2.0 * np.pi * frequency
    motion = wr.Sine(frequency=frequency, acceleration=amplitude * omega**2, direction="z")
    rate = frequency * per_cycle
    r = wr.simulate(
        prescribed(law), motion, duration=count / frequency, timestep=1.0 / rate, sample_rate=rate, initial="unloaded"
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


@pytest.mark.parametrize("name", sorted(LAWS))
def test_every_law_draws_in_mujoco_the_loop_of_its_trace(name):
    law = example(name)
    settings = {"duration": 0.3, "timestep": 1e-4, "sample_rate": 10_000.0, "initial": "unloaded"}
    native, python = (
        wr.simulate(sdof(law, mass=MASS), SHAKING, callback=callback, **settings) for callback in ("native", "python")
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
