"""Files of flexible parts: units, what a damaged file says, and what the command prints of a part."""

import re

import numpy as np
import openpyxl
import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.engine.flexible.files import read_flexible, units_in
from wirerope_mj.foundation.errors import RecordError

pytestmark = pytest.mark.quick

MODES = "mode,frequency_Hz,damping,participation_x,participation_y,participation_z\n1,10,0.02,0,0,20\n2,31.5,0.02,0,0,8\n"
SHAPES = "point,mode,x,y,z\nm1,1,0,0,0.05\nm1,2,0,0,0.02\nm2,1,0,0,0.04\nm2,2,0,0,-0.03\n"
POINTS = "point,x_m,y_m,z_m\nm1,0.3,0,0\nm2,-0.3,0,0\n"


def write(folder, **changed):
    folder.mkdir(exist_ok=True)
    for name, text in ({"modes": MODES, "shapes": SHAPES, "points": POINTS} | changed).items():
        if text is not None:
            (folder / f"{name}.csv").write_bytes(text if isinstance(text, bytes) else text.encode())
    return folder


def test_tables_are_read(tmp_path):
    part = wr.load_flexible(write(tmp_path / "deck"))
    np.testing.assert_array_equal(part.frequencies, [10.0, 31.5])
    np.testing.assert_array_equal(part.participation[:, 2], [20.0, 8.0])
    np.testing.assert_array_equal(part.shapes["m2"], [[0, 0, 0.04], [0, 0, -0.03]])
    np.testing.assert_array_equal(part.points["m1"], [0.3, 0.0, 0.0])


@pytest.mark.parametrize("way", ["semicolons", "UTF-16", "brackets", "columns in another order", "workbook"])
def test_tables_are_read_as_all_tables_are(tmp_path, way):
    folder = write(tmp_path / "deck")
    files = {path.stem: path.read_text(encoding="utf-8") for path in folder.iterdir()}
    plain = wr.load_flexible(folder)
    points, shapes, paths = folder / "points.csv", folder / "shapes.csv", {}
    if way == "semicolons":
        shapes.write_text(files["shapes"].replace(",", ";").replace(".", ","), encoding="utf-8")
    elif way == "UTF-16":
        shapes.write_text(files["shapes"], encoding="utf-16")
    elif way == "brackets":
        points.write_text(files["points"].replace("x_m,y_m,z_m", "x [m],y [m],z (m)"), encoding="utf-8")
    elif way == "columns in another order":
        points.write_text(
            "".join(f"{line.partition(',')[2]},{line.partition(',')[0]}\n" for line in files["points"].splitlines()),
            encoding="utf-8",
        )
    else:
        book = openpyxl.Workbook()
        for line in files["shapes"].splitlines():
            book.active.append([float(cell) if re.fullmatch(r"[-\d.]+", cell) else cell for cell in line.split(",")])
        paths["shapes"] = folder / "shapes.xlsx"
        book.save(paths["shapes"])
    part = read_flexible(folder / "modes.csv", paths.get("shapes", shapes), points)
    for name in ("m1", "m2"):
        np.testing.assert_array_equal(part.shapes[name], plain.shapes[name])
        np.testing.assert_array_equal(part.points[name], plain.points[name])


DAMAGED = {
    "no modes": ({"modes": None}, "modes.csv: no such file"),
    "no shapes": ({"shapes": None}, "shapes.csv: no such file"),
    "no points": ({"points": None}, "points.csv: no such file"),
    "empty": ({"modes": ""}, 'the file is empty. Expected a header such as "mode, frequency_Hz'),
    "header alone": ({"shapes": "point,mode,x,y,z\n"}, "no row below it"),
    "no header": ({"points": POINTS.partition("\n")[2]}, "the columns must be point, x_m"),
    "another column": ({"modes": MODES.replace("damping", "loss")}, "the columns must be"),
    "a column less": ({"modes": MODES.replace(",participation_z", "")}, "the columns must be"),
    "a cell less": ({"modes": MODES.replace(",20\n", "\n")}, "line 2: 5 cells where the header has 6 columns"),
    "a cell more": ({"shapes": SHAPES.replace("0.05", "0.05,1")}, "line 2: 6 cells where the header has 5 columns"),
    "word": ({"shapes": SHAPES.replace("0.04", "up")}, 'line 4: "up" in column "z" is not a number'),
    "comma": ({"modes": MODES.replace("31.5", '"31,5"')}, "Decimals are written with a point"),
    "unit": ({"modes": MODES.replace("31.5", "31.5 Hz")}, "is not a number"),
    "nan": ({"shapes": SHAPES.replace("0.04", "nan")}, "no measured value"),
    "infinite": ({"points": POINTS.replace("0.3", "inf", 1)}, "no measured value"),
    "zero frequency": ({"modes": MODES.replace("1,10,", "1,0,")}, "rigid-body modes are the body's own"),
    "negative frequency": ({"modes": MODES.replace("1,10,", "1,-10,")}, "must be > 0"),
    "damping in percent": ({"modes": MODES.replace("0.02", "2")}, "ratios from 0 to below 1"),
    "mode twice": ({"modes": MODES.replace("\n2,", "\n1,")}, "line 3: mode 1 stands there twice"),
    "point twice": ({"points": POINTS.replace("m2", "m1")}, "line 3: point m1 stands there twice"),
    "shape twice": ({"shapes": SHAPES.replace("m2,1", "m1,1")}, "line 4: point m1, mode 1, stands there twice"),
    "unknown point": ({"shapes": SHAPES + "m3,1,0,0,1\n"}, "point 'm3' is not in points.csv"),
    "unknown mode": ({"shapes": SHAPES + "m1,3,0,0,1\n"}, "mode '3' is not in modes.csv"),
    "missing shape": ({"shapes": SHAPES.replace("m2,2,0,0,-0.03\n", "")}, "point 'm2' has no row for mode '2'"),
    "no name": ({"points": POINTS.replace("m1", "")}, 'column "point" is empty'),
    "not text": ({"shapes": b"\x00\x01point\x02"}, "control characters"),
    "NUL": ({"points": POINTS.replace("m1", "m\0")}, r"points.csv, line 2: control characters \(NUL\)"),
}


