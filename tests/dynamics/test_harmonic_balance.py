"""Harmonic balance against closed forms, against orbits computed by event-split integration, and against energy."""

import numpy as np
import pytest

from wirerope_mj.dynamics.single_mass.balance import harmonic_balance
from wirerope_mj.dynamics.single_mass.harmonic_branch import follow_harmonic_balance
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.mounts.laws import (
    AsymmetricBoucWen,
    BoucWen,
    BoucWenBaberNoori,
    KelvinVoigt,
    Masing,
    SymmetricBoucWen,
    TinkerCutchins,
    VaianaRosati,
    Zener,
)

TURN = 2.0 * np.pi

# beta, gamma, omega, half the range of d, largest z, energy; alpha = n = 1, M = 1, p = 0.3.
PURE = [
    (0.5, 0.5, 0.5, 0.45896197, 0.40265818, 0.06308156),
    (0.5, 0.5, 0.8, 1.32292920, 0.83627730, 1.24724792),
    (0.5, 0.5, 1.5, 0.23013706, 0.21640770, 0.00808515),
    (0.8, 0.2, 0.8, 1.05461054, 0.77129585, 0.95005770),
    (0.8, 0.2, 1.0, 0.89536921, 0.70057849, 0.62483884),
    (1.0, 0.0, 0.8, 0.93796753, 0.73428704, 0.81472194),
    (0.5, -0.4, 0.8, 0.65363574, 0.72294920, 0.18020300),
]
# (k1, k2, k3, lambda), omega, p, smallest d, largest d, largest z, energy; alpha = n = 1, beta = gamma = 0.5, M = 1.
MODIFIED = [
    ((0.1, 0.0, 0.0, 0.0), 0.8, 0.3, -1.17245244, 1.17245244, 0.78900135, 0.91128124),
    ((0.1, 0.0, 0.0, 0.0), 1.0, 0.3, -1.08550092, 1.08550092, 0.75686469, 0.74170077),
    ((0.1, 0.0, 0.0, 0.0), 0.5, 1.0, -5.26131962, 5.26131962, 0.99992683, 16.04571750),
    ((0.5, 0.1, 0.05, 0.2), 0.8, 0.3, -0.35556769, 0.37984929, 0.33197992, 0.03280018),
    ((0.5, 0.1, 0.05, 0.2), 1.0, 0.3, -0.81001739, 0.68422320, 0.59366449, 0.25865647),
    ((0.5, 0.1, 0.05, 0.2), 0.8, 1.0, -1.50350412, 1.46598311, 0.87666184, 1.67092270),
]
# beta, gamma, alpha, n, omega and height of the peak of |absolute acceleration| on a grid of 0.01 rad/s; p = 0.3.
PEAKS = [
    (0.5, -0.4, 1.0, 1.0, 1.05, 1.448), (0.8, -0.4, 1.0, 1.0, 0.99, 1.059), (1.1, -0.4, 1.0, 1.0, 0.94, 0.851),
    (0.8, 0.0, 1.0, 1.0, 0.89, 0.865), (0.8, 0.2, 1.0, 1.0, 0.84, 0.783), (0.8, 0.4, 1.0, 1.0, 0.80, 0.709),
    (0.5, 0.5, 1.0, 1.0, 0.80, 0.836),
    (0.5, -0.4, 0.5, 1.0, 0.75, 1.091), (0.5, -0.4, 2.0, 1.0, 1.48, 1.947),
    (0.5, -0.4, 1.0, 0.5, 1.07, 1.408), (0.5, -0.4, 1.0, 2.0, 1.04, 1.459), (0.5, -0.4, 1.0, 10.0, 0.98, 1.248),
]  # fmt: skip

# The printed references end after eight decimals: half of the last one, over the number itself, is up to 6e-7.
PRINTED = 5e-9


def pure(beta, gamma, omega, **options):
    law = BoucWen(alpha=1.0, beta=beta, gamma=gamma, n=1.0)
    return harmonic_balance(law, mass=1.0, frequency=omega / TURN, acceleration=0.3, **options)


def modified(elastic, omega, level, **options):
    k1, k2, k3, rate = elastic
    law = AsymmetricBoucWen(alpha=1.0, beta=0.5, gamma=0.5, n=1.0, k1=k1, k2=k2, k3=k3, b=np.e, c=rate)
    return harmonic_balance(law, mass=1.0, frequency=omega / TURN, acceleration=level, **options)


@pytest.mark.quick
@pytest.mark.parametrize(("beta", "gamma", "omega", "amplitude", "z", "energy"), PURE)
def test_orbits_of_pure_bouc_wen_are_those_of_event_split_integration(beta, gamma, omega, amplitude, z, energy):
    orbit = pure(beta, gamma, omega)
    # 31 harmonics leave 2e-8 (measured); 1e-7 of it is twice what 63 and 31 differ by.
    near = {"rel": 1e-7, "abs": PRINTED}
    assert (orbit.largest_deflection - orbit.smallest_deflection) / 2.0 == pytest.approx(amplitude, **near)
    assert orbit.largest_hysteretic_state == pytest.approx(z, **near)
    assert orbit.dissipated_energy == pytest.approx(energy, **near)
    assert orbit.amplitude == pytest.approx(z, **near)  # mass 1 and no force but z
    assert orbit.residual < 1e-10
    assert abs(orbit.coefficients[0]) < 1e-12


