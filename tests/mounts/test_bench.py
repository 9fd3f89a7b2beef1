"""The virtual cyclic test rig."""

import numpy as np
import pytest
from laws_for_tests import example

from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.mounts.laws import AsymmetricBoucWen, BoucWen, KelvinVoigt, Masing, Parallel, Zener
from wirerope_mj.mounts.test_rig import CLOSURE, cyclic_test

pytestmark = pytest.mark.quick

BOUC_WEN = BoucWen(alpha=1.0, beta=0.8, gamma=0.2, n=1)


def test_loop_closes_and_says_after_how_many_cycles():
    loop = cyclic_test(BOUC_WEN, 1.0)[0]
    assert loop.closure <= CLOSURE
    assert loop.cycles > 1
    before = cyclic_test(BOUC_WEN, 1.0, cycles=loop.cycles - 1)[0]
    assert before.cycles == loop.cycles - 1
    assert before.closure > CLOSURE


def test_first_cycle_starts_unloaded_at_zero():
    loop = cyclic_test(BOUC_WEN, 1.0, cycles=1)[0]
    assert loop.force[0] == 0.0
    assert loop.work[0] == 0.0
    # The first quarter is the virgin path: 1 - exp(-x) for alpha = beta + gamma = 1.
    np.testing.assert_allclose(loop.force[:101], 1.0 - np.exp(-loop.deflection[:101]), atol=1e-9)


def test_every_amplitude_has_its_own_unloaded_start():
    together = cyclic_test(BOUC_WEN, [0.5, 1.0], cycles=2)
    alone = [cyclic_test(BOUC_WEN, amplitude, cycles=2)[0] for amplitude in (0.5, 1.0)]
    for one, other in zip(together, alone, strict=True):
        np.testing.assert_array_equal(one.force, other.force)


def test_operating_point_is_the_middle_of_the_deflection_and_shifts_the_asymmetric_loop():
    law = AsymmetricBoucWen(alpha=1e5, beta=150.0, gamma=0.0, n=1, k1=8e4, k2=0.0, k3=0.0, b=2.0, c=10.0)
    about_zero = cyclic_test(law, 0.005)[0]
    sagged = cyclic_test(law, 0.005, operating_point=-0.02)[0]
    assert sagged.deflection.max() == pytest.approx(-0.015, abs=1e-15)
    assert sagged.deflection.min() == pytest.approx(-0.025, abs=1e-15)
    # z does not know where it is: F2 alone scales the loop, by 2^(10 x) at every x.
    z_part = about_zero.hysteretic_state
    np.testing.assert_allclose(sagged.hysteretic_state, z_part, atol=1e-6 * np.ptp(z_part))
    x = sagged.deflection
    np.testing.assert_allclose(sagged.force, 2.0 ** (10.0 * x) * (sagged.hysteretic_state + 8e4 * x), rtol=1e-12)
    assert sagged.dissipated_energy < about_zero.dissipated_energy


def test_measures_of_an_asymmetric_loop_use_its_two_extremes():
    law = AsymmetricBoucWen(alpha=1e5, beta=150.0, gamma=0.0, n=1, k1=8e4, k2=0.0, k3=0.0, b=2.0, c=10.0)
    loop = cyclic_test(law, 0.01, operating_point=-0.01)[0]
    top, bottom = loop.force[100], loop.force[300]
    assert loop.amplitude == pytest.approx(0.01, rel=1e-12)
    assert loop.secant_stiffness == pytest.approx((top - bottom) / 0.02, rel=1e-12)
    area = np.trapezoid(loop.force, loop.deflection)
    assert loop.dissipated_energy == pytest.approx(area, rel=2e-4)  # 400 chords against the law's own curve
    assert loop.damping_ratio == pytest.approx(area / (2.0 * np.pi * loop.secant_stiffness * 1e-4), rel=2e-4)


@pytest.mark.parametrize("points", [40, 400])
def test_energy_of_a_rate_independent_law_does_not_depend_on_the_sampling(points):
    loop = cyclic_test(BOUC_WEN, 1.0, points_per_cycle=points)[0]
    assert loop.dissipated_energy == pytest.approx(0.8309464386, abs=1e-9)
    assert loop.deflection.size == points + 1


@pytest.mark.parametrize("cycles", [None, 1, 3])
@pytest.mark.parametrize("operating_point", [0.0, -0.02])
def test_viscous_energy_grows_with_the_frequency(cycles, operating_point):
    law = KelvinVoigt(k=1e5, c=300.0)
    for frequency in (1.0, 7.0):
        loop = cyclic_test(law, 0.01, operating_point=operating_point, frequency=frequency, cycles=cycles)[0]
        # The law is given the sine's own rates; the cubics between the samples lose (2 pi / 400)^4 / 720 of the energy.
        assert loop.dissipated_energy == pytest.approx(np.pi * 300.0 * 2.0 * np.pi * frequency * 1e-4, rel=1e-9)


