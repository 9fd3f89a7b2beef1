"""Commands that stand in hostile folders, each audited: what they execute of the folder, how they end, what they print.
The package and the commands are those of the interpreter that runs this, one of a wheel, too; many folders are a campaign:
`python tests/fuzz/campaign.py hostile --inputs 200`.
"""

import shutil

import numpy as np
from commands import JOB
from hostile_folder import Hostile, audited
from table_study import table_study

import wirerope_mj as wr
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.runs.scenario import load_scenario

COMMANDS = (
    ["replay", "."], ["report", ".", "--pdf", "--force"], ["statics", "shock_table"], ["show", "."],
    ["compare", ".", "run", "--out", "c.rrd"], ["export", ".", "o.csv"], ["export", ".", "o.h5"],
    ["durability", ".", "--exponent", "5"], ["share", ".", "../shared"], ["fmu", "shock_table", "o.fmu"],
    ["run", "shock_table", "--duration", "0.06", "--out", "run", "--force"], ["modes", "shock_table", "--out", "m"],
    ["shock", "model/shock_table.xml", "--half-sine", "5 g 11 ms z", "--duration", "0.1", "--out", "run", "--force"],
    ["study", ".", "--vary", "motion/level = Normal(1, 0.1)", "--variants", "4", "--workers", "2", "--out", "s"],
    ["study-report", "study"], ["new", "n", "--template", "cabinet"], ["levels"], ["schemas", "j"],
    ["isolators", "enidine_wr12_400"],
    ["loops", "enidine_wr12_400", "--axis", "axial", "--csv", "l.csv"], ["laws", "cyclic.csv"],
    ["identify", "cyclic.csv", "--law", "bouc-wen", "--out", "i.toml"], ["board", "shock_table", "--no-browser"],
    ["frf", "sdof_shaker", "--acceleration", "1", "--out", "f"], ["compile"], ["schemas", "k"],
    ["select", "worksheet", "--mass", "100", "--mounts", "4", "--shock", "15 g 11 ms half-sine", "--travel", "30"],
    ["select", "--mass", "100", "--mounts", "4", "--shock", "half-sine 9 g 11 ms z", "--parts", "CB1400*", "--out", "c"],
    ["cases", "job.toml", "--out", "job", "--docx", "--workers", "2"], ["comfort", ".", "block"],
    ["compare", ".", "drop.csv", "--map", "A0=base z g", "A1=body/block z g", "--force"],
    ["calibrate", "shock_table", "--test", "drop.csv", "--map", "A0=base z g", "A1=body/block z g",
     "--vary", "mount/*/stiffness = Uniform(0.7, 1.4)", "--draws", "100", "--out", "k"],
    ["flexible", "modes.csv", "shapes.csv", "--points", "points.csv", "--units", "m,kg,s", "--out", "p"],
    ["export", ".", "o.xlsx"], ["export", ".", "o.png"], ["isolators", "fit", "sheet.toml", "fit.toml"],
    ["durability", ".", "--exponent", "8", "--equivalent-psd", "block 60 s 5 to 80 Hz z", "--out", "d.csv"],
    ["film", ".", "o.mp4", "--at", "30 ms"], ["check", "."],
)  # fmt: skip


def colleague(folder):
    """Write a folder with a run, its model, a study and records, as a colleague would send it."""
    wr.run_scenario(load_scenario("shock_table").make(duration=0.06), folder)
    wr.run_scenario(load_scenario("shock_table").make(duration=0.05), folder / "run")
    table_study(variants=4).run(folder / "study", workers=1)
    device = wr.load_isolator("enidine_wr12_400")
    wr.save_cyclic_test(wr.cyclic_test(device.axial, amplitudes=[0.002, 0.005, 0.01]), folder / "cyclic.csv")
    response = wr.simulate(wr.load_system("shock_table"), wr.HalfSine(peak=80.0, duration=0.011, direction="z"), duration=0.06)
    columns = [
        response.time,
        response.base.acceleration[:, 2] / 9.81,
        response.bodies["block"].acceleration[:, 2] / 9.81,
    ]
    np.savetxt(folder / "drop.csv", np.column_stack(columns), delimiter=",", header="time [s],A0,A1", comments="")
    (folder / "job.toml").write_text(JOB, encoding="utf-8")
    (folder / "modes.csv").write_text(
        "mode,frequency_Hz,damping,participation_x,participation_y,participation_z\n1,12,0.02,0,0,10\n",
        encoding="utf-8",
    )
    (folder / "shapes.csv").write_text("point,mode,x,y,z\nm1,1,0,0,1\nm2,1,0,0,1\n", encoding="utf-8")
    (folder / "points.csv").write_text("point,x_m,y_m,z_m\nm1,0.5,0.4,0\nm2,-0.5,0.4,0\n", encoding="utf-8")
    shutil.copy(min((models_folder() / "isolators" / "datasheets").glob("*.toml")), folder / "sheet.toml")


def faults(number, data, scratch):
    """Return the command of a number, and what is wrong with what it did in a copy of `data` made hostile by that number."""
    folder, mark, log = scratch / "inbox", scratch / "executed", scratch / "log"
    command = COMMANDS[number % len(COMMANDS)]
    shutil.copytree(data, folder)
    Hostile(folder, mark, number).write()
    ended, said, noted = audited(command, folder, log)
    found = [f"executed: {mark.name}"] * mark.exists() + [f"noted: {line}" for line in noted.splitlines()]
    found += [f"traceback: {said[-600:]}"] * ("Traceback" in said)
    found += [f"exit {ended}: {said[-600:]}"] * (ended not in (0, 1, 2, 130, 143))
    return command, found
