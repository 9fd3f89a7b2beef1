"""Inputs that are accepted as they stand, spelled otherwise or changed in their meaning: jobs, tables of models, service lives,
calibrations, flexible parts, decks.

Spelled otherwise (another unit with the value in it, other order, encoding, separator) an input must be taken, and mean the
same. With another number, sign or unit it must be refused, or mean something else. With a number at the end of what a
computer holds it must be refused, or mean something finite. What it means is all that is computed from it, as one array.
"""

import csv
import io
import tempfile
import tomllib
import warnings
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import tomli_w
from campaign import Case
from fuzz_studies import SYSTEM, short_run
from generators import NUMBERS, pick

import wirerope_mj as wr
from wirerope_mj.assessment.durability.mission import mission_damage, read_mission
from wirerope_mj.engine.flexible import load_flexible, panel_of_phrase, save_flexible
from wirerope_mj.engine.from_tables import mjcf_of, read_layout
from wirerope_mj.foundation.units import ACCELERATION_UNITS, LENGTH_UNITS, TIME_UNITS, UNITS
from wirerope_mj.runs.job_file import load_job
from wirerope_mj.runs.measured import read_map
from wirerope_mj.studies.calibration.forward import SystemForward
from wirerope_mj.studies.calibration.measured_test import MeasuredTest
from wirerope_mj.studies.vary.vary_option import read_vary

SPELLED = {
    "length": LENGTH_UNITS, "mass": {"kg": 1.0, "t": 1e3}, "time": TIME_UNITS, "frequency": {"Hz": 1.0, "kHz": 1e3},
    "ratio": {"%": 0.01}, "acceleration": ACCELERATION_UNITS, "angle": UNITS["angle"], "stiffness": UNITS["stiffness"],
    "damping": UNITS["damping"], "force": UNITS["force"], "velocity": UNITS["velocity"], "speed": {"m/s": 1.0, "mm/s": 1e-3},
}  # fmt: skip
KINDS = ("job", "tables", "mission", "calibration", "part", "deck")
OFTEN = (0.17, 0.15, 0.08, 0.03, 0.35, 0.22)  # by what they cost
SAME = 1e-5  # by which numbers with ten digits in another unit, and what is computed from them, may differ


@dataclass
class Number:
    """A number of an input, with its unit and the kind of quantity; "" for none."""

    value: float
    unit: str = ""
    quantity: str = ""
    text: str = ""  # in place of the value, where it is none any more

    def __str__(self) -> str:
        return f"{self.text or f'{self.value:.13g}'} {self.unit}".rstrip()


def n(value, unit="", quantity=""):
    return Number(float(value), unit, quantity)


def deck():
    frequency, mass, ratio = n(11, "Hz", "frequency"), n(900, "kg", "mass"), n(4, "%", "ratio")
    return [frequency, mass, ratio], lambda folder: {"deck": " ".join(map(str, (frequency, mass, ratio)))}


def job():
    peak, width, start = n(15, "g", "acceleration"), n(11, "ms", "time"), n(50, "ms", "time")
    limit, level, low, high, rate = n(9, "g", "acceleration"), n(0.5, "g", "acceleration"), n(5), n(30), n(60)
    speed, duration, samples, timestep = n(0.8, "m/s", "speed"), n(0.5), n(2000), n(2e-4)

    def files(folder):
        return {"job.toml": (
            f'name = "Table"\nmodel = "shock_table"\n[simulate]\nduration = {duration}\nsample_rate = {samples}\n'
            f'timestep = {timestep}\n[[case]]\nname = "a"\nhalf-sine = "{peak} {width} z at {start}"\n[[case]]\nname = "b"\n'
            f'sweep = "{level} {low} to {high} Hz {rate} oct/min z"\n[[case]]\nname = "c"\n'
            f'velocity-step = "{speed} x at 1 ms"\n[limits]\n"acceleration/block" = "{limit}"\n'
        )}  # fmt: skip

    return [peak, width, start, limit, level, low, high, rate, speed, duration, samples, timestep], files


def table(names, rows, units):
    """Return the text of a table whose columns have units."""
    out = io.StringIO()
    heads = [f"{name} [{units[name]}]" if units.get(name) else name for name in names]
    csv.writer(out, lineterminator="\n").writerows([heads, *rows])
    return out.getvalue()


