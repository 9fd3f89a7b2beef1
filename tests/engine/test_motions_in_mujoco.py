"""The motions drive the base of a simulation, and what stands on it answers as oscillators do."""

import math

import numpy as np
import pytest
from house import sdof

import wirerope_mj as wr

G = wr.STANDARD_GRAVITY
MASS = 3.5
FREQUENCY, DAMPING = 12.0, 0.05
OMEGA = 2 * math.pi * FREQUENCY
MOUNT = wr.KelvinVoigt(k=MASS * OMEGA**2, c=2 * DAMPING * OMEGA * MASS)
MOTIONS = {
    "double half-sine": wr.DoubleHalfSine(peak=300.0, velocity=1.5, displacement=0.04, direction="z", start=0.02),
    "double triangle": wr.DoubleTriangle(peak=300.0, velocity=1.5, displacement=0.04, direction="z", start=0.02),
    "drop table": wr.ShockTableImpact(drop_height=0.1, rebound=0.2, pulse_duration=0.01, start=0.02),
    "struck deck": wr.DecayingSine(
        frequency=14.0, damping=0.05, velocity=1.0, direction="z", impact_duration=0.004, start=0.02
    ),
    "lines": wr.VibrationLines(velocity=[(9.0, 0.02), (14.0, 0.03)], direction="z", duration=0.6, seed=2),
    "random": wr.RandomVibration(psd=[(8.0, 1.0), (60.0, 1.0)], duration=0.6, seed=2, direction="z"),
}


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS.keys())
def test_a_linear_mount_answers_as_the_spectrum_of_the_motion_says(motion):
    r = wr.simulate(sdof(MOUNT, mass=MASS), motion, duration=0.8, timestep=2e-4, sample_rate=1000.0)
    np.testing.assert_allclose(r.base.displacement, motion.displacement(r.time), rtol=0, atol=1e-12)
    np.testing.assert_allclose(r.base.velocity, motion.velocity(r.time), rtol=0, atol=1e-11)
    time = np.arange(0.0, 0.8, 2e-5)
    spectrum = wr.shock_response_spectrum(time, motion.acceleration(time)[:, 2], [FREQUENCY], q=1 / (2 * DAMPING))
    peak = r.peaks.bodies["mass"].acceleration.value
    # The spectrum's samples miss corners by up to 2e-5 s, 1e-4 of an oscillator's period; the simulation's error is smaller.
    assert peak == pytest.approx(spectrum.maximax[0], rel=5e-4)


def test_an_instant_drop_table_impact_is_a_velocity_step():
    table = wr.ShockTableImpact(drop_height=0.1, rebound=0.2, start=0.02)
    step = wr.VelocityStep(velocity=1.2 * math.sqrt(2 * G * 0.1), direction="z", start=0.02)
    one, other = (
        wr.simulate(sdof(MOUNT, mass=MASS), motion, duration=0.2, timestep=2e-4).mounts["m1"].deflection
        for motion in (table, step)
    )
    np.testing.assert_allclose(one, other, rtol=0, atol=1e-12)


def test_a_falling_table_leaves_its_payload_weightless():
    soft = wr.KelvinVoigt(k=MASS * OMEGA**2, c=2 * 0.7 * OMEGA * MASS)
    table = wr.ShockTableImpact(drop_height=0.5, pulse_duration=0.01, fall=True, start=0.05)
    r = wr.simulate(sdof(soft, mass=MASS, gravity=G), table, duration=0.5, timestep=2e-4)
    force, time = r.mounts["m1"].force[:, 2], r.time
    np.testing.assert_allclose(force[time < 0.05], -MASS * G, rtol=1e-6)  # it stands
    # 0.3 s of the fall are 16 time constants 1/(0.7 w) of the mount: e^-16 = 1e-7 of the weight are left.
    late = (time > 0.35) & (time < table.impact)
    assert late.any()
    assert np.abs(force[late]).max() < 1e-6 * MASS * G
    np.testing.assert_allclose(r.bodies["mass"].acceleration[late, 2], -G, rtol=1e-6)
    assert force[(time > table.impact) & (time < table.end)].min() < -10 * MASS * G  # and it is struck
