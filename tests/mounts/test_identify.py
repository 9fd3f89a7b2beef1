"""Identification: known laws come back from noisy loops, and what the data cannot fix is said."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.mounts.identification.families import FAMILIES, Scales
from wirerope_mj.mounts.identification.measured import prepare
from wirerope_mj.mounts.identification.result import validity_of
from wirerope_mj.mounts.identification.search import area_residual
from wirerope_mj.mounts.test_rig import cyclic_test, measured

TRAVEL = 0.01
TESTED = TRAVEL * np.array([0.05, 0.15, 0.4, 0.7, 1.0])
LEFT_OUT = TRAVEL * np.array([0.1, 0.25, 0.85])
NOISE = 0.01  # of the half force range


def noisy_loops(law, seed, amplitudes=TESTED, noise=NOISE):
    """Return loops of 200 samples with force noise and an unknown zero of the load cell each."""
    rng = np.random.default_rng(seed)
    loops = []
    for loop in cyclic_test(law, amplitudes):
        sigma = noise * np.ptp(loop.force) / 2.0
        one = measured([loop], points_per_cycle=200, force_noise=sigma, seed=int(rng.integers(1 << 31)))[0]
        loops.append(wr.Loop.from_samples(one.deflection, one.force + rng.normal(scale=20.0)))
    return loops


def error_left_out(found, truth):
    """Return the largest error of loops at amplitudes that were not tested, over their half force range, without means."""
    pairs = zip(cyclic_test(found, LEFT_OUT), cyclic_test(truth, LEFT_OUT), strict=True)
    return max(np.std(a.force - b.force) / (np.ptp(b.force) / 2.0) for a, b in pairs)


TRUTHS = [
    wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.3, k=5e4),
    wr.SymmetricBoucWen.from_normalised(z_max=500.0, x_y=1.5e-3, sigma=0.9, n=1.0, k1=4e4, k2=0.0, k3=4e8),
    wr.AsymmetricBoucWen.from_normalised(z_max=700.0, x_y=1e-3, sigma=0.6, n=1.0, k1=5e4, k2=1e6, k3=2e8, b=np.e, c=35.0),
    wr.EnhancedDryFriction(k=6e4, d=400.0, u_c=1e-3),
]


@pytest.mark.parametrize("truth", TRUTHS, ids=lambda law: law.name)
def test_a_known_law_comes_back_within_the_noise(truth):
    result = wr.identify(noisy_loops(truth, seed=1), law=type(truth))
    assert result.converged, result.message
    # What is left is the noise: 1 % with 200 samples on each of five loops, within 5 % of itself.
    assert result.residual == pytest.approx(NOISE, rel=0.1)
    assert error_left_out(result.law, truth) < NOISE
    expected = FAMILIES[type(truth)].read(truth)
    for name, parameter in result.parameters.items():
        # Of eight parameters the largest deviation exceeds four standard errors once in two thousand seeds.
        assert abs(parameter.value - expected[name]) < 4.0 * parameter.standard_error, (name, parameter, expected[name])


@pytest.mark.quick
def test_poor_start_is_rescued_by_the_grid():
    truth = TRUTHS[0]
    poor = wr.BoucWen.from_normalised(z_max=8.0, x_y=0.2, sigma=0.01, n=10.0, k=5e2)
    result = wr.identify(noisy_loops(truth, seed=2), law=wr.BoucWen, start=poor)
    assert error_left_out(result.law, truth) < NOISE


def test_pair_of_equal_sum_is_told_apart_by_loops_and_not_by_tips():
    pair = [wr.BoucWen.from_normalised(z_max=800.0, x_y=4e-3, sigma=s, n=1.0, k=5e4) for s in (0.8, 0.5)]
    for truth in pair:
        loops = noisy_loops(truth, seed=3)
        whole = wr.identify(loops, law=wr.BoucWen).parameters["sigma"]
        assert whole.standard_error < 0.02
        assert abs(whole.value - truth.normalised.sigma) < 4.0 * whole.standard_error
        tips = wr.identify(loops, law=wr.BoucWen, data="skeleton", noise=NOISE)
        assert tips.parameters["sigma"].standard_error > 0.3  # the whole distance of the pair
        assert any("sigma" in words for words in tips.non_identifiable), tips.non_identifiable


def test_constraints_hold():
    loops = noisy_loops(TRUTHS[0], seed=4)  # sigma = 0.7
    values = {
        constraint: wr.identify(loops, law=wr.BoucWen, constraint=constraint).parameters["sigma"]
        for constraint in ("beta>gamma", "beta=gamma", "beta<gamma")
    }
    assert values["beta>gamma"].value == pytest.approx(0.7, abs=0.05)
    assert values["beta=gamma"].fixed
    assert values["beta=gamma"].value == 0.5
    assert values["beta<gamma"].at_bound
    assert values["beta<gamma"].value == pytest.approx(0.5, abs=1e-3)


@pytest.mark.quick
def test_bad_input_is_refused():
    loops = noisy_loops(TRUTHS[0], seed=5)
    with pytest.raises(ValueError, match="8 parameters are free .*3 different amplitudes are needed, 2 given"):
        wr.identify(loops[:2], law=wr.AsymmetricBoucWen)
    with pytest.raises(ValueError, match="`law` must be one that cyclic tests can fix .*got 'zener'"):
        wr.identify(loops, law=wr.Zener)
    with pytest.raises(ValueError, match="`fixed` names 'beta', which bouc-wen does not have; it has z_max"):
        wr.identify(loops, law=wr.BoucWen, fixed={"beta": 1.0})
    half = wr.Loop.from_samples(loops[-1].deflection[:101], loops[-1].force[:101])
    with pytest.raises(ValueError, match="loop 1 is not a full cycle"):
        wr.identify([half, *loops[1:]], law=wr.BoucWen)
    still = wr.Loop.from_samples(np.full(100, 1e-3), loops[0].force[:100])
    with pytest.raises(ValueError, match="loop 1: the deflection is constant at 0.001 m"):
        wr.identify([still], law=wr.BoucWen)
    clipped = wr.Loop.from_samples(loops[-1].deflection, np.minimum(loops[-1].force, 0.7 * loops[-1].force.max()))
    with pytest.raises(ValueError, match="exactly the largest force.*saturated"):
        wr.identify([clipped], law=wr.BoucWen)


@pytest.mark.quick
def test_a_parameter_that_moves_nothing_stops_the_fit_and_is_named():
    # The second element slips beyond every deflection tested: nothing tells where.
    start = wr.Masing(stiffness=[1e5, 1e5], slip_force=[1e2, 1e7], k=1e4)
    with pytest.raises(ValueError, match=r"`x2/x1` does not move the residual at the start"):
        wr.identify(noisy_loops(TRUTHS[0], seed=6), law=wr.Masing, start=start, grid=False)


@pytest.mark.quick
def test_a_loop_run_through_backwards_is_refused_and_a_thin_one_is_not():
    loops = noisy_loops(TRUTHS[0], seed=7)
    backwards = wr.Loop.from_samples(loops[0].deflection[::-1], loops[0].force[::-1])
    with pytest.raises(ValueError, match=r"the loop of \+-0\.5 mm encloses -.* J: it would give energy"):
        wr.identify([backwards, *loops[1:]], law=wr.BoucWen)
    # The line through the turning points encloses nothing; the first loop's weight in the areas must stay finite.
    x = loops[0].deflection
    thin = wr.Loop.from_samples(x, 8e4 * x)
    residual = area_residual(prepare([thin, *loops[1:]]))(TRUTHS[0])
    assert np.isfinite(residual).all()
    assert np.abs(residual).max() < 50.0  # at most the whole rectangle over the share that counts as thin, 1 / 0.02
    assert np.isfinite(wr.identify([thin, *loops[1:]], law=wr.BoucWen, start=TRUTHS[0], grid=False).residual)


@pytest.mark.quick
@pytest.mark.parametrize(("least", "bound"), [(1e-2, 0.1772), (1e-3, 0.1115), (1e-4, 0.1)])
def test_n_is_not_searched_for_below_what_the_least_amplitude_shows(least, bound):
    """ln 2 / ln(A_max / (0.02 A_min)): half of the slope at z = 0 is then lost within what its samples show."""
    scales = Scales(deflection=1e-2, least=least, force=500.0)
    for kind in (wr.BoucWen, wr.Ozdemir, wr.SymmetricBoucWen, wr.AsymmetricBoucWen):
        (n,) = [c for c in FAMILIES[kind].coordinates(scales) if c.name == "n"]
        assert n.lower == pytest.approx(bound, abs=1e-4)


@pytest.mark.quick
def test_a_fit_of_a_gradual_law_names_its_range_and_what_it_does_not_show():
    """x_y (1/2)^(1/n) of the truth is 0.6 um, and 2 % of the least amplitude 40 um: samples cannot know alpha."""
    truth = wr.BoucWen.from_normalised(z_max=60.0, x_y=6e-4, sigma=0.7, n=0.1, k=1e5)
    result = wr.identify(noisy_loops(truth, seed=3, amplitudes=[2e-3, 5e-3, 1e-2]), law=wr.BoucWen, profiles=False)
    assert result.law.n >= 0.1255 * (1.0 - 1e-3)  # ln 2 / ln 250
    assert result.validity.startswith("valid for cycles of 2 to 10 mm amplitude between -10 and 10 mm")
    assert result.validity in str(result)
    unseen = result.law.normalised.x_y * 0.5 ** (1.0 / result.law.n) < 0.02 * 2e-3
    assert ("the stiffness of smaller cycles is a guess" in result.validity) == unseen
    sharp = validity_of(TRUTHS[0], result.loops)
    tested = "cycles of 2 to 10 mm amplitude between -10 and 10 mm, which were tested"
    assert sharp == f"valid for {tested}, not below 2 mm; extrapolated beyond, where the error of the fit says nothing"
    assert "n = 0.1 half of the slope alpha is lost within 0.00059 mm" in validity_of(truth, result.loops)
