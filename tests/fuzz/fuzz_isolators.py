"""Isolator files: TOML with damaged bytes, wrong values, types, keys and units, loaded, mounted and simulated."""

import datetime
import sys
import tomllib
from copy import deepcopy
from functools import cache
from pathlib import Path

import tomli_w
from campaign import Case
from fuzz_models import rest_and_shake
from hostile import NUMBERS, WORDS, damaged, pick

import wirerope_mj as wr
from wirerope_mj.foundation.resources import catalogue_folder

sys.path.append(str(Path(__file__).parents[1]))

from laws_for_tests import PARAMETERS  # noqa: E402

MODEL = """<mujoco>
  <option gravity="0 0 -9.80665"/>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
    <body name="deck"><joint name="deck_x" type="slide" axis="1 0 0"/><joint name="deck_z" type="slide" axis="0 0 1"/>
      <geom name="plate" size=".1" mass="5"/><site name="b" pos="0 0 .2"/></body>
    <body name="box" pos="0 0 .3"><joint name="box_x" type="slide" axis="1 0 0"/><joint name="box_z" type="slide" axis="0 0 1"/>
      <geom name="case" size=".1" mass="5"/><site name="p" pos="0 0 -.1"/></body>
  </worldbody>
  <custom>
    <text name="isolator/a" data="iso.toml"/>
    <tuple name="mount/m1"><element objtype="site" objname="p"/><element objtype="site" objname="b"/>
      <element objtype="text" objname="isolator/a"/></tuple>
  </custom>
</mujoco>
"""

VALUES = (
    True,
    False,
    0,
    -1,
    1.0,
    3,
    10**400,
    -(10**30),
    float("nan"),
    float("inf"),
    -0.0,
    1e-300,
    1e300,
    55.0,
    1e9,
    -5.0,
)
VALUES += ("1.0", "", "x" * 300, [], [1.0], [[1.0]], {}, {"x": 1.0}, ["a"], [float("nan")])
VALUES += (datetime.date(2024, 1, 1), datetime.time(12))

KEYS = ("colour", "", "Alpha", "law", "name", "travel", "roll", "axial", "ünï", "a.b", "coupling", "kind", "k", "n")


@cache
def contents():
    """Return the isolators that are mutated: those that ship, and one of every law with all that a file can say."""
    shipped = [tomllib.loads(path.read_text(encoding="utf-8")) for path in sorted(catalogue_folder().glob("*.toml"))]
    full = {
        "limits": {
            "static_load": 2000.0,
            "travel": {"compression": 0.04, "tension": 0.03, "shear": 0.04, "roll": 0.04},
        },
        "geometry": {"height": 0.089, "width": 0.105},
        "provenance": {"kind": "identified", "source": "a rig", "assumed": ["one"]},
        "spread": {"parameters": ["axial.alpha"], "covariance": [[1.0]]},
    }
    laws = [
        {"name": law, **{axis: {"law": law, **parameters} for axis in ("roll", "shear", "axial")}, **full}
        for law, parameters in PARAMETERS.items()
    ]
    return tuple(shipped + laws)


def mutate(rng, folder):
    """Write a mutated isolator and a model on it, and return the case."""
    content = deepcopy(pick(rng, contents()))
    text, valid = None, None
    if rng.random() < 0.15:
        mutation, text = "bytes", damaged(tomli_w.dumps(content).encode(), rng)
    elif rng.random() < 0.1:
        mutation, text = number_text(tomli_w.dumps(content), rng)
    else:
        mutation, valid = pick(rng, CHANGES)(content, rng)
        text = tomli_w.dumps(content).encode()
    (folder / "iso.toml").write_bytes(text)
    (folder / "model.xml").write_text(MODEL, encoding="utf-8")
    inputs = {"folder": folder, "way": int(rng.integers(12))}
    return Case(mutation, inputs, names=("iso.toml", "m1", "box", "deck"), valid=valid)


def number_text(text, rng):
    """Replace the text of one value."""
    lines = text.split("\n")
    places = [number for number, line in enumerate(lines) if " = " in line]
    place = pick(rng, places)
    key, new = lines[place].split(" = ")[0], pick(rng, NUMBERS + WORDS)
    lines[place] = f"{key} = {new}"
    return f"{key} = {new[:20]}", "\n".join(lines).encode()


def tables(content):
    """Return all tables of a file's content."""
    inner = [value for value in content.values() if isinstance(value, dict)]
    return [content, *(table for value in inner for table in tables(value))]


def one_value(content, rng):
    """Replace a value by one of another type or size."""
    table = pick(rng, [table for table in tables(content) if table])
    key, value = pick(rng, list(table)), pick(rng, VALUES)
    table[key] = value
    return f"{key} = {value!r:.40}", None


def one_size(content, rng):
    """Multiply a number."""
    found = [(t, key) for t in tables(content) for key, value in t.items() if isinstance(value, float)]
    table, key = pick(rng, found)
    factor = pick(rng, (-1.0, 0.0, 1e3, 1e-3, 1e6, 1e-6, 1e12, 1e-12, 1e150, 10.0, 0.1))
    table[key] *= factor
    return f"{key} times {factor:g}", None


def no_key(content, rng):
    """Leave out a key."""
    table = pick(rng, [table for table in tables(content) if table])
    key = pick(rng, list(table))
    del table[key]
    return f"no {key}", None


def new_key(content, rng):
    """Add a key, or give one another name."""
    table = pick(rng, tables(content))
    key, value = pick(rng, KEYS), pick(rng, VALUES)
    if rng.random() < 0.5 and table:
        value = table.pop(pick(rng, list(table)))
    table[key] = value
    return f"new {key} = {value!r:.40}", None


def two_values(content, rng):
    """Swap two values of a file."""
    found = [(t, key) for t in tables(content) for key in t]
    (first, a), (second, b) = pick(rng, found), pick(rng, found)
    if isinstance(first[a], dict) or isinstance(second[b], dict):
        return "nothing", None
    first[a], second[b] = second[b], first[a]
    return f"swapped {a} and {b}", None


def millimetres(content, rng):
    """Write travels, or the height, in millimetres."""
    limits, geometry = content.get("limits", {}).get("travel", {}), content.get("geometry", {})
    table = pick(rng, [table for table in (limits, geometry) if table] or [{"nothing": 1.0}])
    changed = [pick(rng, list(table))] if rng.random() < 0.5 else list(table)
    for key in changed:
        table[key] *= 1e3
    return f"mm: {', '.join(changed)}", None if "nothing" in table else False


CHANGES = (one_value, one_value, one_size, one_size, no_key, new_key, two_values, millimetres)


def use(case):
    """Load the isolator, save and load it again, and shake a box on it."""
    folder, way = case.inputs["folder"], case.inputs["way"]
    isolator = wr.load_isolator(folder / "iso.toml")
    isolator.save(folder / "again.toml")
    if wr.load_isolator(folder / "again.toml") != isolator:
        return "saved and loaded again it is another"
    return rest_and_shake(wr.load_system(folder / "model.xml"), way)