FIRST = {"mass": "kg", "length": "mm", "angle": "deg", "stiffness": "MN/m", "damping": "kN s/m", "gap": "mm"}
HEADS = {
    "masses": "name mass x y z size_x size_y size_z", "mounts": "name x y z inclination azimuth isolator",
    "stops": "name x y z gap stiffness damping", "points": "name x y z",
}  # fmt: skip
OF = {"mass": "mass", "inclination": "angle", "azimuth": "angle", "gap": "gap", "stiffness": "stiffness", "damping": "damping"}


def tables():
    columns = {name: n(1, unit, "length" if name == "gap" else name) for name, unit in FIRST.items()}
    masses = [n(v) for v in (700, 250, 205, 300, 500, 400, 300)]
    mounts = [n(v) for v in (0, 10, 5, 12, 30)]
    stop = [n(v) for v in (250, 200, 15, 12, 5, 1)]
    point = [n(v) for v in (250, 210, 650)]

    def cells(names, numbers):
        texts = []
        for name, number in zip(names, numbers, strict=True):
            column = columns[OF.get(name, "length")]
            known = SPELLED[column.quantity]
            factor = 1.0 if column.text == "meant" else known[FIRST[OF.get(name, "length")]] / known[column.unit]
            texts.append(number.text or f"{number.value * factor:.12g}")
        return texts

    def files(folder):
        heads = {name: text.split() for name, text in HEADS.items()}
        units = {name: columns[OF.get(name, "length")].unit for text in heads.values() for name in text}
        units |= {"name": "", "isolator": ""}
        at = {"m1": (0, 0, 0), "m2": (0, 400, 0), "m3": (500, 0, 0), "m4": (500, 400, 0)}
        moved = {
            name: [b if b.text else n(a + b.value) for a, b in zip(place, mounts, strict=False)] for name, place in at.items()
        }  # fmt: skip
        tank = [n(v) for v in (50, 250, 200, 500, 100, 100, 100)]
        placed = heads["mounts"][1:6]
        lines = {
            "masses": [[name, *cells(heads["masses"][1:], row)] for name, row in (("engine", masses), ("tank", tank))],
            "mounts": [[name, *cells(placed, [*row, *mounts[3:]]), "enidine_wr16_400"] for name, row in moved.items()],
            "stops": [["s1", *cells(heads["stops"][1:], stop)]], "points": [["top", *cells(heads["points"][1:], point)]],
        }  # fmt: skip
        return {f"{name}.csv": table(heads[name], lines[name], units) for name in heads}

    return [*columns.values(), *masses, *mounts, *stop, *point], files


def mission():
    exponent, constant, often, hours = n(4), n(1e-3), n(10), n(2)

    def files(folder):
        return {"life.toml": (
            f'exponent = {exponent}\nconstant = {constant}\n[[stage]]\nrun = "{short_run()}"\nrepetitions = {often}\n'
            f'[[stage]]\nrun = "{short_run()}"\nhours = {hours}\n'
        )}  # fmt: skip

    return [exponent, constant, often, hours], files


@cache
def measured():
    """Return times [s], accelerations of base and block [m/s^2] of a short test, computed once a process."""
    pulse = wr.HalfSine(peak=100.0, duration=0.011, direction="z", start=0.02)
    response = wr.simulate(wr.load_system("shock_table"), pulse, duration=0.15, timestep=5e-4)
    return response.time[::2], response.base.acceleration[::2, 2], response.bodies["block"].acceleration[::2, 2]


def calibration():
    base, block, clock = n(1, "g", "acceleration"), n(1, "m/s^2", "acceleration"), n(1, "s", "time")
    low, high, mean, deviation, delay = n(0.7), n(1.4), n(1), n(0.1), n(5e-4)

    def files(folder):
        def scale(number, was):
            known = SPELLED[number.quantity]
            return 1.0 if number.text == "meant" else known[was] / known[number.unit]

        time, moved, felt = measured()
        rows = zip(time * scale(clock, "s"), moved / ACCELERATION_UNITS["g"] * scale(base, "g"), felt * scale(block, "m/s^2"),
                   strict=True)  # fmt: skip
        lines = [
            f"time [{clock.unit}],A0 [{base.unit}],A1 [{block.unit}]",
            *(",".join(f"{v:.12g}" for v in row) for row in rows),
        ]
        vary = [f"mount/m1/stiffness = Uniform({low}, {high})", f"body/block/mass = Normal({mean}, {deviation}, relative)",
                f"channel/*/delay = Normal(0, {delay})"]  # fmt: skip
        return {"drop.csv": "\n".join(lines) + "\n", "vary": "\n".join(vary)}

    return [base, block, clock, low, high, mean, deviation, delay], files


