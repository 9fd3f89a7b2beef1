"""Laws led through what a record holds before a loop: cycles that still change, zeros of the force."""

import numpy as np
import pytest
from rig_records import rig_record

import wirerope_mj as wr
from wirerope_mj.mounts.identification.measured import prepare
from wirerope_mj.mounts.identification.result import fitted_loops
from wirerope_mj.mounts.test_rig import cyclic_test, steady_loops
from wirerope_mj.mounts.test_rig.turning import mean_of_cycles

LAW = wr.BoucWen(alpha=300e3, beta=2.0, gamma=-0.5, n=1.5, k=80e3)
AMPLITUDES = [0.5e-3, 2e-3, 5e-3, 15e-3]
STEEL = wr.Masing(
    stiffness=[60e3, 80e3, 60e3, 50e3, 30e3],
    slip_force=np.array([60e3, 80e3, 60e3, 50e3, 30e3]) * [0.5e-3, 1.2e-3, 3e-3, 7e-3, 12e-3],
    k=40e3,
)


def test_cycles_that_still_change_give_the_law_away_all_the_same():
    time, deflection, force = rig_record(LAW, AMPLITUDES, operating_point=-5e-3, points=500.0, drift=40.0, seed=3)
    loops = steady_loops(deflection, force, time=time)
    assert loops[0].closure > 0.02  # the smallest is far from steady
    form, found = LAW.normalised, wr.identify(loops, law=wr.BoucWen)
    truth = {"z_max": form.z_max, "x_y": form.x_y, "sigma": form.sigma, "n": form.n, "k": LAW.k}
    for name, value in truth.items():
        p = found.parameters[name]
        assert abs(p.value - value) < 3.0 * p.standard_error, name
    # As steady loops they are not what the law does: seven standard errors off.
    assert found.parameters["n"].standard_error < 0.02


@pytest.mark.parametrize("point", [0.0, -5e-3])
def test_law_of_a_record_leaves_nothing_of_it(point):
    time, deflection, force = rig_record(LAW, AMPLITUDES, operating_point=point, points=500.0, noise=0.0, drift=200.0)
    for loop in prepare(steady_loops(deflection, force, time=time)):
        difference = loop.model_force(LAW) - loop.force
        # Means over a two-hundredth of the cycle, where 1.4 % is left of the smallest as a steady loop.
        assert np.std(difference) < 5e-4 * np.ptp(loop.force)


def test_elements_that_do_not_slip_stand_where_the_record_left_them():
    time, deflection, force = rig_record(STEEL, [1e-3, 5e-3, 15e-3], points=500.0, noise=0.0, zero=10.0)
    for loop in prepare(steady_loops(deflection, force, time=time)):
        zero = np.mean(loop.force - loop.model_force(STEEL))
        assert zero == pytest.approx(10.0, abs=1e-3 * np.ptp(loop.force))


@pytest.mark.parametrize("cycles", [2, 5])
def test_zero_of_the_force_is_that_of_the_load_cell_while_cycles_still_change(cycles):
    record = rig_record(LAW, AMPLITUDES, operating_point=-5e-3, points=500.0, noise=0.0, zero=40.0, cycles=cycles)
    for loop in prepare(steady_loops(*record[1:], time=record[0])):
        zero = np.mean(loop.force - loop.model_force(LAW))
        assert zero == pytest.approx(40.0, abs=1e-3 * np.ptp(loop.force))  # the force relaxes by 150 N in the smallest


def test_closure_of_the_law_is_that_of_the_record():
    record = rig_record(LAW, AMPLITUDES, operating_point=-5e-3, points=500.0, noise=0.0, drift=300.0)
    loops = steady_loops(*record[1:], time=record[0])
    for loop, ready in zip(loops, prepare(loops), strict=True):
        assert ready.law_closure(LAW) == pytest.approx(loop.closure, rel=0.1, abs=1e-3)  # smoothing at the turning points


def test_record_that_begins_loaded_counts_as_steady():
    time, deflection, force = rig_record(LAW, AMPLITUDES, operating_point=-5e-3, noise=0.0)
    cut = steady_loops(deflection[time > 1.0], force[time > 1.0], time=time[time > 1.0])
    assert [loop.averaged for loop in cut] == [0] * 4
    assert [loop.averaged for loop in steady_loops(deflection, force, time=time)] == [3] * 4


def test_mean_of_cycles_has_no_line_left():
    elapsed = np.linspace(0.0, 1.0, 101)
    cycle = np.sin(2.0 * np.pi * elapsed)
    drifting = np.stack([cycle + 3.0 * (number + elapsed) for number in range(3)])
    for forces in (drifting, drifting[:1]):
        made = mean_of_cycles(forces, elapsed)
        np.testing.assert_allclose(made - made.mean(), cycle, atol=1e-12)


@pytest.mark.parametrize("point", [0.0, -4e-3])
def test_steady_loop_of_elements_is_reached_by_a_ramp_from_the_unloaded_device(point):
    (loop,) = cyclic_test(STEEL, 1e-3, operating_point=point)
    order = np.append(np.roll(np.arange(400), 37), 400 - 37)  # wherever in the cycle its samples begin
    for each in (loop, wr.Loop.from_samples(loop.deflection[order], loop.force[order])):
        # The middle of the deflections is the operating point to rounding.
        np.testing.assert_allclose(prepare([each])[0].model_force(STEEL), each.force, atol=1e-9 * np.ptp(loop.force))


def test_pictures_show_measured_and_fitted_force_on_top_of_each_other():
    record = rig_record(STEEL, [1e-3, 2e-3, 5e-3, 15e-3], noise=0.0, zero=-30.0)
    found = wr.identify(steady_loops(*record[1:], time=record[0]), law=wr.Masing, start=STEEL, grid=False)
    assert [fit.zero for fit in fitted_loops(found)] == pytest.approx([-30.0] * 4, abs=5.0)
