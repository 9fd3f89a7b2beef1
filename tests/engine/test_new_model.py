"""Models from tables: their masses against hand sums, their statics, what stands in the folder, and bad tables."""

import csv
import os
import re
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.engine.statics import static_table
from wirerope_mj.foundation.resources import catalogue_folder, models_folder
from wirerope_mj.runs.selection import equipment

G = wr.STANDARD_GRAVITY
TABLES = models_folder() / "templates" / "genset"
ROOT = Path(__file__).parents[2]

MOUNTS = "name, x [mm], y [mm], z [mm], isolator, inclination [deg], azimuth [deg]"
MASSES = "name, mass [kg], x [mm], y [mm], z [mm], ixx [kg m^2], iyy [kg m^2], izz [kg m^2], ixy [kg m^2]"
STOPS = "name, x [mm], y [mm], z [mm], gap [mm], stiffness [MN/m], damping [kN s/m]"
FEET = [f"m{n}, {x}, {y}, 100, enidine_wr16_400, 30, {-90 if y > 0 else 90}"
        for n, (x, y) in enumerate([(x, y) for y in (-300, 300) for x in (-800, 0, 800)], start=1)]  # fmt: skip
PARTS = ["engine, 700, -400, 20, 500, 50, 90, 80, 3", "alternator, 500, 600, -10, 450, 25, 40, 35, -1"]
SOFT = [(1, -300, -300), (2, 300, -300), (3, 0, 300)]
STOP_ROWS = ["s1, -800, 0, 100, 40, 10, 15", "s2, 800, 0, 100, 40, 10, 15"]


def write(path, header, rows):
    Path(path).write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")


def good_tables():
    write("mounts.csv", MOUNTS, FEET)
    write("masses.csv", MASSES, PARTS)
    write("stops.csv", STOPS, STOP_ROWS)


def make(*options, name="genset"):
    return main(["new", name, "--mounts", "mounts.csv", "--masses", "masses.csv", *options])


@pytest.mark.slow
def test_a_model_that_nothing_holds_up_is_written_and_exits_with_1_as_the_help_says(here, capsys):
    good_tables()
    write("mounts.csv", MOUNTS, [f"m{n}, {x}, {y}, 100, enidine_wr12_400, 0, 0" for n, x, y in SOFT])
    write("masses.csv", MASSES, ["engine, 90000, 0, 0, 600, 6000, 6000, 6000, 0"])
    new = ["new", "genset", "--mounts", "mounts.csv", "--masses", "masses.csv"]
    assert main([*new, "--no-bottoming"]) == 1
    assert "no equilibrium was found" in capsys.readouterr().err
    assert Path("genset/genset.xml").is_file()
    assert main([*new, "--force"]) == 1  # it rests where its mounts are solid, and not on the first loading
    said = capsys.readouterr().out
    assert "Isolation is short-circuited at rest, after long vibration: bottom_m" in said
    assert "Bottomed, pressed until solid: m1, m2, m3." in said


