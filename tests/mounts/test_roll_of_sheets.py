"""A data sheet that states roll by itself: its law meets its own values, and shear keeps those of shear."""

import pytest

from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts.vendor_parts.comparison import compare
from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_datasheet

PATH = catalogue_folder() / "datasheets" / "enidine_wr16_400.toml"
SHEET = PATH.read_text(encoding="utf-8")
ROLL = "\n[roll]\ntravel_mm = {}\nvibration_stiffness_N_per_mm = {}\nshock_stiffness_N_per_mm = {}\n"


def fitted(folder, text):
    path = folder / "sheet.toml"
    path.write_text(text, encoding="utf-8")
    return fit_datasheet(path), path


def test_roll_has_the_values_of_its_own_table(tmp_path):
    isolator, path = fitted(tmp_path, SHEET + ROLL.format(45.2, 210, 190))
    assert isolator.shear == fit_datasheet(PATH).shear
    assert isolator.roll != isolator.shear
    rows = [row for row in compare(path, isolator) if row.axis == "roll" and row.vendor is not None]
    assert [row.vendor for row in rows] == [210, 190]
    for row in rows:
        assert row.fitted == pytest.approx(row.vendor, rel=1e-6)
    assert any(text.startswith("roll: ") for text in isolator.provenance.fitted_to.split("; "))


def test_the_same_values_in_both_tables_are_one_law(tmp_path):
    isolator, _ = fitted(tmp_path, SHEET + ROLL.format(45.2, 173, 173))
    assert isolator.roll == isolator.shear
    other, _ = fitted(tmp_path, SHEET + ROLL.format(50, 173, 173))
    assert (other.limits.travel.shear, other.limits.travel.roll) == (0.0452, 0.05)


def test_a_roll_that_is_neither_is_refused(tmp_path):
    with pytest.raises(ModelError, match="`roll` must be a table or 'rope loop', got 'as axial'"):
        fitted(tmp_path, 'roll = "as axial"\n' + SHEET)
