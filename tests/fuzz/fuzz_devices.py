"""Models, isolator files and tables of mounts: damaged or with wrong numbers, names and elements; loaded, settled, shaken."""

import re
import sys
import tomllib
from copy import deepcopy
from functools import cache, partial
from pathlib import Path

import numpy as np
import tomli_w
from campaign import Case
from generators import NUMBERS, WORDS, Table, damaged, edited, pick, spoiled

import wirerope_mj as wr
from wirerope_mj.engine.simulation.stability import stable_step
from wirerope_mj.engine.system.model_files import write_model
from wirerope_mj.foundation.resources import catalogue_folder, models_folder
from wirerope_mj.runs.new_model import new_model

sys.path.append(str(Path(__file__).parents[1]))
from laws_for_tests import PARAMETERS  # noqa: E402

SHOCK = wr.HalfSine(peak=20.0, duration=0.002, direction="z")
LAW = wr.BoucWen(alpha=1e5, beta=75.0, gamma=30.0, n=1.2, k=4e4)
GUIDED = '<joint name="box_x" type="slide" axis="1 0 0"/><joint name="box_z" type="slide" axis="0 0 1"/>'
PART = '<mujoco>\n<body name="rack" pos="1 0 0"><geom name="shelf" size=".1" mass="1"/></body>\n</mujoco>\n'
MODEL = """<mujoco>
  <option gravity="0 0 -9.80665"/>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
    <body name="deck">
      <joint name="deck_x" type="slide" axis="1 0 0"/><joint name="deck_z" type="slide" axis="0 0 1"/>
      <geom name="plate" size=".1" mass="5"/>
      <site name="b1" pos=".3 .2 .2"/><site name="b2" pos="-.3 .2 .2"/><site name="b3" pos="0 -.3 .2"/>
    </body>
    <body name="box" pos="0 0 .3">
      {joint}
      <geom name="case" size=".1" mass="30"/><geom name="foot" type="box" size=".3 .3 .01" pos="0 0 -.1" mass="2"/>
      <site name="p1" pos=".3 .2 -.1"/><site name="p2" pos="-.3 .2 -.1"/><site name="p3" pos="0 -.3 -.1"/>
      <site name="point/top" pos="0 0 .1"/>
      <body name="arm" pos="0 0 .1"><joint name="hinge" axis="0 1 0" stiffness="50" damping=".1"/>
        <geom name="rod" size=".02" pos="0 0 .05" mass="1"/></body>
    </body>
    {more}
  </worldbody>
  <custom>
    <numeric name="limit/acceleration/box" data="300"/>
    <text name="isolator/a" data="a.toml"/>
    {mounts}
  </custom>
</mujoco>
"""


def model(mounts, joint="<freejoint/>", more=""):
    """Return the text of a model on so many mounts."""
    tuples = [
        f'<tuple name="mount/m{i}"><element objtype="site" objname="p{i}"/><element objtype="site" objname="b{i}"/>'
        '<element objtype="text" objname="isolator/a"/></tuple>'
        for i in range(1, mounts + 1)
    ]
    return MODEL.format(joint=joint, more=more, mounts="\n".join(tuples))


@cache
def model_texts():
    """Return the models that are mutated: small ones, twice, and those that ship."""
    small = [model(3), model(3, GUIDED, '<include file="part.xml"/>'), model(1), model(2)]
    return (*small, *small, *(path.read_text(encoding="utf-8") for path in sorted(models_folder().glob("*.xml"))))


ATTRIBUTE = re.compile(r'([\w/]+)="([^"]*)"')
ELEMENT = re.compile(r"<(\w+)\b[^<>]*/>")
NUMBER = re.compile(r"-?\d*\.?\d+(?:e-?\d+)?")
OF_ATTRIBUTES = {
    "gravity": [f"{x} {y} {z}" for size in ("0", "nan", "inf", "-9806.65", "-1e6", "1e9", "-1e300", "1e-300", "9.8", "-1e4")
                for x, y, z in ((size, 0, 0), (0, 0, size), (0, 0, size))],
    "axis": ["1 0 0", "0 1 0", "0 0 1", "1 1 1", "0 0 0", "1 0 1", "1e-20 0 0", "1 1e-12 0", "0 nan 1", "1e200 0 0"],
}  # fmt: skip
"""What stands in place of an attribute that is chosen by its name."""


