"""The band of error of a part: what the rest says of values that are left out."""

from statistics import median

import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts.vendor_parts import vendor_parts
from wirerope_mj.mounts.vendor_parts.comparison import left_out
from wirerope_mj.mounts.vendor_parts.secants import RULES, ElasticShape, first_state, fit_secants
from wirerope_mj.mounts.vendor_parts.sheet import read_datasheet


def band(name):
    return left_out(name, wr.load_isolator(name))


def errors(found, axis):
    return {row.name: row.error for row in found.values if row.axis == axis}


@pytest.mark.quick
def test_one_stiffness_of_two_is_that_of_the_other_parts_of_the_table():
    found, part = band("enidine_wr16_400"), next(one for one in vendor_parts() if one.name == "WR16-400")
    others = [one.modes["compression"] for one in vendor_parts() if one.series == part.series and one is not part]
    ratio = median(one.shock / one.vibration for one in others if None not in (one.shock, one.vibration))
    said = errors(found, "compression")
    assert said["shock stiffness"] == pytest.approx(613.0 * ratio / 278.0 - 1.0, rel=1e-9)
    assert said["vibration stiffness"] == pytest.approx(278.0 / ratio / 613.0 - 1.0, rel=1e-9)
    assert not errors(found, "shear")  # one number, printed twice
    diagonal = wr.load_isolator("enidine_wr16_400").provenance.check_45
    for name, error in errors(found, "45 degrees").items():
        assert error == pytest.approx(diagonal[f"{name.replace(' ', '_')}_relative_error"], abs=1e-4)
    assert found.largest == max(abs(row.error) for row in found.values)


def test_one_value_of_three_is_that_of_the_law_without_it():
    sheet = read_datasheet(catalogue_folder() / "datasheets" / "socitec_cb1390_30.toml")
    isolator = wr.load_isolator("socitec_cb1390_30")
    law, yielding = first_state(isolator.shear), 0.75 * first_state(isolator.axial).normalised.x_y
    curve = ElasticShape(asymmetry=None, cubic=law.k3 / law.k1)
    said = errors(band("socitec_cb1390_30"), "shear")
    for value in sheet.shear.stated:
        if not value.fitted:
            continue
        rest = tuple(one for one in sheet.shear.fitted if one is not value)
        without, at = fit_secants(rest, curve, yielding, RULES[2]), value.deflection
        loop = wr.cyclic_test(without, [at])[0].secant_stiffness
        predicted = loop if value.steady else without.trace([0.0, at]).force[-1] / at
        assert said[value.name] == pytest.approx(predicted / value.stiffness - 1.0, abs=1e-7)


@pytest.mark.quick
def test_a_row_of_a_table_and_its_file_have_one_band():
    row = next(one for one in vendor_parts() if one.name == "WR12-400")
    by_name = left_out(row.name, wr.load_isolator("enidine_wr12_400"))
    assert errors(by_name, "compression") == errors(band("enidine_wr12_400"), "compression")
    assert 0.25 < by_name.others["compression"] < 0.35


def test_the_command_states_the_band(capsys):
    assert main(["isolators", "CB1500-30"]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "shear: shock stiffness 140.1 N/mm, from the rest 165.3 (+18 %)" in printed
    assert "Band of error by leaving out: 18 %; nine in ten parts of the vendor's table stay below" in printed