@pytest.mark.parametrize(("elastic", "omega", "level", "low", "high", "z", "energy"), MODIFIED)
def test_orbits_of_the_modified_law_are_those_of_event_split_integration(elastic, omega, level, low, high, z, energy):
    orbit = modified(elastic, omega, level)
    near = {"rel": 3e-7, "abs": PRINTED}  # measured: 1.5e-7 in the row that saturates, 7e-8 elsewhere
    assert orbit.smallest_deflection == pytest.approx(low, **near)
    assert orbit.largest_deflection == pytest.approx(high, **near)
    assert orbit.largest_hysteretic_state == pytest.approx(z, **near)
    assert orbit.dissipated_energy == pytest.approx(energy, **near)


def test_the_error_falls_with_the_fourth_power_of_the_harmonics_at_least():
    orders = [5, 9, 15, 23, 31, 47]
    orbits = [modified((0.1, 0.0, 0.0, 0.0), 0.5, 1.0, harmonics=h, samples=2048) for h in [*orders, 127]]
    errors = [abs(orbit.largest_deflection - orbits[-1].largest_deflection) for orbit in orbits[:-1]]
    # Coefficients of the deflection fall as k^-5, so that their sum beyond H falls as H^-4; their phases differ, and part
    # of it cancels (measured: -4.7). Single errors scatter by a factor of five about the line.
    assert -6.0 < np.polyfit(np.log(orders), np.log(errors), 1)[0] < -4.0
    # Aliases of the samples fall as fast as the force's coefficients, k^-3: 512 and 2048 samples differ by less than this.
    coarse = modified((0.1, 0.0, 0.0, 0.0), 0.5, 1.0, harmonics=47, samples=512)
    assert coarse.largest_deflection == pytest.approx(orbits[-2].largest_deflection, rel=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize(("beta", "gamma", "alpha", "n", "omega", "height"), PEAKS)
def test_resonance_peaks_follow_the_parameters_as_in_the_thesis(beta, gamma, alpha, n, omega, height):
    law = BoucWen(alpha=alpha, beta=beta, gamma=gamma, n=n)
    branch = follow_harmonic_balance(
        law, mass=1.0, start=0.9 * omega / TURN, stop=1.1 * omega / TURN, acceleration=0.3, harmonics=9, samples=256,
        largest_step=0.02,
    )  # fmt: skip
    top = int(np.argmax(branch.amplitude))
    assert branch.folds == ()
    # Half a step of the reference's grid and half of ours, and half of its last digit: the peak is flat.
    assert TURN * branch.frequency[top] == pytest.approx(omega, abs=0.005 + 0.01 * omega)
    assert branch.amplitude[top] == pytest.approx(height, abs=1e-3)


def test_a_spring_and_damper_answers_as_the_closed_form():
    mass, k, c, level = 2.0, 300.0, 4.0, 5.0
    for frequency in (0.5, 1.95, 6.0):
        omega = TURN * frequency
        orbit = harmonic_balance(KelvinVoigt(k=k, c=c), mass=mass, frequency=frequency, acceleration=level, gravity=9.81)
        stiffness = k + 1j * omega * c
        deflection = 1j * mass * level / (stiffness - mass * omega**2)  # a sin(w t) is Re[-i a exp(i w t)], d follows -m a
        # Rounding of 1024 samples and their transform.
        assert orbit.coefficients[1] == pytest.approx(deflection, rel=1e-12)
        assert orbit.coefficients[0] == pytest.approx(-mass * 9.81 / k, rel=1e-12)
        assert np.abs(orbit.coefficients[2:]).max() < 1e-14
        assert orbit.amplitude == pytest.approx(abs(stiffness * deflection) / mass, rel=1e-11)
        assert orbit.dissipated_energy == pytest.approx(np.pi * c * omega * abs(deflection) ** 2, rel=1e-9)


def test_a_standard_solid_answers_as_the_closed_form():
    law, omega = Zener(k0=200.0, k1=300.0, c=20.0), 12.0
    orbit = harmonic_balance(law, mass=2.0, frequency=omega / TURN, acceleration=5.0)
    stiffness = 200.0 + 300.0 * 1j * omega / (300.0 / 20.0 + 1j * omega)
    # Between 1024 samples the path is a cubic: (2 pi / 1024)^4 / 384 of it is 4e-12.
    assert orbit.coefficients[1] == pytest.approx(1j * 10.0 / (stiffness - 2.0 * omega**2), rel=1e-10)


LAWS = [
    AsymmetricBoucWen(alpha=1.0, beta=0.4, gamma=0.3, n=1.4, k1=0.3, k2=0.05, k3=0.02, b=2.0, c=0.3),
    Masing(stiffness=[0.6, 0.4, 0.2], slip_force=[0.2, 0.4, 0.5], k=0.2),
    VaianaRosati(kb=0.2, f0=0.4, alpha=2.0, b1=0.1, b2=0.4, g1=0.05, g2=1.0, g3=0.0),
    TinkerCutchins(k1=0.8, k3=0.1, c=0.1, n=1.5, f0=0.1, smoothing=0.1),
]


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_what_the_base_puts_in_the_law_takes_out_and_the_mass_hangs_on_it(law):
    orbit = harmonic_balance(law, mass=1.0, frequency=0.9 / TURN, acceleration=0.4, gravity=0.2)
    # The mass' own coordinate acceleration does no work over a cycle against d', so that the base's share must be all:
    # -m a times the integral of sin(w t) d', which only the first harmonic enters.
    put_in = -np.pi * 0.4 * orbit.coefficients[1].real * -1.0
    assert orbit.dissipated_energy == pytest.approx(put_in, rel=1e-5)  # kinks between the last harmonics and the samples
    assert np.mean(orbit.force[:-1]) == pytest.approx(-0.2, abs=1e-9)  # the residual's tolerance
    assert orbit.coefficients[0].real < -0.05  # compression


@pytest.mark.quick
def test_a_symmetric_law_has_odd_harmonics_and_an_asymmetric_one_all():
    odd = pure(0.5, 0.5, 0.8).harmonics
    every = modified((0.5, 0.1, 0.05, 0.2), 0.8, 1.0).harmonics
    assert odd[3] > 0.01 * odd[1]
    assert odd[[0, 2, 4, 6]].max() < 1e-9 * odd[1]  # the residual's tolerance
    assert every[2] > 0.01 * every[1]
    assert every[0] < 1e-9


def test_a_hardening_law_folds_and_has_three_motions_between_its_folds():
    law = SymmetricBoucWen(alpha=1.0, beta=0.5, gamma=-0.2, n=2.0, k1=1.0, k2=0.0, k3=0.5)
    setting = {"mass": 1.0, "acceleration": 0.6}
    options = {**setting, "harmonics": 11, "samples": 256}
    up = follow_harmonic_balance(law, start=1.0 / TURN, stop=3.0 / TURN, **options)
    upper, lower = up.folds
    assert upper.frequency > lower.frequency
    assert upper.amplitude > lower.amplitude
    assert up.frequency[upper.index] == upper.frequency
    middle = 0.5 * (upper.frequency + lower.frequency)
    orbits = up.orbits_at(middle)
    assert len(orbits) == 3
    assert all(orbit.residual < 1e-10 for orbit in orbits)
    assert orbits[0].amplitude > orbits[1].amplitude > orbits[2].amplitude
    down = follow_harmonic_balance(law, start=3.0 / TURN, stop=1.0 / TURN, **options)
    # Two ways round the same curve: the fold's frequency is exact to second order in where it is found.
    assert [fold.frequency for fold in down.folds] == pytest.approx([lower.frequency, upper.frequency], rel=1e-8)
    # Beyond its fold the large motion is gone, and below the other one the small one.
    assert [len(up.orbits_at(f)) for f in (0.99 * lower.frequency, 1.01 * upper.frequency)] == [1, 1]


@pytest.mark.quick
def test_a_search_that_fails_says_what_was_tried():
    with pytest.raises(
        ConvergenceError, match=r"no periodic motion with 15 harmonics .* from equivalent linearisation and from small"
    ):
        pure(0.5, 0.5, 0.8, harmonics=15, samples=128, tolerance=1e-30)  # below rounding, so many sums are never all zero


@pytest.mark.quick
def test_what_cannot_be_balanced_is_said():
    law, setting = BoucWen(alpha=1.0, beta=0.5, gamma=0.5, n=1.0), {"mass": 1.0, "frequency": 0.1, "acceleration": 0.3}
    with pytest.raises(ValueError, match="carries no weight"):
        harmonic_balance(law, gravity=9.81, **setting)
    with pytest.raises(ValueError, match="`frequency` must be > 0"):
        harmonic_balance(law, **{**setting, "frequency": 0.0})
    with pytest.raises(ValueError, match="`harmonics` must be an integer >= 1"):
        harmonic_balance(law, harmonics=0, **setting)
    with pytest.raises(ValueError, match="at least 8 for each of 31"):
        harmonic_balance(law, samples=128, **setting)
    worn = BoucWenBaberNoori(alpha=1.0, beta=0.5, gamma=0.5, n=1.0, k=0.1)
    with pytest.raises(ValueError, match="no steady cycle"):
        harmonic_balance(worn, **setting)
    with pytest.raises(ValueError, match="`stop` must differ from `start`"):
        follow_harmonic_balance(law, mass=1.0, start=1.0, stop=1.0, acceleration=0.3)
