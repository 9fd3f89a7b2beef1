"""Standard errors where the noise is that of a load cell: as many newtons on a small loop as on a large one."""

import numpy as np
import pytest
import scipy

import wirerope_mj as wr
from wirerope_mj.mounts.identification.families import Scales, family_of
from wirerope_mj.mounts.identification.search import Minimum, Unknowns
from wirerope_mj.mounts.identification.uncertainty import uncertainty_of, with_noise_of_each
from wirerope_mj.mounts.test_rig import cyclic_test, measured, steady_loops

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


@pytest.mark.slow
def test_standard_errors_hold_where_loops_of_unlike_noise_count_alike():
    # The rms of 40 normal numbers is within 2.6 of its own standard errors, 1 / sqrt(80), of one.
    assert scatter() == pytest.approx([1.0] * 5, abs=0.29)


@pytest.mark.slow
def test_standard_errors_hold_where_a_newton_counts_alike():
    assert scatter(weights="equal") == pytest.approx([1.0] * 5, abs=0.29)


def recorded(seed, kind):
    """Return the loops of a record whose noise of 12 N rms is white, correlated 0.9 from sample to sample, or hum as well."""
    rng = np.random.default_rng(seed)
    time = np.arange(8000) / 400.0
    path = np.repeat(AMPLITUDES, 5)[time.astype(int)] * np.sin(2.0 * np.pi * time)
    noise = rng.standard_normal(time.size + 300)
    if kind == "correlated":
        noise = scipy.signal.lfilter([np.sqrt(1.0 - 0.9**2)], [1.0, -0.9], noise)
    force = TRUTH.trace(path).force + 12.0 * noise[300:]
    if kind == "hum":
        force = force + 17.0 * np.sin(2.0 * np.pi * 13.3 * time + rng.uniform(0.0, 6.0))  # of a pump: not of the mains
    return steady_loops(path, force, time=time)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["white", "correlated", "hum"])
def test_standard_errors_hold_whatever_correlates_the_noise(kind):
    fits = [
        wr.identify(recorded(seed, kind), law=wr.BoucWen, start=TRUTH, grid=False, method="time", profiles=False).parameters
        for seed in range(100, 140)
    ]
    ratios = np.array([[(p[name].value - true) / p[name].standard_error for name, true in VALUES.items()] for p in fits])
    assert np.sqrt(np.mean(ratios**2, axis=0)) == pytest.approx([1.0] * 5, abs=0.29)  # as above
    # 95 % of 40: within three of their standard errors, for every parameter.
    assert np.mean(np.abs(ratios) < 1.96, axis=0).min() >= 0.85


def test_a_parameter_that_moves_nothing_where_a_search_ends_is_not_known_and_leaves_the_others_alone():
    rng = np.random.default_rng(3)
    family = family_of(wr.BoucWen)
    unknowns = Unknowns(
        family=family, coordinates=family.coordinates(Scales(deflection=0.01, least=0.001, force=1e3)), fixed={}
    )
    jacobian, residual = rng.standard_normal((800, 5)), rng.standard_normal(800)
    jacobian[:, 2] = 0.0
    minimum = Minimum(
        numbers=unknowns.numbers(VALUES), residual=residual, jacobian=jacobian, iterations=1, evaluations=1, converged=True,
        message="",
    )  # fmt: skip
    found = with_noise_of_each(uncertainty_of(unknowns, minimum), unknowns, minimum, [200] * 4).parameters
    assert found["sigma"].standard_error > 1e9
    assert all(0.0 < found[name].standard_error < VALUES[name] for name in VALUES if name != "sigma")


def test_a_noise_that_is_given_is_that_of_all_loops():
    known, left = fitted(1, noise=1.0), fitted(1, noise=2.0)
    for name in VALUES:
        assert left.parameters[name].standard_error == pytest.approx(2.0 * known.parameters[name].standard_error)


def test_terms_that_the_device_does_not_have_are_not_significant():
    loops = [
        measured([loop], points_per_cycle=200, force_noise=12.0, seed=place)[0]
        for place, loop in enumerate(cyclic_test(TRUTH, AMPLITUDES))
    ]
    found = wr.identify(loops, law=wr.AsymmetricBoucWen, profiles=False)
    assert set(found.insignificant) == {"k2", "k3", "c_ln_b"}
    assert "not significant: k2, k3, c_ln_b" in str(found)
    assert wr.identify(loops, law=wr.BoucWen, profiles=False).insignificant == ()
