"""A factor on what dissipates: hysteretic and viscous forces apart from the elastic ones."""

import numpy as np
import pytest
from laws_for_tests import PARAMETERS, example
from one_scale import one_scale

import wirerope_mj as wr
from wirerope_mj.mounts.laws import LAWS, KelvinVoigt, OnBracket, Parallel, Smoothed

PATH = 1e-2 * np.sin(np.linspace(0.0, 4.0 * np.pi, 801))
TIME = np.linspace(0.0, 0.2, PATH.size)
WITHOUT = {"stop", "tabulated", "vaiana-rosati"}
"""Laws whose loss is no part that stands by itself."""


def forces(law):
    return law.trace(PATH, time=TIME).force if not law.rate_independent else law.trace(PATH).force


def laws():
    return [example(name) for name in sorted(PARAMETERS)]


@pytest.mark.parametrize("law", laws(), ids=lambda law: law.name)
def test_the_force_is_linear_in_the_factor(law):
    """F = E + c H: equal steps of the factor add equal forces, and nothing but what dissipates changes."""
    if law.name in WITHOUT:
        assert law.damping_parameters == ()
        assert law.with_damping(3.0) == law
        return
    assert set(law.damping_parameters) <= set(law.force_powers)
    one, two, three = (forces(law.with_damping(factor)) for factor in (1.0, 2.0, 3.0))
    np.testing.assert_array_equal(one, forces(law))
    largest = np.abs(three).max()
    assert np.abs(two - one).max() > 0.05 * largest
    # Baber and Noori's law is integrated to 1e-8, the others have closed forms.
    np.testing.assert_allclose(three - two, two - one, rtol=0, atol=(3e-8 if "noori" in law.name else 1e-12) * largest)


def test_every_law_is_looked_at():
    assert {law.name for law in laws()} == set(LAWS)


def test_a_closed_cycle_loses_so_many_times_more():
    law = example("asymmetric-bouc-wen")
    (loop,), (more,) = (wr.cyclic_test(one, [8e-3]) for one in (law, law.with_damping(1.7)))
    assert more.dissipated_energy == pytest.approx(1.7 * loop.dissipated_energy, rel=1e-9)


def test_laws_made_of_laws_hand_the_factor_on():
    hysteretic, stop = example("bouc-wen"), example("stop")
    both = Parallel(laws=(hysteretic, stop)).with_damping(2.0)
    assert both.laws == (hysteretic.with_damping(2.0), stop)
    assert Parallel(laws=(hysteretic, stop)).damping_parameters == ("alpha_1", "beta_1", "gamma_1")
    for wrapped in (Smoothed(law=hysteretic, width=0.1), OnBracket(law=hysteretic, stiffness=1e6)):
        assert wrapped.with_damping(2.0).law == hysteretic.with_damping(2.0)
        assert wrapped.multiplied("yield", 2.0).law == hysteretic.multiplied("yield", 2.0) != hysteretic


def test_friction_of_a_smoothed_law_builds_up_over_more_deflection():
    law, factor = example("bouc-wen"), 2.0
    both = Parallel(laws=(Smoothed(law=law, width=0.1), KelvinVoigt(k=1e3, c=0.0)))
    varied = Parallel(**both.completed({"yield": factor})).laws[0]  # as a study varies it
    # Over the stretched path z is that over the path, the width being one of the rates, which are stretched, too.
    stretched = varied.trace(factor * PATH, time=TIME).hysteretic_state
    narrower = Smoothed(law=law, width=0.1 / factor).trace(PATH, time=TIME).hysteretic_state
    np.testing.assert_allclose(stretched, narrower, rtol=0, atol=1e-8 * np.ptp(narrower))  # as exact as a trace


@pytest.mark.parametrize("around", [{"law": example("bouc-wen"), "width": 0.1}, {"law": example("bouc-wen"), "stiffness": 1e6}])
def test_factors_on_laws_made_of_laws_are_tried_one_by_one(around):
    both = Parallel(laws=((Smoothed if "width" in around else OnBracket)(**around), KelvinVoigt(k=1e3, c=0.0)))
    for name in ("stiffness", "friction", "yield"):
        assert not both.certainly_valid({name: np.array([0.5, 2.0])})


def test_an_isolator_keeps_its_elastic_forces_and_its_limits():
    rope = one_scale("wr16_400")["wr16_400"]
    more = rope.with_damping(1.5)
    assert more.limits == rope.limits
    assert more.loop == rope.loop
    assert more.spread is None
    assert (more.axial.alpha, more.axial.k1) == (1.5 * rope.axial.alpha, rope.axial.k1)
    assert rope.scaled(2.0).axial == rope.axial.scaled(2.0)
    assert rope.scaled(2.0).loop == rope.loop.scaled(2.0)


@pytest.mark.parametrize("factor", [0.0, -1.0, float("nan")])
def test_a_factor_is_above_zero(factor):
    with pytest.raises(ValueError, match="`factor` must be (a finite number|> 0)"):
        example("bouc-wen").with_damping(factor)


def test_friction_alone_leaves_dampers_as_they_are():
    """Of a rope beside a damper, of a friction law with both, and of what is only viscous."""
    rope, damper = example("bouc-wen"), KelvinVoigt(k=0.0, c=50.0)
    both = wr.Isolator(name="both", axial=Parallel(laws=(rope, damper)), shear=damper).with_friction(2.0)
    assert both.axial.laws == (rope.with_damping(2.0), damper)
    assert both.shear == damper
    mixed = example("tinker-cutchins")
    more = mixed.with_friction(2.0)
    assert (more.f0, more.f1, more.f2) == (2.0 * mixed.f0, 2.0 * mixed.f1, 2.0 * mixed.f2)
    assert (more.c, more.k1) == (mixed.c, mixed.k1)
    assert OnBracket(law=rope, stiffness=1e6).with_friction(2.0).law == rope.with_damping(2.0)
    for wrong in (0.0, -1.0, float("nan")):
        with pytest.raises(ValueError, match="factor"):
            rope.with_friction(wrong)
