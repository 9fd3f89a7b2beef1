"""Tables as offices make them: workbooks of several sheets, decimal commas, lines above the header, an envelope apart."""

from pathlib import Path

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.assessment.criteria.payload import body_corners, rattle_verdicts
from wirerope_mj.cli import main

pytestmark = pytest.mark.quick

SHEETS = {
    "Mounts": [
        ["name", "x [mm]", "y [mm]", "z [mm]", "isolator"],
        *[[f"m{2 * i + j}", 600.0 * i - 300.0, 500.0 * j - 250.0, 54.0, "WR16-400"] for i in (0, 1) for j in (0, 1)],
    ],
    "masses": [
        ["name", "mass [kg]", "x [mm]", "y [mm]", "z [mm]", "size_x [mm]", "size_y [mm]", "size_z [mm]"],
        ["frame", 180.5, 0.0, 12.5, 500.0, 600.0, 500.0, 700.0],
        ["drives", 220.0, 20.0, 0.0, 350.0, 400.0, 400.0, 200.0],
    ],
    "envelope": [
        ["name", "size_x [mm]", "size_y [mm]", "size_z [mm]", "corner_x [mm]", "corner_y [mm]", "corner_z [mm]"],
        ["cabinet", 620.0, 520.0, 1200.0, -310.0, -260.0, 108.0],
    ],
    "prices": [["part", "price"], ["WR16-400", 100.0]],
}


