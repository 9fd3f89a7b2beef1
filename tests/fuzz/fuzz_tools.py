"""Commands that read a run, a job, measured tests, parts and tables, whose options and files are strange."""

import shutil
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
from campaign import Case
from fuzz_commands import SOME, STEPS
from fuzz_commands import use as use  # the same question of every command
from hostile import damaged, pick
from words import muddled

import wirerope_mj as wr
from wirerope_mj.cli import main

TABLES = {
    "levels.csv": "frequency [Hz],displacement [mm]\n5,1\n10,0.5\n20,0.2\n",
    "spectrum.csv": "frequency [Hz],acceleration [g]\n2,0.2\n10,1\n30,1\n",
    "modes.csv": (
        "mode,frequency_Hz,damping,participation_x,participation_y,participation_z\n1,12,0.02,0,0,10\n2,19,0.02,0,0,1\n"
    ),
    "shapes.csv": "point,mode,x,y,z\nm1,1,0,0,1\nm2,1,0,0,1\nm1,2,0,0,1\nm2,2,0,0,-1\n",
    "points.csv": "point,x_m,y_m,z_m\nm1,0.5,0.4,0\nm2,-0.5,0.4,0\n",
    "prices.csv": "name,price,mass [kg]\nCB1400-15,300,2\nCB1400-20,400,3\n",
    "answers.csv": "frequency [Hz], level [g], transmissibility\n5,0.5,1.2\n8,0.5,2\n10,0.5,3\n12,0.5,2\n20,0.5,0.7\n",
    "mounts.csv": (
        "name,x [mm],y [mm],z [mm],isolator,bracket_axial [kN/mm]\n"
        "m1,-300,-300,100,enidine_wr12_400,5\nm2,300,-300,100,enidine_wr12_400,5\nm3,0,300,100,enidine_wr12_400,5\n"
    ),
    "masses.csv": "name,mass [kg],x [mm],y [mm],z [mm],ixx [kg m^2],iyy [kg m^2],izz [kg m^2]\nengine,120,0,-100,300,5,6,7\n",
    "bracket.toml": '{isolator}\n[bracket]\nshear = 5e6\n',
    "job.toml": (
        'name = "Table"\nmodel = "shock_table"\nreport = ["accelerations", "mounts"]\n'
        '[simulate]\nduration = 0.03\ntimestep = 1e-3\n'
        '[[case]]\nname = "Down"\nhalf-sine = "5 g 11 ms -z"\n[limits]\n"acceleration/block" = "8 g"\n'
    ),
}  # fmt: skip
"""Files that are sound; each input damages one that its command reads."""

