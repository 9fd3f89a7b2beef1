"""What one loop and several loops measure: tangents at reversal, hardening overlap, softening to hardening."""

import re

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from wirerope_mj.mounts.laws import (
    AsymmetricBoucWen,
    BoucWen,
    EnhancedDryFriction,
    KelvinVoigt,
    Loop,
    Masing,
    SymmetricBoucWen,
)
from wirerope_mj.mounts.test_rig import cyclic_test, hardening_overlap, measured, softening_to_hardening

pytestmark = pytest.mark.quick

NI = AsymmetricBoucWen(alpha=1e5, beta=1500.0, gamma=0.0, n=1, k1=2e4, k2=0.0, k3=1e9, b=np.e, c=150.0)
CASES = [(0.8, 0.2, 1), (0.2, 0.8, 1), (0.5, 0.5, 1), (0.8, -1.0, 1), (0.5, -0.5, 1), (0.8, 0.2, 2), (0.5, -0.4, 1.5)]


def table_3_2(law, z):
    """Slopes before and after the turn at z (thesis, table 3.2)."""
    size = abs(z) ** law.n
    return law.k + law.alpha - (law.beta + law.gamma) * size, law.k + law.alpha + (law.beta - law.gamma) * size


@pytest.mark.parametrize(("beta", "gamma", "n"), CASES)
def test_tangents_at_reversal_are_those_of_table_3_2(beta, gamma, n):
    law = BoucWen(alpha=1.0, beta=beta, gamma=gamma, n=n, k=0.3)
    loop = cyclic_test(law, 1.0)[0]
    before, after = table_3_2(law, loop.hysteretic_state.max())
    # A cubic over the first 7 of 400 samples, 0.4 % of the amplitude deep: its error is (0.004)^3 of the curve's bend.
    assert loop.tangents_at_reversal == pytest.approx((after, after), rel=1e-6)
    assert loop.slope_jumps_at_reversal == pytest.approx((after - before,) * 2, rel=1e-5)
    assert after - before == pytest.approx(2.0 * beta * loop.hysteretic_state.max() ** n, rel=1e-12)


def test_tangents_of_the_asymmetric_law_tell_tension_from_compression():
    loop = cyclic_test(NI, 3e-3)[0]
    expected = []
    for index in (100, 300):
        x, z = loop.deflection[index], loop.hysteretic_state[index]
        factor, elastic = np.exp(150.0 * x), 2e4 * x + 1e9 * x**3
        # d/dx of F2 (z + F1), z unloading.
        expected.append(factor * (150.0 * (z + elastic) + 1e5 + 1500.0 * abs(z) + 2e4 + 3e9 * x * x))
    assert loop.tangents_at_reversal == pytest.approx(tuple(expected), rel=1e-5)  # as above; the curve bends more
    assert loop.tangents_at_reversal.after_largest > 2.0 * loop.tangents_at_reversal.after_smallest


def test_tangents_are_found_wherever_the_cycle_begins():
    loop = cyclic_test(BoucWen(alpha=1.0, beta=0.8, gamma=0.2, n=1), 1.0)[0]
    for shift in (90, 100, 101, 299, 300, 350):
        x, force = (np.roll(signal[:-1], -shift) for signal in (loop.deflection, loop.force))
        turned = Loop.from_samples(np.append(x, x[0]), np.append(force, force[0]))
        assert turned.tangents_at_reversal == pytest.approx(loop.tangents_at_reversal, rel=1e-9)  # the same samples


def test_tangents_of_a_path_that_ends_at_its_largest_deflection_are_unknown_there():
    trace = BoucWen(alpha=1.0, beta=0.8, gamma=0.2, n=1).trace(np.linspace(0.0, 1.0, 100))
    assert np.isnan(trace.tangents_at_reversal.after_largest)
    # The virgin path leaves its smallest deflection, z = 0, with the slope alpha.
    assert trace.tangents_at_reversal.after_smallest == pytest.approx(1.0, rel=1e-4)


@pytest.mark.parametrize(("beta", "gamma", "n"), CASES)
@pytest.mark.parametrize("points", [100, 400])
def test_tangents_survive_noise_of_a_thousandth(beta, gamma, n, points):
    law = BoucWen(alpha=1.0, beta=beta, gamma=gamma, n=n, k=0.3)
    loop = cyclic_test(law, 1.0)[0]
    noise = {"force_noise": 1e-3 * np.ptp(loop.force) / 2.0, "deflection_noise": 1e-3}
    noisy = [measured([loop], seed=seed, points_per_cycle=points, **noise)[0].tangents_at_reversal for seed in range(20)]
    after = table_3_2(law, loop.hysteretic_state.max())[1]
    # 1 to 2 % of scatter as `tangent_at_start` states it, five of them; the mean of 40 has what the cubic misses.
    np.testing.assert_allclose(noisy, after, rtol=0.1)
    assert np.mean(noisy) == pytest.approx(after, rel=0.015)