def changed_text(rng, text):
    """Return what was done to a model's attributes and elements, and the text."""
    found = list(ATTRIBUTE.finditer(text))
    numbers = [m for m in found if NUMBER.search(m[2]) and m[1] not in ("name", "class", "rgba", "file")]
    at = pick(rng, found)
    kind = pick(rng, ("number", "number", "number", "word", "attribute", "element", "swap", "swap", "mm", "mass", "named"))
    if kind == "number":
        at = pick(rng, numbers)
        number = pick(rng, list(NUMBER.finditer(at[2])))
        new = f"{float(number[0]) * pick(rng, (-1.0, 1e3, 1e-3, 1e6, 1e-6, 10.0, 1e12)):.17g}"
        new = new if rng.random() < 0.4 else pick(rng, NUMBERS)
        pieces = {at.span(2): at[2][: number.start()] + new + at[2][number.end() :]}
    elif kind == "word":
        pieces = {at.span(2): pick(rng, WORDS).replace('"', "&quot;")}
    elif kind == "attribute":
        pieces = {at.span(): pick(rng, ("", "q" + at[0]))}
    elif kind == "element":
        at, other = pick(rng, list(ELEMENT.finditer(text))), pick(rng, list(ELEMENT.finditer(text)))
        pieces = pick(rng, ({at.span(): ""}, {at.span(): at[0] * 2}, {(other.start(), other.start()): at[0]}))
    elif kind == "swap":
        other = pick(rng, [m for m in found if m[1] == at[1]])
        pieces = {at.span(2): other[2], other.span(2): at[2]}
    elif kind == "mm":
        which = pick(rng, (("pos",), ("size",), ("pos", "size")))
        larger = partial(NUMBER.sub, lambda m: f"{1e3 * float(m[0]):g}")
        pieces = {m.span(2): larger(m[2]) for m in found if m[1] in which}
    elif kind == "mass":
        masses, factor = [m for m in found if m[1] in ("mass", "diaginertia")], 10.0 ** rng.integers(-12, 13)
        chosen = [pick(rng, masses)] if rng.random() < 0.7 else masses
        pieces = {m.span(2): " ".join(f"{factor * float(v):.17g}" for v in m[2].split()) for m in chosen}
    else:
        at = pick(rng, [m for m in found if m[1] in OF_ATTRIBUTES])
        pieces = {at.span(2): pick(rng, OF_ATTRIBUTES[at[1]])}
    for (begin, end), new in sorted(pieces.items(), reverse=True):
        text = text[:begin] + new + text[end:]
    return f"{kind} {at[0][:60]}: {[new[:30] for new in pieces.values()][:2]}", text


def models(rng, folder):
    """A model and what it includes, loaded, copied as a run does, settled and shaken."""
    text = pick(rng, model_texts())
    if rng.random() < 0.12:
        mutation, content = damaged(rng, text.encode())
    else:
        mutation, text = changed_text(rng, text)
        content = text.encode()
    part = PART.encode()
    if rng.random() < 0.03:
        how, part = damaged(rng, part)
        mutation += f", part.xml {how}"
    (folder / "model.xml").write_bytes(content)
    (folder / "part.xml").write_bytes(part)
    wr.Isolator(name="A", roll=LAW, shear=LAW, axial=LAW).save(folder / "a.toml")
    names, way = re.findall(r'name="([^"/]{2,})', text), int(rng.integers(12))

    def use():
        system = wr.load_system(folder / "model.xml")
        if way % 4 == 0:
            copy = wr.load_system(write_model(system, folder / "run" / "model"))
            if list(copy.mounts) != list(system.mounts) or not np.array_equal(copy.model.qpos0, system.model.qpos0):
                return "the copy of the model is another"
        return settled_and_shaken(system, way)

    return Case(mutation, use, ("model.xml", "part.xml", "a.toml", "gravity", "`accuracy`", *names))


def settled_and_shaken(system, way):
    """Return a complaint if a result of a system is not finite, or it does not rest where it is said to."""
    rest = wr.equilibrium(system, history="relaxed" if way % 5 == 0 else "virgin")
    for name, load in rest.mounts.items():
        if not np.isfinite([*load.deflection, *load.force]).all():
            return f"equilibrium: mount {name} has {load.deflection}, {load.force}"
    if not rest.residual <= 1e-6 * max(1.0, float(np.linalg.norm(system.model.opt.gravity))):
        return f"equilibrium: residual {rest.residual}"
    if way % 3:
        modes = wr.modes(system, history=rest.history)
        tips = np.array(["(tips over)" in words for words in modes.descriptions])
        if not np.isfinite(modes.frequencies[~tips]).all():
            return f"modes: {modes.frequencies}"
    motion = SHOCK if len(system.assembly.driven_dofs) else wr.HalfSine(peak=1e-9, duration=0.001, direction="z", start=9.0)
    if stable_step(system) < 1e-7:
        return None  # a shock on so stiff a mount takes hours: no fault
    step = None if way == 0 else min(stable_step(system), 2e-4)
    response = wr.simulate(system, motion, duration=0.003, timestep=step, sample_rate=1000.0)
    for kind in ("bodies", "points", "mounts"):
        for name, entry in getattr(response, kind).items():
            for attribute in ("position", "acceleration", "deflection", "force"):
                if not np.isfinite(getattr(entry, attribute, 0.0)).all():
                    return f"simulate: {kind} {name}: {attribute} is not finite"
    return None


