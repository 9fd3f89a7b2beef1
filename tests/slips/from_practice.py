"""Slips that practitioners make in whole files: tables with wall mounts, data sheets, densities, channels, study files."""

import re
from collections.abc import Callable

import numpy as np

from tests.slips.foreign_inputs import earthquake, half_sine, text
from tests.slips.models_and_tables import columns, put, times
from tests.slips.planting import Base, Slip
from tests.slips.records_and_jobs import on_rows
from tests.slips.right_inputs import CABINET, GENSET, ISOLATORS, TWO_STAGE
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.resources import models_folder

MOUNTS, MASSES, STOPS, POINTS = "mounts.csv", "masses.csv", "stops.csv", "points.csv"
_STOPS = "name,x [mm],y [mm],z [mm],gap [mm],stiffness [MN/m],damping [kN s/m]\n"
CAMERA = Base("camera", {
    MOUNTS: "name,x [mm],y [mm],z [mm],isolator\nm1,-120,-80,15,WR4-400\nm2,120,-80,15,WR4-400\nm3,-120,80,15,WR4-400\n"
    "m4,120,80,15,WR4-400\n",
    MASSES: "name,mass [kg],x [mm],y [mm],z [mm],size_x [mm],size_y [mm],size_z [mm]\nhousing,12,0,0,130,300,220,190\n"
    "lens,4,90,0,150,160,120,120\nplate,9,0,0,40,300,240,12\n",
    STOPS: f"{_STOPS}t1,-100,0,15,11,1,0.5\nt2,100,0,15,11,1,0.5\n",
    POINTS: "name,x [mm],y [mm],z [mm]\nfront,170,0,150\n",
})  # fmt: skip
WALLED = Base("cabinet at a wall", {
    MOUNTS: "name,x [mm],y [mm],z [mm],isolator,direction_x,direction_y,direction_z\n"
    + "".join(f"b{n},{x},{y},54,enidine_wr16_700,0,0,1\n" for n, (x, y) in enumerate(
        ((-300, -300), (300, -300), (-300, 300), (300, 300)), start=1))
    + "w1,-250,454,1700,enidine_wr16_700,0,-1,0\nw2,250,454,1700,enidine_wr16_700,0,-1,0\n",
    MASSES: "name,mass [kg],x [mm],y [mm],z [mm],size_x [mm],size_y [mm],size_z [mm]\nframe,120,0,0,1008,800,800,1800\n"
    "drawers,300,0,-20,850,600,600,1400\n",
    STOPS: f"{_STOPS}t1,-250,0,54,45,5,8\nt2,250,0,54,45,5,8\n",
    POINTS: "name,x [mm],y [mm],z [mm]\ntop,0,0,1908\n",
})  # fmt: skip
FOLDERS = (GENSET, WALLED, CAMERA)
MIXED = (WALLED, CAMERA)  # upright mounts at one height
LONGITUDINAL = tuple(
    Base(f"{base.name} on inclined mounts", {**base.files,
         MOUNTS: "name,x [mm],y [mm],z [mm],isolator,inclination [deg],azimuth [deg]\n"
    + "".join(f"m{x}{y},{x},{y},{z},{isolator},30,{90 if y < 0 else -90}\n" for x in (-far, far) for y in (-far, far))})
    for base, far, z, isolator in ((GENSET, 500, 100, "enidine_wr20_600"), (WALLED, 300, 54, "enidine_wr16_700"),
         (CAMERA, 110, 15, "WR4-400"))
)  # fmt: skip


def sheet(name: str) -> Base:
    """Return a data sheet of the catalogue."""
    words = (models_folder() / f"isolators/datasheets/{name}.toml").read_text(encoding="utf-8")
    return Base(f"sheet {name}", {"sheet.toml": words}, "sheet.toml")


SHEETS = tuple(map(sheet, ("enidine_wr16_400", "enidine_wr12_400", "socitec_cb1400_30")))
PROFILES = tuple(Base(f"profile {number}", {"p.csv": words}, "p.csv") for number, words in enumerate((
    "frequency [Hz],psd [g^2/Hz]\n5,0.001\n20,0.002\n100,0.002\n200,0.0005\n",
    "frequency [Hz],psd [g^2/Hz]\n20,0.01\n80,0.04\n350,0.04\n2000,0.007\n",
    "frequency [Hz],psd [(m/s^2)^2/Hz]\n5,0.02\n20,0.05\n150,0.001\n",
)))  # fmt: skip
FLOORS = tuple(Base(f"floor {number}", {"s.csv": words}, "s.csv") for number, words in enumerate((
    "frequency [Hz],acceleration [g]\n1,0.2\n4,0.9\n10,0.9\n33,0.35\n", "frequency [Hz],acceleration "
    "[g]\n1,1.3\n2,2.4\n8,2.4\n30,0.9\n",
    "frequency [Hz],acceleration [m/s^2]\n0.5,1.5\n2,8\n9,8\n33,3\n",
)))  # fmt: skip