def test_dense_samples_closer_than_their_own_noise_do_not_flatten_the_tangent():
    loop = cyclic_test(BoucWen(alpha=1.0, beta=0.8, gamma=-1.0, n=1, k=0.3), 2.0, points_per_cycle=4000)[0]
    noisy = measured([loop] * 10, seed=1, points_per_cycle=4000, deflection_noise=0.02)
    # A fit within the noise sees no slope at all: off by 100 %. 1 % of noise leaves a tenth or two.
    tangents = [one.tangents_at_reversal for one in noisy]
    np.testing.assert_allclose(tangents, loop.tangents_at_reversal.after_largest, rtol=0.3)


def test_slope_jump_of_a_noisy_loop_recovers_beta():
    law = BoucWen(alpha=1.0, beta=0.8, gamma=0.2, n=1)
    loop = cyclic_test(law, 1.0)[0]
    noisy = [
        measured([loop], seed=seed, points_per_cycle=400, force_noise=1e-3, deflection_noise=1e-3)[0] for seed in range(20)
    ]
    beta = np.mean([one.slope_jumps_at_reversal for one in noisy]) / (2.0 * loop.force.max())
    assert beta == pytest.approx(0.8, rel=0.02)  # two tangents, a percent each


def test_overlap_of_dry_friction_is_its_closed_form():
    law = EnhancedDryFriction(k=1e4, d=200.0, u_c=1e-3)
    loops = cyclic_test(law, [1e-3, 2e-3, 4e-3], points_per_cycle=2000)

    def up(x, amplitude):  # TNO (2.1) from its steady reversal force -d tanh(A/u_c)
        return 200.0 * (1.0 - (1.0 + np.tanh(amplitude / 1e-3)) * np.exp(-(x + amplitude) / 1e-3))

    gap = sum(quad(lambda x, a=a: up(x, 4e-3) - up(x, a), 0.0, a)[0] for a in (1e-3, 2e-3))
    thickness = sum(quad(lambda x: up(x, 4e-3) + up(-x, 4e-3), 0.0, a)[0] for a in (1e-3, 2e-3))
    # Means over 400 points weigh both ends fully: 1/400 of the ends' difference.
    assert hardening_overlap(loops) == pytest.approx(gap / thickness, rel=0.01)


def test_overlap_of_thin_ellipses_is_that_of_circles():
    law, radii = KelvinVoigt(k=1e5, c=100.0), (1e-3, 4e-3)
    loops = cyclic_test(law, radii, points_per_cycle=2000)
    small, large = (quad(lambda x, r=r: np.sqrt(r * r - x * x), 0.0, radii[0])[0] for r in radii)
    assert hardening_overlap(loops) == pytest.approx((large - small) / (2.0 * large), rel=0.01)  # as above


def test_overlap_is_perfect_where_slip_is_saturated_on_the_tension_side():
    law = Masing(stiffness=[1e5], slip_force=[50.0], k=2e4)
    loops = cyclic_test(law, [1e-3, 2e-3, 3e-3])  # full slip after 2 h / c = 1 mm of loading: from x = 0 on, even at 1 mm
    assert hardening_overlap(loops) < 1e-10  # rounding


def test_ni_law_overlaps_in_tension_and_plain_hardening_does_not():
    """Thesis, figure 3.9 against figure 3.4; amplitudes in the same ratios."""
    ni = hardening_overlap(cyclic_test(NI, [2e-3, 3e-3, 4e-3]))
    assert ni < 0.02
    assert cyclic_test(NI, 4e-3)[0].tangents_at_reversal.after_largest > 2.0 * NI.initial_stiffness  # it hardens
    plain = BoucWen(alpha=1.0, beta=0.8, gamma=-1.0, n=1)
    for scale in (0.5, 1.0, 2.0):
        assert hardening_overlap(cyclic_test(plain, scale * np.array([0.5, 0.75, 1.0]))) > 0.2


