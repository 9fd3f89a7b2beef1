"""Friction on several scales: laws of two and three sets in parallel, found from cyclic tests."""

import math
from dataclasses import replace

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.mounts.identification.identify import group_error
from wirerope_mj.mounts.identification.measured import ScaleLoop, prepare, scales_of
from wirerope_mj.mounts.identification.scales import APART, LEAST_EXPONENT, SCALES, scales_family

AMPLITUDES = (0.5e-3, 1e-3, 2e-3, 4e-3, 8e-3, 15e-3)


def rope(*, sizes=((360.0, 6e-3), (105.0, 1.4e-3), (45.0, 0.36e-3)), n=1.6, c=8.0):
    """Return asymmetric Bouc-Wen sets in parallel, as of (z_max, x_y), with one spring."""
    springs = [{"k1": 3e4, "k2": 0.0, "k3": 3e7}] + [{"k1": 0.0, "k2": 0.0, "k3": 0.0}] * (len(sizes) - 1)
    return wr.Parallel(
        laws=[
            wr.AsymmetricBoucWen.from_normalised(z_max=z, x_y=x, sigma=0.6, n=n, b=math.e, c=c, **spring)
            for (z, x), spring in zip(sizes, springs, strict=True)
        ]
    )


def noisy_loops(law, amplitudes=AMPLITUDES, *, noise=2e-3, seed=0):
    """Return steady loops with noise of a fraction of half the force range."""
    rng, loops = np.random.default_rng(seed), []
    for loop in wr.cyclic_test(law, amplitudes, points_per_cycle=200):
        force = loop.force + noise * 0.5 * np.ptp(loop.force) * rng.standard_normal(loop.force.size)
        force[-1] = force[0]
        loops.append(replace(loop, force=force))
    return loops


@pytest.fixture(scope="module")
def loops():
    return noisy_loops(rope())


@pytest.fixture(scope="module")
def three(loops):
    return wr.identify(loops, law=wr.AsymmetricBoucWen, scales=3)


@pytest.mark.slow
def test_three_scales_are_found_within_their_errors(three):
    truth = {
        "z_max_large": 360.0, "z_max_middle": 105.0, "z_max_small": 45.0, "x_y_large": 6e-3, "x_y_large/middle": 6.0 / 1.4,
        "x_y_middle/small": 1.4 / 0.36, "n_large": 1.6, "n_middle": 1.6, "n_small": 1.6, "sigma": 0.6, "k1": 3e4, "k2": 0.0,
        "k3": 3e7, "c_ln_b": 8.0,
    }  # fmt: skip
    assert three.converged
    assert three.scales == ("large", "middle", "small")
    assert set(three.parameters) == set(truth)
    off = {n: (p.value - truth[n]) / p.standard_error for n, p in three.parameters.items()}
    assert max(map(abs, off.values())) < 5.0, off  # of 14, beyond five standard errors never
    # The noise is 0.2 %, and so is what is left.
    assert three.residual == pytest.approx(2e-3, rel=0.05)
    assert not three.non_identifiable


def test_the_law_has_one_spring_one_asymmetry_and_scales_apart(three):
    large, middle, small = three.law.laws
    assert {law.asymmetry for law in three.law.laws} == {large.asymmetry}
    assert (middle.k1, middle.k2, middle.k3, small.k1, small.k2, small.k3) == (0.0,) * 6
    yields = [law.normalised.x_y for law in three.law.laws]
    assert yields[0] >= APART * yields[1] >= APART**2 * yields[2]
    assert three.uncertainty.correlation.shape == (14, 14)
    assert "yield deflections: large scale 6" in str(three)
    assert "0.5 to 15 mm" in three.validity
    assert repr(three).startswith("Identification of 3 scales of AsymmetricBoucWen")


@pytest.mark.slow
def test_the_smallest_amplitude_left_out_is_predicted_three_times_better_than_by_one_set(loops):
    smallest = prepare(loops)[0]
    errors = {
        scales: group_error(
            wr.identify(loops[1:], law=wr.AsymmetricBoucWen, scales=scales, profiles=False).law, [smallest], [0]
        )
        for scales in (1, 3)
    }
    assert errors[3] < errors[1] / 3.0, errors


@pytest.mark.slow
def test_stiffness_and_damping_of_small_cycles_are_the_devices(three):
    for amplitude in (0.05e-3, 0.2e-3):  # a tenth of the least amplitude, and less than half of it
        ours, device = (wr.cyclic_test(law, amplitude, points_per_cycle=200)[0] for law in (three.law, rope()))
        assert ours.secant_stiffness == pytest.approx(device.secant_stiffness, rel=0.01)  # resonances within 0.5 %
        assert ours.damping_ratio == pytest.approx(device.damping_ratio, rel=0.2)


@pytest.mark.quick
@pytest.mark.parametrize("kind", [wr.BoucWen, wr.SymmetricBoucWen])
def test_other_laws_have_two_scales_too(kind):
    device = rope(sizes=((360.0, 6e-3), (45.0, 0.36e-3)), c=0.0)
    if kind is wr.BoucWen:
        device = wr.Parallel(
            laws=[wr.BoucWen(alpha=law.alpha, beta=law.beta, gamma=law.gamma, n=law.n, k=law.k1) for law in device.laws]
        )
    fit = wr.identify(noisy_loops(device, AMPLITUDES[1:]), law=kind, scales=2, profiles=False)
    assert [type(law) for law in fit.law.laws] == [kind, kind]
    assert fit.law.laws[1].normalised.x_y == pytest.approx(0.36e-3, rel=0.05)  # the errors of 1 % and less, three of them
    assert fit.residual == pytest.approx(2e-3, rel=0.1)