def _study(model: str, peak: float, duration: float, stiffness: str, body: str) -> Base:
    words = (
        f'"""How far does it scatter?"""\n\nimport wirerope_mj as wr\n\n\ndef study(*, variants: int = 64) -> wr.Study:\n'
        '    """Return the study.\n\n    Args:\n        variants: how many.\n    """\n'
        f'    return wr.Study(\n        model="{model}", variants=variants, duration={duration},\n'
        f'        motion=wr.HalfSine(peak={peak}, duration=0.011, direction="z", start=0.02),\n        vary={{\n'
        f'            "mount/{stiffness}/stiffness": wr.Normal(1.0, 0.1), "motion/level": wr.Uniform(0.85, 1.15),\n'
        f'            "body/{body}/mass": wr.Normal(1.0, 0.05, relative=True),\n        }},\n    )\n'
    )
    return Base(f"study file of {model}", {"study.py": words}, "study.py")


STUDIES = (
    _study("shock_table.xml", 150.0, 0.3, "m1", "block"), _study("cabinet.xml", 120.0, 0.5, "m*", "rack"),
    _study("floating_floor.xml", 90.0, 0.6, "m*", "floor"),
)  # fmt: skip
DECKS = tuple(
    Base(f"struck deck {phrase}", {"levels.toml": f'[[motion]]\nstruck-deck = "{phrase} z at 20 ms"\n'}, "levels.toml")
    for phrase in (
        "14 Hz 1.5 m/s damping 5 % blow 4 ms",
        "8 Hz 1.2 m/s damping 4 % blow 6 ms",
        "25 Hz 2 m/s damping 6 % blow 3 ms",
    )
)


def _axes(rate: float, length: float, peaks: tuple[float, ...]) -> str:
    time, _ = half_sine(rate, length, peak=1.0, lasts=0.008, at=0.2)
    courses = [half_sine(rate, length, peak=peak, lasts=0.008, at=0.2, seed=10 + n)[1] for n, peak in enumerate(peaks)]
    return text(
        ["time [s],x [g],y [g],z [g]"], [[f"{value:.6g}" for value in row] for row in np.column_stack([time, *courses])]
    )


def _ground() -> str:
    time, _ = earthquake(200.0, 30.0, peak=1.0)
    courses = [earthquake(200.0, 30.0, peak=peak, seed=seed)[1] for peak, seed in ((2.0, 3), (1.5, 5), (1.1, 8))]
    return text(
        ["time [s],x [m/s^2],y [m/s^2],z [m/s^2]"], [[f"{v:.6g}" for v in row] for row in np.column_stack([time, *courses])]
    )


TRIAXIAL = (
    Base("drop, three axes", {"r.csv": _axes(10_000.0, 0.6, (2.0, 1.2, 40.0))}, "r.csv"),
    Base("table, three axes", {"r.csv": _axes(4000.0, 0.8, (15.0, 3.0, 1.0))}, "r.csv"),
    Base("ground, three axes", {"r.csv": _ground()}, "r.csv"),
)
SHOCKS = TRIAXIAL[:2]


def changed(change: Callable[[Array, Array], Array]) -> Callable[[str], str]:
    """Change all channels of a record, given with its time."""
    return on_rows(lambda rows: np.column_stack([rows[:, :1], change(rows[:, :1], rows[:, 1:])]))


def _dead(_: Array, a: Array) -> Array:
    return np.column_stack([a[:, :-1], np.zeros(len(a))])


def _copied(_: Array, a: Array) -> Array:
    return np.column_stack([a[:, 0], a[:, 0], a[:, 2:]])


def _coarse(_: Array, a: Array) -> Array:
    step = np.abs(a).max(axis=0) / 5.0
    return step * np.round((a + 0.4 * step * np.random.default_rng(3).standard_normal(a.shape)) / step)