MAP = ("A0=base z g", "A1=body/block z g")
VARY = "mount/*/stiffness = Uniform(0.7, 1.4)"
QUICK = ("--duration", "0.03", "--timestep", "1e-3")
FRF = ("--start", "20", "--stop", "22", "--largest-step", "0.05")
COMMANDS = (
    (4.0, ("comfort", "RUN", "block"), {"--space": ("A", "D", ""), "--discard": SOME}, ()),
    (4.0, ("shock", "sdof_shaker", "--amplitude-table", "levels.csv 0.1 s z", *QUICK, "--out", "o"),
     {"--amplitude-table": ("levels.csv 0.1 s z",), "--timestep": STEPS}, ("levels.csv",)),
    (4.0, ("shock", "sdof_shaker", "--required-spectrum", "spectrum.csv 1 s z seed 1", *QUICK, "--out", "o"),
     {"--required-spectrum": ("spectrum.csv 1 s z damping 5 % seed 1",), "--scale": SOME}, ("spectrum.csv",)),
    (2.0, ("select", "--mass", "60", "--mounts", "4", "--shock", "half-sine 10 g 11 ms z", "--parts", "CB1400-15"),
     {"--mass": SOME, "--mounts": ("4+2", "4+", "+", "0", "1e9", "x", "5"), "--shock": ("half-sine 10 g 11 ms z", "2 m/s"),
      "--fragility": SOME, "--travel": SOME, "--limit": ("acceleration/equipment = 15 g", "clearance/equipment = 30 30 20 mm"),
      "--parts": ("CB1400-2*", "", "[", "nobody"), "--by": ("price", "mass", "height", "x"), "--take": ("CB1400-15", "x"),
      "--prices": ("prices.csv", "no.csv"), "--initial": ("relaxed", "x")}, ("prices.csv",)),
    (2.0, ("cases", "job.toml", "--out", "job", "--workers", "1"), {"--workers": ("0", "1", "-1", "x")}, ("job.toml",)),
    (2.0, ("calibrate", "shock_table", "--test", "drop.csv", "--map", *MAP, "--draws", "50", "--out", "c"),
     {"--vary": (VARY, VARY, "mount/*/stiffness", ""), "--draws": SOME, "--start": SOME, "--limit": ("acceleration = 15 g",),
      "--predict": ("half-sine 5 g 11 ms z",), "--residuals": ("srs", "x"),
      "--frequency-response": ("answers.csv=body/block z",),
      "--loops": ("answers.csv=mount/m1 axial",), "--baseline": ("rest", "x")}, ("drop.csv", "answers.csv")),
    (3.0, ("compare", "RUN", "drop.csv", "--map", *MAP, "--out", "c.html"),
     {"--start": SOME, "--clock": SOME, "--baseline": ("rest", "mean", "x"), "--gaps": ("fill", "x"),
      "--names": ("a", "", "a/b")}, ("drop.csv",)),
    (2.0, ("frf", "sdof_shaker", "--acceleration", "1", *FRF, "--out", "f"),
     {"--acceleration": SOME, "--start": SOME, "--stop": SOME, "--largest-step": SOME, "--smallest-step": SOME,
      "--periods": SOME, "--smoothing": SOME, "--rate": SOME, "--orders": SOME, "--speed-rpm": SOME}, ()),
    (3.0, ("frf", "shock_table", "--acceleration", "1", "--deck", "10 Hz 800 kg 4 %", *FRF, "--out", "f"),
     {"--deck": ("10 Hz 800 kg 4 %",)}, ()),
    (5.0, ("flexible", "modes.csv", "shapes.csv", "--points", "points.csv", "--units", "m,kg,s", "--out", "p"),
     {"--units": ("mm,t,s", "kg,m,s", "", "m"), "--mass-kg": SOME, "--damping": SOME, "--highest-hz": SOME},
     ("modes.csv", "shapes.csv", "points.csv")),
    (4.0, ("new", "g", "--mounts", "mounts.csv", "--masses", "masses.csv"), {"--deck": ("18 Hz 3 t",)},
     ("mounts.csv", "masses.csv")),
    (3.0, ("loops", "bracket.toml", "--axis", "shear", "--amplitudes", "2"), {"--amplitudes": SOME}, ("bracket.toml",)),
    (2.0, ("durability", "RUN", "--exponent", "8", "--equivalent-psd", "block 60 s 5 to 80 Hz z"),
     {"--exponent": SOME, "--equivalent-psd": ("block 60 s 5 to 80 Hz z",), "--repetitions": SOME}, ()),
)  # fmt: skip
WEIGHTS = np.array([weight for weight, *_ in COMMANDS])


@cache
def made() -> Path:
    """Return a folder with a run and the sound files, made once a process."""
    folder = Path(tempfile.mkdtemp(prefix="tools-"))
    assert main(["shock", "shock_table", "--half-sine", "5 g 11 ms z", "--duration", "0.3", "--out", str(folder / "run")]) == 0
    isolator = wr.load_isolator("enidine_wr12_400")
    wr.Isolator(name="b", shear=isolator.shear).save(folder / "isolator.toml")
    text = (folder / "isolator.toml").read_text(encoding="utf-8")
    for name, content in TABLES.items():
        (folder / name).write_text(content.replace("{isolator}", text), encoding="utf-8")
    time = np.arange(300) / 1000.0
    pulse = np.where(time < 0.011, 5.0 * np.sin(np.pi * time / 0.011), 0.0)
    table = np.column_stack([time, pulse, 0.7 * pulse])
    np.savetxt(folder / "drop.csv", table, delimiter=",", header="time [s],A0,A1", comments="", fmt="%.6g")
    return folder


def mutate(rng: np.random.Generator, folder: Path) -> Case:
    """Make a command of which an option or a file is strange."""
    _, given, options, files = COMMANDS[int(rng.choice(len(COMMANDS), p=WEIGHTS / WEIGHTS.sum()))]
    words, hurt = [str(made() / "run") if word == "RUN" else word for word in given], ""
    for path in made().glob("*.*"):
        shutil.copy(path, folder)
    if files and rng.random() < 0.5:
        hurt = pick(rng, files)
        path = folder / hurt
        if rng.random() < 0.4:
            path.write_bytes(damaged(path.read_bytes(), rng))
        else:
            lines = path.read_text(encoding="utf-8").split("\n")
            number = int(rng.integers(len(lines)))
            lines[number] = ",".join(muddled(rng, " ".join(lines[number].split(","))).split(" "))
            path.write_text("\n".join(lines), encoding="utf-8")
    for _ in range(pick(rng, (1, 1, 2)) if options and not hurt else 0):
        name = pick(rng, list(options))
        value = pick(rng, options[name])
        value = muddled(rng, value) if " " in value and rng.random() < 0.8 else value
        if name in words:
            words[words.index(name) + 1] = value
        else:
            words += [name, value]
    return Case(f"{given[0]} {hurt} {words[1:]!r:.220}", {"arguments": words, "folder": folder})
