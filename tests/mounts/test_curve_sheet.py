"""Data sheets of force-deflection curves: one isolator of their laws, what it reproduces, and what is refused."""

import pytest

import wirerope_mj as wr
from wirerope_mj.cli.app import main
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.mounts.vendor_parts.comparison import compare
from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_datasheet

pytestmark = pytest.mark.quick

SHEET = """name = "Socitec CB1390-20"
source = "Socitec CB1390 vendor data sheet, page 2"
curve = "shock"
yield_deflection_mm = 1.9

[compression]
static_mm_daN = [[6.8, 282]]
shock_mm_daN = [[6.8, 282], [36, 846]]
damping_mm = [[5, 0.17], [36, 0.12]]

[shear]
static_mm_daN = [[9.6, 141]]
shock_mm_daN = [[32, 674]]
areas_mm_J = [[32, 30.0]]
"""
"""The figures of both curves as the vendor states them; damping and area are examples."""


def written(folder, text=SHEET):
    path = folder / "sheet.toml"
    path.write_text(text)
    return path


def test_the_laws_have_every_value_of_the_chosen_curve(tmp_path):
    path = written(tmp_path)
    isolator = fit_datasheet(path)
    rows = {(row.axis, row.name): row for row in compare(path, isolator)}
    assert len(rows) == 8
    for (_, name), row in rows.items():
        if not name.startswith("static"):
            # Points to rounding; damping ratios to the search's 1e-10, areas to the rig's closed cycles.
            assert abs(row.error) < 1e-9, row
    assert rows["shear", "static force at 9.6 mm"].error > 0.5  # the shock curve is stiffer there
    assert isolator.limits.travel == wr.Travel(compression=0.036, shear=0.032, roll=0.032)
    assert isolator.roll == isolator.shear
    said = isolator.provenance
    assert said.kind == "catalogue"
    assert "compression: the shock curve, 8460 N at its end, 36 mm, damping ratio 0.17 at 5 mm" in said.fitted_to
    assert "Not fitted: compression static force at 6.8 mm 2820 N" in said.fitted_to
    assert any("tension mirrors" in sentence for sentence in said.assumed)


def test_the_other_curve_is_another_word_in_the_sheet(tmp_path):
    text = SHEET.replace('"shock"', '"static"')
    for line in ("damping_mm = [[5, 0.17], [36, 0.12]]", "areas_mm_J = [[32, 30.0]]"):
        text = text.replace(line, "")
    isolator = fit_datasheet(written(tmp_path, text))
    assert isolator.axial.trace([0.0, -6.8e-3]).force[-1] == pytest.approx(-2820.0, rel=1e-12)
    assert isolator.axial.z_max == 0.0
    assert isolator.limits.travel == wr.Travel(compression=6.8e-3, shear=9.6e-3, roll=9.6e-3)
    assert any(sentence.startswith("axial: no hysteresis") for sentence in isolator.provenance.assumed)
    # Of the shock curve one point lies on the static one's table.
    assert isolator.provenance.fitted_to.endswith("Not fitted: compression shock force at 6.8 mm 2820 N, here 2820 N")


def test_tension_and_points_in_a_file(tmp_path):
    (tmp_path / "tension.csv").write_text("deflection_mm,force_kN\n0,0\n5,3\n15,14\n")
    text = SHEET.replace("[36, 0.12]", "[15, 0.12]") + '[tension]\nshock = "tension.csv"\n'
    isolator = fit_datasheet(written(tmp_path, text))
    forces = isolator.axial.trace([0.0, 5e-3, 15e-3]).force
    assert forces[1:] == pytest.approx([3e3, 14e3], rel=1e-12)
    assert isolator.axial.trace([0.0, -0.036]).force[-1] == pytest.approx(-8460.0, rel=1e-12)
    assert isolator.limits.travel.tension == 0.015
    assert isolator.axial.travel_ends == (0.036, 0.015)
    isolator.save(tmp_path / "out.toml")
    # Cycles about zero end where tension does, though compression is rated for more.
    assert main(["isolators", str(tmp_path / "out.toml"), "--out", str(tmp_path / "loops.png")]) == 0
    assert main(["loops", str(tmp_path / "out.toml"), "--out", str(tmp_path / "cycles.png")]) == 0


def test_the_command_writes_one_file_that_loads(tmp_path, capsys):
    out = tmp_path / "out.toml"
    assert main(["isolators", "fit", str(written(tmp_path)), str(out)]) == 0
    assert "shock force at 36 mm" in capsys.readouterr().out
    assert wr.load_isolator(out) == fit_datasheet(tmp_path / "sheet.toml")
    assert main(["isolators", str(out)]) == 0
    assert "curve" not in capsys.readouterr().out.split("axial: tabulated")[1].split("assumed")[0]


def test_points_of_compression_are_positive_in_a_file_too(tmp_path):
    (tmp_path / "curve.csv").write_text("deflection_mm,force_kN\n0,0\n-10,-1\n-20,-3\n")
    path = written(tmp_path, SHEET.replace("shock_mm_daN = [[32, 674]]", 'shock = "curve.csv"'))
    with pytest.raises(ModelError, match=r"sheet.toml, line \d+: \[shear\] `shock`: curve.csv: points must be > 0"):
        fit_datasheet(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('curve = "shock"', 'curve = "slow"', "`curve` must be one of 'static', 'shock', got 'slow'"),
        ("shock_mm_daN = [[32, 674]]", "", r"\[shear\] states no shock curve"),
        ("shock_mm_daN = [[32, 674]]", "shock = [[32, 674]]", "`shock` must be a text, got"),
        ("shock_mm_daN = [[32, 674]]", 'shock = "no.csv"', r"\[shear\] `shock`: .*no.csv: no such file"),
        ("shock_mm_daN = [[32, 674]]", "shock_mm_t = [[32, 674]]", r"\[shear\] `shock_mm_t` is unknown; known: .*shock_mm_N"),
        ("[6.8, 282], [36, 846]", "[36, 846], [6.8, 282]", r"\[compression\] `deflection` must increase strictly"),
        ("areas_mm_J = [[32, 30.0]]", "areas_mm_J = [[32, 1e3]]\ntravel_mm = 40", "inside the rated travel of 0.04 m"),
        ("areas_mm_J = [[32, 30.0]]", "areas_mm_J = [[5, 30.0], [32, 31]]", r"\[shear\] `areas`: the smaller cycles make"),
        ("areas_mm_J = [[32, 30.0]]", "areas_mm_J = [[32, 30.0]]\ndamping_mm = [[5, 0.1]]", "or `damping_mm`, not both"),
        ("[36, 0.12]", "[37, 0.12]", r"\[compression\] areas .* one of 37 mm leads beyond the end of the curve, 36 mm"),
        ("yield_deflection_mm = 1.9", "", "`yield_deflection` must be > 0 for a law with hysteresis"),
        ("[shear]", "[tension]", r"\[tension\] goes with \[compression\], where areas"),
        ("[shear]", "[sheer]", "`sheer` is unknown; known: .* Did you mean `shear`"),
    ],
)  # fmt: skip
def test_bad_sheets_are_refused(tmp_path, old, new, message):
    assert old in SHEET
    with pytest.raises(ModelError, match=message) as error:
        fit_datasheet(written(tmp_path, SHEET.replace(old, new)))
    assert "sheet.toml" in str(error.value)
