"""Laws against the closed forms of the Bouc-Wen differential equation and against their physical properties."""

import math
from dataclasses import replace

import numpy as np
import pytest
from laws_for_tests import LOOPS
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq
from scipy.special import hyp2f1

from wirerope_mj.mounts.laws import LAWS, AsymmetricBoucWen, BoucWen, KelvinVoigt, Ozdemir, SymmetricBoucWen
from wirerope_mj.mounts.laws.registry import REGISTERED, evaluate
from wirerope_mj.mounts.laws.stop_kernels import N_POINTS, POINTS
from wirerope_mj.mounts.laws.table_kernels import ROW
from wirerope_mj.mounts.test_rig import cyclic_test

pytestmark = pytest.mark.quick

NI = AsymmetricBoucWen(alpha=1e5, beta=150.0, gamma=30.0, n=1.0, k1=8e4, k2=1e5, k3=2e7, b=2.0, c=6.0)
SYMMETRIC = SymmetricBoucWen(alpha=1e5, beta=150.0, gamma=30.0, n=1.0, k1=8e4, k2=1e5, k3=2e7)


@pytest.mark.parametrize(("beta", "gamma", "n", "amplitude", "peak", "work"), LOOPS)
def test_steady_loop_has_the_closed_form_peak_and_work(beta, gamma, n, amplitude, peak, work):
    loop = cyclic_test(BoucWen(alpha=1, beta=beta, gamma=gamma, n=n), amplitude)[0]
    # The reference has ten decimals; the last row hardens so steeply that the loop's closure, 1e-10, counts tenfold.
    assert loop.force.max() == pytest.approx(peak, rel=2e-9)
    assert loop.dissipated_energy == pytest.approx(work, rel=2e-9)


@pytest.mark.parametrize("n", [0.5, 1.5, 3.0])
def test_steady_loop_of_any_sharpness_follows_the_hypergeometric_form(n):
    beta, gamma, amplitude = 0.7, 0.2, 1.3

    def reach(z, total):
        return z * hyp2f1(1.0, 1.0 / n, 1.0 + 1.0 / n, total * z**n)

    top = (1.0 / (beta + gamma)) ** (1.0 / n) * (1.0 - 1e-12)
    peak = brentq(lambda z: reach(z, gamma - beta) + reach(z, gamma + beta) - 2.0 * amplitude, 0.0, top, xtol=1e-14)
    work = 2.0 * quad(lambda z: z * (1.0 / (1.0 - (beta + gamma) * z**n) - 1.0 / (1.0 + (beta - gamma) * z**n)), 0.0, peak)[0]
    loop = cyclic_test(BoucWen(alpha=1, beta=beta, gamma=gamma, n=n), amplitude)[0]
    # Limited by the quadrature of the reference and, for n < 1, by the kink of |z|^n at zero.
    assert loop.force.max() == pytest.approx(peak, rel=1e-7)
    assert loop.dissipated_energy == pytest.approx(work, rel=1e-7)


def test_segments_follow_the_exponential_for_n_1():
    alpha, beta, gamma = 2.0, 0.9, 0.3
    law = BoucWen(alpha=alpha, beta=beta, gamma=gamma, n=1)
    x = np.linspace(0.0, 2.0, 9)
    bound = alpha / (beta + gamma)
    loading = law.trace(x)
    np.testing.assert_allclose(loading.force, bound * (1.0 - np.exp(-(beta + gamma) * x)), rtol=1e-9)
    unloading = law.trace(np.concatenate([[0.0], 2.0 - 0.1 * np.arange(5)]))  # stays above z = 0
    q = alpha / (beta - gamma)
    expected = (loading.force[-1] + q) * np.exp(-(beta - gamma) * 0.1 * np.arange(5)) - q
    np.testing.assert_allclose(unloading.force[1:], expected, rtol=1e-9)


def test_segments_follow_the_hyperbolic_tangent_for_n_2():
    alpha, beta, gamma = 2.0, 0.9, 0.3
    law = BoucWen(alpha=alpha, beta=beta, gamma=gamma, n=2)
    x = np.linspace(0.0, 2.0, 9)
    expected = law.z_max * np.tanh(math.sqrt(alpha * (beta + gamma)) * x)
    np.testing.assert_allclose(law.trace(x).force, expected, rtol=1e-9)


def test_virgin_path_reaches_the_bound_of_the_hysteretic_force():
    law = BoucWen(alpha=3.0, beta=0.8, gamma=0.2, n=1.5)
    assert law.z_max == pytest.approx(3.0 ** (1 / 1.5))
    assert law.trace([0.0, 40.0]).hysteretic_state[-1] == pytest.approx(law.z_max, rel=1e-9)


