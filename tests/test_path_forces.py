"""Forces alone, without work: the same as those of a full trace, only cheaper."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.laws.path import follow_force, follow_path

LAWS = [
    *(
        wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=s, n=n, k=1e4)
        for s in (0.3, 1.6)
        for n in (1.0, 1.4, 2.0)
    ),
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
    # Closed forms differ by rounding, the integration not at all.
    np.testing.assert_allclose(alone, whole, rtol=0.0, atol=1e-13 * np.abs(whole).max())


def test_a_state_that_overflows_is_not_a_number_from_there_on():
    # beta + gamma < 0 and n = 2: the force is infinite at a finite deflection.
    law = wr.BoucWen(alpha=1e5, beta=0.01, gamma=-0.06, n=2.0)
    far = law.finite_travel
    force = follow_force(
        law.kernel, law.kernel_parameters(), np.array([0.0, 0.5 * far, 1.1 * far, 0.0]), np.zeros(1), 1
    )
    assert np.isfinite(force).tolist() == [True, True, False, False]
