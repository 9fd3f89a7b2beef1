"""Jenkin elements: what the smallest loop can tell of the first, and starts that are not left for worse places."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.mounts.identification.identify import run_stages as run_all_stages
from wirerope_mj.mounts.identification.search import run_search
from wirerope_mj.mounts.test_rig import cyclic_test, measured

SMOOTH = wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.0, k=5e4)
LOOPS = measured(cyclic_test(SMOOTH, [0.5e-3, 1.5e-3, 4e-3, 10e-3]), points_per_cycle=60, force_noise=2.0, seed=1)
GUESS = wr.Masing(stiffness=[2e5, 1e5], slip_force=[200.0, 400.0], k=5e4)


def test_slip_that_the_smallest_loop_does_not_show_is_not_searched_for():
    # Without the bound the first element takes the noise at the turning points of the smallest loop for friction.
    found = wr.identify(
        LOOPS, law=wr.Masing, elements=2, start=wr.Masing(stiffness=[1e8, 2e5], slip_force=[20.0, 600.0], k=5e4)
    )
    least = 0.02 * LOOPS[0].amplitude
    assert found.parameters["x1"].value >= least * (1.0 - 1e-3)  # samples of the noisy path
    stiffness = max(loop.secant_stiffness for loop in LOOPS)
    assert max(found.law.stiffness) < 10.0 * stiffness


def test_a_good_start_is_not_left_for_a_worse_place(monkeypatch):
    def astray(search, loops, full, values, method):
        """Return stages that lead away from the start, as those of areas alone may."""
        if method == "three-stage":
            far = {name: 3.0 * value for name, value in values.items()}
            return run_search(search, full, far, max_evaluations=1), ()
        return run_all_stages(search, loops, full, values, method)

    monkeypatch.setattr("wirerope_mj.mounts.identification.identify.run_stages", astray)
    monkeypatch.setattr("wirerope_mj.mounts.identification.identify.grid_starts", lambda *_, **__: [])
    alone = wr.identify(LOOPS, law=wr.Masing, start=GUESS, method="time", grid=False)
    beside = wr.identify(LOOPS, law=wr.Masing, start=GUESS)
    assert beside.residual == pytest.approx(alone.residual, rel=1e-6)


def test_jenkin_elements_beside_nis_polynomial_are_found_again():
    truth = wr.Masing(stiffness=[3e5, 8e4], slip_force=[240.0, 360.0], k=4e4, k2=1.5e6, k3=4e8)
    loops = measured(cyclic_test(truth, [0.5e-3, 2e-3, 5e-3, 12e-3]), points_per_cycle=100, force_noise=1.0, seed=3)
    found = wr.identify(loops, law=wr.Masing, elements=2, free=["k2", "k3"])
    from_start = wr.identify(loops, law=wr.Masing, start=found.law, grid=False, profiles=False)
    assert {"k2", "k3"} <= set(from_start.uncertainty.free)
    for name in ("k", "k2", "k3"):
        parameter = found.parameters[name]
        assert abs(parameter.value - getattr(truth, name)) <= 4.0 * parameter.standard_error, name
        assert parameter.standard_error < 0.1 * getattr(truth, name), name
    bent = [np.abs(loop.force).max() for loop in loops][-1] / truth.k / loops[-1].amplitude
    assert bent > 2.0  # so that a straight spring would not do