def test_hardening_above_n_1_blows_up_at_the_stated_deflection():
    law = BoucWen(alpha=1.0, beta=0.8, gamma=-1.0, n=2)
    assert law.finite_travel == pytest.approx(math.pi / (2.0 * math.sqrt(0.2)))
    below = law.trace([0.0, 0.999 * law.finite_travel])
    # Close to the pole z = tan(sqrt(B) x) / sqrt(B), here at 0.1 % before it.
    expected = math.tan(math.sqrt(0.2) * 0.999 * law.finite_travel) / math.sqrt(0.2)
    assert below.force[-1] == pytest.approx(expected, rel=1e-6)
    with pytest.raises(ValueError, match="leaves the finite numbers at a deflection of"):
        law.trace([0.0, 1.01 * law.finite_travel])


def test_redundant_pairs_share_the_virgin_path_but_not_the_loop_area():
    one, other = (BoucWen(alpha=1, beta=b, gamma=g, n=1) for b, g in ((0.8, 0.2), (0.5, 0.5)))
    x = np.linspace(0.0, 2.0, 21)
    np.testing.assert_allclose(one.trace(x).force, other.trace(x).force, rtol=1e-10)
    areas = [cyclic_test(law, 1.0)[0].dissipated_energy for law in (one, other)]
    assert areas[0] / areas[1] == pytest.approx(1.40, abs=0.005)


def test_slope_jumps_by_twice_beta_z_at_a_reversal():
    law = BoucWen(alpha=2.0, beta=0.7, gamma=0.3, n=1.5)
    z = law.trace([0.0, 1.0]).force[-1]
    h = 1e-6  # the slope itself changes by about 1e-6 over the step
    back, forth = (law.trace([0.0, 1.0, 1.0 + s * h]).force[-1] - z for s in (-1.0, 1.0))
    assert -back / h - forth / h == pytest.approx(2.0 * 0.7 * z**1.5, rel=1e-5)


def test_one_long_segment_equals_many_short_ones_where_a_trial_step_overflows():
    law = BoucWen(alpha=1.0, beta=1.0, gamma=-0.75, n=3.0)
    once = law.trace([0.0, 2.0, -2.0])
    often = law.trace(np.concatenate([[0.0], np.linspace(2.0, -2.0, 101)]))
    assert once.force[-1] == pytest.approx(often.force[-1], rel=1e-9)
    assert once.work[-1] == pytest.approx(often.work[-1], rel=1e-9)


def test_hysteresis_below_n_1_is_safe_at_zero_force():
    law = BoucWen(alpha=1.0, beta=0.6, gamma=0.1, n=0.2)
    loop = cyclic_test(law, 0.5)[0]
    assert np.isfinite(loop.force).all()
    assert loop.dissipated_energy > 0.0


def test_ozdemir_is_bouc_wen_without_gamma_and_has_the_dry_friction_area():
    friction, decay, amplitude = 2.0, 0.4, 1.1
    law = Ozdemir(alpha=friction / decay, beta=1.0 / decay, n=1)
    loop = cyclic_test(law, amplitude)[0]
    closed_form = 4.0 * friction * (amplitude - decay * math.tanh(amplitude / decay))
    assert loop.dissipated_energy == pytest.approx(closed_form, rel=1e-9)
    same = BoucWen(alpha=friction / decay, beta=1.0 / decay, gamma=0.0, n=1)
    np.testing.assert_array_equal(loop.force, cyclic_test(same, amplitude)[0].force)


def test_small_loops_dissipate_with_the_cube_of_the_amplitude():
    law = BoucWen(alpha=2.0, beta=0.7, gamma=0.3, n=1)
    loop = cyclic_test(law, 1e-3)[0]
    # W -> 4 beta alpha A^3 / 3; the next term is of relative order A.
    assert loop.dissipated_energy == pytest.approx(4.0 * 0.7 * 2.0 * 1e-9 / 3.0, rel=3e-3)


def test_spring_in_parallel_adds_its_force_and_no_work():
    bare, sprung = (BoucWen(alpha=1, beta=0.8, gamma=0.2, n=1, k=k) for k in (0.0, 0.5))
    one, other = (cyclic_test(law, 1.0, cycles=20)[0] for law in (bare, sprung))
    np.testing.assert_allclose(other.force - one.force, 0.5 * one.deflection, atol=1e-12)
    assert other.dissipated_energy == pytest.approx(one.dissipated_energy, rel=1e-9)


def test_ni_force_is_its_equation_along_a_path_integrated_independently():
    path = np.array([0.0, 0.02, -0.03, 0.01])
    state, expected = 0.0, [0.0]
    for start, end in zip(path, path[1:], strict=False):
        sign = math.copysign(1.0, end - start)

        def rate(_length, z, sign=sign):
            return sign * (NI.alpha - (NI.gamma + NI.beta * np.sign(sign * z)) * np.abs(z))

        state = solve_ivp(rate, (0.0, abs(end - start)), [state], rtol=1e-10, atol=1e-7, max_step=1e-4).y[0, -1]
        elastic = NI.k1 * end + NI.k2 * math.copysign(end**2, end) + NI.k3 * end**3
        expected.append(2.0 ** (6.0 * end) * (state + elastic))
    # The reference does not split its steps where z changes sign.
    np.testing.assert_allclose(NI.trace(path).force, expected, rtol=1e-6)


