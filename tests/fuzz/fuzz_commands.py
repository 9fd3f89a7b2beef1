"""Whole commands, called as the shell calls them: an option or two, or a file that they read, is strange."""

import contextlib
import io
import os
import re
import shutil
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
from campaign import Case
from generators import LARGE, NUMBERS, damaged, muddled, pick

import wirerope_mj as wr
from wirerope_mj.cli import main

SOME = (*(number for number in NUMBERS if number not in LARGE), "abc", "1 mm")
"""Numbers that ask for nothing that is large and possible all the same."""

STEPS = ("0", "nan", "-1", "1e-4", "1e400", "abc", "1e-15", "1e-308", "0.5", "1e-3", "inf", "")
"""Time steps of which no run has many."""

SHOCKS = ("15 g 11 ms half-sine", "2 m/s", "20 g 11 ms sawtooth")
SELECT = ("select", "--mass", "100", "--mounts", "4")
SIZES = dict.fromkeys(("--mass", "--mounts", "--drop", "--velocity", "--travel", "--fragility", "--disturbance-rpm",
                       "--disturbance-hz", "--isolation-ratio", "--loops"), SOME) | {"--shock": SHOCKS}  # fmt: skip
ESTIMATE = ("isolators", "estimate", "--height", "89", "--width", "105", "--rope", "12.7", "--loops", "8")
ALONE = (
    (1, ("statics", "shock_table"), {}), (4, ("modes", "shock_table"), {"--amplitude-mm": SOME}), (2, SELECT, SIZES),
    (4, (*SELECT, "--drop", "0.3"), SIZES), (3, (*SELECT, "--velocity", "2"), SIZES),
    (3, (*SELECT, "--shock", SHOCKS[0]), SIZES),
    (6, ("loops", "enidine_wr16_400", "--axis", "axial", "--amplitudes", "2"),
     dict.fromkeys(("--amplitudes", "--operating-point-mm", "--frequency", "--cycles"), SOME)),
    (3, ("fmu", "sdof_shaker", "o.fmu"), {"--timestep": SOME}),
    (1, ("levels", "bv_043"), {"--out": ("x.toml", "no/x.toml", "", "/")}),
    (8, ESTIMATE, dict.fromkeys(("--height", "--width", "--rope", "--loops", "--bar", "--bar-length"), SOME)),
    (3, ("shock", "sdof_shaker", "--half-sine", "3 g 5 ms z", "--duration", "0.02", "--timestep", "1e-3"),
     dict.fromkeys(("--duration", "--sample-rate", "--accuracy", "--start", "--scale"), SOME)
     | {"--half-sine": ("3 g 5 ms z",), "--timestep": STEPS, "--limit": ("acceleration/mass = 15 g",),
        "--direction": ("x", "1,1,0", "q")}),
    (1, ("study", "shock_table", "--vary", "motion/level = Uniform(0.5, 1)", "--variants", "2", "--duration", "0.06"),
     dict.fromkeys(("--variants", "--seed", "--duration"), SOME)
     | {"--vary": ("motion/level = Choice(1, 2)", "motion/level", "")}),
)  # fmt: skip
"""How often, words, and options with their strange values, of commands that read nothing of the user's."""

FILES = {
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
    "bracket.toml": "{isolator}\n[bracket]\nshear = 5e6\n",
    "job.toml": (
        'name = "Table"\nmodel = "shock_table"\nreport = ["accelerations", "mounts"]\n'
        "[simulate]\nduration = 0.03\ntimestep = 1e-3\n"
        '[[case]]\nname = "Down"\nhalf-sine = "5 g 11 ms -z"\n[limits]\n"acceleration/block" = "8 g"\n'
    ),
}  # fmt: skip
"""Files that are sound; an input damages one that its command reads."""

