"""Standard errors where the noise is that of a load cell: as many newtons on a small loop as on a large one."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.mounts.test_rig import cyclic_test, measured

VALUES = {"z_max": 500.0, "x_y": 1.5e-3, "sigma": 0.6, "n": 1.3, "k": 6e4}
TRUTH = wr.BoucWen.from_normalised(**VALUES)
AMPLITUDES = [1e-3, 3e-3, 6e-3, 12e-3]


def fitted(seed, **options):
    loops = [
        measured([loop], points_per_cycle=200, force_noise=12.0, seed=10 * seed + place)[0]
        for place, loop in enumerate(cyclic_test(TRUTH, AMPLITUDES))
    ]
    return wr.identify(loops, law=wr.BoucWen, profiles=False, **options)


def scatter(**options):
    """Return the rms of (found - true) / standard error over 40 draws of the noise, for each parameter."""
    fits = [fitted(seed, **options).parameters for seed in range(40)]
    return [
        np.sqrt(np.mean([((p[name].value - true) / p[name].standard_error) ** 2 for p in fits]))
        for name, true in VALUES.items()
    ]


def test_standard_errors_hold_where_loops_of_unlike_noise_count_alike():
    # The rms of 40 normal numbers is within 2.6 of its own standard errors, 1 / sqrt(80), of one.
    assert scatter() == pytest.approx([1.0] * 5, abs=0.29)


def test_standard_errors_hold_where_a_newton_counts_alike():
    assert scatter(weights="equal") == pytest.approx([1.0] * 5, abs=0.29)


def test_a_noise_that_is_given_is_that_of_all_loops():
    known, left = fitted(1, noise=1.0), fitted(1, noise=2.0)
    for name in VALUES:
        assert left.parameters[name].standard_error == pytest.approx(2.0 * known.parameters[name].standard_error)


def test_terms_that_the_device_does_not_have_are_not_told_from_zero():
    loops = [
        measured([loop], points_per_cycle=200, force_noise=12.0, seed=place)[0]
        for place, loop in enumerate(cyclic_test(TRUTH, AMPLITUDES))
    ]
    found = wr.identify(loops, law=wr.AsymmetricBoucWen, profiles=False)
    assert set(found.not_told_from_zero) == {"k2", "k3", "c_ln_b"}
    assert "not told from zero: k2, k3, c_ln_b" in str(found)
    assert wr.identify(loops, law=wr.BoucWen, profiles=False).not_told_from_zero == ()
