"""`wirerope calibrate` from a file to a folder, and what it says to bad input."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main

MAP = ["--map", "A0=base z g", "A1=body/block z g"]
VARY = ["--vary", "mount/*/stiffness = Uniform(0.7, 1.4)"]


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """Write the file of a drop of the shock table whose isolator is 15 % stiffer."""
    path = tmp_path_factory.mktemp("test") / "drop.csv"
    table = wr.load_system("shock_table")
    stiffer = wr.varied(table, isolators={"m1": table.mounts["m1"].written.scaled(1.15)})
    motion = wr.HalfSine(peak=80.0, duration=0.011, direction="z", start=0.02)
    r = wr.simulate(stiffer, motion, duration=0.5, sample_rate=2000.0, timestep=5e-4)
    noise = 0.02 * np.random.default_rng(1).standard_normal(r.time.size)
    columns = [r.time, r.base.acceleration[:, 2] / 9.80665, r.bodies["block"].acceleration[:, 2] / 9.80665 + noise]
    np.savetxt(path, np.column_stack(columns), delimiter=",", header="time [s],A0,A1", comments="", fmt="%.7g")
    return path


@pytest.fixture
def drop(file, tmp_path, monkeypatch):
    """Go to a folder with the file and with others that are wrong."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(file, "drop.csv")
    Path("short.csv").write_text("time [s],A0,A1\n" + "".join(f"{k},{k},{k}\n" for k in range(5)), encoding="utf-8")
    Path("few.csv").write_text("frequency [Hz], level [g], transmissibility\n5, 0.5, 1.2\n", encoding="utf-8")
    Path("none.csv").write_text("frequency [Hz], transmissibility\n5, 1.2\n", encoding="utf-8")
    return tmp_path


@pytest.mark.slow
def test_a_file_becomes_a_calibrated_model(drop, capsys):
    arguments = ["calibrate", "shock_table", "--test", "drop.csv", *MAP, *VARY, "--out", "out"]
    assert main([*arguments, "--predict", "half-sine 12 g 11 ms z", "--limit", "acceleration/block = 20 g"]) == 0
    printed = capsys.readouterr().out
    assert "acceleration/block: 20 g is exceeded with a probability of less than 0.1 %" in printed
    said = json.loads((drop / "out" / "calibration.json").read_text(encoding="utf-8"))
    (row,) = (row for row in said["values"]["rows"] if row[0] == "mount/*/stiffness")
    assert row[1] == pytest.approx(1.15, rel=0.01)
    system = wr.load_system(drop / "out" / "model" / "shock_table.xml")
    isolator = system.mounts["m1"].isolator
    assert isolator.spread is not None
    assert "calibrated from drop" in isolator.provenance.source
    before = wr.load_system("shock_table").mounts["m1"].isolator
    assert isolator.axial.parameter("laws[0].k1") == pytest.approx(row[1] * before.axial.parameter("laws[0].k1"), rel=1e-3)
    page = (drop / "out" / "report.html").read_text(encoding="utf-8")
    assert "Measured and calculated" in page
    assert main([*arguments]) == 2  # the folder is there
    assert "--force" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--test", "drop.csv", *MAP], "`--vary` must say what is to be found, with its prior"),
        ([*MAP, *VARY], "name the tests"),
        (["--test", "drop.csv", *VARY], "`--map` must say what the columns"),
        (["--test", "drop.csv", "--map", "A1=body/block z g", *VARY], "no column of the base"),
        (["--test", "drop.csv", *MAP, "--vary", "mount/*/stiffness"], "must be written like"),
        (["--test", "drop.csv", *MAP, "--vary", "mount/*/colour = Uniform(0, 1)"], "there is no quantity"),
        (["--test", "drop.csv", "--map", "A0=base z g", "A1=body/rack z g", *VARY], "another model's"),
        (["--test", "drop.csv", "--map", "A0=base z g", "A1=body/block z", *VARY], 'column "A1" has no unit'),
        (
            ["--test", "drop.csv", "--map", "A0=base z g", "A1=body/block axial g", *VARY],
            "the axis of a body is x, y or z",
        ),
        (["--test", "drop.csv", *MAP, *VARY, "--limit", "acceleration/block = 9 g"], "is on a prediction"),
        (["--test", "drop.csv", *MAP, *VARY, "--predict", "bang 9 g"], "names no kind of motion: half-sine"),
        (["--test", "short.csv", *MAP, *VARY], "at least 16 samples"),
        (["--frequency-response", "few.csv", *VARY], "must be FILE=PHRASE"),
        (["--frequency-response", "few.csv=body/block z", *VARY], "needs 5 rising frequencies"),
        (["--loops", "few.csv=body/block z", *VARY], "`--loops` must be FILE=PHRASE"),
        (["--loops", "few.csv=mount/m9 axial", *VARY], "few.csv"),
        (["--frequency-response", "none.csv=body/block z", *VARY], "'level' is missing"),
        (["--frequency-response", "few.csv=mount/m1 axial", *VARY], "is of a body"),
    ],
)
def test_bad_input_is_one_message(drop, capsys, arguments, message):
    assert main(["calibrate", "shock_table", *arguments, "--out", "out"]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert "Traceback" not in said
    assert not (drop / "out").exists()


@pytest.mark.slow
def test_loops_of_a_rig_tell_beside_a_record_what_it_does_not(drop):
    # accelerations alone fix stiffness over mass; a rig's loops fix stiffness, and so both
    rig = wr.cyclic_test(wr.load_system("shock_table").mounts["m1"].written.axial.scaled(1.15), [2e-3, 8e-3])
    for number, loop in enumerate(rig):
        np.savetxt(
            f"rig{number}.csv", np.column_stack([loop.deflection * 1e3, loop.force]), delimiter=",",
            header="deflection [mm],force [N]", comments="",
        )  # fmt: skip
    mass = ["--vary", "body/block/mass = Normal(1, 0.05, relative)"]
    loops = [word for k in range(len(rig)) for word in ("--loops", f"rig{k}.csv=mount/m1 axial")]
    assert main(["calibrate", "shock_table", "--test", "drop.csv", *MAP, *VARY, *mass, *loops, "--out", "out"]) == 0
    said = json.loads((drop / "out" / "calibration.json").read_text(encoding="utf-8"))
    rows = {row[0]: row for row in said["values"]["rows"]}
    assert rows["mount/*/stiffness"][1] == pytest.approx(1.15, rel=0.01)
    assert rows["body/block/mass"][1] == pytest.approx(1.0, rel=0.01)
    # the model runs as it is, its mass in it
    system = wr.load_system(drop / "out" / "model" / "shock_table.xml")
    before = wr.load_system("shock_table").model.body("block").mass[0]
    assert system.model.body("block").mass[0] == pytest.approx(before * rows["body/block/mass"][1], rel=1e-4)
    assert not (drop / "out" / "model" / "changes.toml").exists()
