"""SpecimenFits: the scatter that was made comes back, and stands in the isolator file."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.mounts.identification import identify_specimens
from wirerope_mj.mounts.test_rig import cyclic_test, measured

AMPLITUDES = 0.01 * np.array([0.1, 0.4, 1.0])
CENTRE = {"k": 6e4, "d": 400.0, "u_c": 1e-3}
# Standard deviations 6 %, 8 % and 10 %; a specimen with more friction is also stiffer.
SIZES = np.array([0.06, 0.08, 0.10]) * np.array(list(CENTRE.values()))
POPULATION = np.outer(SIZES, SIZES) * np.array([[1.0, 0.7, 0.0], [0.7, 1.0, 0.0], [0.0, 0.0, 1.0]])
NOISE = 0.005  # of the half force range


def noisy(law, seed):
    loops = cyclic_test(law, AMPLITUDES)
    return [
        measured([loop], points_per_cycle=200, force_noise=NOISE * np.ptp(loop.force) / 2.0, seed=seed + place)[0]
        for place, loop in enumerate(loops)
    ]


@pytest.fixture(scope="module")
def made():
    """Return the laws of five specimens and what was found of them."""
    draws = np.random.default_rng(5).multivariate_normal(list(CENTRE.values()), POPULATION, size=5)
    laws = [wr.EnhancedDryFriction(**dict(zip(CENTRE, map(float, row), strict=True))) for row in draws]
    tests = [noisy(law, seed=10 * number) for number, law in enumerate(laws)]
    return draws, identify_specimens(tests, law=wr.EnhancedDryFriction)


def test_covariance_is_that_of_the_specimens_within_the_noise_of_the_fits(made):
    draws, found = made
    assert [row.parameter for row in found.rows] == list(CENTRE)
    true = np.cov(draws, rowvar=False)
    errors = np.array([row.fit_error for row in found.rows])
    assert (errors < 0.2 * SIZES).all()
    # Errors e of the values change s_ij by at most (s_i e_j + s_j e_i + e_i e_j), with 3 standard errors for the largest e.
    sizes = np.sqrt(np.diag(true))
    allowed = 3.0 * (np.outer(sizes, errors) + np.outer(errors, sizes) + 3.0 * np.outer(errors, errors))
    assert (np.abs(found.covariance - true) < allowed).all()
    for row, values in zip(found.rows, draws.T, strict=True):
        # Of fifteen values one exceeds 4 standard errors in a thousand runs.
        np.testing.assert_allclose(row.values, values, rtol=0.0, atol=4.0 * row.fit_error)


def test_covariance_is_that_of_the_population_within_the_sampling_error(made):
    _, found = made
    # 4 s^2 / sigma^2 is chi-squared with 4 degrees of freedom: 99.9 % lie between 0.06 and 20.
    ratios = 4.0 * np.diag(found.covariance) / np.diag(POPULATION)
    assert ((ratios > 0.06) & (ratios < 20.0)).all(), ratios
    # What was found is a covariance: symmetric, no variance below zero.
    assert np.linalg.eigvalsh(found.correlation).min() > -1e-12


def test_nominal_law_stands_amid_the_specimens(made):
    draws, found = made
    for row, values in zip(found.rows, draws.T, strict=True):
        assert values.min() < row.nominal < values.max()
        # Loops of equal weight: near the mean, off by curvature, a tenth of a parameter's scatter squared.
        assert row.nominal == pytest.approx(row.mean, rel=0.03)
    assert isinstance(found.law, wr.EnhancedDryFriction)
    assert len(found.each) == 5


def test_scatter_goes_through_the_isolator_file(made, tmp_path):
    _, found = made
    isolator = wr.Isolator(name="five of a kind", axial=found.law, spread=found.spread("axial"))
    isolator.save(tmp_path / "five.toml")
    back = wr.load_isolator(tmp_path / "five.toml")
    assert back.spread.parameters == ("axial.k", "axial.d", "axial.u_c")
    np.testing.assert_allclose(back.spread.covariance, found.covariance, rtol=1e-12)
    # What a tolerance study does: draw, and put the values where their names say.
    for name in back.spread.parameters:
        axis, parameter = name.split(".")
        assert parameter in back.axes[axis].to_dict()


def test_a_shared_coordinate_is_the_same_in_every_specimen():
    laws = [wr.BoucWen.from_normalised(z_max=z, x_y=1e-3, sigma=0.8, n=1.0, k=5e4) for z in (300.0, 330.0, 360.0)]
    found = identify_specimens(
        [noisy(law, seed=10 * place) for place, law in enumerate(laws)], law=wr.BoucWen, shared=("n", "sigma")
    )
    assert len({fit.parameters["n"].value for fit in found.each}) == 1
    assert all(fit.parameters["sigma"].fixed for fit in found.each)
    # n does not vary, so it has no row; alpha = z_max / x_y varies as it was made, 10 % of 3.3e5.
    assert [row.parameter for row in found.rows] == ["alpha", "beta", "gamma", "k"]
    assert found.rows[0].deviation == pytest.approx(3e4, rel=0.2)


def test_bad_input_is_refused():
    one = noisy(wr.EnhancedDryFriction(**CENTRE), seed=0)
    with pytest.raises(ValueError, match="`specimens` must hold the loops of 2 at least, got 1"):
        identify_specimens([one], law=wr.EnhancedDryFriction)
    with pytest.raises(ValueError, match="`shared` names 'n'; enhanced-dry-friction is searched for by d, u_c, k"):
        identify_specimens([one, one], law=wr.EnhancedDryFriction, shared=("n",))
    with pytest.raises(ValueError, match=r"`specimens\[1\]` must hold at least one closed loop"):
        identify_specimens([one, []], law=wr.EnhancedDryFriction)
    found = identify_specimens([one, noisy(wr.EnhancedDryFriction(**CENTRE), seed=9)], law=wr.EnhancedDryFriction)
    with pytest.raises(ValueError, match="`axis` must be one of 'roll', 'shear', 'axial', got 'x'"):
        found.spread("x")
