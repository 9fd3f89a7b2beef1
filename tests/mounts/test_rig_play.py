"""Play in a record is named with its size, behind any device and in noise, and where there is none it is not."""

import numpy as np
import pytest
from foreign_devices import dead_zone, few_sliders, iwan, lugre
from laws_for_tests import PARAMETERS, example

import wirerope_mj as wr
from wirerope_mj.mounts.test_rig.faults import play_in

TIME = np.linspace(0.0, 8.0, 4001)
NOISE = (0.0, 0.03)

FRICTION = {
    "sharp": wr.BoucWen.from_normalised(z_max=300.0, x_y=0.4e-3, sigma=0.6, n=2.0, k=4e3),
    "soft": wr.BoucWen.from_normalised(z_max=300.0, x_y=0.8e-3, sigma=0.6, n=1.0, k=4e3),
    "sliders": wr.Masing(stiffness=[3e5, 1e5, 3e4], slip_force=[100.0, 100.0, 50.0]),
}
"""Devices whose force is friction for the most part: of a spring with play the dead zone stays where it is."""


def path(amplitude):
    return amplitude * np.sin(2.0 * np.pi * TIME) * np.minimum(TIME, 1.0)


def noisy(force, level):
    return force + level * 0.5 * np.ptp(force) * np.random.default_rng(5).standard_normal(force.size)


def with_play(law, amplitude, width):
    """Return deflection and force of a law behind a pin with play, whose deflection is a sine."""
    strokes = 9
    ends = amplitude * np.where(np.arange(strokes + 1) % 2, 1.0, -1.0)
    inner = np.concatenate([np.linspace(a, b, 2000, endpoint=False) for a, b in zip(ends[:-1], ends[1:], strict=True)])
    force = law.trace(np.concatenate([np.linspace(0.0, ends[0], 500), inner])).force[500:]
    outer = inner + 0.5 * width * np.tanh(force / (0.02 * np.abs(force).max()))
    phase = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 250, endpoint=False)
    x, f = [], []
    for stroke in range(strokes):
        own, felt = (one[2000 * stroke : 2000 * (stroke + 1)] for one in (outer, force))
        sense = 1.0 if own[-1] > own[0] else -1.0
        x.append(0.5 * (own[0] + own[-1]) + 0.5 * abs(own[-1] - own[0]) * sense * np.sin(phase))
        f.append(np.interp(sense * x[-1], np.maximum.accumulate(sense * own), felt))
    return np.concatenate(x), np.concatenate(f)


@pytest.mark.parametrize("noise", NOISE)
@pytest.mark.parametrize("friction", FRICTION)
@pytest.mark.parametrize("width", [1e-3, 3e-3])
def test_play_is_named_with_its_width(friction, width, noise):
    deflection, force = with_play(FRICTION[friction], 8e-3, width)
    found = play_in(np.arange(deflection.size) / 500.0, deflection, noisy(force, noise))
    assert found is not None
    # Of the way near zero force a part is the device's own.
    assert 0.4 * width < found.width < 1.3 * width


@pytest.mark.parametrize("noise", NOISE)
@pytest.mark.parametrize("amplitude", [1e-3, 4e-3, 12e-3])
def test_no_law_and_no_foreign_device_raises_a_false_alarm(amplitude, noise):
    x = path(amplitude)
    turn = np.tanh(20.0 * np.cos(2.0 * np.pi * TIME))
    forces = {name: example(name).trace(x, time=TIME).force for name in PARAMETERS}
    forces |= {"iwan": iwan(x), "sliders": few_sliders(x), "dead zone": dead_zone(x), "lugre": lugre(x, time=TIME)}
    # Springs that harden: thin loops, fat ones, and one about a line.
    forces |= {"thin": 2e9 * x**3 + 30.0 * turn, "fat": 2e9 * x**3 + 100.0 * turn + 1e4 * x}
    forces["line"] = 1e4 * x + 5e8 * x**3 + 20.0 * turn
    assert [name for name, force in forces.items() if play_in(TIME, x, noisy(force, noise))] == []


def test_a_record_without_force_or_movement_has_none():
    assert play_in(TIME, path(1e-3), np.zeros(TIME.size)) is None
    assert play_in(TIME, np.zeros(TIME.size), path(1.0)) is None
