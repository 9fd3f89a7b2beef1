"""Every command that writes, where no file may grow beyond what it needs: one message, exit code 2, whole files or none."""

import shutil

import numpy as np
import pytest
from commands import JOB
from small_study import write_study

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.cli.app import COMMANDS
from wirerope_mj.foundation.resources import models_folder

pytestmark = pytest.mark.slow

resource = pytest.importorskip("resource", reason="Windows has no limits of file sizes")

PULSE = ["--half-sine", "5 g 11 ms z", "--duration", "0.1"]
MAP = ["--map", "A0=base z g", "A1=body/block z g"]
EXPORTS = {f"export {ending}": ["export", "run", f"o.{ending}", "--force"] for ending in ("csv", "h5", "mat", "xlsx", "png")}
WRITING = {
    "shock": ["shock", "shock_table", *PULSE, "--out", "run", "--force"],
    "run": ["run", "shock_table", "--duration", "0.1", "--out", "other", "--force"],
    "cases": ["cases", "job.toml", "--out", "job", "--workers", "1", "--force"],
    "study": ["study", "small.py", "--variants", "8", "--workers", "1", "--out", "study", "--force"],
    "study-report": ["study-report", "study", "--out", "s.html", "--force"],
    "report": ["report", "run", "--out", "r.html", "--pdf", "--docx", "--force"],
    "calibrate": ["calibrate", "shock_table", "--test", "drop.csv", *MAP, "--vary", "mount/*/stiffness = Uniform(0.7, 1.4)",
                  "--draws", "100", "--out", "calibrated", "--force"],
    "compare": ["compare", "run", "other", "--out", "c.rrd", "--force"],
    "compare --map": ["compare", "run", "drop.csv", *MAP, "--out", "c.html", "--force"],
    "durability": ["durability", "run", "--exponent", "8", "--equivalent-psd", "block 60 s 5 to 80 Hz z", "--out", "d.csv"],
    **EXPORTS,
    "flexible": ["flexible", "modes.csv", "shapes.csv", "--points", "points.csv", "--units", "m,kg,s",
                 "--out", "part", "--force"],
    "fmu": ["fmu", "shock_table", "o.fmu", "--force"],
    "frf": ["frf", "sdof_shaker", "--acceleration", "1", "--start", "20", "--stop", "50", "--out", "frf", "--force"],
    "identify": ["identify", "cyclic.csv", "--law", "ozdemir", "--out", "identified.toml", "--force"],
    "isolators fit": ["isolators", "fit", "sheet.toml", "fit.toml"],
    "isolators estimate": ["isolators", "estimate", "--height", "90", "--width", "105", "--rope", "16", "--loops", "8",
                           "--out", "estimate.toml"],
    "isolators": ["isolators", "enidine_wr12_400", "--out", "isolator.pdf"],
    "levels": ["levels", "bv_043", "--out", "levels.toml", "--force"],
    "loops": ["loops", "enidine_wr12_400", "--axis", "axial", "--out", "l.png", "--csv", "l.csv"],
    "modes": ["modes", "shock_table", "--out", "modes", "--force"],
    "new": ["new", "genset", "--mounts", "tables/mounts.csv", "--masses", "tables/masses.csv", "--pdf", "--force"],
    "select": ["select", "--mass", "100", "--mounts", "4", "--shock", "half-sine 10 g 11 ms z", "--travel", "60",
               "--parts", "CB1400*", "--out", "selected", "--force"],
    "share": ["share", "run", "shared", "--force"],
    "statics": ["statics", "shock_table", "--json", "statics.json"],
}  # fmt: skip
NOTHING = {"comfort", "compile", "explore", "laws", "replay", "show"}
"""Commands that leave no file where the user asks for one."""

GOES_ON = {"cases", "study"}
"""Commands whose folder keeps what is done, and goes on with it."""


def test_every_command_that_writes_is_here():
    assert {words[0] for words in WRITING.values()} | NOTHING == set(COMMANDS)


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """Return a folder with all that the commands read, and what those wrote that others read."""
    folder = tmp_path_factory.mktemp("full")
    write_study(folder)
    shutil.copytree(models_folder() / "templates" / "genset", folder / "tables")
    shutil.copy(min((models_folder() / "isolators" / "datasheets").glob("*.toml")), folder / "sheet.toml")
    device = wr.load_isolator("enidine_wr12_400")
    wr.save_cyclic_test(wr.cyclic_test(device.axial, amplitudes=[0.002, 0.005, 0.01]), folder / "cyclic.csv")
    pulse = wr.HalfSine(peak=80.0, duration=0.011, direction="z", start=0.02)
    r = wr.simulate(wr.load_system("shock_table"), pulse, duration=0.3, sample_rate=2000.0, timestep=5e-4)
    columns = np.column_stack([r.time, r.base.acceleration[:, 2] / 9.81, r.bodies["block"].acceleration[:, 2] / 9.81])
    np.savetxt(folder / "drop.csv", columns, delimiter=",", header="time [s],A0,A1", comments="", fmt="%.7g")
    tables = {
        "job.toml": JOB,
        "modes.csv": "mode,frequency_Hz,damping,participation_x,participation_y,participation_z\n1,12,0.02,0,0,10\n",
        "shapes.csv": "point,mode,x,y,z\nm1,1,0,0,1\nm2,1,0,0,1\n",
        "points.csv": "point,x_m,y_m,z_m\nm1,0.5,0.4,0\nm2,-0.5,0.4,0\n",
    }
    for name, text in tables.items():
        (folder / name).write_text(text, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for name in ("shock", "run", "study"):
            assert main(WRITING[name]) == 0
    return folder


def files(folder):
    """Return the contents of all files below a folder, by their paths."""
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def limited(words, size):
    """Run a command here while no file may be larger [bytes]: that meets the same errors as a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        return main(words)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("name", WRITING)
def test_a_full_disk_is_one_message_and_leaves_whole_files(name, place, tmp_path, monkeypatch, capsys):
    folder, words = tmp_path / "work", WRITING[name]
    shutil.copytree(place, folder, symlinks=True)
    monkeypatch.chdir(folder)
    first = {path.stat().st_ino for path in files(folder)}
    assert main(words) in (0, 1)
    whole = files(folder)
    sizes = sorted({path.stat().st_size for path in whole if path.stat().st_ino not in first})
    capsys.readouterr()
    for size in (0, sizes[-1] // 2):
        before = files(folder)
        assert limited(words, size) == 2
        told = [line for line in capsys.readouterr().err.splitlines() if "the peaks and verdicts above hold" not in line]
        assert told
        assert "there is no space left" in told[-1]
        assert "Errno" not in told[-1]
        assert not [path for path in folder.rglob(".*wirerope*") if "wirerope" in path.name]
        if name not in GOES_ON:
            assert files(folder) == before
    if name in GOES_ON:
        again = [word for word in words if word != "--force"] + ["--resume"] * (name == "study")
        assert main(again) == 0
        assert {path.name for path in files(folder)} >= {path.name for path in whole}
