"""Models: MJCF files, damaged or with wrong numbers, names and elements, loaded and simulated."""

import re
from functools import cache

import numpy as np
from campaign import Case
from hostile import NUMBERS, WORDS, damaged, pick

import wirerope_mj as wr
from wirerope_mj.engine.simulation.stability import stable_step
from wirerope_mj.engine.system.model_files import write_model
from wirerope_mj.foundation.resources import models_folder

SHOCK = wr.HalfSine(peak=20.0, duration=0.002, direction="z")

LAW = wr.BoucWen(alpha=1e5, beta=75.0, gamma=30.0, n=1.2, k=4e4)

SMALL = """<mujoco>
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


@cache
def texts() -> tuple[str, ...]:
    """Return the models that are mutated: small ones of this file, several times, and those that ship."""
    mounts = [
        f'<tuple name="mount/m{i}"><element objtype="site" objname="p{i}"/><element objtype="site" objname="b{i}"/>'
        '<element objtype="text" objname="isolator/a"/></tuple>'
        for i in (1, 2, 3)
    ]
    guided = '<joint name="box_x" type="slide" axis="1 0 0"/><joint name="box_z" type="slide" axis="0 0 1"/>'
    included = '<include file="part.xml"/>'
    small = [
        SMALL.format(joint="<freejoint/>", more="", mounts="\n".join(mounts)),
        SMALL.format(joint=guided, more=included, mounts="\n".join(mounts)),
        SMALL.format(joint="<freejoint/>", more="", mounts=mounts[0]),
        SMALL.format(joint="<freejoint/>", more="", mounts="\n".join(mounts[:2])),
    ]
    shipped = [path.read_text(encoding="utf-8") for path in sorted(models_folder().glob("*.xml"))]
    return (*small, *small, *shipped)


PART = '<mujoco>\n<body name="rack" pos="1 0 0"><geom name="shelf" size=".1" mass="1"/></body>\n</mujoco>\n'

VALUE = re.compile(r'([\w/]+)="([^"]*)"')
ELEMENT = re.compile(r"<(\w+)\b[^<>]*/>")
NUMBER = re.compile(r"-?\d*\.?\d+(?:e-?\d+)?")


def mutate(rng, folder):
    """Write a mutated model and its isolator, and return the case."""
    text = pick(rng, texts())
    if rng.random() < 0.12:
        mutation, content = "bytes", damaged(text.encode(), rng)
    else:
        change = pick(rng, CHANGES)
        mutation, text = change(text, rng)
        content = text.encode()
    part = PART.encode()
    if rng.random() < 0.03:
        mutation, part = mutation + ", bytes of part.xml", damaged(part, rng)
    (folder / "model.xml").write_bytes(content)
    (folder / "part.xml").write_bytes(part)
    wr.Isolator(name="A", roll=LAW, shear=LAW, axial=LAW).save(folder / "a.toml")
    names = re.findall(r'name="([^"/]{2,})', text)
    inputs = {"folder": folder, "way": int(rng.integers(12))}
    return Case(mutation, inputs, names=("model.xml", "part.xml", "a.toml", "gravity", "`accuracy`", *names))


def _values(text):
    """Return the places of the attributes below the defaults."""
    return list(VALUE.finditer(text))


def one_number(text, rng):
    """Replace one number by another."""
    found = [m for m in _values(text) if NUMBER.search(m[2]) and m[1] not in ("name", "class", "rgba", "file")]
    place = pick(rng, found)
    numbers = list(NUMBER.finditer(place[2]))
    number = pick(rng, numbers)
    new = pick(rng, NUMBERS)
    if rng.random() < 0.4:
        new = f"{float(number[0]) * pick(rng, (-1.0, 1e3, 1e-3, 1e6, 1e-6, 10.0, 1e12)):.17g}"
    begin = place.start(2) + number.start()
    return f"{place[1]}: {number[0]} to {new[:20]}", text[:begin] + new + text[begin + len(number[0]) :]


def one_value(text, rng):
    """Replace the value of one attribute by a word."""
    place, new = pick(rng, _values(text)), pick(rng, WORDS)
    return f'{place[1]}: "{place[2][:20]}" to "{new[:20]}"', text[: place.start(2)] + new + text[place.end(2) :]


def no_attribute(text, rng):
    """Leave out an attribute, or misspell it."""
    place = pick(rng, _values(text))
    new = "" if rng.random() < 0.5 else "q" + place[0]
    return f"{place[0][:30]} to {new[:30]!r}", text[: place.start()] + new + text[place.end() :]


def one_element(text, rng):
    """Leave out an element, repeat it, or put it elsewhere."""
    found = list(ELEMENT.finditer(text))
    place, other, kind = pick(rng, found), pick(rng, found), rng.integers(3)
    if kind == 0:
        return f"no {place[0][:60]}", text[: place.start()] + text[place.end() :]
    if kind == 1:
        return f"twice {place[0][:60]}", text[: place.end()] + place[0] + text[place.end() :]
    return f"{place[0][:40]} at {other[0][:40]}", text[: other.start()] + place[0] + text[other.end() :]


def two_values(text, rng):
    """Swap two values of one attribute."""
    found = _values(text)
    place = pick(rng, found)
    other = pick(rng, [m for m in found if m[1] == place[1]])
    first, second = sorted((place, other), key=lambda m: m.start())
    if first is second:
        return "nothing", text
    middle = text[first.end(2) : second.start(2)]
    swapped = text[: first.start(2)] + second[2] + middle + first[2] + text[second.end(2) :]
    return f"swapped {place[1]} {place[2][:20]} and {other[2][:20]}", swapped


def millimetres(text, rng):
    """Write the positions of the whole model, or its sizes, in millimetres."""
    which = pick(rng, (("pos",), ("size",), ("pos", "size")))

    def scaled(match):
        if match[1] not in which:
            return match[0]
        return f'{match[1]}="{NUMBER.sub(lambda m: f"{1e3 * float(m[0]):g}", match[2])}"'

    return f"mm: {which}", VALUE.sub(scaled, text)


def one_mass(text, rng):
    """Make one mass or inertia, or all of them, far larger or smaller."""
    factor = 10.0 ** rng.integers(-12, 13)
    found = [m for m in _values(text) if m[1] in ("mass", "diaginertia")]
    chosen = [pick(rng, found)] if rng.random() < 0.7 else found
    for place in reversed(chosen):
        new = " ".join(f"{factor * float(v):.17g}" for v in place[2].split())
        text = text[: place.start(2)] + new + text[place.end(2) :]
    return f"{len(chosen)} masses times {factor:g}", text


def gravity(text, rng):
    """Replace gravity."""
    size = pick(rng, ("0", "nan", "inf", "-9806.65", "-1e6", "-1e9", "1e9", "-1e300", "1e-300", "9.80665", "-98.0665", "-1e4"))
    axes = ["0", "0", "0"]
    axes[int(rng.integers(3))] = size
    return f"gravity {axes}", re.sub(r'gravity="[^"]*"', f'gravity="{" ".join(axes)}"', text)


def one_axis(text, rng):
    """Turn the axis of a joint: along another, nowhere, or close to another."""
    new = pick(rng, ("1 0 0", "0 1 0", "0 0 1", "1 1 1", "0 0 0", "1 0 1", "1e-20 0 0", "1 1e-12 0", "0 nan 1", "1e200 0 0"))
    found = [m for m in _values(text) if m[1] == "axis"]
    place = pick(rng, found)
    return f"axis {place[2]} to {new}", text[: place.start(2)] + new + text[place.end(2) :]


CHANGES = (one_number, one_number, one_number, one_value, no_attribute, one_element, two_values, two_values)
CHANGES += (millimetres, one_mass, gravity, one_axis)


def use(case):
    """Load the model, find where it rests and its modes, and simulate a small shock; copy it as a run does."""
    path, way = case.inputs["folder"] / "model.xml", case.inputs["way"]
    system = wr.load_system(path)
    if way % 4 == 0:
        copy = wr.load_system(write_model(system, case.inputs["folder"] / "run" / "model"))
        if list(copy.mounts) != list(system.mounts) or not np.array_equal(copy.model.qpos0, system.model.qpos0):
            return "the copy of the model is another"
    return rest_and_shake(system, way)


def rest_and_shake(system, way):
    """Return a complaint if a result of `system` is not finite, or it does not rest where it is said to."""
    e = wr.equilibrium(system, history="relaxed" if way % 5 == 0 else "virgin")
    for name, load in e.mounts.items():
        if not np.isfinite([*load.deflection, *load.force]).all():
            return f"equilibrium: mount {name} has {load.deflection}, {load.force}"
    if not e.residual <= 1e-6 * max(1.0, float(np.linalg.norm(system.model.opt.gravity))):
        return f"equilibrium: residual {e.residual}"
    if way % 3:
        modes = wr.modes(system, history=e.history)
        said = np.array(["(tips over)" in words for words in modes.descriptions])
        if not np.isfinite(modes.frequencies[~said]).all():
            return f"modes: {modes.frequencies}"
    motion = SHOCK if len(system.assembly.driven_dofs) else wr.HalfSine(peak=1e-9, duration=0.001, direction="z", start=9.0)
    if stable_step(system) < 1e-7:
        return None  # a shock on so stiff a mount takes hours: no fault
    step = None if way == 0 else min(stable_step(system), 2e-4)
    response = wr.simulate(system, motion, duration=0.003, timestep=step, sample_rate=1000.0)
    for kind in ("bodies", "points", "mounts"):
        for name, entry in getattr(response, kind).items():
            for attribute in ("position", "acceleration", "deflection", "force"):
                values = getattr(entry, attribute, None)
                if values is not None and not np.isfinite(values).all():
                    return f"simulate: {kind} {name}: {attribute} is not finite"
    return None