def workbook(path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in SHEETS.items():
        sheet = book.create_sheet(name)
        if name == "masses":
            sheet.append(["Project:", "galley cabinet"])
        for row in rows:
            sheet.append(row)
    book.save(path)


def european(folder):
    """Write the sheets as a German spreadsheet program saves them, below two lines about the project."""
    folder.mkdir()
    for name, rows in SHEETS.items():
        lines = [";".join(str(cell).replace(".", ",") for cell in row) for row in rows]
        above = [] if name == "prices" else ["Projekt;Schrank 4711", "Stand;24.11.2026", ""]
        (folder / f"{name.lower()}.csv").write_text("\n".join([*above, *lines]).replace("[mm]", "(mm)"), encoding="utf-8-sig")


@pytest.mark.slow
def test_a_workbook_and_a_folder_with_decimal_commas_make_one_model(here):
    workbook(here / "job.xlsx")
    european(here / "tables")
    assert main(["new", "a", "--tables", "job.xlsx", "--name", "equipment"]) == 0
    assert main(["new", "b", "--tables", "tables", "--name", "equipment"]) == 0
    assert main(["new", "c", "--tables", "a/tables/job.xlsx", "--name", "equipment"]) == 0
    texts = [Path(f"{name}/{name}.xml").read_text().replace(f'model="{name}"', "") for name in "abc"]
    assert texts[0] == texts[1] == texts[2]
    system = wr.load_system("a/a.xml")
    assert float(system.model.body("equipment").mass[0]) == pytest.approx(400.5)


@pytest.mark.slow
def test_clearances_hold_for_the_corners_of_the_envelope_by_a_pattern(here, capsys):
    workbook(here / "job.xlsx")
    assert main(["new", "a", "--tables", "job.xlsx"]) == 0
    limits = ["--limit", "clearance/* = 4 4 4 cm", "--limit", "acceleration/a = 20 g"]
    assert main(["shock", "a/a.xml", "--half-sine", "5 g 11 ms z", *limits, "--out", "run"]) in (0, 1)
    response = wr.load_response("run")
    (body,) = (body for body in response.scene.bodies if body.name == "a")
    corners = body.position + body_corners(body)
    assert np.allclose([corners.min(axis=0), corners.max(axis=0)], [[-0.31, -0.26, 0.108], [0.31, 0.26, 1.308]])
    rooms = {verdict.limit for verdict in rattle_verdicts(response) if verdict.subject == "a"}
    assert rooms == {0.04}


@pytest.mark.parametrize(
    ("name", "change", "message"),
    [
        ("masses", ("180,5", "180.5"), "Decimals are written with a point, or all with a comma"),
        ("masses", ("12,5", "12.5"), '"12.5" has a point and numbers above it have decimal commas'),
        ("envelope", ("corner_z", "centre_z"), "one of the two; both are filled in"),
        ("envelope", ("620,0", "0,0"), '"size_x", "size_y", "size_z" must be > 0'),
        ("mounts", ("y (mm);z (mm);isolator", "weight (mm);height (mm);part"), 'unknown column "weight"'),
    ],
)
def test_one_message_says_what_is_wrong(here, capsys, name, change, message):
    european(here / "tables")
    file = here / "tables" / f"{name}.csv"
    file.write_text(file.read_text().replace(*change))
    assert main(["new", "a", "--tables", "tables"]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert f"{name}.csv, line" in said
    assert not Path("a").exists()


def test_every_column_that_is_missing_is_named_at_once(here, capsys):
    european(here / "tables")
    (here / "tables" / "mounts.csv").write_text("name;x (mm)\nm1;12,5\n")
    assert main(["new", "a", "--tables", "tables"]) == 2
    assert 'columns "y [mm]", "z [mm]", "isolator" are missing' in capsys.readouterr().err


def test_a_rig_s_table_is_read_below_its_own_lines(here):
    angle = np.linspace(0.0, 2.0 * np.pi, 65)
    x, force = 0.5 * np.sin(angle), 120.0 * np.sin(angle) + 20.0 * np.cos(angle)
    rows = [f"{a:.6f};{b:.6f}".replace(".", ",") for a, b in zip(x, force, strict=True)]
    (here / "rig.csv").write_text("Rig;4\nSample rate [Hz];1000\n\nDisp. (in);Load (lbf)\n" + "\n".join(rows))
    (loop,) = wr.load_cyclic_test(here / "rig.csv")
    assert loop.deflection.max() == pytest.approx(0.0127, rel=1e-5)
    assert loop.force[0] == pytest.approx(20.0 * 4.4482216, rel=1e-5)


def test_a_record_with_decimal_commas_is_the_record(here):
    time = np.arange(0.0, 0.1005, 1e-3)
    level = 3.0 * np.sin(20.0 * np.pi * time)
    (here / "a.csv").write_text("time [s], z [g]\n" + "\n".join(f"{t:.6f}, {a:.6f}" for t, a in zip(time, level, strict=True)))
    text = "\n".join(f"{t:.6f};{a:.6f}".replace(".", ",") for t, a in zip(time, level, strict=True))
    (here / "b.csv").write_text("Logger 7\nserial;0815\ntime (s);z (g)\n" + text)
    one, other = wr.load_record(here / "a.csv"), wr.load_record(here / "b.csv")
    assert np.array_equal(one.acceleration(time), other.acceleration(time))
    (here / "c.csv").write_text("time (s);z (g)\n0,000;1,5\n0,001;1.5\n0,002;1,5\n")
    with pytest.raises(wr.RecordError, match=r'line 3: "1\.5" has a point'):
        wr.load_record(here / "c.csv")


@pytest.mark.parametrize("name", ["Z (500g)", "Z (500 g)", "Z [500g]", "Acc Z (+-500 g)", "Z (\u00b1500g)", "z (500 G)"])
def test_the_range_of_a_sensor_in_place_of_a_unit_says_the_unit_and_what_it_cannot_show(here, name):
    time = np.arange(0.0, 0.1001, 2e-4)
    level = 120.0 * np.sin(200.0 * np.pi * time) * np.sin(10.0 * np.pi * time) ** 2
    rows = [f"{t:.6f},{a:.6f}" for t, a in zip(time, level, strict=True)]
    Path("a.csv").write_text("\n".join([f"Time (s),{name}", *rows]), encoding="utf-8")
    assert np.abs(wr.load_record("a.csv").acceleration(time)).max() > 1000.0  # of 1100 m/s^2 at the largest sample
    Path("a.csv").write_text("\n".join([f"Time (s),{name.replace('500', '50')}", *rows]), encoding="utf-8")
    with pytest.raises(wr.RecordError, match="a sensor whose range is 50 g. In which unit are the numbers"):
        wr.load_record("a.csv")
