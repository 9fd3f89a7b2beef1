"""Periodic motions of laws with n < 1, whose slope has no derivative at zero: multipliers, branches, both engines."""

import numpy as np
import pytest
from house import sdof
from steep_branches import MASS, asymmetric, bouc_wen, moduli, motion_of, search_of, two_scales

import wirerope_mj as wr
from wirerope_mj.dynamics.periodic import flow as flows
from wirerope_mj.dynamics.periodic.flow import KernelFlow
from wirerope_mj.dynamics.periodic.shooting import monodromy, wide_monodromy
from wirerope_mj.dynamics.periodic.variational import variational_of
from wirerope_mj.foundation.units import STANDARD_GRAVITY


@pytest.mark.slow
@pytest.mark.parametrize("level_g", [0.2, 4.0])  # of the bound of z in its yield deflection: a tenth, and far beyond it
@pytest.mark.parametrize("n", [0.1, 0.2, 0.35])
def test_multipliers_do_not_depend_on_the_steps(n, level_g):
    search = search_of(bouc_wen(n))
    with search.flow.ready():
        few, many = (moduli(variational_of(search.flow).matrix(motion_of(search, 20.0, level_g, s))) for s in (1000, 16000))
    # Reversals are placed between the steps, and z = 0 is passed by a chord: of second order in 1/1000 of a period, but for the
    # cusp |z|^n, which a sample misses by (1/1000)^(1 + n). Sampled derivatives scattered by 0.2.
    assert few == pytest.approx(many, abs=2e-3)


@pytest.mark.slow
def test_the_scaled_equation_gives_the_matrix_of_wide_difference_quotients():
    search = search_of(asymmetric(0.5))
    with search.flow.ready():
        motion = motion_of(search, 34.0, 0.2, 16000)
        scaled, wide = variational_of(search.flow).matrix(motion), wide_monodromy(search.flow, motion)
    # The quotients are 3e-3 of the motion wide and miss the square of that.
    assert np.abs(scaled - wide).max() < 1e-5 * np.abs(wide).max()


def test_with_n_of_one_it_gives_the_columns_of_the_map():
    search = search_of(asymmetric(1.0))
    with search.flow.ready():
        motion = motion_of(search, 34.0, 2.0, 4000)
        scaled, columns = variational_of(search.flow).matrix(motion), monodromy(search.flow, motion)
    # A reversal within one of 4000 steps is missed by the columns: 2 pi / 4000 of their largest entry.
    assert np.abs(scaled - columns).max() < 2e-3 * np.abs(columns).max()


@pytest.mark.slow
@pytest.mark.parametrize("law", [two_scales(), bouc_wen(0.2)], ids=["two scales", "one"])
def test_both_engines_give_the_same_multipliers(monkeypatch, law):
    """MuJoCo's steps sample the slope of steep states where the kernel carries them in closed form."""
    found = []
    for mujoco in (False, True):
        with monkeypatch.context() as patched:
            if mujoco:
                patched.setattr(flows, "unsupported_system", lambda system: "MuJoCo is asked for")
            search = search_of(law)
        assert isinstance(search.flow, KernelFlow) is not mujoco
        with search.flow.ready():
            found.append(moduli(variational_of(search.flow).matrix(motion_of(search, 20.0, 0.2, 1000))))
    assert found[1] == pytest.approx(found[0], abs=2e-3)  # the motions differ by 1e-4 of their ranges at n = 0.2


@pytest.mark.slow
@pytest.mark.parametrize("law", [bouc_wen(0.1), bouc_wen(0.2), asymmetric(0.3), two_scales()], ids=str)
def test_a_branch_of_a_steep_law_is_stable_and_has_no_gaps(law):
    """It reported 82 unstable points of 676 and 34 gaps with n = 0.2: sampled derivatives, infinite at z = 0."""
    system, level = sdof(law, mass=MASS), 0.2 * STANDARD_GRAVITY
    branch = wr.follow_branch(system, start=10.0, stop=45.0, acceleration=level, direction="z", payload="mass")
    assert branch.complete
    assert branch.stable.all()
    assert branch.gaps == ()
    assert branch.bifurcations == ()
    peak = branch.orbit(branch.peak)
    settled = wr.simulate(
        system, peak.motion, duration=300 / peak.frequency, initial="unloaded", timestep=1 / (2000 * peak.frequency),
        sample_rate=200 * peak.frequency,
    )  # fmt: skip
    last = np.abs(settled.bodies["mass"].acceleration[-2000:, 2]).max()
    # 128 steps for an accuracy of 1e-4, multiplied by at most five where the branch is steep; samples miss 1e-4 of a crest
    assert branch.amplitude[branch.peak] == pytest.approx(last, rel=1e-3)


@pytest.mark.slow
def test_an_orbit_of_a_steep_law_is_judged_alike_alone():
    orbit = wr.periodic_orbit(sdof(bouc_wen(0.15), mass=MASS), frequency=34.0, acceleration=1.96, direction="z")
    assert orbit.residual < 1e-8
    assert orbit.stable
    search = search_of(bouc_wen(0.15))
    with search.flow.ready():
        fine = moduli(variational_of(search.flow).matrix(motion_of(search, 34.0, 1.96 / STANDARD_GRAVITY, 16000)))
    assert np.abs(orbit.floquet_multipliers) == pytest.approx(fine, abs=2e-3)  # as in the first test, with 128 steps


@pytest.mark.parametrize("frequency", [4.66, 5.0])
def test_a_motion_that_wanders_between_two_steps_is_found_with_finer_ones(frequency):
    """The law of an identification (n = 0.113): a reversal falls on a step there, and 128 to a period have no fixed point."""
    law = wr.AsymmetricBoucWen(
        alpha=345417.4, beta=39248.9, gamma=130727.2, n=0.113, k1=66400.5, k2=-3998772.0, k3=3.670376e8, b=np.e, c=24.7336,
    )  # fmt: skip
    shaken = {"frequency": frequency, "acceleration": 0.9807, "direction": "z"}
    found, finer = (
        wr.periodic_orbit(sdof(law, mass=50.0, gravity=STANDARD_GRAVITY), accuracy=accuracy, **shaken)
        for accuracy in (1e-4, 1e-5)
    )
    assert found.steps == 192
    assert found.residual < 1e-6
    assert found.stable
    peaks = [one.response.peaks.bodies["mass"].acceleration.value for one in (found, finer)]
    assert peaks[0] == pytest.approx(peaks[1], rel=2e-3)
