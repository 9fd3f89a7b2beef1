"""What a fit and a comparison say when they are printed."""

import wirerope_mj as wr
from wirerope_mj.mounts.identification import compare_laws
from wirerope_mj.mounts.test_rig import cyclic_test, measured

LAW = wr.EnhancedDryFriction(d=400.0, u_c=1e-3, k=5e4)
LOOPS = measured(cyclic_test(LAW, [1e-3, 4e-3]), points_per_cycle=60, force_noise=1.0, seed=1)


def test_a_fit_prints_its_parameters_with_units_and_no_arrays():
    text = str(wr.identify(LOOPS, law=wr.EnhancedDryFriction, fixed={"k": 5e4}))
    assert "array(" not in text
    words = [line.split() for line in text.splitlines()]
    assert ["parameter", "value", "standard", "error", "unit"] in words
    (d,) = [line for line in words if line[0] == "d"]
    assert abs(float(d[1]) - 400.0) < 10.0  # the noise of one sample
    assert d[-1] == "N"
    assert ["k", "50000", "given", "N/m"] in words


def test_a_law_that_could_not_be_fitted_says_why_in_the_table():
    table = str(compare_laws(LOOPS[:1], laws=[wr.EnhancedDryFriction, wr.BoucWen]))
    assert "nan" not in table
    assert "inf" not in table
    assert "bouc-wen                 not fitted: 5 parameters are free" in table
    assert "-: there is only one amplitude" in table