@cache
def part_files():
    """Return the tables of a flexible part of two modes at two points as rows of texts."""
    part = wr.FlexiblePart(
        frequencies=[12.0, 31.0], damping=[0.02, 0.03], participation=[[1.0, 2.0, 20.0], [3.0, 0.5, 4.0]],
        points={"a": [0.1, 0.2, 0.3], "b": [0.6, -0.2, 0.1]},
        shapes={"a": [[0.01, 0.02, 0.1], [0.03, 0.01, 0.2]], "b": [[0.02, 0.01, 0.12], [0.01, 0.02, -0.1]]},
    )  # fmt: skip
    folder = Path(tempfile.mkdtemp(prefix="fuzz-part-")) / "part"
    save_flexible(part, folder)
    return {path.name: list(csv.reader(path.open())) for path in folder.iterdir()}


def part():
    rows = {name: [list(row) for row in lines] for name, lines in part_files().items()}
    first = {"modes.csv": 1, "shapes.csv": 2, "points.csv": 1}
    numbers = []
    for name, lines in rows.items():
        for row in lines[1:]:
            for column in range(first[name], len(row)):
                row[column] = n(row[column])
                numbers.append(row[column])

    def files(folder):
        return {name: "\n".join(",".join(map(str, row)) for row in lines) + "\n" for name, lines in rows.items()}

    return numbers, files


MAKERS = dict(zip(KINDS, (job, tables, mission, calibration, part, deck), strict=True))