def test_frequency_has_no_effect_on_a_rate_independent_law():
    slow, fast = (cyclic_test(BOUC_WEN, 1.0, frequency=f)[0] for f in (0.01, 10.0))
    np.testing.assert_array_equal(slow.force, fast.force)


def test_loop_that_does_not_close_says_why_and_what_to_try():
    worn = example("bouc-wen-baber-noori")
    with pytest.raises(ConvergenceError, match=r"0\.001 m about 0 m has not closed after 4096 cycles.*`cycles` to run"):
        cyclic_test(worn, 0.001, points_per_cycle=4)


@pytest.mark.slow
@pytest.mark.parametrize("operating_point", [0.0, -2e-3])
def test_a_scale_that_yields_far_beyond_the_amplitude_closes(operating_point):
    # The large set forgets a millionth of its start in a cycle of 0.02 mm, the small one half of it.
    sets = [
        AsymmetricBoucWen.from_normalised(z_max=z, x_y=x, sigma=0.6, n=n, k1=k, k2=0.0, k3=0.0, b=np.e, c=8.0)
        for z, x, n, k in ((360.0, 6e-3, 2.0, 3e4), (45.0, 0.4e-3, 1.6, 0.0), (5.0, 0.03e-3, 1.0, 0.0))
    ]
    law = Parallel(laws=sets)
    loop = cyclic_test(law, 2e-5, operating_point=operating_point)[0]
    assert loop.closure <= 1e-10
    assert loop.cycles == 513
    # Every set by itself, where F2 takes the part of the operating point.
    each = [cyclic_test(one, 2e-5, operating_point=operating_point)[0] for one in sets]
    assert loop.dissipated_energy == pytest.approx(sum(one.dissipated_energy for one in each), rel=1e-6)
    # Closed is where the mean of a state is that of the steady cycle, which hardly depends on how it was reached.
    assert abs(loop.internal_states[:, 0].mean()) < 1e-3 * np.ptp(loop.internal_states[:, 0])


def test_steady_zener_loop_has_the_loss_and_storage_moduli_of_its_frequency():
    law, frequency = Zener(k0=1e5, k1=5e4, c=800.0), 12.0
    loop = cyclic_test(law, 0.01, frequency=frequency)[0]
    lag = 2.0 * np.pi * frequency * 800.0 / 5e4
    complex_stiffness = 1e5 + 5e4 * 1j * lag / (1.0 + 1j * lag)
    assert loop.closure <= CLOSURE
    # Cubics through deflection and rate at 400 points per cycle: (2 pi / 400)^4 / 384 = 2e-10 of the amplitude.
    assert loop.secant_stiffness == pytest.approx(complex_stiffness.real, rel=1e-8)
    assert loop.dissipated_energy == pytest.approx(np.pi * complex_stiffness.imag * 1e-4, rel=1e-8)


def test_masing_loop_closes_at_once_and_exactly():
    law = Masing(stiffness=[1e5, 5e4], slip_force=[100.0, 300.0], k=2e4)
    loop = cyclic_test(law, 0.01)[0]
    assert loop.cycles == 2
    assert loop.dissipated_energy == pytest.approx(4.0 * (100.0 * 0.009 + 300.0 * 0.004), rel=1e-12)  # sum 4 h (A - h/c)


def test_pure_damper_has_no_secant_stiffness_and_an_infinite_damping_ratio():
    loop = cyclic_test(KelvinVoigt(k=0.0, c=300.0), 0.01)[0]
    assert loop.secant_stiffness == 0.0
    assert loop.damping_ratio == np.inf


def test_internal_states_carry_from_cycle_to_cycle():
    loop = cyclic_test(BOUC_WEN, 1.0, cycles=3)[0]
    quarter = np.sin(2.0 * np.pi * np.arange(101) / 400.0)
    half = np.concatenate([quarter, quarter[-2::-1]])
    cycle = np.concatenate([half[:-1], -half[:-1]])
    trace = BOUC_WEN.trace(np.append(np.tile(cycle, 3), 0.0))
    np.testing.assert_array_equal(loop.force, trace.force[800:])
    # The same increments of work, summed from another start: rounding of sums of order 1.
    np.testing.assert_allclose(loop.work, trace.work[800:] - trace.work[800], atol=1e-14)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"amplitudes": 0.0}, "`amplitudes` must be finite and > 0"),
        ({"amplitudes": []}, "`amplitudes` must be finite and > 0"),
        ({"amplitudes": [1.0, np.nan]}, "`amplitudes` must be finite and > 0"),
        ({"operating_point": np.inf}, "`operating_point` must be a finite number"),
        ({"frequency": 0.0}, "`frequency` must be > 0"),
        ({"cycles": 0}, "`cycles` must be an integer >= 1"),
        ({"points_per_cycle": 30}, "`points_per_cycle` must be a multiple of 4"),
    ],
)
def test_bad_arguments_are_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        cyclic_test(BOUC_WEN, **{"amplitudes": 1.0} | arguments)