def test_ni_hardens_in_tension_and_softens_in_compression():
    law = replace(NI, k2=0.0, k3=0.0)
    tension, compression = (law.trace([0.0, s * 0.03]).force[-1] for s in (1.0, -1.0))
    assert tension > 0.0 > compression
    assert tension / -compression == pytest.approx(2.0 ** (2.0 * 6.0 * 0.03), rel=1e-9)


def test_kelvin_voigt_needs_time_and_returns_the_ellipse_of_its_loss_factor():
    law = KelvinVoigt(k=1e5, c=300.0)
    with pytest.raises(ValueError, match="`time` must be given"):
        law.trace([0.0, 1.0])
    loop = cyclic_test(law, 0.01, frequency=3.0)[0]
    # Central differences at 400 points per cycle lose (2 pi / 400)^2 / 3 = 8e-5 of the energy.
    assert loop.dissipated_energy == pytest.approx(math.pi * 300.0 * 2.0 * math.pi * 3.0 * 1e-4, rel=1e-4)
    assert loop.secant_stiffness == pytest.approx(1e5, rel=1e-9)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"alpha": 0.0}, "`alpha` must be > 0"),
        ({"beta": -0.1}, "`beta` must be > 0, got -0.1: the law would not be passive"),
        ({"n": 0.0}, "`n` must be > 0"),
        ({"n": 1e-6}, "`n` must be >= 0.05, got 1e-06"),
        ({"n": 1e6}, "`n` must be <= 100, got 1000000.0"),
        ({"k": -1.0}, "`k` must be a finite number >= 0"),
        ({"gamma": math.nan}, r"`gamma` must be a finite number \[N\^\(1-n\)/m\], got nan"),
        ({"gamma": True}, r"`gamma` must be a finite number \[N\^\(1-n\)/m\], got True"),
    ],
)
def test_law_rejects_what_is_not_passive(arguments, message):
    with pytest.raises(ValueError, match=message):
        BoucWen(**{"alpha": 1.0, "beta": 0.8, "gamma": 0.2, "n": 1.0} | arguments)


@pytest.mark.parametrize(
    "law",
    [
        BoucWen(alpha=1e5, beta=2.0, gamma=-0.5, n=0.7, k=3e4),
        BoucWen(alpha=1e5, beta=150.0, gamma=30.0, n=1),
        Ozdemir(alpha=1e5, beta=0.01, n=2, k=1e4),
        NI,
        SYMMETRIC,
        KelvinVoigt(k=1e5, c=300.0),
    ],
)
def test_native_kernel_equals_plain_python(law):
    rng = np.random.default_rng(5)
    p, kernel = law.kernel_parameters(), dict(REGISTERED)[type(law)]
    for x, v, z in zip(rng.normal(0, 0.02, 50), rng.normal(0, 1, 50), rng.normal(0, 500, 50), strict=True):
        states, rates = np.array([z]), np.zeros((3, 1))
        native = kernel(p, 0, x, v, states, 0, rates[0], 0)
        plain = kernel.py_func(p, 0, x, v, states, 0, rates[1], 0)
        dispatched = evaluate(law.kernel, p, 0, x, v, states, 0, rates[2], 0)
        # pow and exp of the compiler's library may differ from Python's in the last digit.
        assert native == pytest.approx(plain, rel=1e-13)
        assert dispatched == native
        np.testing.assert_allclose(rates[0], rates[1], rtol=1e-12, atol=1e-9)


def test_every_law_is_known_by_its_name():
    assert all(LAWS[law.name] is law for law in LAWS.values())
    assert {"bouc-wen", "ozdemir", "asymmetric-bouc-wen", "symmetric-bouc-wen", "kelvin-voigt"} <= set(LAWS)


def test_a_path_through_the_origin_is_not_stalled_by_rounding():
    # Deflection, z and force pass through zero together: their errors relative to themselves are rounding there.
    law = BoucWen(alpha=4e4, beta=48.52013902086025, gamma=20.7943452946544, n=1.2, k=2e4)
    start = -1.1363570306954784e-08
    path = law.trace([start, 8.863642964040963e-08], initial_states=[4e4 * start])
    assert path.force[-1] == pytest.approx(6e4 * path.deflection[-1], rel=1e-6)


def test_a_stop_of_points_states_the_depth_of_every_knot():
    p = LAWS["stop"](gap_above=2e-3, depths=(1e-3, 2e-3), forces=(100.0, 300.0)).kernel_parameters()
    knots = int(p[N_POINTS])
    assert p.size == POINTS + knots + ROW * (knots + 1) + knots
