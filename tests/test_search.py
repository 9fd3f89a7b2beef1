"""The search itself: its Jacobian, where it is easily wrong."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.bench import cyclic_test
from wirerope_mj.identification.coordinates import FAMILIES
from wirerope_mj.identification.measured import prepare, scales_of
from wirerope_mj.identification.residuals import loop_residual
from wirerope_mj.identification.search import Search, run_search


@pytest.mark.parametrize("k", [0.0, 1e-6, 5e4])
def test_jacobian_of_a_number_near_zero_is_no_rounding(k):
    law = wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.0, k=k)
    loops = prepare(cyclic_test(law, [1e-3, 4e-3]))
    scales = scales_of(loops)
    family = FAMILIES[wr.BoucWen]
    search = Search(family=family, coordinates=family.coordinates(scales), fixed={})
    found = run_search(search, loop_residual(loops), family.read(law))
    # The force is linear in k: its column is the deflection without its mean, over the loop's weight, times k's scale.
    deflections = [(loop.deflection - loop.deflection.mean()) / loop.weight for loop in loops]
    expected = np.concatenate(deflections) * scales.force / scales.deflection
    place = [c.name for c in search.free].index("k")
    # Traces are exact to 1e-11, the step is 1e-6.
    np.testing.assert_allclose(found.jacobian[:, place], expected, atol=1e-4 * np.abs(expected).max())
