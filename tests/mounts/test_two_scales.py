"""The rule by which parts get friction on two scales, and what their vendors state of racks, damping and 45 degrees.

Only the rack of 850 kg, and of that of 320 kg the sag, were used to find the rule and the yield deflection of the CB1390.
"""

from dataclasses import replace
from functools import cache

import house
import numpy as np
import one_scale
import pytest
import racks
from racks import Rack, modes_along

import wirerope_mj as wr
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts.laws import Parallel
from wirerope_mj.mounts.vendor_parts import vendor_parts
from wirerope_mj.mounts.vendor_parts.comparison import compare
from wirerope_mj.mounts.vendor_parts.law_values import damping_ratio, virgin_force
from wirerope_mj.mounts.vendor_parts.secants import RULES, VIBRATION_AMPLITUDE, ElasticShape, first_state
from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_datasheet, fit_part

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

SHEETS = {path.stem: path for path in sorted((catalogue_folder() / "datasheets").glob("*.toml"))}
ENIDINE = [name for name in SHEETS if name.startswith("enidine")]
AMPLITUDE = 5e-3
"""Of the cycles that modes of all racks are of [m]: no sheet states one."""


@cache
def fitted(name):
    return fit_datasheet(SHEETS[name])


@cache
def rack(mass, coupled):
    part, below, behind = {850: ("cb1400_15", 6, 4), 320: ("cb1390_30", 4, 2), 610: ("cb1390_20", 6, 2)}[mass]
    isolator = fitted(f"socitec_{part}")
    isolator = isolator if coupled else replace(isolator, coupling=None, loop=None)
    return Rack(isolator, 609.86 if mass == 610 else float(mass), below, behind).system


@pytest.mark.quick
@pytest.mark.parametrize("number", RULES)
@pytest.mark.parametrize("reach", [0.05, 0.7, 3.0, 40.0])
def test_friction_of_the_rule_is_that_of_its_law(number, reach):
    rule, yielding, amplitude = RULES[number], 1.3e-3, reach * 1.3e-3
    law = rule.law(700.0, yielding, 1e-3, ElasticShape(asymmetry=None, cubic=0.0))
    virgin = 700.0 * rule.friction(amplitude, yielding, steady=False)
    assert virgin_force(law, amplitude) == pytest.approx(virgin, rel=1e-7)  # nine digits of its numbers
    stiffness = wr.cyclic_test(law, [amplitude])[0].secant_stiffness
    assert stiffness * amplitude == pytest.approx(700.0 * rule.friction(amplitude, yielding, steady=True), rel=1e-7)


@pytest.mark.parametrize("name", SHEETS)
def test_all_but_three_numbers_of_an_axis_follow_from_the_rule(name):
    isolator, ratios = fitted(name), RULES[2].scales[1]
    for axis, law in isolator.axes.items():
        assert isinstance(law, Parallel)
        one, other = law.laws
        assert (one.n, other.n, one.gamma, other.gamma, one.k2) == (2.0, 2.0, 0.0, 0.0, 0.0)
        assert (other.k1, other.k2, other.k3) == (0.0, 0.0, 0.0)
        found = other.normalised.z_max / one.normalised.z_max, other.normalised.x_y / one.normalised.x_y
        assert found == pytest.approx(ratios, rel=1e-7)
        if axis == "axial":
            assert one.asymmetry == other.asymmetry
        else:
            assert one.normalised.x_y == pytest.approx(0.75 * first_state(isolator.axial).normalised.x_y, rel=1e-7)
    whole = wr.load_isolator(one_scale.FILES[name]).axial
    if "cb1390" not in name:  # another rope
        assert first_state(isolator.axial).asymmetry == pytest.approx(whole.asymmetry / 3.0, rel=1e-7)


@pytest.mark.parametrize("name", SHEETS)
def test_the_values_of_a_sheet_are_met(name):
    for row in compare(SHEETS[name], fitted(name)):
        if row.vendor is None or row.axis == "45 degrees" or row.name == "resonance":
            continue
        if name == "socitec_cb1400_15" and row.axis == "shear":
            # Three values that contradict each other, and a fourth that is compared only: no law has them.
            assert row.name == "shock stiffness" or abs(row.error) < 0.112
            continue
        # Of the CB1390's shear three values are met by two numbers.
        assert row.fitted == pytest.approx(row.vendor, rel=0.04 if name.startswith("socitec_cb1390") else 1e-6)


@pytest.mark.parametrize("name", SHEETS)
def test_damping_at_a_millimetre(name):
    """In the ranges of the vendors; VMC's, 15 to 20 % without an amplitude, is met at the vibration amplitude."""
    lowest, highest = (0.05, 0.15) if name in ENIDINE else (0.10, 0.20)
    for axis, law in fitted(name).axes.items():
        if "cb1390" in name and axis != "axial":
            lowest = 0.075  # its vendor states none
        assert lowest <= damping_ratio(law, 1e-3) <= highest, axis
    if "cb1400" in name:
        assert damping_ratio(fitted(name).axial, 2.54e-3) == pytest.approx(0.20, rel=1e-6)


@pytest.mark.parametrize("name", SHEETS)
def test_damping_does_not_vanish_from_a_fifth_of_a_millimetre_to_half_the_travel(name):
    law, half = fitted(name).axial, 0.5 * fitted(name).limits.travel.compression
    once = wr.load_isolator(one_scale.FILES[name]).axial
    for amplitude in (2e-4, 5e-4, 1e-3, 2.5e-3, 4e-3, 8e-3, half):
        assert 0.055 < damping_ratio(law, amplitude) < 0.22
    assert damping_ratio(law, 2e-4) > damping_ratio(once, 2e-4)