MAP = ("A0=base z g", "A1=body/block z g")
VARY = "mount/*/stiffness = Uniform(0.7, 1.4)"
QUICK = ("--duration", "0.03", "--timestep", "1e-3")
FRF = ("--start", "20", "--stop", "22", "--largest-step", "0.05")
READING = (
    (4, ("comfort", "RUN", "block"), {"--space": ("A", "D", ""), "--discard": SOME}, ()),
    (4, ("shock", "sdof_shaker", "--amplitude-table", "levels.csv 0.1 s z", *QUICK, "--out", "o"),
     {"--amplitude-table": ("levels.csv 0.1 s z",), "--timestep": STEPS}, ("levels.csv",)),
    (4, ("shock", "sdof_shaker", "--required-spectrum", "spectrum.csv 1 s z seed 1", *QUICK, "--out", "o"),
     {"--required-spectrum": ("spectrum.csv 1 s z damping 5 % seed 1",), "--scale": SOME}, ("spectrum.csv",)),
    (2, ("select", "--mass", "60", "--mounts", "4", "--shock", "half-sine 10 g 11 ms z", "--parts", "CB1400-15"),
     {"--mass": SOME, "--mounts": ("4+2", "4+", "+", "0", "1e9", "x", "5"), "--shock": ("half-sine 10 g 11 ms z", "2 m/s"),
      "--fragility": SOME, "--travel": SOME, "--limit": ("acceleration/equipment = 15 g", "clearance/equipment = 30 30 20 mm"),
      "--parts": ("CB1400-2*", "", "[", "nobody"), "--by": ("price", "mass", "height", "x"), "--take": ("CB1400-15", "x"),
      "--prices": ("prices.csv", "no.csv"), "--initial": ("relaxed", "x")}, ("prices.csv",)),
    (2, ("cases", "job.toml", "--out", "job", "--workers", "1"), {"--workers": ("0", "1", "-1", "x")}, ("job.toml",)),
    (2, ("calibrate", "shock_table", "--test", "drop.csv", "--map", *MAP, "--draws", "50", "--out", "c"),
     {"--vary": (VARY, VARY, "mount/*/stiffness", ""), "--draws": SOME, "--start": SOME, "--limit": ("acceleration = 15 g",),
      "--predict": ("half-sine 5 g 11 ms z",), "--residuals": ("srs", "x"), "--baseline": ("rest", "x"),
      "--frequency-response": ("answers.csv=body/block z",), "--loops": ("answers.csv=mount/m1 axial",)},
     ("drop.csv", "answers.csv")),
    (3, ("compare", "RUN", "drop.csv", "--map", *MAP, "--out", "c"),
     {"--start": SOME, "--clock": SOME, "--baseline": ("rest", "mean", "x"), "--gaps": ("fill", "x"),
      "--names": ("a", "", "a/b")}, ("drop.csv",)),
    (2, ("frf", "sdof_shaker", "--acceleration", "1", *FRF, "--out", "f"),
     dict.fromkeys(("--acceleration", "--start", "--stop", "--largest-step", "--smallest-step", "--periods", "--smoothing",
                    "--rate", "--orders", "--speed-rpm"), SOME), ()),
    (3, ("frf", "shock_table", "--acceleration", "1", "--deck", "10 Hz 800 kg 4 %", *FRF, "--out", "f"),
     {"--deck": ("10 Hz 800 kg 4 %",)}, ()),
    (5, ("flexible", "modes.csv", "shapes.csv", "--points", "points.csv", "--units", "m,kg,s", "--out", "p"),
     {"--units": ("mm,t,s", "kg,m,s", "", "m"), "--mass-kg": SOME, "--damping": SOME, "--highest-hz": SOME},
     ("modes.csv", "shapes.csv", "points.csv")),
    (4, ("new", "g", "--mounts", "mounts.csv", "--masses", "masses.csv"), {"--deck": ("18 Hz 3 t",)},
     ("mounts.csv", "masses.csv")),
    (3, ("loops", "bracket.toml", "--axis", "shear", "--amplitudes", "2"), {"--amplitudes": SOME}, ("bracket.toml",)),
    (2, ("durability", "RUN", "--exponent", "8", "--equivalent-psd", "block 60 s 5 to 80 Hz z"),
     {"--exponent": SOME, "--equivalent-psd": ("block 60 s 5 to 80 Hz z",), "--repetitions": SOME}, ()),
)  # fmt: skip
"""The same of commands that read a run and the files of a user, and which of these are damaged."""