def test_overlap_is_measured_about_the_operating_point():
    law = Masing(stiffness=[1e5], slip_force=[50.0], k=2e4)
    assert hardening_overlap(cyclic_test(law, [1e-3, 3e-3], operating_point=-0.02)) < 1e-10  # rounding
    apart = cyclic_test(law, 1e-3, operating_point=-0.02) + cyclic_test(law, 2e-3)
    with pytest.raises(ValueError, match=r"one operating point, got -0.02 m and 0 m"):
        hardening_overlap(apart)


def test_noise_adds_little_to_the_overlap():
    loops = cyclic_test(NI, [2e-3, 3e-3, 4e-3])
    noisy = [measured(loops, seed=seed, force_noise=5.0, points_per_cycle=400) for seed in range(8)]
    excess = np.mean([hardening_overlap(one) for one in noisy]) - hardening_overlap(loops)
    # 5 N in loops some 200 N thick: 0.8 5 sqrt(2) / 200 = 0.028 sample by sample, less than half of it in bins.
    assert 0.0 < excess < 0.016


def test_loops_without_area_or_of_one_amplitude_have_no_overlap():
    with pytest.raises(ValueError, match="no area in tension"):
        hardening_overlap(cyclic_test(BoucWen(alpha=1.0, beta=1e-30, gamma=0.0, n=1), [1.0, 2.0], cycles=1))
    with pytest.raises(ValueError, match="at least 2 different amplitudes, got 1"):
        hardening_overlap(cyclic_test(NI, [1e-3, 1e-3]))


def test_transition_lies_where_the_closed_secant_stiffness_is_least():
    # z as in dry friction with d = alpha / beta, u_c = 1 / beta: K(A) = d tanh(A/u_c) / A + k1 + k3 A^2.
    d, u_c, k1, k3 = 200.0, 1e-3, 2e4, 1e9
    law = SymmetricBoucWen(alpha=d / u_c, beta=1.0 / u_c, gamma=0.0, n=1, k1=k1, k2=0.0, k3=k3)

    def secant(a):
        return d * np.tanh(a / u_c) / a + k1 + k3 * a * a

    least = minimize_scalar(secant, bounds=(1e-3, 1e-2), method="bounded", options={"xatol": 1e-12})
    transition = softening_to_hardening(cyclic_test(law, np.geomspace(0.5e-3, 20e-3, 15)))
    assert transition.exists
    # A cubic spline over log A with steps of 0.26: (0.26)^3 / 24 of the curve's scale in place, less in height.
    assert transition.amplitude == pytest.approx(least.x, rel=2e-3)
    assert transition.stiffness == pytest.approx(least.fun, rel=1e-4)
    assert "softens up to an amplitude of 4.6" in transition.message


def test_three_amplitudes_are_enough_for_a_transition():
    transition = softening_to_hardening(cyclic_test(NI, [1e-3, 2e-3, 6e-3]))
    assert transition.exists
    assert 1e-3 < transition.amplitude < 6e-3


@pytest.mark.parametrize(
    ("law", "message"),
    [
        (BoucWen(alpha=1e5, beta=800.0, gamma=200.0, n=1), "softens over all.*1 mm to 4 mm.*lies above"),
        (BoucWen(alpha=1e5, beta=800.0, gamma=-1000.0, n=1), "hardens over all.*1 mm to 4 mm.*lies below"),
        (KelvinVoigt(k=1e5, c=100.0), "neither softens nor hardens between 1 mm and 4 mm"),
    ],
)
def test_without_a_transition_it_says_what_the_loops_show(law, message):
    transition = softening_to_hardening(cyclic_test(law, [1e-3, 2e-3, 4e-3]))
    assert not transition.exists
    assert np.isnan(transition.amplitude)
    assert np.isnan(transition.stiffness)
    assert re.search(message, transition.message), transition.message


def test_rise_below_the_scatter_of_the_stiffnesses_is_no_transition():
    loops = cyclic_test(KelvinVoigt(k=1e5, c=10.0), np.linspace(1e-3, 4e-3, 7))
    noisy = measured(loops, seed=1, force_noise=1.0)  # 1 N of 100 to 400 N
    assert not softening_to_hardening(noisy, rise=0.03).exists
    assert softening_to_hardening(noisy).exists  # every scatter has a least value


@pytest.mark.parametrize(
    ("count", "arguments", "message"),
    [(2, {}, "at least 3 different amplitudes, got 2"), (3, {"rise": -0.1}, "`rise` must be >= 0")],
)
def test_bad_arguments_of_the_transition_are_named(count, arguments, message):
    with pytest.raises(ValueError, match=message):
        softening_to_hardening(cyclic_test(NI, [1e-3, 2e-3, 3e-3][:count]), **arguments)