# Relative errors at 45 degrees, to which nothing is fitted, of the files of one scale (docs/catalogue.md).
ONE_SCALE = {
    "enidine_wr12_400": {"shock stiffness": 0.06},
    "enidine_wr16_400": {"shock stiffness": 0.09},
    "enidine_wr16_700": {"shock stiffness": 0.07},
    "enidine_wr20_600": {"shock stiffness": 0.04},
    "socitec_cb1390_20": {"shock force": 0.23, "static force": 0.09},
    "socitec_cb1390_30": {"shock force": 0.24, "static force": 0.13},
}


@pytest.mark.parametrize("name", ONE_SCALE)
def test_45_degrees(name):
    errors = {row.name: row.error for row in compare(SHEETS[name], fitted(name)) if row.axis == "45 degrees"}
    for value, before in ONE_SCALE[name].items():
        assert abs(errors[value]) <= before, value


# Sag [mm] and modes along x, y, z [Hz]; x of the two in random vibration is no translation (test_racks.py).
SAGS = {850: 0.613, 320: 1.4, 610: 1.2}
MODES = {850: (10.42, 6.98, 11.68), 320: (None, 7.4, 10.5), 610: (None, 8.1, 11.3)}


@pytest.mark.parametrize("coupled", [False, True])
@pytest.mark.parametrize("mass", SAGS)
def test_sags_and_modes_of_the_racks(mass, coupled):
    """320 and 610 kg: the sag of the first was used, all else of both is predicted."""
    found = racks.sag(rack(mass, coupled))
    along = modes_along(wr.modes(rack(mass, coupled), amplitude=AMPLITUDE))
    print(mass, coupled, found - SAGS[mass], along, MODES[mass])
    assert found == pytest.approx(SAGS[mass], abs=0.15)
    for frequency, stated in zip(along, MODES[mass], strict=True):
        assert stated is None or frequency == pytest.approx(stated, rel=0.10)


@pytest.mark.parametrize("coupled", [False, True])
@pytest.mark.parametrize(("axis", "displacement", "acceleration"), [("x", 15.89, 7.05), ("y", 20.79, 5.96), ("z", 15.22, 7.17)])
def test_shocks_of_the_rack_of_850_kg_in_both_senses(axis, displacement, acceleration, coupled):
    """The larger of both senses is the vendor's figure; neither sense exceeds it by more."""
    # The second scale yields over 0.08 mm, which the rack goes in 7e-5 s.
    each = [racks.shock(rack(850, coupled), axis, sense, timestep=5e-5) for sense in (1, -1)]
    print(axis, coupled, each, np.max(each, axis=0) / (displacement, acceleration) - 1)
    np.testing.assert_allclose(np.max(each, axis=0), (displacement, acceleration), rtol=0.10)


def test_a_row_of_a_table_is_fitted_as_its_sheet_is():
    part = next(one for one in vendor_parts() if one.name == "WR12-400")
    row, sheet = fit_part(part, scales=2), fitted("enidine_wr12_400")
    for one, other in zip(row.axial.laws, sheet.axial.laws, strict=True):
        assert one.kernel_parameters() == pytest.approx(other.kernel_parameters(), rel=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["WR2-100", "WR16-900", "WR28-600", "CB1500-30", "CB1700-15"])
def test_other_rows_have_a_law_with_their_stiffnesses(name):
    part = next(one for one in vendor_parts() if one.name == name)
    law, stated = fit_part(part, scales=2).axial, part.modes["compression"]
    loop = wr.cyclic_test(law, [VIBRATION_AMPLITUDE * stated.travel])[0]
    assert loop.secant_stiffness == pytest.approx(stated.vibration, rel=1e-6)
    assert loop.damping_ratio == pytest.approx(part.series.damping, rel=1e-6)
    assert virgin_force(law, -stated.travel) == pytest.approx(-stated.shock * stated.travel, rel=1e-6)


@pytest.mark.quick
def test_a_number_of_scales_without_a_rule_is_refused(tmp_path):
    sheet = tmp_path / "sheet.toml"
    sheet.write_text(SHEETS["enidine_wr12_400"].read_text().replace("scales = 2", "scales = 3"))
    with pytest.raises(ModelError, match="`scales` must be one of 1, 2, got 3"):
        fit_datasheet(sheet)


@pytest.mark.parametrize(("timestep", "off"), [(1e-4, 2e-4), (2e-4, 5e-3), (5e-4, 0.04)])
def test_a_step_through_several_yield_deflections_is_off_by_percents_and_not_unstable(timestep, off):
    """1 m/s goes through 0.08 mm, the finer yield deflection, in 8e-5 s; the rate of a state beyond its bound is bounded."""
    system = house.sdof(fitted("socitec_cb1400_15").axial, mass=850.0 / 6.0, gravity=wr.STANDARD_GRAVITY)
    step = wr.VelocityStep(velocity=racks.VELOCITY, direction="z")

    def peak(h):
        return wr.simulate(system, step, duration=0.2, timestep=h).peaks.bodies["mass"].acceleration.value

    assert peak(timestep) == pytest.approx(peak(1e-5), rel=off)


def test_a_step_through_far_more_is_refused():
    system = house.sdof(fitted("socitec_cb1400_15").axial, mass=850.0 / 6.0, gravity=wr.STANDARD_GRAVITY)
    step = wr.VelocityStep(velocity=3.0 * racks.VELOCITY, direction="z")
    with pytest.raises(wr.SimulationError, match="use a smaller `timestep`"):
        wr.simulate(system, step, duration=0.2, timestep=1e-3)