@pytest.mark.slow
def test_n_of_a_scale_does_not_leave_its_bound(loops):
    # Two scales for a device of three: n is pressed down, as one set's is to 0.11.
    fit = wr.identify(loops, law=wr.AsymmetricBoucWen, scales=2, profiles=False)
    assert min(law.n for law in fit.law.laws) >= LEAST_EXPONENT
    one = wr.identify(loops, law=wr.AsymmetricBoucWen, profiles=False)
    assert one.law.n < LEAST_EXPONENT


@pytest.mark.slow
def test_auto_takes_as_many_scales_as_the_device_has():
    for sizes in (((360.0, 6e-3),), ((360.0, 6e-3), (45.0, 0.36e-3))):
        device = rope(sizes=sizes)
        fit = wr.identify(
            noisy_loops(device if len(sizes) > 1 else device.laws[0]),
            law=wr.AsymmetricBoucWen,
            scales="auto",
            profiles=False,
        )
        assert len(fit.law.components) == len(sizes), fit.scale_rows
        assert [row.count for row in fit.scale_rows] == list(range(1, len(sizes) + 2))


@pytest.mark.slow
def test_auto_keeps_what_it_could_judge():
    # Five amplitudes less one are too few for the 13 parameters of three scales.
    fit = wr.identify(noisy_loops(rope(c=0.0), AMPLITUDES[1:]), law=wr.SymmetricBoucWen, scales="auto", profiles=False)
    assert fit.scales == ("large", "small")
    assert "amplitudes are needed" in fit.scale_rows[-1].why_not


def test_a_search_begins_at_a_law_of_several_scales(loops):
    truth = rope()
    fit = wr.identify(loops, law=wr.AsymmetricBoucWen, scales=3, start=truth, grid=False, method="time", profiles=False)
    assert fit.started == "given"
    assert fit.residual == pytest.approx(2e-3, rel=0.05)
    family, names = scales_family(wr.AsymmetricBoucWen, SCALES[3]), SCALES[3]
    values = family.read(wr.Parallel(laws=truth.laws[::-1]))  # in any order
    assert list(values) == [*(f"z_max_{n}" for n in names), *(f"n_{n}" for n in names), *list(values)[6:]]
    again = family.make(values)
    for one, other in zip(again.laws, truth.laws, strict=True):
        np.testing.assert_allclose(one.kernel_parameters(), other.kernel_parameters(), rtol=1e-12)
    assert {c.name for c in family.coordinates(scales_of(prepare(loops)))} == set(values)


@pytest.mark.quick
def test_recalled_forces_are_the_laws_own():
    law, time = rope(), np.arange(0.0, 10.0, 0.01)
    path = np.where(time < 5.0, 1e-3, 6e-3) * np.sin(2.0 * np.pi * time)
    recorded = wr.steady_loops(path, law.trace(path).force, time=time)
    for loop in [*prepare(recorded), *prepare(wr.cyclic_test(law, [1e-3, 6e-3], points_per_cycle=100))]:
        force = loop.model_force(law)
        recalled = ScaleLoop.of(loop)
        for _ in range(2):  # followed, and recalled
            # The shape is made with another bound and scaled: rounding of the parameters, and what counts as steady.
            np.testing.assert_allclose(recalled.model_force(law), force, rtol=0, atol=1e-9 * np.abs(force).max())
        np.testing.assert_array_equal(recalled.model_force(law.laws[0]), loop.model_force(law.laws[0]))


@pytest.mark.quick
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"scales": 4}, "must be 1, 2, 3 or 'auto', got 4"),
        ({"scales": True}, "must be 1, 2, 3 or 'auto', got True"),
        (
            {"scales": 2, "law": wr.Masing},
            "are for the laws bouc-wen, symmetric-bouc-wen, asymmetric-bouc-wen, got 'masing'",
        ),
        ({"scales": 2, "beside": rope().laws[0]}, "and a law `beside` do not go together"),
        ({"scales": "auto", "start": rope()}, "`start` has a number of scales already"),
        ({"scales": 2, "start": rope()}, "`start` must be 2 asymmetric-bouc-wen laws in parallel"),
        ({"scales": 2, "fixed": {"n": 1.0}}, "it has z_max_large, z_max_small, x_y_large, x_y_large/small, n_large"),
    ],
)
def test_what_does_not_go_with_scales_is_refused(arguments, message):
    few = wr.cyclic_test(rope(), AMPLITUDES, points_per_cycle=40)
    with pytest.raises(ValueError, match=message.replace("(", r"\(")):
        wr.identify(few, **arguments)


def test_fixed_and_constraint_hold_on_every_scale(loops):
    fit = wr.identify(
        loops, law=wr.AsymmetricBoucWen, scales=2, fixed={"n_small": 1.5}, constraint="beta=gamma", profiles=False
    )
    assert fit.law.laws[1].n == 1.5
    for law in fit.law.laws:
        assert law.beta == pytest.approx(law.gamma, rel=1e-12)
