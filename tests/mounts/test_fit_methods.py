"""The three methods of the thesis in one table."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.mounts.identification import compare_methods
from wirerope_mj.mounts.test_rig import cyclic_test, measured

TRUTH = wr.EnhancedDryFriction(k=6e4, d=400.0, u_c=1e-3)


def noisy(noise=0.01):
    loops = cyclic_test(TRUTH, [1e-3, 3e-3, 1e-2])
    return [
        measured([loop], points_per_cycle=200, force_noise=noise * np.ptp(loop.force) / 2.0, seed=place)[0]
        for place, loop in enumerate(loops)
    ]


def test_from_a_good_start_all_methods_end_at_the_noise():
    starts = {"near": wr.EnhancedDryFriction(k=5e4, d=500.0, u_c=1.2e-3)}
    table = compare_methods(noisy(), starts=starts)
    assert [row.method for row in table.rows] == ["three-stage", "time", "frequency"]
    for row in table.rows:
        assert row.converged, row
        # 1 % noise; 603 samples know it within 3 %, and seven harmonics leave what is left of it in place.
        assert row.error == pytest.approx(0.01, rel=0.15), row
        # Each step costs one residual and a Jacobian of one to three more.
        assert 2 * row.iterations <= row.evaluations <= 5 * row.iterations + 10
    assert "three-stage" in str(table)


def test_a_start_that_moves_nothing_is_a_row_with_its_reason():
    dead = wr.Masing(stiffness=[1e5, 1e5], slip_force=[1e2, 1e7], k=1e4)
    table = compare_methods(noisy(), starts={"dead": dead})
    assert all(row.error == np.inf and "does not move the residual" in row.message for row in table.rows)


def test_no_start_is_refused():
    with pytest.raises(ValueError, match="`starts` must hold at least one law"):
        compare_methods(noisy(), starts={})
