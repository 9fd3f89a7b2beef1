"""The virtual acquisition: samples, noise of the stated size, converter steps, and the same again for the same seed."""

import numpy as np
import pytest

from wirerope_mj.mounts.laws import BoucWen, Loop
from wirerope_mj.mounts.test_rig import cyclic_test, measured

pytestmark = pytest.mark.quick

LOOP = cyclic_test(BoucWen(alpha=1e5, beta=800.0, gamma=200.0, n=1), 2e-3)[0]


def test_samples_without_noise_are_those_of_the_loop():
    (sampled,) = measured([LOOP], seed=1, points_per_cycle=100)
    np.testing.assert_array_equal(sampled.deflection, LOOP.deflection[::4])
    np.testing.assert_array_equal(sampled.force, LOOP.force[::4])
    assert sampled.cycles == LOOP.cycles
    assert np.isnan(sampled.hysteretic_state).all()


def test_samples_between_those_of_the_loop_lie_on_its_chords():
    (sampled,) = measured([LOOP], seed=1, points_per_cycle=77)
    exact = 2e-3 * np.sin(2.0 * np.pi * np.arange(78) / 77)
    assert np.abs(sampled.deflection - exact).max() < np.pi**2 / 2.0 / 400**2 * 2e-3


@pytest.mark.parametrize("points", [50, 100, 200])
def test_area_of_samples_is_that_of_the_inscribed_polygon(points):
    (sampled,) = measured([LOOP], seed=1, points_per_cycle=points)
    lost = 1.0 - sampled.dissipated_energy / LOOP.dissipated_energy
    # (2 pi / N)^2 / 6 for an ellipse; the pointed ends of a hysteresis loop change that by some tens of percent.
    assert lost == pytest.approx((2.0 * np.pi / points) ** 2 / 6.0, rel=0.5)


def test_noise_has_the_stated_size_in_each_channel_and_no_mean():
    many = measured([LOOP] * 50, seed=7, points_per_cycle=400, force_noise=3.0, deflection_noise=2e-5)
    for signal, exact, size in (
        ([loop.force for loop in many], LOOP.force, 3.0),
        ([loop.deflection for loop in many], LOOP.deflection, 2e-5),
    ):
        error = np.asarray(signal) - exact
        # 20 050 samples: 1 / sqrt(2 N) = 0.5 % of the deviation, 1 / sqrt(N) = 0.7 % of it in the mean; four of each.
        assert error.std() == pytest.approx(size, rel=0.02)
        assert abs(error.mean()) < 0.03 * size
    ends = np.array([loop.force[-1] - loop.force[0] for loop in many])
    assert ends.std() == pytest.approx(3.0 * np.sqrt(2.0), rel=0.4)  # measured anew: 50 samples, 10 % each, four of them


def test_noise_does_not_bias_the_area():
    many = measured([LOOP] * 200, seed=2, points_per_cycle=400, force_noise=3.0, deflection_noise=2e-5)
    energies = np.array([loop.dissipated_energy for loop in many])
    expected = measured([LOOP], seed=0, points_per_cycle=400)[0].dissipated_energy
    assert abs(energies.mean() - expected) < 4.0 * energies.std() / np.sqrt(energies.size)


def test_the_same_seed_gives_the_same_samples_and_another_gives_others():
    first, same, other = (measured([LOOP, LOOP], seed=seed, force_noise=1.0) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first[0].force, same[0].force)
    assert (first[0].force != other[0].force).any()
    assert (first[0].force != first[1].force).any()


def test_noise_of_one_channel_does_not_depend_on_the_other():
    alone, both = (measured([LOOP], seed=1, force_noise=1.0, deflection_noise=noise)[0] for noise in (0.0, 1e-5))
    np.testing.assert_array_equal(alone.force, both.force)


def test_converter_rounds_to_its_steps():
    (stepped,) = measured([LOOP], seed=1, points_per_cycle=400, force_resolution=5.0, deflection_resolution=1e-4)
    np.testing.assert_allclose(stepped.force / 5.0, np.round(stepped.force / 5.0), rtol=1e-12)
    assert np.abs(stepped.force - LOOP.force).max() <= 2.5 * (1.0 + 1e-12)
    assert np.abs(stepped.deflection - LOOP.deflection).max() <= 0.5e-4 * (1.0 + 1e-12)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"points_per_cycle": 4}, "`points_per_cycle` must be an integer >= 8, got 4"),
        ({"force_noise": -1.0}, "`force_noise` must be >= 0, got -1.0"),
        ({"deflection_noise": np.nan}, "`deflection_noise` must be a finite number"),
        ({"force_resolution": np.inf}, "`force_resolution` must be a finite number"),
        ({"deflection_resolution": -1e-6}, "`deflection_resolution` must be >= 0"),
    ],
)
def test_bad_arguments_are_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        measured([LOOP], seed=1, **arguments)


@pytest.mark.parametrize(
    ("deflection", "force"), [([0.0, 1.0], [0.0]), ([0.0], [0.0]), ([0.0, np.nan], [0.0, 1.0]), ([[0.0]], [[0.0]])]
)
def test_a_loop_of_samples_needs_two_finite_series(deflection, force):
    with pytest.raises(ValueError, match="finite series of the same length"):
        Loop.from_samples(deflection, force)