def _humming(time: Array, a: Array) -> Array:
    return a + 0.06 * np.abs(a).max(axis=0) * np.sin(2.0 * np.pi * 50.0 * time)


def _integrated(time: Array, a: Array) -> Array:
    return np.cumsum(a, axis=0) * float(time[1, 0] - time[0, 0]) * 9.80665


def _scaled(change: Callable[[float, float], tuple[float, float]]) -> Callable[[str], str]:
    return on_rows(lambda rows: np.array([change(*row) for row in rows.tolist()]))


def _one_off(rows: Array) -> Array:
    changed = rows.copy()
    changed[1, 1] *= 1000.0
    return changed


def number(pattern: str, change: Callable[[float], float]) -> Callable[[str], str]:
    """Change the number behind every match of a pattern."""
    return lambda words: re.sub(
        rf"({pattern})([-\d.e+]+)", lambda m: f"{m[1]}{change(float(m[2])):.8g}", words, flags=re.MULTILINE
    )


def cell(index: int, name: str, change: Callable[[float], float]) -> Callable[[str], str]:
    """Change one cell of a table without comments."""

    def plant(words: str) -> str:
        comments = [line for line in words.splitlines() if line.startswith("#")]
        head, *rows = [[cell.strip() for cell in line.split(",")] for line in words.splitlines() if not line.startswith("#")]
        column = next(n for n, title in enumerate(head) if title.split(" ")[0] == name)
        rows[index][column] = f"{change(float(rows[index][column])):g}"
        return "\n".join([*comments, *(",".join(cells) for cells in (head, *rows))]) + "\n"

    return plant


def _limits(lines: str) -> Callable[[str], str]:
    return put("<custom>", f"<custom>{lines}")


