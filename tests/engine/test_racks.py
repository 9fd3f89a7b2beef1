"""Wire-rope isolators of the catalogue against what their vendors state of racks, damping and transmissibility.

Racks move by translations only: mounts below carry along their axis, stabilisers behind them stand across, roll upright, and
all shear along y. The vendor's program is one simulation and this another; sheets state no amplitude of their modes, so that
the cycles of 12.5 mm (850 kg) and of 6 mm (the two racks that were held back) are assumptions.
"""

from functools import cache

import house
import numpy as np
import pytest
import racks
from one_scale import FILES
from racks import Rack, modes_along

import wirerope_mj as wr

G = wr.STANDARD_GRAVITY

WITHIN = 0.10
"""What the vendor's figures of racks are to be met by: the project's own aim, not an error estimate."""


def of_catalogue(part):
    return wr.load_isolator(FILES[f"socitec_{part}"])


RACKS = {
    850: Rack(of_catalogue("cb1400_15"), 850.0, 6, 4),
    320: Rack(of_catalogue("cb1390_30"), 320.0, 4, 2),
    610: Rack(of_catalogue("cb1390_20"), 609.86, 6, 2),
}


@cache
def system(rack):
    return RACKS[rack].system


# Sag [mm]; modes along x, y and z [Hz], of which x of the two racks in random vibration is no translation.
@pytest.mark.parametrize(("rack", "sag"), [(850, 0.613), (320, 1.4), (610, 1.2)])
def test_the_sag_of_the_first_loading(rack, sag):
    assert racks.sag(system(rack)) == pytest.approx(sag, rel=WITHIN)


@pytest.mark.parametrize("stiffness", ["secant_stiffness", "stiffness"])
def test_modes_of_the_rack_of_850_kg_in_cycles_of_12_5_mm(stiffness):
    """By the secant to which the isolator was fitted, and by the first harmonic of the same cycles."""
    np.testing.assert_allclose(RACKS[850].frequencies(0.0125, stiffness), [10.42, 6.98, 11.68], rtol=WITHIN)


@pytest.mark.slow
def test_modes_of_the_package_are_those_of_the_first_harmonic():
    """Apart from where the cycles run: at the sag of 0.6 mm instead of about zero mean force, 1 % of these."""
    found = modes_along(wr.modes(system(850), amplitude=0.0125))
    np.testing.assert_allclose(found, [10.42, 6.98, 11.68], rtol=WITHIN)
    np.testing.assert_allclose(found, RACKS[850].frequencies(0.0125, "stiffness"), rtol=0.01)


@pytest.mark.parametrize(("axis", "displacement", "acceleration"), [("x", 15.89, 7.05), ("y", 20.79, 5.96), ("z", 15.22, 7.17)])
def test_shocks_of_the_rack_of_850_kg(axis, displacement, acceleration):
    """Upwards the deck starts, so that the mounts below are compressed first; along x the larger of both senses counts."""
    found = [racks.shock(system(850), axis, sense) for sense in ((1, -1) if axis == "x" else (1,))]
    farthest, largest = np.max(found, axis=0)
    assert farthest == pytest.approx(displacement, rel=WITHIN)
    assert largest == pytest.approx(acceleration, rel=WITHIN)


def test_the_rack_of_850_kg_in_the_other_sense_is_far_from_the_sheet():
    """Downwards the deck starts, and the mounts below are drawn first; no sheet says in which sense its program started."""
    farthest, largest = racks.shock(system(850), "z", -1)
    assert largest / 7.17 - 1.0 == pytest.approx(0.194, abs=2e-3)  # to a digit or two
    assert farthest / 15.22 - 1.0 == pytest.approx(-0.211, abs=2e-3)


@pytest.mark.parametrize(("rack", "y", "z"), [(320, 7.4, 10.5), (610, 8.1, 11.3)])
def test_resonances_of_the_racks_that_were_held_back(rack, y, z):
    """Along y and z: the secant of cycles of 6 mm; by the first harmonic of 5 mm (of 6 mm y of the heavier falls to -11 %)."""
    np.testing.assert_allclose(RACKS[rack].frequencies(0.006, "secant_stiffness")[1:], [y, z], rtol=WITHIN)
    np.testing.assert_allclose(modes_along(wr.modes(system(rack), amplitude=0.005))[1:], [y, z], rtol=WITHIN)


