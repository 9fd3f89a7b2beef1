"""Forces alone, without work: the same as those of a full trace, only cheaper."""

import numpy as np
import pytest
from scipy.special import hyp2f1

import wirerope_mj as wr
from wirerope_mj.mounts.laws.path import follow_path
from wirerope_mj.mounts.laws.steady import follow_force, settle

pytestmark = pytest.mark.quick

LAWS = [
    *(wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=s, n=n, k=1e4) for s in (0.3, 1.6) for n in (1.0, 1.4, 2.0)),
    wr.AsymmetricBoucWen.from_normalised(z_max=7e2, x_y=1e-3, sigma=0.6, n=1.0, k1=5e4, k2=1e6, k3=2e8, b=2.0, c=35.0),
    wr.EnhancedDryFriction(k=6e4, d=400.0, u_c=1e-3),
    wr.VaianaRosati(kb=3e4, f0=150.0, alpha=300.0, b1=20.0, b2=60.0, g1=15.0, g2=300.0, g3=1e-3),
    wr.Masing(stiffness=[6e4, 4e4, 3e4], slip_force=[60.0, 100.0, 200.0], k=2e4),
]


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_forces_alone_are_those_of_the_trace(law):
    # Random reversals, some far apart, some within the yield deflection, on both sides of zero, one sample repeated.
    path = np.concatenate([[0.0], np.random.default_rng(0).uniform(-0.01, 0.01, 100), [1e-3, 1e-3, 1.1e-3]])
    arguments = law.kernel, law.kernel_parameters(), path
    whole = follow_path(*arguments, np.zeros(law.n_states), law.n_states)[0]
    alone = follow_force(*arguments, np.zeros(law.n_states), law.n_states)
    # Closed forms differ by rounding, the power series by what the trace's integration errs: 1e-11 in each of its steps.
    near = 1e-8 if getattr(law, "n", 1.0) == 1.4 else 1e-13
    np.testing.assert_allclose(alone, whole, rtol=0.0, atol=near * np.abs(whole).max())


@pytest.mark.parametrize("n", [7.0, 8.0, 10.0, 12.0, 20.0])
def test_high_powers_do_not_leap_over_the_place_where_they_bend(n):
    # Samples just past z = 0: there the series' last terms vanish, and it reaches no further than where |z|^n begins to matter.
    law = wr.BoucWen(alpha=1.0, beta=0.6, gamma=0.4, n=n)
    path = np.concatenate([[0.0, 1e-4, 0.3, 0.9, 1.5, 0.6, 0.1, -0.4, -0.45], np.linspace(-0.4, 2.0, 40)])
    parameters = law.kernel_parameters()
    whole = follow_path(law.kernel, parameters, path, np.zeros(1), 1)[0]
    alone = follow_force(law.kernel, parameters, path, np.zeros(1), 1)
    np.testing.assert_allclose(alone, whole, rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("n", [0.3, 0.8, 1.4, 3.0, 6.0])
def test_power_series_keep_the_length_between_two_states(n):
    # u' = 1 - u^n joins 0 and u over the length u 2F1(1, 1/n; 1 + 1/n; u^n); 900 samples cross every step of the series.
    law = wr.BoucWen(alpha=1.0, beta=0.6, gamma=0.4, n=n)
    path = np.linspace(0.0, 3.0, 900)
    u = follow_force(law.kernel, law.kernel_parameters(), path, np.zeros(1), 1)
    kept = u < 0.99  # beyond, a length says little about a state
    length = u[kept] * hyp2f1(1.0, 1.0 / n, 1.0 + 1.0 / n, u[kept] ** n)
    # du = (1 - u^n) dl with 1 - u^n >= 0.003: rounding of u, 1e-15, is 3e-13 of length.
    np.testing.assert_allclose(length, path[kept], rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("amplitude", [2e-4, 1e-2])
def test_settled_state_repeats_itself(amplitude):
    law = wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.3, k=0.0)
    turning = np.array([0.0, amplitude, -amplitude, 0.0])
    states = settle(law.kernel, law.kernel_parameters(), turning, 1, 1e-9)
    again = follow_force(law.kernel, law.kernel_parameters(), turning, states.copy(), 1)
    # The loop is symmetric in its turning points; 1e-9 N was asked for, slow memory leaves ten times that.
    assert again[0] == pytest.approx(again[-1], abs=1e-8)
    assert again[1] == pytest.approx(-again[2], abs=1e-7)


def test_a_state_that_overflows_is_not_a_number_from_there_on():
    # beta + gamma < 0 and n = 2: the force is infinite at a finite deflection.
    law = wr.BoucWen(alpha=1e5, beta=0.01, gamma=-0.06, n=2.0)
    far = law.finite_travel
    force = follow_force(law.kernel, law.kernel_parameters(), np.array([0.0, 0.5 * far, 1.1 * far, 0.0]), np.zeros(1), 1)
    assert np.isfinite(force).tolist() == [True, True, False, False]