def meaning(kind, folder, files):
    """Return all that is computed from an input, as one array of numbers."""
    for name, text in files.items():
        (folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    if kind == "deck":
        system = wr.on_deck(SYSTEM("shock_table"), panel_of_phrase(files["deck"]))
        model = system.model
        return np.concatenate([model.jnt_stiffness, model.dof_damping, model.body_mass, model.qpos_spring])
    if kind == "job":
        made = load_job(folder / "job.toml")
        values = [limit for case in made.cases for one in case.scenario.limits for limit in one.values]
        for case in made.cases:
            values += [float(value) for value in case.scenario.simulate.values() if isinstance(value, float | int)]
            motion = case.scenario.motion
            times = np.linspace(0.00037, 0.5, 301)  # none at a corner, which rounding moves
            values += [
                motion.end if np.isfinite(motion.end) else 0.0,
                *motion.acceleration(times).ravel()[:900],
                *motion.velocity(times).ravel()[:900],
            ]
        return np.array(values)
    if kind == "tables":
        layout = read_layout("rack", {name: folder / f"{name}.csv" for name in ("masses", "mounts", "stops", "points")})
        path = folder / "rack.xml"
        (folder / "isolators").mkdir(exist_ok=True)
        path.write_text(mjcf_of(layout, "rack"))
        laws = [[s.law.gap, s.law.stiffness, s.law.damping] for s in layout.stops if s.law]
        parts = [
            np.concatenate([[m.properties.mass], m.properties.centre, m.properties.inertia.ravel()]) for m in layout.masses
        ]
        placed = [np.concatenate([one.position, one.axes.ravel()]) for one in (*layout.mounts, *layout.stops)]
        return np.concatenate([*parts, *placed, *(p.position for p in layout.points), np.ravel(laws)])
    if kind == "mission":
        found = mission_damage(read_mission(folder / "life.toml"))
        return np.array([value for one in found for value in (one.total, one.cycles, one.largest_range)])
    if kind == "part":
        made = load_flexible(folder)
        shapes = [made.shapes[name] for name in sorted(made.shapes)]
        places = [np.asarray(made.points[name]) for name in sorted(made.points)]
        return np.concatenate([np.ravel(a) for a in (made.frequencies, made.damping, made.participation, *shapes, *places)])
    test = MeasuredTest.of(wr.load_measured(folder / "drop.csv", **read_map(["A0=base z", "A1=body/block z"])))
    forward = SystemForward(SYSTEM("shock_table"), [test], read_vary(files["vary"].splitlines()))
    values = forward.prior.values(
        np.array([[-1.0] * forward.prior.size, [0.0] * forward.prior.size, [2.0] * forward.prior.size])
    )
    times = np.linspace(0.0, 0.12, 40)
    series = [
        np.interp(np.linspace(0.0, 1.0, 30), np.linspace(0.0, 1.0, one.values.size), one.values) for one in forward.series
    ]
    return np.concatenate([values.ravel(), test.motion.acceleration(times)[:, 2], *series])


@cache
def as_it_stands(kind):
    """Return what the input means before it is changed, computed once a process."""
    with tempfile.TemporaryDirectory(prefix="fuzz-meant-") as folder:
        _, files = MAKERS[kind]()
        return meaning(kind, Path(folder), files(Path(folder)))


IN_COLUMNS = ("tables", "calibration")
"""Kinds whose units stand above columns: their numbers follow them."""


def respell(rng, kind, numbers):
    """Write some numbers in other units."""
    units = [number for number in numbers if len(SPELLED.get(number.quantity, ())) > 1]
    for number in [pick(rng, units) for _ in range(int(rng.integers(1, 4)))] if units else ():
        known = SPELLED[number.quantity]
        unit = pick(rng, [unit for unit in known if kind in IN_COLUMNS or "²" not in unit])
        number.value = 1.0 if kind in IN_COLUMNS else number.value * known[number.unit] / known[unit]
        number.unit = unit


def rewritten(rng, kind, name, text, spelling):
    """Return a file as another program writes it: order, encoding, separators."""
    if kind in ("job", "mission") and spelling < 2:
        return tomli_w.dumps(tomllib.loads(text))
    if kind in IN_COLUMNS and name.endswith(".csv"):
        text = {1: text.replace(",", ";"), 2: "# rig 3\n\n" + text, 3: text.replace("\n", "\r\n")}.get(spelling, text)
        return text.encode("utf-8-sig") if spelling == 4 else text
    if kind == "part" and name != "modes.csv":  # whose order is that of the modes
        head, *rows = text.splitlines()
        return "\n".join([head, *(rows[i] for i in rng.permutation(len(rows)))]) + "\n"
    if kind == "deck":
        words = text.split(" ")
        return " ".join(" ".join(words[2 * i : 2 * i + 2]) for i in rng.permutation(len(words) // 2))
    return text


def change(rng, kind, numbers):
    """Change one number, its sign or its unit; return whether that can be done with it."""
    number = pick(rng, numbers)
    known, placed = SPELLED.get(number.quantity, {}), kind in IN_COLUMNS
    units = [unit for unit in known if known[unit] != known[number.unit]]
    if units and (placed or rng.random() < 0.5):
        number.unit, number.text = pick(rng, units), "meant" if placed else ""
    elif not (placed and number.quantity):
        number.value = (number.value or 1.0) * pick(rng, (1.07, 0.9, 1.3, -1.0, 10.0, 1e-3, 1e3))
    else:
        return False
    return True


def meant(rng, folder):
    """An input of one kind that is respelled, changed or spoiled; what it means is held against what it meant as it stood."""
    kind = str(rng.choice(KINDS, p=OFTEN))
    numbers, files = MAKERS[kind]()
    how, spelling = pick(rng, ("same", "same", "other", "other", "wild")), int(rng.integers(5))
    if how == "same":
        respell(rng, kind, numbers)
    elif how == "other":
        while not change(rng, kind, numbers):
            pass
    else:
        plain = [number for number in numbers if not (kind in IN_COLUMNS and number.quantity)]
        pick(rng, plain).text = pick(rng, NUMBERS)
    written = files(folder)
    if how == "same":
        written = {name: rewritten(rng, kind, name, text, spelling) for name, text in written.items()}

    def use():
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                before, now = as_it_stands(kind), meaning(kind, folder, written)
            except (ValueError, wr.WireRopeError) as error:
                if how == "same":
                    return f"refused though it says the same: {error}"
                raise
        if not np.isfinite(now).all():
            return "something is not finite"
        if library := [str(one.message) for one in caught if one.category in (RuntimeWarning, DeprecationWarning)]:
            return f"a library's warning: {library[0]}"
        near = now.shape == before.shape and np.allclose(now, before, rtol=SAME, atol=SAME * 1e-3 * np.abs(before).max())
        if how == "same" and not near:
            return "it says the same and means something else"
        if how == "other" and np.array_equal(now, before) and not caught:
            return "it says something else and means the same"
        return None

    return Case(f"{kind} {how}: {next(iter(written.values()))!r:.300}", use)