NO_NUMBER = re.compile(r"(?<![\w.])[-+]?(?:nan|inf)(?![\w.])")


def called(rng, words, options, most):
    """Return the words of a command with up to so many strange options."""
    words = list(words)
    for _ in range(pick(rng, (1, 1, most)) if options else 0):
        name = pick(rng, list(options))
        value = pick(rng, options[name])
        value = muddled(rng, value) if " " in value and rng.random() < 0.75 else value
        if name in words:
            words[words.index(name) + 1] = value
        else:
            words += [name, value]
    return words


def case(words, folder):
    """Return the case of a command in a folder: it answers with finite numbers, or says what is wrong and exits with 2."""

    def use():
        here, out, err = Path.cwd(), io.StringIO(), io.StringIO()
        os.chdir(folder)
        try:
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                code = main(words)
        finally:
            os.chdir(here)
        message = err.getvalue().strip()
        if code == 2:
            if not message.startswith("wirerope: ") or "Traceback" in message:
                return f"exit code 2 and no message: {message[:200]}"
            raise ValueError(message)
        found = NO_NUMBER.search(out.getvalue())
        return f"it prints {found[0]}" if found else None

    return Case(f"{words[0]} {words[1:]!r:.220}", use)


def drawn(rng, commands):
    """Return one of the commands, the more often the larger its number."""
    often = np.array([often for often, *_ in commands], dtype=float)
    return commands[rng.choice(len(commands), p=often / often.sum())][1:]


def commands(rng, folder):
    """Commands that read nothing of the user's."""
    words = called(rng, *drawn(rng, ALONE), most=2)
    if rng.random() < 0.05:
        words.insert(
            int(rng.integers(1, len(words) + 1)), pick(rng, ("--nobody", "--out", "-1", "", "x", "--force", "\u00fc", "--"))
        )
    return case(words, folder)


@cache
def sound():
    """Return a folder with a run and the sound files, made once a process."""
    folder = Path(tempfile.mkdtemp(prefix="tools-"))
    assert main(["shock", "shock_table", "--half-sine", "5 g 11 ms z", "--duration", "0.3", "--out", str(folder / "run")]) == 0
    wr.Isolator(name="b", shear=wr.load_isolator("enidine_wr12_400").shear).save(folder / "isolator.toml")
    text = (folder / "isolator.toml").read_text(encoding="utf-8")
    for name, content in FILES.items():
        (folder / name).write_text(content.replace("{isolator}", text), encoding="utf-8")
    time = np.arange(300) / 1000.0
    pulse = np.where(time < 0.011, 5.0 * np.sin(np.pi * time / 0.011), 0.0)
    table = np.column_stack([time, pulse, 0.7 * pulse])
    np.savetxt(folder / "drop.csv", table, delimiter=",", header="time [s],A0,A1", comments="", fmt="%.6g")
    return folder


def tools(rng, folder):
    """Commands that read a run, a job, measured tests, parts and tables; an option or a file is strange."""
    words, options, files = drawn(rng, READING)
    words = [str(sound() / "run") if word == "RUN" else word for word in words]
    for path in sound().glob("*.*"):
        shutil.copy(path, folder)
    if not files or rng.random() < 0.5:
        return case(called(rng, words, options, most=2), folder)
    path = folder / pick(rng, files)
    if rng.random() < 0.4:
        path.write_bytes(damaged(rng, path.read_bytes())[1])
    else:
        lines = path.read_text(encoding="utf-8").split("\n")
        at = int(rng.integers(len(lines)))
        lines[at] = ",".join(muddled(rng, " ".join(lines[at].split(","))).split(" "))
        path.write_text("\n".join(lines), encoding="utf-8")
    return case(words, folder)
