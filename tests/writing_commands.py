"""Every command that writes, in a folder that holds what they read, and something that each of them replaces."""

import shutil
from pathlib import Path

import numpy as np
from commands import JOB
from small_search import SEARCH_FILE
from small_study import write_study

import wirerope_mj as wr
from wirerope_mj.foundation.resources import models_folder

PULSE = ["--half-sine", "5 g 11 ms z", "--duration", "0.1"]
MAP = ["--map", "A0=base z g", "A1=body/block z g"]
EXPORTS = {f"export {ending}": ["export", "run", f"o.{ending}", "--force"] for ending in ("csv", "h5", "mat", "xlsx", "png")}
WRITING = {
    "shock": ["shock", "shock_table", *PULSE, "--out", "run", "--force"],
    "run": ["run", "shock_table", "--duration", "0.1", "--out", "other", "--force"],
    "cases": ["cases", "job.toml", "--out", "job", "--workers", "1", "--force"],
    "study": ["study", "small.py", "--variants", "8", "--workers", "1", "--out", "study", "--force"],
    "search": ["study", "search.py", "--workers", "1", "--out", "search", "--force"],
    "study-report": ["study-report", "study", "--out", "s.html", "--force"],
    "report": ["report", "run", "--out", "r.html", "--pdf", "--docx", "--force"],
    "calibrate": ["calibrate", "shock_table", "--test", "drop.csv", *MAP, "--vary", "mount/*/stiffness = Uniform(0.7, 1.4)",
                  "--draws", "100", "--out", "calibrated", "--force"],
    "compare": ["compare", "run", "other", "--out", "compared", "--force"],
    "compare .rrd": ["compare", "run", "other", "--out", "c.rrd", "--force"],
    "compare --map": ["compare", "run", "drop.csv", *MAP, "--out", "with_tests", "--force"],
    "durability": ["durability", "run", "--exponent", "8", "--equivalent-psd", "block 60 s 5 to 80 Hz z", "--out", "d.csv"],
    "check": ["check", "job.toml", "--json", "checked.json"],
    **EXPORTS,
    "film": ["film", "run", "o.mp4", "--at", "50 ms", "--force"],
    "flexible": ["flexible", "modes.csv", "shapes.csv", "--points", "points.csv", "--units", "m,kg,s",
                 "--out", "part", "--force"],
    "fmu": ["fmu", "shock_table", "o.fmu", "--force"],
    "frf": ["frf", "sdof_shaker", "--acceleration", "1", "--start", "20", "--stop", "50", "--out", "frf", "--force"],
    "identify": ["identify", "cyclic.csv", "--law", "ozdemir", "--out", "identified.toml", "--force"],
    "isolators fit": ["isolators", "fit", "sheet.toml", "fit.toml"],
    "isolators blank": ["isolators", "blank", "blank.toml", "--force"],
    "isolators export": ["isolators", "export", "enidine_wr12_400", "mount.bdf", "--amplitude-mm", "2", "--force"],
    "cases --blank": ["cases", "blank_job.toml", "--blank", "--force"],
    "isolators estimate": ["isolators", "estimate", "--height", "90", "--width", "105", "--rope", "16", "--loops", "8",
                           "--out", "estimate.toml"],
    "isolators": ["isolators", "enidine_wr12_400", "--out", "isolator.pdf"],
    "levels": ["levels", "bv_043", "--out", "levels.toml", "--force"],
    "loops": ["loops", "enidine_wr12_400", "--axis", "axial", "--out", "l.png", "--csv", "l.csv"],
    "modes": ["modes", "shock_table", "--out", "modes", "--force"],
    "new": ["new", "genset", "--mounts", "tables/mounts.csv", "--masses", "tables/masses.csv", "--pdf", "--force"],
    "schemas": ["schemas", "schemas", "--force"],
    "select": ["select", "--mass", "100", "--size", "400", "400", "400", "--mounts", "4", "--shock", "half-sine 10 g 11 ms z",
               "--travel", "60", "--parts", "CB1400*", "--out", "selected", "--force"],
    "share": ["share", "run", "shared", "--force"],
    "statics": ["statics", "shock_table", "--json", "statics.json"],
}  # fmt: skip
NOTHING = {"board", "comfort", "compile", "laws", "replay", "show"}
"""Commands that leave no file where the user asks for one."""

GOES_ON = {"cases"}
"""Commands whose folder keeps what is done, and goes on with it, also where all is asked for anew."""


def prepare(folder: Path) -> None:
    """Write all that the commands read into a folder, but for what other commands of them write."""
    folder.mkdir(exist_ok=True)
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
        "search.py": SEARCH_FILE,
        "modes.csv": "mode,frequency_Hz,damping,participation_x,participation_y,participation_z\n1,12,0.02,0,0,10\n",
        "shapes.csv": "point,mode,x,y,z\nm1,1,0,0,1\nm2,1,0,0,1\n",
        "points.csv": "point,x_m,y_m,z_m\nm1,0.5,0.4,0\nm2,-0.5,0.4,0\n",
    }
    for name, text in tables.items():
        (folder / name).write_text(text, encoding="utf-8")


FIRST = ("shock", "run", "study")
"""Commands whose results others read."""


def files(folder):
    """Return the contents of all files below a folder, by their paths."""
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}
