"""An isolator that strikes its stop, in closed cycles: cyclic tests, harmonic balance, equivalent linearisation."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import wirerope_mj as wr
from wirerope_mj.dynamics.single_mass.balance import harmonic_balance
from wirerope_mj.dynamics.single_mass.equivalent import equivalent_linear

ROPE = wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.0, k=5e4)
STOP = wr.Stop(gap_below=3e-3, k=3e5, rounding=2e-3, loss=0.3, reversal=2e-3)
MASS, FREQUENCY, LEVEL = 40.0, 5.0, 25.0
BOTH = wr.Parallel(laws=[ROPE, STOP])


def orbit_in_time(*, c, cycles=12):
    """Return smallest and largest deflection of the last of some cycles: the laws' equations written out, from rest."""
    omega = 2.0 * np.pi * FREQUENCY

    def rates(t, y):
        x, v, z, w = y
        depth = max(-x - STOP.gap_below, 0.0)
        part = min(depth / STOP.rounding, 1.0)
        counted = depth - STOP.rounding / 2 if part == 1.0 else STOP.rounding * part**3 * (1.0 - part / 2.0)
        push = STOP.k * counted * (1.0 - STOP.loss * w) - c * part**2 * (3.0 - 2.0 * part) * v
        force = ROPE.k * x + z - max(push, 0.0)
        zdot = ROPE.alpha * v - ROPE.beta * abs(v) * z - ROPE.gamma * v * abs(z)
        acceleration = -force / MASS - LEVEL * np.sin(omega * t)
        return [v, acceleration, zdot, (v - abs(v) * w) / STOP.reversal]

    last = (cycles - 1 + np.linspace(0.0, 1.0, 4001)) / FREQUENCY
    run = solve_ivp(rates, (0.0, last[-1]), np.zeros(4), t_eval=last, method="DOP853", rtol=1e-9, atol=1e-12, max_step=2e-3)
    return run.y[0].min(), run.y[0].max()


@pytest.mark.parametrize("c", [0.0, pytest.param(300.0, marks=pytest.mark.slow)])
def test_harmonic_balance_finds_the_orbit_that_strikes_the_stop(c):
    law = wr.Parallel(laws=[ROPE, wr.Stop(**{**vars(STOP), "c": c})])
    orbit = harmonic_balance(law, mass=MASS, frequency=FREQUENCY, acceleration=LEVEL, samples=512)
    low, high = orbit_in_time(c=c)
    print(low, high, orbit.smallest_deflection, orbit.largest_deflection)
    assert low < -STOP.gap_below - 0.5e-3
    # 4001 samples miss a tip by 1e-6 of the stroke; 31 harmonics and twelve cycles leave as much.
    np.testing.assert_allclose([orbit.smallest_deflection, orbit.largest_deflection], [low, high], rtol=1e-4)


def test_a_stop_stiffens_the_linearised_isolator_once_it_is_struck():
    free, struck = (equivalent_linear(law, mass=MASS, frequencies=[FREQUENCY], acceleration=LEVEL) for law in (ROPE, BOTH))
    assert struck.deflection[0, 0] > STOP.gap_below
    assert struck.stiffness[0, 0] > 1.01 * free.stiffness[0, 0]


def test_cyclic_tests_of_laws_in_parallel_close_and_dissipate_what_both_do():
    for loop, rope, stop in zip(*(wr.cyclic_test(law, [2e-3, 8e-3], cycles=10) for law in (BOTH, ROPE, STOP)), strict=True):
        assert loop.closure < 1e-10
        # The same ten cycles: sums of the same numbers.
        assert loop.dissipated_energy == pytest.approx(rope.dissipated_energy + stop.dissipated_energy, rel=1e-12)
        np.testing.assert_allclose(loop.force, rope.force + stop.force, atol=1e-12 * np.ptp(loop.force))


def test_a_loop_within_the_gap_has_no_damping_ratio():
    loop = wr.cyclic_test(STOP, 2e-3)[0]
    assert loop.dissipated_energy == 0.0
    assert np.isnan(loop.damping_ratio)


@pytest.mark.parametrize("reversal", [1e-9, 1e-300])
def test_a_loss_that_turns_at_once_takes_its_part_of_every_push(reversal):
    """2 loss of what both pushes store, 1/2 k d^2 each; short of that by what is turned within the reversal, reversal / d."""
    law = wr.Stop(gap_below=0.01, gap_above=0.01, k=1e6, loss=0.3, reversal=reversal)
    (loop,) = wr.cyclic_test(law, 0.02)
    assert loop.dissipated_energy == pytest.approx(2 * 0.5 * 1e6 * 0.01**2 * 2 * 0.3, rel=1e-6)
