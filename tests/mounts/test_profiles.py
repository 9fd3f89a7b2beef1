"""How far values may be moved: curved residuals of known width, second valleys, and a law that has them."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.mounts.identification.families import Coordinate, Family
from wirerope_mj.mounts.identification.profiles import survey
from wirerope_mj.mounts.identification.search import Unknowns, run_search
from wirerope_mj.mounts.test_rig import cyclic_test, measured

TRAVEL = 0.01


def surveyed(function, start, *, names=("a",), rivals=()):
    """Return the survey of a residual of plain numbers with noise 1, and where its search ended."""
    coordinates = [Coordinate(name=name, unit="N", lower=-1e3, upper=1e3, scale=100.0) for name in names]
    family = Family(coordinates=lambda scales: coordinates, make=lambda values: values, read=lambda law: law)
    search = Unknowns(family=family, coordinates=coordinates, fixed={})
    found = run_search(search, function, dict(zip(names, start, strict=True)))
    others = [run_search(search, function, dict(zip(names, place, strict=True))) for place in rivals]
    return survey(search, function, found, others, noise=1.0)


def test_error_of_a_linear_residual_stays():
    result = surveyed(lambda v: np.array([(v["a"] - 50.0) / 2.0, 0.0]), [30.0])
    assert result.uncertainty.parameters["a"].standard_error == pytest.approx(2.0, rel=1e-6)
    assert result.uncertainty.non_identifiable == ()
    assert result.evaluations == 2  # one on each side


def test_error_of_a_residual_that_flattens_is_a_third_of_where_it_has_risen_by_nine():
    result = surveyed(lambda v: np.array([np.arcsinh((v["a"] - 500.0) / 2.0), 0.0]), [490.0])
    # asinh(d / 2) = 3 at d = 2 sinh(3); the rise counts from 8.1 on, sinh(2.85) / sinh(3) = 0.86.
    assert result.uncertainty.parameters["a"].standard_error == pytest.approx(2.0 * np.sinh(3.0) / 3.0, rel=0.15)


def test_a_value_for_which_another_makes_up_beyond_its_error_is_named():
    # Near a = 100 the second residual holds b, far from it b follows a freely and the first says nothing.
    def function(v):
        return np.array([v["a"] - 100.0 - v["b"], np.tanh(v["b"] / 5.0), 0.0])

    result = surveyed(function, [100.0, 0.5], names=("a", "b"))
    assert result.uncertainty.parameters["a"].standard_error > 25.0
    assert any(words.startswith("a is not identifiable to better than") for words in result.uncertainty.non_identifiable)


def test_another_valley_within_nine_variances_widens_the_error_and_is_named():
    def valleys(depth):
        # Slope 1 at both ends, 40 apart; the second is higher by `depth`.
        return lambda v: np.array([(v["a"] - 80.0) * (v["a"] - 120.0) / 40.0, np.sqrt(depth) * (v["a"] > 100.0), 0.0])

    near = surveyed(valleys(1.0), [81.0], rivals=[[119.0]]).uncertainty
    # 40 to the second valley, and there sqrt(9 - 1) of its errors of 1.
    assert near.parameters["a"].standard_error == pytest.approx((40.0 + np.sqrt(8.0)) / 3.0, rel=1e-3)
    assert any("another set of values fits almost as well: a 120 N" in words for words in near.non_identifiable)
    far = surveyed(valleys(20.0), [81.0], rivals=[[119.0]]).uncertainty
    assert far.parameters["a"].standard_error < 1.2
    assert far.non_identifiable == ()


def test_a_better_fit_met_on_the_way_is_handed_back():
    # A step down beyond 1.5 errors: another valley, deeper by four variances.
    def function(v):
        return np.array([v["a"] - 100.0 if v["a"] < 101.5 else 0.1 * (v["a"] - 103.0), 2.0 * (v["a"] < 101.5)])

    result = surveyed(function, [99.0])
    assert result.better is not None
    assert result.better["a"] == pytest.approx(103.0, abs=0.1)


@pytest.mark.slow
def test_springs_that_harden_and_soften_alike_are_told_of():
    # b2 < 0 beside a stiffer kb fits as well: found by moving nothing, only by beginning there too.
    truth = wr.VaianaRosati(kb=45555.0, f0=188.1, alpha=374.8, b1=23.6, b2=143.2, g1=94.4, g2=256.0, g3=1.157e-3)
    loops = []
    for seed, loop in enumerate(cyclic_test(truth, TRAVEL * np.array([0.05, 0.15, 0.4, 0.7, 1.0]))):
        loops += measured([loop], points_per_cycle=200, force_noise=0.005 * np.ptp(loop.force), seed=seed)
    result = wr.identify(loops, law=wr.VaianaRosati)
    assert any(words.startswith("another set of values fits") for words in result.non_identifiable)
    kb = result.parameters["kb"]
    assert abs(kb.value - truth.kb) < 3.0 * kb.standard_error
    linear = np.sqrt(result.uncertainty.covariance[0, 0])
    assert result.uncertainty.free[0] == "kb"
    assert kb.standard_error > 2.0 * linear