IN_TABLES = (
    Slip("centre of mass below all mounts", FOLDERS, columns("z", times(-1)), "below the mounts", MASSES),
    Slip("masses from another origin", FOLDERS, columns("x", lambda x: x + 2000.0), "outside the area", MASSES),
    Slip("one mount's height with a digit too many", FOLDERS, cell(0, "z", times(20)), "is its own right", MOUNTS),
    Slip("all inclined mounts lean one way", LONGITUDINAL, put(",-90$", ",90"), "all lean towards", MOUNTS),
    Slip("one mount among others lies on its side", MIXED[:1], put("^b1(.*),0,0,1$", r"b1\1,1,0,0"),
         "direction right|leads away", MOUNTS),
    Slip("y and z of mounts exchanged beside a wall", MIXED, put(r"^(\w+,[-\d]+),([-\d]+),([-\d]+),", r"\1,\3,\2,"),
         "above each other|z is up|leads away", MOUNTS),
    Slip("one mount ten times as strong", (CAMERA,), put("^m1(.*)WR4-400", r"m1\1enidine_wr16_400"), "right isolator", MOUNTS),
    Slip("stop's stiffness by a thousand", FOLDERS, columns("stiffness", times(1e3)), '"stiffness" in other units', STOPS),
    Slip("stop's damping in N s/m", FOLDERS, columns("damping", times(1e3)), '"damping" in other units', STOPS),
    Slip("stop's gap ten times the mounts'", FOLDERS, columns("gap", times(10)), "pressed flat before", STOPS),
    Slip("stops from another origin", FOLDERS, columns("x", lambda x: x + 4000.0), "check columns|stands outside", STOPS),
    Slip("points in m where mm is said", FOLDERS, columns("x y z", times(1e-3)), "in m where the header says mm", POINTS),
)  # fmt: skip
IN_MODELS = (
    Slip("a mount between two stages turned round", (TWO_STAGE,), put(
        r'objname="machine/upper1"(.*\n.*)objname="raft/upper1"', r'objname="raft/upper1"\1objname="machine/upper1"'
    ), "Swap its two sites"),
    Slip("a damper in the payload's free joint", (CABINET, TWO_STAGE), put(
        r'<freejoint name="(rack|machine)"/>', r'<joint name="\1" type="free" damping="5000"/>'
    ), "the world at rest"),
    Slip("a mount's load limit in kN", (TWO_STAGE,), _limits('<numeric name="limit/load/lower1" data="5"/>'), "is it in kN"),
    Slip("an acceleration limit in mm/s^2", (TWO_STAGE,),
         _limits('<numeric name="limit/acceleration/machine" data="98066"/>'), r"mm/s\^2"),
    Slip("limits for limit", (TWO_STAGE,), _limits('<numeric name="limits/acceleration/machine" data="98"/>'),
         "a limit is called"),
    Slip("the mass beside all mounts, some at a wall", (CABINET,), put(r'(rack_shell".*)pos="-0.015 0 ',
         r'\1pos="-0.015 9 '), "outside the area"),
)  # fmt: skip
IN_ISOLATORS = (
    Slip("k1 negative", ISOLATORS, number("^k1 = ", times(-1)), "instead of resisting|signs"),
    Slip("beta with m for mm", ISOLATORS, number("^beta = ", times(1e6)), "friction is lost"),
    Slip("sheet with N/m for N/mm", SHEETS, number(r"^(?:vibration|shock)_stiffness_\w+ = ", times(1e3)),
         "stiffnesses in another unit"),
    Slip("sheet with lb/in for N/mm", SHEETS, number(r"^(?:vibration|shock)_stiffness_\w+ = ", times(5.71)),
         "stiffnesses in another unit"),
    Slip("sheet with a load in kg", SHEETS, number(r"^static_load_\w+ = ", times(1 / 9.80665)), "in kg"),
)  # fmt: skip
IN_FILES = (
    Slip("one point of a density off by a thousand", PROFILES, on_rows(_one_off), "a digit wrong"),
    Slip("a density without a unit", PROFILES, put(r"psd \[.*\]", "psd"), "no unit"),
    Slip("a density of aerospace in (m/s2)2/Hz", PROFILES[1:2], _scaled(lambda f, s: (f, 96.17 * s)), r"\(m/s\^2\)\^2/Hz"),
    Slip("a spectrum in cm/s2 for g", FLOORS[:2], _scaled(lambda f, a: (f, 981.0 * a)), "in another unit"),
    Slip("a spectrum's frequencies in kHz", FLOORS, _scaled(lambda f, a: (1e-3 * f, a)), "in kHz"),
    Slip("a dead channel", TRIAXIAL, changed(_dead), "zero throughout"),
    Slip("a column copied", TRIAXIAL, changed(_copied), "equal from sample to sample"),
    Slip("a recorder's range far too wide", TRIAXIAL, changed(_coarse), "levels alone"),
    Slip("hum before the shock", SHOCKS, changed(_humming), "hum of the mains"),
    Slip("a velocity for an acceleration", SHOCKS[:1], changed(_integrated), "is it one, in m/s"),
    Slip("a blow of seconds", DECKS, put("blow (.) ms", r"blow \1 s"), "ms meant"),
    Slip("a deck's velocity in mm/s", DECKS, number(r"Hz ", times(1e3)), "Hz and m/s"),
)  # fmt: skip
IN_STUDIES = (
    Slip("a deviation in per cent, study file", STUDIES, put(r"Normal\(1.0, 0.1\)", "Normal(1.0, 10)"), "low="),
    Slip("factors in per cent, study file", STUDIES, put(r"Normal\(1.0, 0.1\)", "Normal(100, 10)"), "per cent"),
    Slip("a mass for a factor", STUDIES, put(r"Normal\(1.0, 0.05,", "Normal(300.0, 15.0,"), "leave out `relative`"),
    Slip("a factor for a mass", STUDIES, put(", relative=True", ""), "say `relative`"),
    Slip("levels that change their sign", STUDIES, put(r"Uniform\(0", "Uniform(-0"), "turn the motion round"),
    Slip("an azimuth in radians", STUDIES, put('"motion/level"',
         '"motion/azimuth": wr.Uniform(0, 6.2832), "motion/level"'), "look like radians"),
    Slip("a peak a thousandth, study file", STUDIES, number("peak=", times(1e-4)), "no mount feels"),
    Slip("a peak a hundred times, study file", STUDIES, number("peak=", times(100)), "more than shock tests do"),
    Slip("a pulse of 11 s, study file", STUDIES, put("duration=0.011", "duration=11"), "ms meant"),
    Slip("a study that ends before its pulse", STUDIES, put(r"duration=0\.\d,", "duration=0.01,"), "ends the simulation"),
    Slip("a study of minutes", STUDIES, put(r"duration=0\.\d,", "duration=300,"), "ms meant"),
)  # fmt: skip
SLIPS = (*IN_TABLES, *IN_MODELS, *IN_ISOLATORS, *IN_FILES, *IN_STUDIES)