@pytest.mark.parametrize("kind", DAMAGED)
def test_a_damaged_file_is_named_in_one_message(kind, tmp_path, capsys):
    changed, message = DAMAGED[kind]
    folder = write(tmp_path / "deck", **changed)
    with pytest.raises(RecordError, match=message):
        wr.load_flexible(folder)
    assert main(["flexible", str(folder), "--units", "m,kg,s", "--out", str(tmp_path / "part")]) == 2
    error = capsys.readouterr().err
    assert error.startswith("wirerope: ")
    assert error.count("\n") == 1
    assert not (tmp_path / "part").exists()


def test_units_are_asked_for_and_taken(tmp_path, capsys):
    points = "point,x,y,z\nm1,300,0,0\nm2,-300,0,0\n"
    folder = write(tmp_path / "mm", points=points)
    names = [str(folder / f"{name}.csv") for name in ("modes", "shapes")]
    out = tmp_path / "deck"
    command = ["flexible", *names, "--points", str(folder / "points.csv"), "--out", str(out), "--mass-kg", "500000"]
    assert main([*command, "--units", "mm,t,s"]) == 0
    part = wr.load_flexible(out)
    np.testing.assert_allclose(part.points["m1"], [0.3, 0.0, 0.0], rtol=1e-15)
    np.testing.assert_allclose(part.participation[0, 2], 20.0 * np.sqrt(1e3), rtol=1e-15)
    np.testing.assert_allclose(part.shapes["m1"][0, 2], 0.05 / np.sqrt(1e3), rtol=1e-15)
    text = capsys.readouterr().out
    assert "2 modes from 10" in text
    assert "92.8 %" in text
    assert "less than 90 %" not in text
    assert main([*command, "--units", "mm,t,s", "--force"]) == 0
    assert main([*command, "--units", "mm,t,s"]) == 2  # it is there
    assert main([*command, "--units", "mm,oz,s", "--force"]) == 2
    for text in ("mm,t", "t,mm,s", "mm,t,ms", ""):
        with pytest.raises(ValueError, match="mm,t,s or m,kg,s"):
            units_in(text)


@pytest.mark.parametrize(
    ("changed", "options", "said"),
    [
        (
            {"modes": MODES.replace("0,0,20", "0,0,0").replace("0,0,8", "0,0,0")},
            [],
            "right for equipment free in space",
        ),
        ({}, ["--mass-kg", "800"], "58.0 % of the mass, less than 90 %"),
        ({}, ["--mass-kg", "300"], "more than there is"),
        ({"modes": MODES.replace("0,0,20", "0,0,2e4")}, [], "are the units those that --units says?"),
        ({"modes": MODES.replace("31.5", "10")}, [], "Two modes have one frequency"),
    ],
)
def test_what_is_perhaps_not_meant_is_said(changed, options, said, tmp_path, capsys):
    folder = write(tmp_path / "deck", **changed)
    assert main(["flexible", str(folder), "--units", "m,kg,s", "--out", str(tmp_path / "part"), *options]) == 0
    assert said in " ".join(capsys.readouterr().out.split())


def test_files_of_finite_element_programs_are_told_how_to_come(tmp_path, capsys):
    (tmp_path / "deck.rst").write_bytes(b"")
    command = [
        "flexible",
        str(tmp_path / "deck.rst"),
        str(tmp_path / "deck.rst"),
        "--points",
        "p.csv",
        "--units",
        "mm,t,s",
    ]
    assert main([*command, "--out", str(tmp_path / "part")]) == 2
    assert "eigenvectors of unit modal mass" in capsys.readouterr().err