def compiled(path="genset/genset.xml"):
    """Return what MuJoCo alone compiles, and the inertia of the payload about its centre along the world's axes."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    body = model.body("genset").id
    turn = data.ximat[body].reshape(3, 3)
    return model.body_mass[body], data.xipos[body], turn @ np.diag(model.body_inertia[body]) @ turn.T


def by_hand(rows):
    """Return mass, centre and inertia of rows (mass, centre [m], tensor) as sums of m r r over all, taken about the origin."""
    mass = sum(m for m, _, _ in rows)
    centre = sum(m * np.array(c) for m, c, _ in rows) / mass
    about_origin = sum(np.array(i) - m * skew(c) @ skew(c) for m, c, i in rows)
    return mass, centre, about_origin + mass * skew(centre) @ skew(centre)


def skew(v):
    x, y, z = v
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


@pytest.mark.parametrize(("products", "sign"), [("tensor", 1.0), ("positive", -1.0)])
def test_the_masses_of_the_tables_are_those_that_mujoco_compiles(here, products, sign):
    good_tables()
    assert make("--products", products) == 0
    parts = [
        (700.0, (-0.4, 0.02, 0.5), [[50, 3 * sign, 0], [3 * sign, 90, 0], [0, 0, 80]]),
        (500.0, (0.6, -0.01, 0.45), [[25, -sign, 0], [-sign, 40, 0], [0, 0, 35]]),
    ]
    for found, wanted in zip(compiled(), by_hand(parts), strict=True):
        # twelve digits are written; MuJoCo's own eigenvalue iteration ends at 1e-12 or so of the largest moment
        np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-9)


def test_a_box_has_the_inertia_of_its_sizes(here):
    write("mounts.csv", MOUNTS, FEET)
    write("masses.csv", "name, mass [kg], x [mm], y [mm], z [mm], size_x [mm], size_y [mm], size_z [m]",
          ["rack, 320, 0, 0, 850, 600, 800, 1.8"])  # fmt: skip
    assert make() == 0
    mass, centre, inertia = compiled()
    assert mass == pytest.approx(320.0)
    np.testing.assert_allclose(centre, [0.0, 0.0, 0.85], atol=1e-12)
    a, b, c = 0.6**2, 0.8**2, 1.8**2
    np.testing.assert_allclose(inertia, 320 / 12 * np.diag([b + c, a + c, a + b]), rtol=1e-9, atol=1e-9)


def test_six_mounts_of_a_symmetric_genset_carry_a_sixth_each(here, capsys):
    write("mounts.csv", MOUNTS, FEET)
    write("masses.csv", MASSES, ["engine, 1200, 0, 0, 450, 100, 450, 440, 0"])
    assert make() == 0
    table = static_table(wr.load_system("genset/genset.xml"))
    loads = wr.equilibrium(wr.load_system("genset/genset.xml")).mounts
    vertical = [load.force for name, load in loads.items() if not name.startswith("bottom_")]
    assert len(vertical) == 6
    assert set(table.sags["virgin"].mounts) == {*(f"m{n}" for n in range(1, 7)), *(f"bottom_m{n}" for n in range(1, 7))}
    assert set(table.sags["virgin"].listed) == {f"m{n}" for n in range(1, 7)}
    model = mujoco.MjModel.from_xml_path("genset/genset.xml")
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    for n, force in enumerate(vertical, start=1):
        axes = data.site(f"deck/m{n}").xmat.reshape(3, 3)
        lift = -(axes @ force)[2]  # the spring's force on the payload is against its restoring sense
        # the middle ones are alike with the outer ones, because nothing turns; the equilibrium ends at 1e-9 of the weight
        assert lift == pytest.approx(1200 * G / 6, rel=1e-6)
    rows = [line.split() for line in capsys.readouterr().out.splitlines() if line.startswith("m") and "within" in line]
    assert [row[6] for row in rows] == ["16.7"] * 12  # per cent of the weight, on the first loading and relaxed


@pytest.mark.slow
def test_axes_of_a_mount_lead_from_the_base_to_the_payload(here):
    """A direction, or inclination and azimuth, mean the same; bars stand square to it."""
    direction = "direction_x, direction_y, direction_z, bars_x, bars_y, bars_z"
    header = f"name, x [m], y [m], z [m], isolator, {direction}"
    write("mounts.csv", MOUNTS, FEET)
    write("masses.csv", MASSES, PARTS)
    assert make() == 0
    vectors = [f"m{n}, {x}, {y}, 0.1, enidine_wr16_400, 0, {0.5 if y < 0 else -0.5}, 0.8660254037844386, 1, 0, 0.3"
               for n, (x, y) in enumerate([(x, y) for y in (-0.3, 0.3) for x in (-0.8, 0, 0.8)], start=1)]  # fmt: skip
    write("mounts.csv", header, vectors)
    assert make(name="other") == 0
    for name in ("m1", "m6"):
        axes = [axes_of(f"{model}/{model}.xml", f"deck/{name}") for model in ("genset", "other")]
        np.testing.assert_allclose(axes[0][:, 2], axes[1][:, 2], atol=1e-11)  # twelve digits are written
        assert axes[0][2, 1] == pytest.approx(0.0, abs=1e-11)  # without bars they lie horizontally
        np.testing.assert_allclose(np.linalg.det(axes[1]), 1.0, atol=1e-12)
        assert axes[1][:, 1] @ np.cross(axes[1][:, 2], [1, 0, 0.3]) == pytest.approx(0.0, abs=1e-11)


def axes_of(path, site):
    model = mujoco.MjModel.from_xml_path(path)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return data.site(site).xmat.reshape(3, 3)


def test_stops_close_after_their_gap_and_stand_in_files_of_their_own(here):
    good_tables()
    assert make("--stops", "stops.csv") == 0
    stop = wr.load_system("genset/genset.xml").mounts["s1"].isolator.axial
    assert (stop.gap_below, stop.k, stop.c) == (0.040, 10e6, 15e3)
    assert [path.name for path in sorted(Path("genset/isolators").iterdir())] == [
        "bottom_of_enidine_wr16_400.toml", "enidine_wr16_400.toml", "stop_of_table_1.toml",
    ]  # fmt: skip


def test_names_of_what_is_written_for_stops_are_refused_to_others(here, capsys):
    good_tables()
    write("stops.csv", STOPS, ["bottom_m1, -800, 0, 100, 40, 10, 15"])
    assert make("--stops", "stops.csv") == 2
    said = capsys.readouterr().err
    assert 'line 2: the stop where mount "m1" goes solid is called "bottom_m1". Give this one another name' in said
    assert make("--stops", "stops.csv", "--no-bottoming") == 0
    wr.Isolator(name="pad", axial=wr.KelvinVoigt(k=1e5, c=10.0)).save("stop_of_table_1.toml")
    write("stops.csv", f"{STOPS}, isolator", ["s1, -800, 0, 100, 40, 10, 15,", "s2, 800, 0, 100, , , , stop_of_table_1"])
    assert make("--stops", "stops.csv", name="other") == 2
    assert 'line 3, column "isolator": "stop_of_table_1" is the name of a file that is written' in capsys.readouterr().err
    assert not Path("other").exists()


@pytest.mark.parametrize(("acts", "direction"), [
    ("up", "0, 0, -1"), ("down", "0, 0, -1"), ("up", "1, 0, 0"), ("down", "1, 0, 1e-6"), ("up-down", "0, 0, -1"),
    ("all-round", "0, 0, -1"),
])  # fmt: skip
def test_a_stop_that_acts_up_or_down_must_be_upright(here, capsys, acts, direction):
    """Down of a stop that points down is up: what a table says of it would be the opposite."""
    good_tables()
    further = ", gap_up [mm], acts, direction_x, direction_y, direction_z"
    gap, gap_up = {"up": ("", 7), "down": (3, "")}.get(acts, (3, 7))
    row = f"s1, -800, 0, 100, {gap}, 10, 15, {gap_up}, {acts}"
    write("stops.csv", STOPS + further, [f"{row}, {direction}"])
    assert make("--stops", "stops.csv") == 2
    said = capsys.readouterr().err
    assert f'line 2: "s1" acts {acts}, which is told from a direction that points up' in said
    assert 'leave column "acts" empty' in said


def test_stops_that_point_down_say_where_their_gaps_count_along_their_direction(here, capsys):
    """Of a ceiling stop the payload has gone away by its sag; equal gaps both ways have no up and down."""
    good_tables()
    further = ", acts, gap_at, direction_x, direction_y, direction_z"
    rows = ["s1, -800, 0, 900, 3, 10, 15, , installed, 0, 0, -1", "s2, 800, 0, 100, 3, 10, 15, up-down, installed, 0, 0, -1"]
    write("stops.csv", STOPS + further, [*rows, "s3, 0, 0, 100, 3, 10, 15, down, installed, 0, 0, 1"])
    assert make("--stops", "stops.csv") == 0
    said = capsys.readouterr().out
    loads = {name: load.deflection[2] for name, load in wr.equilibrium(wr.load_system("genset/genset.xml")).mounts.items()}
    assert loads["s1"] > 0.0 > loads["s3"]
    low, high = sorted([1e3 * loads["s1"], 1e3 * loads["s2"]])
    down = f"Gaps of s3 count at rest, as installed, where the payload has gone down by {-1e3 * loads['s3']:.3g} mm"
    along = f"gaps of s1, s2 count at rest, as installed, where the payload has moved along each stop's direction by {low:.3g}"
    assert down in said
    assert f"{along} to {high:.3g} mm" in said


def test_one_row_of_the_table_of_stops_stands_at_several_mounts_along_their_axes(here):
    good_tables()
    header = "name, mounts, gap [mm], stiffness [MN/m], gap_at, inclination [deg]"
    write("stops.csv", header, ["s, m1; m3, 20, 10, ,", "t, all, 25, 10, installed,", "u, m[46], 30, 10, , 0"])
    assert make("--stops", "stops.csv") == 0
    mounts = wr.load_system("genset/genset.xml").mounts
    named = {name for name in mounts if name[:2] in ("s_", "t_", "u_")}
    assert named == {"s_m1", "s_m3", "u_m4", "u_m6"} | {f"t_m{number}" for number in range(1, 7)}
    for name in named:
        of = mounts[name[2:]]
        np.testing.assert_allclose(mounts[name].position, of.position, atol=1e-9)
        axes = np.eye(3)[:, 2] if name[0] == "u" else of.axes[:, 2]
        np.testing.assert_allclose(mounts[name].axes[:, 2], axes, atol=1e-9)
    assert mounts["s_m1"].isolator.axial == wr.Stop(gap_below=0.02, k=1e7, rounding=1e-3)
    assert len({mounts[f"t_m{number}"].isolator.axial.rest for number in range(1, 7)}) > 1  # each at its own sag


def test_gaps_of_an_all_round_snubber_count_from_rest_where_it_is_installed(here, capsys):
    """Pushed by a steady acceleration beyond the gap, each side touches once the payload has moved 3 mm from rest."""
    write("mounts.csv", MOUNTS, FEET)
    write("masses.csv", MASSES, PARTS)
    header = STOPS.replace("gap [mm]", "gap [mm], gap_up [mm], gap_across [mm], acts, gap_at")
    rows = ["s1, -800, 0, 100, 3, , 5, all-round, installed, 10, 15", "s2, 800, 0, 100, 3, 4, , up-down, , 10, 15"]
    write("stops.csv", header, [*rows, "s3, 0, 0, 100, , 7, , up, unloaded, 10, 15"])
    assert make("--stops", "stops.csv") == 0
    said = capsys.readouterr().out
    system = wr.load_system("genset/genset.xml")
    isolators = {name: system.mounts[name].isolator for name in ("s1", "s2", "s3")}
    load = wr.equilibrium(system).mounts["s1"]
    laws = isolators["s1"].axes
    # the sag of the first loading, to the micrometre that is written; its path is another where the snubber presses before the
    # weight is on, which leaves as much in the ropes' friction. Nothing is pressed there.
    assert [law.rest for law in laws.values()] == pytest.approx(load.deflection.tolist(), abs=5e-6)
    assert load.deflection[2] < -0.003  # so that the gap above is beyond the unloaded geometry
    assert not load.force.any()
    assert [(law.gap_below, law.gap_above) for law in laws.values()] == [(0.005, 0.005), (0.005, 0.005), (0.003, 0.003)]
    assert list(isolators["s2"].stops) == list(isolators["s3"].stops) == ["axial"]
    assert (isolators["s2"].axial.gap_below, isolators["s2"].axial.gap_above, isolators["s2"].axial.rest) == (
        0.003,
        0.004,
        None,
    )
    assert (isolators["s3"].axial.gap_below, isolators["s3"].axial.gap_above) == (None, 0.007)
    assert (
        f"Gaps of s1 count at rest, as installed, where the payload has gone down by {-1e3 * load.deflection[2]:.3g} mm" in said
    )
    assert "gaps of s2, s3 count from the unloaded geometry" in said
    for engine in ("kernel", "mujoco"):
        response = wr.simulate(
            system, wr.HalfSine(peak=60.0, duration=0.02, direction="z"), duration=0.3, timestep=1e-4, engine=engine
        )
        deflection = response.mounts["s1"].deflection[:, 2] - load.deflection[2]
        pressed = response.mounts["s1"].force[:, 2]
        assert (np.abs(deflection[pressed != 0.0]) > 0.003 - 5e-6).all()
        assert {-1.0, 1.0} <= set(np.sign(pressed))  # both ways
        contact = response.peaks.contacts["s1 axial"]
        assert contact.penetration == pytest.approx(
            max(-response.peaks.mounts["s1"].deflection.minimum[2] + load.deflection[2],
                response.peaks.mounts["s1"].deflection.maximum[2] - load.deflection[2]) - 0.003, abs=5e-6,
        )  # fmt: skip
    with pytest.raises(wr.ModelError, match="stop 's1' was installed under load"):
        wr.simulate(system, wr.HalfSine(peak=60.0, duration=0.02, direction="z"), duration=0.1, initial="unloaded")
    with pytest.warns(wr.ModelWarning, match=r"the gaps of s1 are as installed .* `wirerope new`"):
        equipment("genset/genset.xml", {"shock": wr.HalfSine(peak=60.0, duration=0.02, direction="z")})


@pytest.mark.slow
def test_the_folder_is_complete_and_its_tables_make_it_again(here):
    assert main(["new", "genset", "--template", "genset", "--pdf"]) == 0
    first = Path("genset/genset.xml").read_bytes()
    assert ElementTree.fromstring(first).get("model") == "genset"  # stricter than MuJoCo about comments
    assert Path("genset/genset_plan.png").read_bytes()[:4] == b"\x89PNG"
    assert Path("genset/genset_plan.pdf").read_bytes()[:4] == b"%PDF"
    assert {path.name for path in Path("genset/tables").iterdir()} == {path.name for path in TABLES.iterdir()}
    assert b"<!--" in first
    tables = [word for kind in ("mounts", "masses", "stops", "points", "forces")
              for word in (f"--{kind}", f"genset/tables/{kind}.csv")]  # fmt: skip
    assert main(["new", "genset", *tables]) == 2  # there is one
    assert main(["new", "genset", *tables, "--force"]) == 0
    assert Path("genset/genset.xml").read_bytes() == first


@pytest.mark.parametrize("template", ["cabinet", "floor", "two-stage"])
def test_a_template_is_a_model_that_one_edits(here, template, capsys):
    assert main(["new", "mine", "--template", template]) == 0
    assert "written: mine/mine.xml" in capsys.readouterr().out
    system = wr.load_system("mine/mine.xml")
    assert len(system.payloads) == (2 if template == "two-stage" else 1)
    assert (Path("mine") / "isolators").is_dir()


def test_a_two_stage_mount_carries_its_quarter_of_what_stands_above(here):
    assert main(["new", "mine", "--template", "two-stage"]) == 0
    mounts = wr.equilibrium(wr.load_system("mine/mine.xml")).mounts
    for n in range(1, 5):
        assert mounts[f"upper{n}"].force[2] == pytest.approx(-300 * G / 4, rel=1e-6)
        assert mounts[f"lower{n}"].force[2] == pytest.approx(-450 * G / 4, rel=1e-6)


def workbook(path, header, rows):
    import openpyxl

    book = openpyxl.Workbook()
    sheet = book.active
    for line in (header, *rows):
        sheet.append([number_or_text(cell.strip()) for cell in line.split(",")] if line else [])
    book.save(path)
    book.close()


def number_or_text(cell):
    try:
        return float(cell)
    except ValueError:
        return cell


@pytest.mark.slow
def test_a_workbook_makes_the_same_model_as_csv(here):
    good_tables()
    assert make(name="genset") == 0
    workbook("mounts.xlsx", MOUNTS, FEET)
    workbook("masses.xlsx", MASSES, PARTS)
    Path("genset").rename("from_csv")
    assert main(["new", "genset", "--mounts", "mounts.xlsx", "--masses", "masses.xlsx"]) == 0
    assert Path("genset/genset.xml").read_text() == Path("from_csv/genset.xml").read_text()


def test_without_the_extra_a_workbook_is_refused_with_what_to_install(here, monkeypatch, capsys):
    monkeypatch.setitem(__import__("sys").modules, "openpyxl", None)
    good_tables()
    Path("mounts.xlsx").write_bytes(b"PK")
    assert main(["new", "genset", "--mounts", "mounts.xlsx", "--masses", "masses.csv"]) == 2
    assert "pip install 'wirerope-mj[xlsx]'" in capsys.readouterr().err


def changed(row, **cells):
    """Return a row of mounts or masses with cells replaced by number."""
    values = [cell.strip() for cell in row.split(",")]
    for place, value in cells.items():
        values[int(place[1:])] = value
    return ", ".join(values)


BAD = {
    "a unit missing": ("mounts", MOUNTS.replace("x [mm]", "x"), FEET, r'line 1: column "x" has no unit'),
    "an unknown unit": ("masses", MASSES.replace("mass [kg]", "mass [stone]"), PARTS,
                        r'line 1: column "mass" has the unknown unit "stone"'),
    "a unit of another quantity": ("mounts", MOUNTS.replace("x [mm]", "x [kg]"), FEET,
                                   r'line 1: column "x" has the unknown unit "kg"'),
    "comma decimals": ("masses", MASSES.replace(",", ";"),
                       [PARTS[0].replace(",", ";").replace("700", "700,5"), PARTS[1].replace(",", ";").replace("500", "500.5")],
                       r'line 3: "500\.5" has a point and numbers above it have decimal commas'),
    "comma decimals between commas": ("masses", MASSES, [PARTS[0].replace("700", "700,5"), PARTS[1]],
                                      r"line 2: 10 cells where the header has 9 columns\. Decimals are written with a point"),
    "a mount twice": ("mounts", MOUNTS, [*FEET, FEET[0]], r'line 8: the name "m1" is given twice, first in .*line 2'),
    "two mounts at one position": ("mounts", MOUNTS, [*FEET, changed(FEET[0], c0="m7")],
                                   r'line 8: columns "x", "y", "z": mount "m7" stands where "m1" stands'),
    "a mass twice": ("masses", MASSES, [*PARTS, PARTS[0]], r'line 4: the name "engine" is given twice'),
    "a negative mass": ("masses", MASSES, [changed(PARTS[0], c1="-700"), PARTS[1]],
                        r'line 2: column "mass" of "engine" must be > 0, got -700'),
    "no mass": ("masses", MASSES, [changed(PARTS[0], c1="0"), PARTS[1]], r'line 2: column "mass" of "engine" must be > 0'),
    "an inertia against the triangle inequality": ("masses", MASSES, [changed(PARTS[0], c5="500"), PARTS[1]],
                                                   r'line 2: .*"ixx" to "iyz" of "engine".*larger than the sum of the other'),
    "a negative moment": ("masses", MASSES, [changed(PARTS[0], c5="-50"), PARTS[1]], r"line 2: .*none can be negative"),
    "a product beyond the moments": ("masses", MASSES, [changed(PARTS[0], c8="300"), PARTS[1]],
                                     r"line 2: .*none can be negative"),
    "a part of the inertia": ("masses", MASSES, [changed(PARTS[0], c6=""), PARTS[1]],
                              r'line 2: column "iyy" of "engine" is empty though "ixx" is given'),
    "an inertia said twice": ("masses", f"{MASSES}, size_x [m]", [f"{PARTS[0]}, 1", f"{PARTS[1]}, "],
                              r'line 2: columns "ixx" and "size_x" of "engine" both say the inertia'),
    "a negative size": ("masses", "name, mass [kg], x [m], y [m], z [m], size_x [m], size_y [m], size_z [m]",
                        ["block, 1200, 0, 0, 1, 1, -1, 1"], r'line 2: column "size_y" of "block" must be >= 0, got -1'),
    "masses in mm under m": ("masses", MASSES.replace("mm", "m"), PARTS,
                             r'line 2: "engine" has its centre of mass [\d.]+ m from the middle of mounts that are [\d.]+ m '
                             r'apart.*: are columns "x", "y", "z" in mm where the header says m\?'),
    "sizes in mm under m": ("masses", "name, mass [kg], x [mm], y [mm], z [mm], size_x [m], size_y [m], size_z [m]",
                            ["block, 1200, 0, 0, 450, 900, 500, 700"],
                            r'line 2: .*: are columns "size_x" to "size_z", or "ixx" to "iyz", in mm where the header says'),
    "nothing but a point mass": ("masses", MASSES, ["block, 1200, 0, 0, 450, , , , "],
                                 r'masses\.csv: the masses together have no moment of inertia'),
    "an unknown isolator": ("mounts", MOUNTS, [changed(FEET[0], c4="wr99"), *FEET[1:]],
                            r'line 2: column "isolator": there is no isolator \'wr99\'.*enidine_wr16_400'),
    "an empty file": ("mounts", "", [], r"mounts\.csv: the file is empty"),
    "a header alone": ("mounts", MOUNTS, [], r"mounts\.csv: the table of mounts has a header and no rows"),
    "an unknown column": ("mounts", f"{MOUNTS}, colour", [f"{row}, red" for row in FEET],
                          r'line 1: unknown column "colour"\. Known columns: name, x \[mm\]'),
    "a column twice": ("mounts", MOUNTS.replace("y [mm]", "x [mm]"), FEET, r'line 1: column "x" stands there twice'),
    "a column missing": ("mounts", MOUNTS.replace(", isolator", ""), [row.replace(" enidine_wr16_400,", "") for row in FEET],
                         r'line 1: column "isolator" is missing'),
    "NaN": ("mounts", MOUNTS, [changed(FEET[0], c1="nan"), *FEET[1:]], r'line 2: nan in column "x"'),
    "infinity": ("masses", MASSES, [changed(PARTS[0], c1="inf"), PARTS[1]], r'line 2: inf in column "mass"'),
    "an empty cell": ("mounts", MOUNTS, [changed(FEET[0], c2=""), *FEET[1:]],
                      r'line 2: column "y" is empty; a number is needed'),
    "no name": ("mounts", MOUNTS, [changed(FEET[0], c0=""), *FEET[1:]], r'line 2: column "name" is empty'),
    "a unit in a cell": ("mounts", MOUNTS, [changed(FEET[0], c3="100mm"), *FEET[1:]],
                         r'line 2: "100mm" in column "z" is not a number\. Units stand in the header only'),
    "a mount with its sites swapped": ("mounts", MOUNTS, [changed(FEET[0], c5="150"), *FEET[1:]],
                                       r'line 2: mount "m1" has its sites swapped'),
    "an inclination beyond all": ("mounts", MOUNTS, [changed(FEET[0], c5="200"), *FEET[1:]],
                                  r'line 2: column "inclination" must lie between 0 and 180'),
    "a mount far outside": ("mounts", MOUNTS, [changed(FEET[0], c1="-800000"), *FEET[1:]],
                            r'line 2: "m1" stands outside, 800 m from the centre of mass'),
    "a stop without stiffness": ("stops", STOPS, [changed(STOP_ROWS[0], c5="0")],
                                 r'line 2: column "stiffness" must be > 0'),
    "a stop with a negative gap": ("stops", STOPS, [changed(STOP_ROWS[0], c4="-1")], r'line 2: column "gap" must be >= 0'),
    "a stop that acts in no way": ("stops", f"{STOPS}, acts", [f"{STOP_ROWS[0]}, sideways"],
                                   r'line 2: column "acts" must be down, up, up-down or all-round, got "sideways"'),
    "a gap nowhere": ("stops", f"{STOPS}, gap_at", [f"{STOP_ROWS[0]}, fitted"],
                      r'line 2: column "gap_at" must be unloaded or installed, got "fitted"'),
    "a gap of a side that does not act": ("stops", f"{STOPS}, gap_up [mm]", [f"{STOP_ROWS[0]}, 3"],
                                          r'line 2: "s1" has a gap_up, and acts down: leave one of the two columns empty'),
    "stops at no mount": ("stops", "name, mounts, gap [mm], stiffness [MN/m]", ["s, m1 m9, 20, 10"],
                          r'line 2: column "mounts" must be all, or names of mounts such as "m1, m2"; no mount is called "m9"'),
    "stops at mounts and at a place": ("stops", f"{STOPS}, mounts", [f"{STOP_ROWS[0]}, all"],
                                       r'line 2: "s1" stands at mounts and has x: leave one of the two columns empty'),
    "stops of two rows with one name": (
        "stops", f"{STOPS}, mounts", ["s_m1, -800, 0, 100, 40, 10, 15,", "s, , , , 40, 10, 15, all"],
        r'line 3: the name "s_m1" is given twice, first in stops.csv, line 2'),
    "a stop without a place": ("stops", "name, gap [mm], stiffness [MN/m]", ["s, 20, 10"],
                               r'line 2: column "x" is empty; a number is needed'),
    "a stop called like a mount": ("stops", STOPS, [changed(STOP_ROWS[0], c0="m1")], r'line 2: a mount is called "m1" too'),
    "a name with a slash": ("mounts", MOUNTS, [changed(FEET[0], c0="a/b"), *FEET[1:]], r'line 2: column "name": "a/b" holds'),
    "a name with a space": ("mounts", MOUNTS, [changed(FEET[0], c0="fore port"), *FEET[1:]],
                            r'line 2: column "name": "fore port" holds a space'),
    "an isolator in markup": ("mounts", MOUNTS, [changed(FEET[0], c4="<x>"), *FEET[1:]],
                                                     r"line 2: column \"isolator\": there is no isolator '<x>'"),
}  # fmt: skip


@pytest.mark.parametrize("kind", BAD)
def test_a_bad_table_is_answered_in_one_message_and_nothing_is_written(here, kind, capsys):
    table, header, rows, message = BAD[kind]
    good_tables()
    write(f"{table}.csv", header, rows)
    before = sorted(os.listdir())
    assert make("--stops", "stops.csv") == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    assert f"{table}.csv" in lines[0]
    assert re.search(message, lines[0]), lines[0]
    assert sorted(os.listdir()) == before


def test_tables_that_agree_on_a_unit_and_are_both_wrong_are_questioned(here, capsys):
    write("mounts.csv", MOUNTS.replace("mm", "m"), FEET)
    write("masses.csv", "name, mass [kg], x [m], y [m], z [m], size_x [m], size_y [m], size_z [m]",
          ["block, 1200, 0, 0, 450, 900, 500, 700"])  # fmt: skip
    assert make() == 2
    assert re.search(r'mounts\.csv, line 2: .* m apart: are columns "x", "y", "z" of the tables in mm', capsys.readouterr().err)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([], "mounts.xlsx: the sheet Sheet is empty"),
        ([MOUNTS, changed(FEET[0], c1="left")], 'mounts.xlsx, sheet Sheet, row 2: "left" in column "x" is not a number'),
        ([MOUNTS.replace("isolator", "rope")], "mounts.xlsx, sheet Sheet, row 1: unknown column"),
        ([MOUNTS, "", f"{FEET[0]}, 7"], "mounts.xlsx, sheet Sheet, row 3: 8 cells where the header has 7 columns"),
    ],
)
def test_a_bad_workbook_names_its_row(here, rows, message, capsys):
    good_tables()
    workbook("mounts.xlsx", rows[0] if rows else "", rows[1:])
    assert main(["new", "genset", "--mounts", "mounts.xlsx", "--masses", "masses.csv"]) == 2
    assert message in capsys.readouterr().err
    assert not Path("genset").exists()


def test_what_is_no_workbook_says_so(here, capsys):
    good_tables()
    Path("mounts.xlsx").write_text("name, x [mm]")
    assert main(["new", "genset", "--mounts", "mounts.xlsx", "--masses", "masses.csv"]) == 2
    assert "mounts.xlsx: this is no XLSX file" in capsys.readouterr().err


CAD = """Mass properties of genset
     Configuration: Default
     Coordinate system: -- default --

