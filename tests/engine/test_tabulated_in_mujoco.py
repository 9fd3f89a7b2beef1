"""The tabulated law as a mount in MuJoCo: order of accuracy against a solution split at its knots, energy, and its ends."""

import numpy as np
import pytest
from house import quiet, sdof
from laws_for_tests import example
from scipy.integrate import solve_ivp

import wirerope_mj as wr
from wirerope_mj.foundation.errors import ConvergenceError, SimulationError

G = wr.STANDARD_GRAVITY
MASS, FREQUENCY = 20.0, 10.0
SHAKING = wr.Sine(frequency=FREQUENCY, acceleration=3 * G, direction="z")


def reference(law, times):
    """Return deflection and force at `times`, from rest on a base that shakes; split at reversals and at the knots."""
    curve, share, z_max = law._curves
    knots = np.array(law.deflection)
    omega, x_y = 2.0 * np.pi * FREQUENCY, law.yield_deflection

    def turn(_t, y):
        return y[1]

    def crossing(knot):
        def event(_t, y):
            return y[0] - knot

        event.terminal = True
        return event

    y, t, way, out = np.array([0.0, 0.0, 0.0]), 0.0, -1.0, np.empty((times.size, 3))
    row = int(np.searchsorted(knots, 0.0)) - 1  # it begins towards negative deflections
    while t < times[-1]:

        def rates(t, y, row=row, way=way):
            d = y[0] - knots[row]
            mean, g = (np.polyval(poly.c[:, row], d) for poly in (curve, share))
            force = mean + g * y[2]
            return [y[1], -force / MASS - 3 * G * np.sin(omega * t), (z_max - way * y[2]) / x_y * y[1]]

        turn.terminal, turn.direction = True, -way
        ahead = row + (way > 0.0)
        run = solve_ivp(
            rates, (t, times[-1]), y, method="DOP853", rtol=1e-12, atol=1e-14, events=[turn, crossing(knots[ahead])],
            dense_output=True, first_step=1e-8,
        )  # fmt: skip
        assert run.success, run.message
        inside = (times >= t) & (times <= run.t[-1])
        if inside.any():
            out[inside] = run.sol(times[inside]).T
        t, y = run.t[-1], run.y[:, -1].copy()
        if run.t_events[0].size:
            way, y[1] = -way, 0.0
        elif run.t_events[1].size:
            row, y[0] = row + int(way), knots[ahead]
    return out[:, 0], curve(out[:, 0]) + share(out[:, 0]) * out[:, 2]


def test_it_is_of_second_order():
    law = example("tabulated")
    times = np.arange(0, 301) / 1000.0
    x, force = reference(law, times)
    per_cycle, errors = np.array([100, 200, 400, 800, 1600, 3200]), []
    for steps in per_cycle:
        m = wr.simulate(
            sdof(law, mass=MASS), SHAKING, duration=0.3, timestep=1.0 / (FREQUENCY * steps), initial="unloaded"
        ).mounts["m1"]
        gaps = np.abs(m.force[:, 2] - force).max() / np.abs(force).max(), np.abs(m.deflection[:, 2] - x).max()
        errors.append(max(gaps[0], gaps[1] / np.abs(x).max()))
    order = np.polyfit(np.log(1.0 / per_cycle), np.log(errors), 1)[0]
    print("order", order, dict(zip(per_cycle.tolist(), errors, strict=True)))
    # Where a reversal falls inside its step scatters each error, over a factor of 32 in the step.
    assert order > 1.7
    assert errors[2] < 1e-4  # 400 steps per cycle


def test_the_mass_loses_what_the_law_takes_along_its_path():
    law = example("tabulated")
    r = wr.simulate(
        sdof(law, mass=MASS), wr.HalfSine(peak=20 * G, duration=0.008, direction="z", start=0.01),
        duration=0.3, timestep=5e-5, initial="unloaded", sample_rate=20_000.0,
    )  # fmt: skip
    x = r.mounts["m1"].deflection[:, 2]
    v = r.bodies["mass"].velocity[:, 2] - r.base.velocity[:, 2]
    after = int(np.searchsorted(r.time, 0.018 + 1e-9))
    work = law.trace(x).work
    kinetic = 0.5 * MASS * v**2
    balance = kinetic[after:] + work[after:] - kinetic[after] - work[after]
    print("energy balance", np.abs(balance).max() / kinetic[after])
    # Steps of 5e-5 s, and reversals between samples, of second order both; a wrong sign is of order one.
    assert np.abs(balance).max() < 1e-6 * kinetic[after]
    assert work[-1] > 0.5 * kinetic[after]


def test_a_run_that_leaves_the_table_says_so():
    short = wr.Tabulated(deflection=[-0.01, 0.0, 0.01], force=[-1e3, 0.0, 1e3])
    settings = {"duration": 0.2, "timestep": 1e-4, "initial": "unloaded"}
    with pytest.raises(
        SimulationError, match=r"mount 'm1' was at .* on its axial axis, whose law holds up to 0.01 m, where its"
    ):
        wr.simulate(sdof(short, mass=MASS), SHAKING, **settings)
    longer = wr.Tabulated(deflection=short.deflection, force=short.force, extrapolate=True)
    wr.simulate(sdof(longer, mass=MASS), SHAKING, **settings)
    failed, _ = wr.simulate_batch(
        [sdof(law, mass=MASS) for law in (short, longer)], SHAKING, duration=0.2, timestep=1e-4, initial="unloaded"
    )
    assert isinstance(failed, wr.BatchFailure)
    assert "where its table ends" in str(failed.error)


def test_a_weight_that_leads_beyond_the_table_has_no_equilibrium():
    short = wr.Tabulated(deflection=[-0.01, 0.0, 0.01], force=[-1e3, 0.0, 1e3])
    assert wr.equilibrium(sdof(short, mass=50.0, gravity=G)).mounts["m1"].deflection[2] == pytest.approx(-5e-3 * G / 10.0)
    with pytest.raises(ConvergenceError, match="mount 'm1' would stand at -0.01961 m on its axial axis.* where its table ends"):
        wr.equilibrium(sdof(short, mass=200.0, gravity=G))


def test_it_rests_in_a_run():
    law = example("tabulated")
    system = sdof(law, mass=MASS, gravity=G)
    rest = wr.equilibrium(system).mounts["m1"].deflection[2]
    assert law.trace([0.0, rest]).force[-1] == pytest.approx(-MASS * G, rel=1e-9)
    r = wr.simulate(system, quiet(), duration=0.1, timestep=1e-4)
    np.testing.assert_allclose(r.mounts["m1"].deflection[:, 2], rest, rtol=1e-9)
