"""The search itself: its Jacobian, where it is easily wrong."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.mounts.identification.families import FAMILIES
from wirerope_mj.mounts.identification.measured import prepare, scales_of
from wirerope_mj.mounts.identification.search import Unknowns, loop_residual, run_search
from wirerope_mj.mounts.test_rig import cyclic_test, measured

pytestmark = pytest.mark.quick


@pytest.mark.parametrize("k", [0.0, 1e-6, 5e4])
def test_jacobian_of_a_number_near_zero_is_no_rounding(k):
    law = wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.0, k=k)
    loops = prepare(cyclic_test(law, [1e-3, 4e-3]))
    scales = scales_of(loops)
    family = FAMILIES[wr.BoucWen]
    search = Unknowns(family=family, coordinates=family.coordinates(scales), fixed={})
    found = run_search(search, loop_residual(loops), family.read(law))
    # The force is linear in k: its column is the deflection without its mean, over the loop's weight, times k's scale.
    deflections = [(loop.deflection - loop.deflection.mean()) / loop.weight for loop in loops]
    expected = np.concatenate(deflections) * scales.force / scales.deflection
    place = [c.name for c in search.free].index("k")
    # Traces are exact to 1e-11, the step is 1e-6.
    np.testing.assert_allclose(found.jacobian[:, place], expected, atol=1e-4 * np.abs(expected).max())


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.05, 0.1])
def test_a_fit_far_below_the_yield_deflection_ends_although_most_is_open(share):
    # There the law is a spring and a little friction: z_max, x_y, k, and n creep along a valley that the noise does not see.
    law = wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-2, sigma=0.7, n=1.3, k=5e4)
    loops = []
    for seed, loop in enumerate(cyclic_test(law, 0.02 * share * np.array([0.3, 0.5, 0.7, 1.0]))):
        loops += measured([loop], points_per_cycle=200, force_noise=0.005 * np.ptp(loop.force), seed=seed)
    result = wr.identify(loops, law=wr.BoucWen)
    assert result.converged, result.message
    assert len(result.non_identifiable) >= 2
    # 800 samples know the noise within 2.5 %, three times that.
    assert result.residual == pytest.approx(0.01, rel=0.08)


def test_a_search_that_is_cut_short_has_not_converged():
    law = wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.0, k=5e4)
    loops = prepare(cyclic_test(law, [1e-3, 4e-3]))
    family = FAMILIES[wr.BoucWen]
    search = Unknowns(family=family, coordinates=family.coordinates(scales_of(loops)), fixed={})
    found = run_search(search, loop_residual(loops), {**family.read(law), "x_y": 1e-4, "sigma": 0.01}, max_evaluations=3)
    assert not found.converged
    assert "still moved after 3" in found.message