@pytest.mark.parametrize(("rack", "x"), [(320, 18.1), (610, 19.5)])
def test_the_resonance_along_x_is_no_translation(rack, x):
    """Not even with the stiffness of vanishing cycles: two mounts on their axis are fewer than four or six."""
    small = modes_along(wr.modes(system(rack)))
    assert small[0] < small[2] < x


# The vendors' ranges, typed once more: Enidine's for its WR series, VMC's for the CB1400.
DAMPING = {
    "enidine_wr12_400": (0.05, 0.15),
    "enidine_wr16_400": (0.05, 0.15),
    "enidine_wr16_700": (0.05, 0.15),
    "enidine_wr20_600": (0.05, 0.15),
    "socitec_cb1400_15": (0.15, 0.20),
    "socitec_cb1400_30": (0.15, 0.20),
}
AXES = ("axial", "shear", "roll")


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("name", DAMPING)
def test_damping_at_a_millimetre_is_what_the_vendor_states(name, axis):
    law = getattr(wr.load_isolator(FILES[name]), axis)
    lowest, highest = DAMPING[name]
    assert lowest <= wr.cyclic_test(law, [1e-3])[0].damping_ratio <= highest


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("name", DAMPING)
def test_stiffness_is_linear_in_one_over_the_amplitude(name, axis):
    """As tests of ropes find it: R^2 > 0.95 over 15 amplitudes of 1 to 15 mm, stiffer at the small end.

    In shear, where the larger of these cycles harden, the aim does not ask for it; it holds there too.
    """
    law = getattr(wr.load_isolator(FILES[name]), axis)
    amplitudes = np.linspace(1e-3, 15e-3, 15)
    stiffness = [loop.secant_stiffness for loop in wr.cyclic_test(law, amplitudes)]
    correlation = np.corrcoef(1.0 / amplitudes, stiffness)[0, 1]
    assert correlation > 0.0
    assert correlation**2 > 0.95


FREQUENCIES = np.linspace(20.6, 22.4, 10)
"""Across the resonances below [Hz]; between two of them a peak 2 Hz wide or more is missed by (0.1 / 2)^2 / 2, 0.2 %."""


@pytest.mark.slow
@pytest.mark.parametrize(("gravity", "expected"), [(0.0, 8.85), (G, 8.65)])
def test_a_sixth_of_the_rack_resonates_as_rope_does(gravity, expected):
    """850 kg / 6 on one mount, base sine of 0.5 m/s^2: 8 to 10 at the resonance, about rest in gravity and about zero."""
    law, guess, peaks = RACKS[850].isolator.axial, None, []
    for frequency in FREQUENCIES:
        orbit = wr.harmonic_balance(
            law, mass=850.0 / 6.0, frequency=frequency, acceleration=0.5, gravity=gravity, guess=guess, tolerance=1e-6
        )
        guess, peaks = orbit.coefficients, [*peaks, orbit.amplitude / 0.5]
    assert 0 < np.argmax(peaks) < FREQUENCIES.size - 1
    assert 8.0 < max(peaks) < 10.0
    assert max(peaks) == pytest.approx(expected, rel=5e-3)  # 0.2 % of the grid, and the third digit of the figure


def test_the_engine_finds_the_same_resonance():
    """The orbit by shooting in MuJoCo, under gravity, where harmonic balance has its peak."""
    law = RACKS[850].isolator.axial
    system = house.sdof(law, mass=850.0 / 6.0, gravity=G)
    orbit = wr.periodic_orbit(system, frequency=21.27, acceleration=0.5, direction="z")
    largest = orbit.response.peaks.bodies["mass"].acceleration.value
    found = wr.harmonic_balance(law, mass=850.0 / 6.0, frequency=21.27, acceleration=0.5, gravity=G)
    assert largest == pytest.approx(found.amplitude, rel=1e-3)  # ten times the orbit's accuracy
    assert 8.0 < largest / 0.5 < 10.0
