"""Motions and what they are held against: measured records and cyclic tests, phrases, files of levels, limits."""

import sys
from functools import cache
from pathlib import Path

import numpy as np
import tomli_w
from campaign import Case
from generators import TOML_VALUES, VALUES, Table, damaged, edited, finite, ignored, muddled, pick, spoiled

import wirerope_mj as wr
from wirerope_mj.foundation.payload_limits import limit_from_text
from wirerope_mj.motions.registry import SPOKEN_MOTIONS, level_templates, motion_from_dict, motion_from_phrase, motion_of_levels
from wirerope_mj.mounts.identification.measured import prepare
from wirerope_mj.mounts.test_rig import load_cycles, steady_loops
from wirerope_mj.runs.scenario_file import judge_table, judged_by, read_judge_table

sys.path.append(str(Path(__file__).parents[1]))  # for the universal files that other tests write
from uff_files import history, units

PLAYED = ("acceleration", "velocity", "displacement")


@cache
def shaker():
    """Return a small system whose kernels are compiled, loaded once a process."""
    system = wr.load_system("sdof_shaker")
    wr.simulate(system, wr.HalfSine(peak=1.0, duration=0.004, direction="z"), duration=0.005)
    return system


OPTIONS = {
    "baseline": ("rest", "mean", "velocity", "none"), "gaps": ("fill",), "scale": (-2.0, 1e-9, 1e300), "unit": ("g", "mm/s^2"),
    "start": (3.0, -1.0, 1e20), "resample": (500.0, 3000.0, 1e9, 1e-3),
}  # fmt: skip
"""Arguments of `load_record`, most often none of them."""

STAMPS = (2e10, -2e10, 1e300, -1e300, 1e6, 0.5, 1e-12)
"""By which time stamps are wrong [s]."""