Mass = 1200000.00 grams

Volume = 200000000.00 cubic millimeters

Center of mass: ( millimeters )
\tX = 10.00
\tY = -20.00
\tZ = 450.00

Principal axes of inertia and principal moments of inertia: ( grams *  square millimeters )
Taken at the center of mass.
\t Ix = (1.00, 0.00, 0.00)   \tPx = 100000000000.00

Moments of inertia: ( grams *  square millimeters )
Taken at the center of mass and aligned with the output coordinate system. (Using positive tensor notation.)
\tLxx = 100000000000.00\tLxy = 5000000000.00\tLxz = 0.00
\tLyx = 5000000000.00\tLyy = 450000000000.00\tLyz = -2000000000.00
\tLzx = 0.00\tLzy = -2000000000.00\tLzz = 440000000000.00

Moments of inertia: ( grams *  square millimeters )
Taken at the output coordinate system. (Using positive tensor notation.)
\tIxx = 343000000000.00\tIxy = 5000000000.00\tIxz = 0.00
"""


@pytest.mark.slow
def test_mass_properties_of_a_cad_program_are_read_with_their_sign(here, capsys):
    write("mounts.csv", MOUNTS, FEET)
    Path("genset.txt").write_text(CAD)
    for options in ([], ["--products", "positive"]):
        assert main(["new", "genset", "--mounts", "mounts.csv", "--masses", "genset.txt", *options, "--force"]) == 0
        mass, centre, inertia = compiled()
        assert mass == pytest.approx(1200.0, rel=1e-12)
        np.testing.assert_allclose(centre, [0.01, -0.02, 0.45], rtol=1e-12)
        # products of "positive tensor notation" are +sum x y dm; the digits as for tables
        np.testing.assert_allclose(inertia, [[100, -5, 0], [-5, 450, 2], [0, 2, 440]], rtol=1e-9, atol=1e-9)
    assert main(["new", "other", "--mounts", "mounts.csv", "--masses", "genset.txt", "--products", "tensor"]) == 2
    assert "is positive by the words of the text" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("grams\n", "stones\n", 'the unit "stones" is unknown'),
        ("Center of mass", "Middle", "the centre of mass is not found"),
        ("Lyx = 5", "Lyx = 6", "are not symmetric"),
        ("Lxx = 1", "Lxx = 9", "no body has these moments of inertia"),
        ("Mass = 12", "Mass = -12", "the mass must be > 0"),
    ],
)
def test_a_bad_text_of_a_cad_program_is_answered_in_one_message(here, old, new, message, capsys):
    write("mounts.csv", MOUNTS, FEET)
    Path("genset.txt").write_text(CAD.replace(old, new))
    code = main(["new", "genset", "--mounts", "mounts.csv", "--masses", "genset.txt"])
    assert code == 2
    assert message in capsys.readouterr().err
    assert not Path("genset").exists()


def test_names_of_users_are_text_in_the_model(here):
    write("mounts.csv", MOUNTS, [changed(row, c0=f'<m{n}>&"\u00e9$_$') for n, row in enumerate(FEET)])
    write("masses.csv", MASSES, PARTS)
    assert make() == 0
    assert '<m3>&"\u00e9$_$' in wr.load_system("genset/genset.xml").mounts


def test_an_isolator_beside_the_table_goes_into_the_folder(here):
    good_tables()
    device = wr.load_isolator(catalogue_folder() / "enidine_wr16_400.toml")
    device.save("mine.toml")
    write("mounts.csv", MOUNTS, [changed(row, c4="mine") for row in FEET])
    assert make() == 0
    assert wr.load_isolator("genset/isolators/mine.toml").axial == device.axial


def test_the_template_of_a_genset_weighs_what_its_tables_say():
    with (TABLES / "masses.csv").open() as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))[1:]
    assert sum(float(row[1]) for row in rows) == 1200.0


SUB = f"{MASSES}, frequency [Hz], damping [%], along"


def test_a_mass_with_a_frequency_rings_on_its_own_in_the_payload(here):
    good_tables()
    write("masses.csv", SUB, [*(f"{row}, , , " for row in PARTS), "drawer, 20, 100, 0, 900, , , , , 25, 3, "])
    assert make() == 0
    system = wr.load_system("genset/genset.xml")
    model, omega = system.model, 2.0 * np.pi * 25.0
    assert model.body("drawer").mass[0] == 20.0
    assert model.joint("drawer").stiffness[0] == pytest.approx(20.0 * omega**2, rel=1e-11)  # twelve digits
    assert model.dof_damping[model.joint("drawer").dofadr[0]] == pytest.approx(2 * 0.03 * 20.0 * omega, rel=1e-11)
    assert model.body("genset").subtreemass[0] == pytest.approx(1220.0, rel=1e-12)
    data = mujoco.MjData(model)
    mujoco.mj_setState(model, data, wr.equilibrium(system).state.values, mujoco.mjtState.mjSTATE_INTEGRATION)
    # its weight hangs in the spring as drawn, which a tilt of 10 mrad would change by g / omega^2 (1 - cos) = 2e-8 m
    assert data.qpos[model.joint("drawer").qposadr[0]] == pytest.approx(0.0, abs=1e-7)


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("drawer, 20, 0, 0, 900, , , , , 0, , ", '"frequency" > 0'),
        ("drawer, 20, 0, 0, 900, , , , , 25, 120, ", "below 100 %"),
        ("drawer, 20, 0, 0, 900, , , , , 25, 3, up", "x, y or z"),
        ("drawer, 20, 0, 0, 900, , , , , , 3, ", 'no "frequency"'),
        ("deck, 20, 0, 0, 900, , , , , 25, 3, ", "a body of its own"),
    ],
)
def test_a_subassembly_that_is_none_is_refused(here, row, message, capsys):
    good_tables()
    write("masses.csv", SUB, [*(f"{one}, , , " for one in PARTS), row])
    assert make() == 2
    assert message in capsys.readouterr().err


def test_a_payload_of_subassemblies_alone_is_refused(here, capsys):
    good_tables()
    write("masses.csv", SUB, [f"{one}, 25, 3, " for one in PARTS])
    assert make() == 2
    assert "what the mounts carry needs one without" in capsys.readouterr().err


def test_a_model_is_written_on_a_deck_that_bends(here):
    good_tables()
    assert make("--deck", "10 Hz 800 kg 4 %") == 0
    model = wr.load_system("genset/genset.xml").model
    assert model.body("deck_panel").mass[0] == 800.0
    assert make("--deck", "10 Hz", "--force") == 2