@cache
def isolator_contents():
    """Return the isolators that are mutated: those that ship, and one of every law with all that a file can say."""
    whole = {
        "limits": {"static_load": 2000.0, "travel": {"compression": 0.04, "tension": 0.03, "shear": 0.04, "roll": 0.04}},
        "geometry": {"height": 0.089, "width": 0.105},
        "provenance": {"kind": "identified", "source": "a rig", "assumed": ["one"]},
        "spread": {"parameters": ["axial.alpha"], "covariance": [[1.0]]},
    }
    shipped = [tomllib.loads(path.read_text(encoding="utf-8")) for path in sorted(catalogue_folder().glob("*.toml"))]
    laws = [
        {"name": law, **{axis: {"law": law, **parameters} for axis in ("roll", "shear", "axial")}, **whole}
        for law, parameters in PARAMETERS.items()
    ]
    return (*shipped, *laws)


def isolators(rng, folder):
    """An isolator file, loaded, saved, loaded again, and a box shaken on it."""
    content, valid, kind = deepcopy(pick(rng, isolator_contents())), None, rng.random()
    tables = [table for table in (content.get("limits", {}).get("travel"), content.get("geometry")) if table]
    if kind < 0.1 and tables:  # in millimetres
        table = pick(rng, tables)
        keys = [pick(rng, list(table))] if rng.random() < 0.5 else list(table)
        table.update({key: 1e3 * table[key] for key in keys})
        mutation, valid = f"mm: {', '.join(keys)}", False
    else:
        mutation = edited(rng, content)
    data = tomli_w.dumps(content)
    if kind > 0.9:
        lines = data.split("\n")
        at = pick(rng, [number for number, line in enumerate(lines) if " = " in line])
        lines[at] = f"{lines[at].split(' = ')[0]} = {pick(rng, NUMBERS + WORDS)}"
        mutation, data = lines[at][:50], "\n".join(lines)
    content = data.encode()
    if 0.75 < kind < 0.9:
        mutation, content = damaged(rng, content)
    (folder / "a.toml").write_bytes(content)
    (folder / "model.xml").write_text(model(1, GUIDED), encoding="utf-8")
    way = int(rng.integers(12))

    def use():
        isolator = wr.load_isolator(folder / "a.toml")
        isolator.save(folder / "again.toml")
        if wr.load_isolator(folder / "again.toml") != isolator:
            return "saved and loaded again it is another"
        return settled_and_shaken(wr.load_system(folder / "model.xml"), way)

    return Case(mutation, use, ("a.toml", "m1", "box", "deck", "arm"), valid)


POSITION = ["x [mm]", "y [mm]", "z [mm]"]
NAMES = ("m1", "m2", "m3", "m4")
LAYOUT = {
    "mounts": (["name", *POSITION, "isolator"],
               "|".join(f"{name} 0 enidine_wr16_400" for name in ("m1 0 0", "m2 0 400", "m3 500 0", "m4 500 400"))),
    "masses": (["name", "mass [kg]", *POSITION, "size_x [mm]", "size_y [mm]", "size_z [mm]"],
               "engine 700 250 200 300 500 400 300|tank 50 250 200 500 100 100 100"),
    "stops": (["name", *POSITION, "gap [mm]", "stiffness [MN/m]", "damping [kN s/m]"], "s1 250 200 0 12 5 1"),
    "points": (["name", *POSITION], "top 250 200 650"),
    "forces": (["name", *POSITION], "crank 250 200 300"),
}  # fmt: skip


def layouts(rng, folder):
    """Tables of mounts, masses, stops, points and forces, of which `wirerope new` makes a model; it is loaded and settled."""
    which, done, paths = pick(rng, list(LAYOUT)), "", {name: folder / f"{name}.csv" for name in LAYOUT}
    for kind, (header, rows) in LAYOUT.items():
        table, how, content = Table(list(header), [row.split() for row in rows.split("|")]), rng.random(), None
        if kind == which and how < 0.5:
            for _ in range(pick(rng, (1, 1, 2))):
                row, column = pick(rng, table.rows), int(rng.integers(len(header)))
                row[column] = pick(rng, NUMBERS if "[" in header[column] else WORDS)
                done = f"{header[column]} = {row[column]!r:.30}"
        elif kind == which and how < 0.9:
            done, _ = spoiled(rng, table)
        elif kind == which:
            done, content = damaged(rng, table.content())
        paths[kind].write_bytes(content or table.content())

    def use():
        layout = new_model(folder / "made", paths, formats=())
        system = wr.load_system(folder / "made" / "made.xml")
        if set(system.mounts) < {mount.name for mount in layout.mounts}:
            return "a mount is lost"
        if len(layout.mounts) + len(layout.masses) == 0 or not np.isfinite(system.model.body_mass).all():
            return "a mass is not finite"
        rest = wr.equilibrium(system)
        return None if np.isfinite(rest.state.values).all() else "the equilibrium is not finite"

    # A number whose decimal comma is changed, or a cell that stands twice, may be right still: the system is looked at.
    return Case(f"{which}: {done}", use, (f"{which}.csv", *NAMES, "mass", "model"))