def records(rng, folder):
    """Accelerations as a CSV or universal file, loaded, played, and for some run in a short simulation."""
    time = np.arange(pick(rng, (3, 12, 40, 200))) * 1e-3
    shape = np.sin(np.pi * np.minimum(time / 0.02, 1.0)) + 0.1 * np.sin(2.0 * np.pi * 40.0 * time + 1.0)
    waves = [50.0 * shape, -20.0 * shape, 5.0 * np.cos(70.0 * time)][: int(rng.integers(1, 4))]
    options = {name: pick(rng, values) for name, values in OPTIONS.items() if rng.random() < 0.1}
    if rng.random() < 0.1:
        options |= {"baseline": "highpass", "highpass": pick(rng, (5.0, 1e-6, 499.0, 1e6))}
    if rng.random() < 0.3:
        path, (done, valid, content), shaken = folder / "deck.uff", universal(rng, time, waves), False
    else:
        path, shaken = folder / "deck.csv", rng.random() < 0.1
        table = Table.of(["time [s]", *(f"{axis} [m/s^2]" for axis in "zxy"[: len(waves)])], [time, *waves])
        done, valid = stamped(rng, table) if rng.random() < 0.2 else spoiled(rng, table)
        content = table.content()
        if rng.random() < 0.2:
            how, content = damaged(rng, content)
            done, valid = f"{done}, {how}", None
    path.write_bytes(content)
    meant = np.zeros((time.size, 3))
    meant[:, ["xyz".index(axis) for axis in "zxy"[: len(waves)]]] = np.column_stack(waves)
    known = valid is not None and not {"gaps", "unit", "resample"} & options.keys()

    def use():
        record = wr.load_record(path, **options)
        if complaint := finite(record, PLAYED, np.union1d(record.time[:: max(1, record.time.size // 500)], record.time[-3:])):
            return complaint
        if not (np.isfinite(record.duration) and record.duration > 0.0 and (np.diff(record.time) > 0.0).all()):
            return f"its duration is {record.duration}, and its instants do not increase"
        if record.time[0] != options.get("start", 0.0):
            return f"it begins at {record.time[0]}"
        if known and options.get("baseline", "none") == "none":
            if record.time.size != time.size or abs(record.duration - time[-1]) > 1e-9:
                return f"{record.time.size} samples of {record.duration} s where {time.size} of {time[-1]} s were meant"
            scaled = meant * options.get("scale", 1.0)
            apart = float(np.abs(record.samples - scaled).max())
            if apart > 1e-6 * np.abs(scaled).max():  # eight digits are written, and instants are rounded to even ones
                return f"another motion, by {apart:.3g} m/s^2"
        if shaken and np.abs(record.samples).max() < 1e3 and not record.samples[:, :2].any():
            response = wr.simulate(shaker(), record, duration=0.005, timestep=1e-3)
            return finite(response.bodies["mass"], ["position"])
        return None

    return Case(done, use, (path.name, *(f"`{name}`" for name in ("highpass", "resample", "scale", "start"))),
                False if valid is False else None)  # fmt: skip


def stamped(rng, table):
    """Make time stamps wrong: one, those behind it, all, or none at all (jitter)."""
    kind, at, value = pick(rng, ("one", "behind", "jitter", "offset")), int(rng.integers(len(table.rows))), pick(rng, STAMPS)
    for index, row in enumerate(table.rows):
        if kind == "jitter":
            row[0] = f"{float(row[0]) + 1e-3 * rng.uniform(-0.6, 0.6):.17g}"
        elif index == at or kind == "offset" or (kind == "behind" and index > at):
            row[0] = f"{float(row[0]) + value:.17g}"
    return f"time stamps: {kind} by {value:g}", None


def universal(rng, time, waves):
    """Return what was done to a universal file, whether it is whole, and its content."""
    kind = pick(rng, ("bytes", "count", "lines", "step", "values", "units", "times", "whole"))
    strange = {"binary": bool(rng.random() < 0.5), "unit": pick(rng, ("m/s^2", "g", "NONE", "V"))}
    if kind == "count":
        strange["count"] = pick(rng, (0, -1, 1, time.size - 1, time.size + 1, 10**9, -(10**9)))
    if kind == "step":
        strange["step"] = pick(rng, (0.0, -1e-3, 1e300, np.nan, np.inf, 1e-300, 2e10))
    if kind == "times":
        strange["times"] = time + pick(rng, (0.0, 1e-3 * rng.uniform(-0.6, 0.6), 2e10)) * (np.arange(time.size) > 1)
    if kind == "values":
        waves = [np.where(np.arange(time.size) == 1, pick(rng, (np.nan, np.inf, 1e300, 1e99)), wave) for wave in waves]
    content = units(pick(rng, (1, 9)), pick(rng, (0.0, -1.0, 1e-300, 1e300, np.nan))) if kind == "units" else units(1, 1.0)
    content += b"".join(history(12, end, wave, **strange) for end, wave in zip("zxy", waves, strict=False))
    if kind == "bytes":
        kind, content = damaged(rng, content)
    elif kind == "lines":
        lines = content.split(b"\n")
        at = int(rng.integers(len(lines)))
        lines[at : at + 1] = [lines[at]] * pick(rng, (0, 2))
        content = b"\n".join(lines)
    whole = kind == "whole" and strange["unit"] in ("m/s^2", "NONE")
    return f"universal file, {kind}", True if whole else None, content


POINTS = 60
SIZES = (2e-3, 8e-3)


@cache
def clean():
    """Return time [s], deflection [m] and force [N] of three cycles of each amplitude."""
    time = np.arange(6 * POINTS + 1) / POINTS
    path = np.repeat([*SIZES, SIZES[-1]], [3 * POINTS, 3 * POINTS, 1]) * np.sin(2.0 * np.pi * time)
    return time, path, wr.BoucWen(alpha=300e3, beta=200.0, gamma=0.0, n=1.0, k=80e3).trace(path).force


def _noise(share):
    return lambda rng, t, x, f: (t, *(v + share * np.ptp(v) * rng.standard_normal(v.size) for v in (x, f)), None)


def _spike(rng, t, x, f):
    value = pick(rng, (np.nan, np.inf, 1e300, -1e300, 1e20, 1e8, 0.0))
    pick(rng, (x, f))[int(rng.integers(t.size))] = value
    return t, x, f, None if abs(value) < 1e200 else False


def _time(rng, t, x, f):
    t[int(rng.integers(1, t.size))] += pick(rng, (1e-9, 5.0, 2e10, -1.0, 1e300, np.nan, np.inf))
    return t, x, f, None


SIGNALS = {
    "noise of 1 %": _noise(0.005), "noise of 10 %": _noise(0.05), "noise of 100 %": _noise(0.5),
    "a spike": _spike, "time": _time,
    "deflection is noise": lambda rng, t, x, f: (t, 1e-2 * rng.standard_normal(t.size), f, False),
    "force is noise": lambda rng, t, x, f: (t, x, 1e3 * rng.standard_normal(t.size), False),
    "clipped": lambda rng, t, x, f: (t, x, np.minimum(f, rng.uniform(0.6, 0.95) * f.max()), False),
    "wrong sign": lambda rng, t, x, f: (t, x, -f, False),
    "backwards": lambda rng, t, x, f: (t, x[::-1], f[::-1], False),
    "swapped": lambda rng, t, x, f: (t, f, x, None),
    "constant deflection": lambda rng, t, x, f: (t, 0.0 * x + 1e-3, f, False),
    "constant force": lambda rng, t, x, f: (t, x, 0.0 * f + 5.0, False),
    "half a cycle": lambda rng, t, x, f: (t[: POINTS // 2 + 1], x[: POINTS // 2 + 1], f[: POINTS // 2 + 1], None),
    "few samples": lambda rng, t, x, f: (t[::9], x[::9], f[::9], None),
    "huge": lambda rng, t, x, f: (t, x * 1e200, f * 1e200, False),
    "tiny": lambda rng, t, x, f: (t, x * 1e-200, f * 1e-200, None),
    "metres for millimetres": lambda rng, t, x, f: (t, 1e3 * x, f, False),
    "drift": lambda rng, t, x, f: (t, x, f + 100.0 * t, None),
}  # fmt: skip
"""Each returns time, deflection, force, and whether that is valid still."""


def cycles(rng, folder):
    """Cyclic tests as CSV files and as series, cut into loops and made ready for a fit."""
    single, path, table = rng.random() < 0.4, folder / "test.csv", None
    signals, done, valid = [values[-POINTS - 1 :] if single else values for values in clean()], "", True
    if rng.random() < 0.5:
        kind = pick(rng, list(SIGNALS))
        *signals, valid = SIGNALS[kind](rng, *(values.copy() for values in signals))
        done = f"signals: {kind}"
    time, x, force = signals
    names = ("samples", "`deflection`", "`time`", "the record", "loop 1", "loop 2")
    if not done or rng.random() < 0.6:
        table = Table.of(["time [s]", "deflection [mm]", "force [kN]"], [time, 1e3 * x, 1e-3 * force])
        if rng.random() < 0.3:
            table.header, table.rows = ["loop", *table.header], [["1", *row] for row in table.rows]
        if not done:
            done, valid = spoiled(rng, table)
        content, names = table.content(), (path.name, "loop 1", "loop 2")
        if rng.random() < 0.2:
            how, content = damaged(rng, content)
            done, valid = f"{done}, {how}", None
        path.write_bytes(content)
    alone = table is not None and single and rng.random() < 0.7

    def use():
        loops = steady_loops(x, force, time=time) if table is None else (wr.load_cyclic_test if alone else load_cycles)(path)
        if not loops:
            return "there are no loops, and nothing is said"
        for loop in loops:
            values = (loop.amplitude, loop.operating_point, loop.secant_stiffness, loop.dissipated_energy)
            if not (np.isfinite(values).all() and np.isfinite(loop.force).all() and loop.amplitude > 0.0):
                return f"amplitude, operating point, stiffness and energy are {values}"
            if not alone and (loop.dissipated_energy <= 0.0 or loop.secant_stiffness < 0.0):
                return f"stiffness and energy are {values[2:]}"
        prepare(loops)
        sizes = SIZES[-1:] if single else SIZES
        if valid and table is not None and not np.allclose([loop.amplitude for loop in loops], sizes, rtol=0.01):
            return f"amplitudes are {[loop.amplitude for loop in loops]} where {sizes} were meant"
        return None

    return Case(done, use, names, False if valid is False else None)


PHRASES = {kind: (spoken.example,) for kind, spoken in SPOKEN_MOTIONS.items()} | {
    "psd": ("p.csv 0.4 s z seed 1", "p.csv 0.5 s xy seed 2 at 20 ms rise 60 ms fall 50 ms"),
    "spectrum": ("s.csv 1 s x damping 5 % seed 1",),
    "force-table": ("engine f.csv at 1 s", "engine f.csv"),
    "half-sine": ("15 g 11 ms z", "15 g 11 ms xz at 50 ms", "-150 m/s2 0.011 s 1,1,0 at 0.1 s"),
    "unbalance": ("engine 20 kg.mm 5 to 30 Hz 20 s x", "engine 20 kg.mm 25 Hz y for 10 s at 1 s order 2"),
    "sweep": ("0.5 g 5 to 50 Hz 2 oct/min z", "0.5 g 50 to 5 Hz 50 oct/min x"),
}  # fmt: skip
"""Phrases that are right."""


def phrases(rng, folder):
    """Motions of the base and forces on the payload in words, and the files that they name; played, stored and restored."""
    f = np.geomspace(20.0, 60.0, 6)
    tables = {
        "p.csv": Table.of(["frequency [Hz]", "psd [g^2/Hz]"], [f, 0.01 + 0.0 * f]),
        "s.csv": Table.of(["frequency [Hz]", "acceleration [g]"], [f / 10.0, 0.3 + 0.0 * f]),
        "f.csv": Table.of(["time [s]", "fz [N]", "mx [N.m]"], [f - 20.0, f, 2.0 * f]),
    }
    kind = pick(rng, list(PHRASES))
    text, done, valid = pick(rng, PHRASES[kind]), "phrase", None
    file = next((name for name in tables if name in text), None)
    if file is not None and rng.random() < 0.5:
        done, valid = spoiled(rng, tables[file])
    else:
        text = muddled(rng, text)
    for name, table in tables.items():
        (folder / name).write_bytes(table.content())

    def use():
        motion = motion_from_phrase(kind, text, folder=folder)
        corners = motion.corners[:: max(motion.corners.size // 50, 1)]
        ends = [motion.end] if np.isfinite(motion.end) else []
        times = np.unique(np.concatenate([corners, ends, np.linspace(0.0, 1.0, 7)]))
        for site in motion.loaded_sites:
            if not np.isfinite(motion.load(site, times)).all():
                return "a force is not finite"
        if not np.isfinite([time for time, _ in motion.events]).all() or not motion.description:
            return "an event is at no time"
        if not motion.shortest_time > 0.0:
            return "no shortest time"
        if motion_from_dict(motion.to_dict()).to_dict() != motion.to_dict():
            return "it is stored as another motion"
        silent = None  # other numbers of a spectrum take a search each
        if kind != "spectrum":
            silent = ignored(text, lambda other: motion_from_phrase(kind, other, folder=folder).to_dict())
        return finite(motion, PLAYED, times) or silent

    return Case(f"{kind} {done}: {text!r:.150}", use, (kind, file or kind), False if valid is False else None)


KINDS = tuple(kind for kind in PHRASES if kind not in ("psd", "spectrum", "force-table"))


def levels(rng, folder):
    """Files of levels, as `wirerope levels` writes them and a specification fills them in."""
    path, whole, valid = folder / "levels.toml", False, None
    if rng.random() < 0.2:
        data, done = level_templates()[pick(rng, list(level_templates()))].read_bytes(), "template"
        data = data if rng.random() < 0.3 else damaged(rng, data)[1]
        valid = False if b"?" in data else None
    else:
        tables = []
        for _ in range(int(rng.integers(1, 4))):
            kind = pick(rng, KINDS)
            text = pick(rng, PHRASES[kind])
            tables.append({kind: muddled(rng, text) if rng.random() < 0.4 else text})
            if rng.random() < 0.4:
                tables[-1]["factor"] = pick(rng, TOML_VALUES if rng.random() < 0.6 else (0.5, 2, -1.0))
            if rng.random() < 0.1:
                tables[-1][pick(rng, ("half-sine", "sine", "note", ""))] = pick(rng, TOML_VALUES)
        content = {"standard": "house", "motion": tables}
        done = edited(rng, content, pick(rng, list(content))) if rng.random() < 0.1 else ""
        done = f"{done} {tables!r:.150}"
        text = tomli_w.dumps(content)
        data, whole = text.encode(), "#" not in text and text.count('"') % 2 == 0 and 'standard = "house"' in text
        if rng.random() < 0.1:
            (_, data), whole = damaged(rng, data), False
    path.write_bytes(data)

    def answer(text):
        other = path.with_name("other.toml")
        other.write_text(text, encoding="utf-8")
        return motion_of_levels(other).to_dict()

    def use():
        motion = motion_of_levels(path)
        times = np.unique(np.concatenate([motion.corners, np.linspace(0.0, 1.0, 7)]))
        return finite(motion, PLAYED, times) or (ignored(data.decode(), answer) if whole else None)

    return Case(done, use, (path.name,), valid)


@cache
def table():
    """Return the system that is judged, loaded once a process."""
    return wr.load_system("shock_table")


LIMITS = (
    "acceleration/block = 15 g", "acceleration/block = 10 10 5 m/s^2", "clearance/block = 30 30 20 mm",
    "clearance/block = 30 30 30 30 20 20 mm", "acceleration/block=3 g",
)  # fmt: skip


def limits(rng, folder):
    """Limits of the payload in words, as `--limit` says them, and the table of a stored scenario that holds them."""
    if rng.random() < 0.3:
        keys = ("acceleration/block", "clearance/block", "acceleration/nobody", "x", "", "acceleration/")
        content = {"limits": {pick(rng, keys): pick(rng, (*VALUES, None, [1e308]))}}
        if rng.random() < 0.3:
            content = {pick(rng, ("limits", "combined_travel", "other")): pick(rng, (*VALUES, None))}

        def use():
            read = read_judge_table(content)
            judged_by(table(), **read)
            again = read_judge_table(judge_table(**read))
            return None if again == {"combined_travel": True} | read else "it is stored as another limit"

        return Case(f"judge {content!r:.150}", use, ("judge", "limit"))
    texts = [muddled(rng, pick(rng, LIMITS)) for _ in range(int(rng.integers(1, 3)))]

    def use_texts():
        limits = [limit_from_text(text) for text in texts]
        if any(limit not in judged_by(table(), combined_travel=True, limits=limits).limits for limit in limits):
            return "a limit was not taken"
        return next(filter(None, (ignored(text, lambda other: vars(limit_from_text(other))) for text in texts)), None)

    return Case(f"{texts!r:.150}", use_texts, ("limit",))
