"""Measured accelerations, as CSV and universal files, loaded and played as a user would."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from campaign import Case
from tables import DAMAGE, Table, damaged_bytes, table_of

import wirerope_mj as wr
from wirerope_mj.foundation.resources import models_folder

sys.path.append(str(Path(__file__).parents[1]))  # for the universal files that other tests write
from uff_files import history, units

_WILD_TIME = (2e10, -2e10, 1e300, -1e300, 1e6, 0.5, 1e-12)
_SHAKER = wr.load_system(models_folder() / "sdof_shaker.xml")
wr.simulate(_SHAKER, wr.HalfSine(peak=1.0, duration=0.004, direction="z"), duration=0.005)  # compiles, once a process

_OPTIONS = ("`highpass`", "`resample`", "`scale`", "`start`")
"""Arguments that a refusal may name instead of the file."""

_TOLERANCE = 1e-6
"""Of the peak: eight digits are written, and instants are rounded to even ones."""


def mutate(rng: np.random.Generator, folder: Path) -> Case:
    """Write a record that is damaged or strange below `folder`."""
    count = int(rng.choice([3, 12, 40, 200]))
    time = np.arange(count) * 1e-3
    shape = np.sin(np.pi * np.minimum(time / 0.02, 1.0)) + 0.1 * np.sin(2.0 * np.pi * 40.0 * time + 1.0)
    waves = [50.0 * shape, -20.0 * shape, 5.0 * np.cos(70.0 * time)][: int(rng.integers(1, 4))]
    options = _options(rng)
    if rng.random() < 0.3:
        return _universal(rng, folder / "deck.uff", time, waves, options)
    names = [f"{axis} [m/s^2]" for axis in "zxy"[: len(waves)]]
    table = table_of(["time [s]", *names], [time, *waves])
    done, valid = _damage(table, rng)
    content = table.content()
    if rng.random() < 0.2:
        how, content = damaged_bytes(content, rng)
        done, valid = f"{done}, {how}", None
    path = folder / "deck.csv"
    path.write_bytes(content)
    inputs: dict[str, Any] = {"path": path, "options": options, "simulate": rng.random() < 0.1}
    if valid is not None and not {"gaps", "unit", "resample"} & options.keys():
        inputs["meant"] = (time, dict(zip("zxy", waves, strict=False)))
    return Case(done, inputs, (path.name, *_OPTIONS), False if valid is False else None)


def _damage(table: Table, rng: np.random.Generator) -> tuple[str, bool | None]:
    """Return what was done to a table, and whether it is valid still."""
    if rng.random() < 0.2:
        return _wild_time(table, rng)
    change = DAMAGE[int(rng.integers(len(DAMAGE)))]
    return change.__name__, change(table, rng)


def _wild_time(table: Table, rng: np.random.Generator) -> tuple[str, bool | None]:
    """Make time stamps wrong: one, those behind it, all, or none at all (jitter)."""
    kind = str(rng.choice(["one", "behind", "jitter", "offset"]))
    place, value = int(rng.integers(len(table.rows))), float(rng.choice(_WILD_TIME))
    for index, row in enumerate(table.rows):
        if (kind == "one" and index == place) or (kind == "behind" and index >= place) or kind == "offset":
            row[0] = f"{float(row[0]) + value:.17g}"
        elif kind == "jitter":
            row[0] = f"{float(row[0]) + 1e-3 * rng.uniform(-0.6, 0.6):.17g}"
    return f"time stamps: {kind} by {value:g}", None


def _options(rng: np.random.Generator) -> dict[str, Any]:
    """Return arguments of `load_record`, most often none."""
    every: dict[str, list[Any]] = {
        "baseline": ["rest", "mean", "velocity", "none"],
        "gaps": ["fill"],
        "scale": [-2.0, 1e-9, 1e300],
        "start": [3.0, -1.0, 1e20],
        "resample": [500.0, 3000.0, 1e9, 1e-3],
        "unit": ["g", "mm/s^2"],
    }
    chosen = {name: values[int(rng.integers(len(values)))] for name, values in every.items() if rng.random() < 0.1}
    if rng.random() < 0.1:
        chosen |= {"baseline": "highpass", "highpass": float(rng.choice([5.0, 1e-6, 499.0, 1e6]))}
    return chosen


def _universal(
    rng: np.random.Generator, path: Path, time: np.ndarray, waves: list[np.ndarray], options: dict[str, Any]
) -> Case:
    """Write a universal file that is damaged."""
    kind = str(rng.choice(["bytes", "count", "lines", "step", "values", "units", "times", "whole"]))
    strange: dict[str, Any] = {"binary": bool(rng.random() < 0.5), "unit": str(rng.choice(["m/s^2", "g", "NONE", "V"]))}
    if kind == "count":
        strange["count"] = int(rng.choice([0, -1, 1, time.size - 1, time.size + 1, 10**9, -(10**9)]))
    if kind == "step":
        strange["step"] = float(rng.choice([0.0, -1e-3, 1e300, np.nan, np.inf, 1e-300, 2e10]))
    if kind == "times":
        strange["times"] = time + rng.choice([0.0, 1e-3 * rng.uniform(-0.6, 0.6), 2e10]) * (np.arange(time.size) > 1)
    if kind == "values":
        waves = [np.where(np.arange(time.size) == 1, rng.choice([np.nan, np.inf, 1e300, 1e99]), wave) for wave in waves]
    content = units(
        int(rng.choice([1, 9])) if kind == "units" else 1,
        1.0 if kind != "units" else float(rng.choice([0.0, -1.0, 1e-300, 1e300, np.nan])),
    )
    content += b"".join(history(12, end, wave, **strange) for end, wave in zip("zxy", waves, strict=False))
    if kind == "bytes":
        how, content = damaged_bytes(content, rng)
        kind = f"bytes: {how}"
    elif kind == "lines":
        lines = content.split(b"\n")
        place = int(rng.integers(len(lines)))
        lines[place : place + 1] = [lines[place]] * int(rng.choice([0, 2]))
        content = b"\n".join(lines)
    path.write_bytes(content)
    inputs = {"path": path, "options": options, "simulate": False}
    if kind == "whole" and strange["unit"] in ("m/s^2", "NONE") and not {"gaps", "unit", "resample"} & options.keys():
        inputs["meant"] = (time, dict(zip("zxy", waves, strict=False)))
    return Case(f"universal file, {kind}", inputs, (path.name, *_OPTIONS))


def use(case: Case) -> str | None:
    """Load the record, play it, and for some run a short simulation."""
    options = case.inputs["options"]
    record = wr.load_record(case.inputs["path"], **options)
    instants = np.union1d(record.time[:: max(1, record.time.size // 500)], record.time[-3:])
    for name in ("acceleration", "velocity", "displacement"):
        if not np.isfinite(getattr(record, name)(instants)).all():
            return f"its {name} is not finite"
    if not (np.isfinite(record.duration) and record.duration > 0.0 and (np.diff(record.time) > 0.0).all()):
        return f"its duration is {record.duration}, and its instants do not increase"
    if record.time[0] != options.get("start", 0.0):
        return f"it begins at {record.time[0]}"
    if options.get("baseline", "none") == "none" and "meant" in case.inputs:
        complaint = _another(record, *case.inputs["meant"], options.get("scale", 1.0))
        if complaint:
            return complaint
    if case.inputs["simulate"] and np.abs(record.samples).max() < 1e3 and not record.samples[:, :2].any():
        response = wr.simulate(_SHAKER, record, duration=0.005, timestep=1e-3)
        if not np.isfinite(response.bodies[next(iter(response.bodies))].position).all():
            return "the simulation is not finite"
    return None


def _another(record: Any, time: np.ndarray, waves: dict[str, np.ndarray], scale: float) -> str | None:
    """Return how a record differs from what was meant."""
    meant = np.column_stack([waves.get(axis, np.zeros(time.size)) for axis in "xyz"]) * scale
    if record.time.size != time.size or abs(record.duration - time[-1]) > 1e-9:
        return f"{record.time.size} samples of {record.duration} s where {time.size} of {time[-1]} s were meant"
    apart = float(np.abs(record.samples - meant).max())
    return f"another motion, by {apart:.3g} m/s^2" if apart > _TOLERANCE * np.abs(meant).max() else None
