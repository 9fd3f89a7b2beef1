"""MJCF texts that several cases use: written for them, in the house's way to declare mounts."""

from collections.abc import Mapping, Sequence

import numpy as np

import wirerope_mj as wr
from wirerope_mj.mounts.laws import Law, Loop

DECK = '<body name="deck">{slides}<geom size=".1" mass="5"/>{sites}</body>'
SLIDES = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}


def deck(sites: Mapping[str, str], *, slides: str = "xyz") -> str:
    """Return a driven deck with slides along the axes named and sites {name: other attributes}."""
    joints = "".join(f'<joint name="deck_{axis}" type="slide" axis="{SLIDES[axis]}"/>' for axis in slides)
    return DECK.format(
        slides=joints, sites="".join(f'<site name="{name}" {attributes}/>' for name, attributes in sites.items())
    )


def mounts(pairs: Sequence[tuple[str, str, str, str]]) -> str:
    """Return the elements that declare mounts: (name, payload site, base site, isolator) each."""
    texts = [f'<text name="isolator/{name}" data="{name}.toml"/>' for name in dict.fromkeys(pair[3] for pair in pairs)]
    tuples = [
        f'<tuple name="mount/{name}"><element objtype="site" objname="{payload}"/>'
        f'<element objtype="site" objname="{base}"/><element objtype="text" objname="isolator/{isolator}"/></tuple>'
        for name, payload, base, isolator in pairs
    ]
    return "".join(texts + tuples)


def mjcf(world: str, *, custom: str = "", other: str = "", gravity: float = 0.0) -> str:
    """Return MJCF text of the bodies `world`; geoms do not touch unless they say so, gravity [m/s^2] points down."""
    return (
        f'<mujoco><option gravity="0 0 {-gravity!r}" integrator="RK4"/>'
        '<default><geom contype="0" conaffinity="0"/></default>'
        f"<worldbody>{world}</worldbody><custom>{custom}</custom>{other}</mujoco>"
    )


def oscillator(laws: Mapping[str, Law], *, mass: float, gravity: float = 0.0) -> wr.System:
    """Return a mass on parallel vertical mounts m_NAME, one for each law, on a driven deck; both have a vertical slide."""
    world = deck({"b": 'pos="0 0 .2"'}, slides="z") + (
        '<body name="mass" pos="0 0 .3"><joint type="slide" axis="0 0 1"/>'
        f'<geom size=".1" mass="{mass!r}"/><site name="p" pos="0 0 -.1"/></body>'
    )
    pairs = [(f"m_{name}", "p", "b", name) for name in laws]
    isolators = {name: wr.Isolator(name=name, axial=law) for name, law in laws.items()}
    return wr.load_system(mjcf(world, custom=mounts(pairs), gravity=gravity), isolators=isolators)


def chain(laws: Sequence[Law], masses: Sequence[float]) -> wr.System:
    """Return masses above each other, each on a mount m1, m2, .. on the one below, the first on a driven deck; no gravity."""
    world, pairs, isolators = deck({"b0": 'pos="0 0 .2"'}, slides="z"), [], {}
    for i, (law, mass) in enumerate(zip(laws, masses, strict=True), start=1):
        world += (
            f'<body name="mass{i}" pos="0 0 {0.1 + 0.2 * i!r}"><joint type="slide" axis="0 0 1"/>'
            f'<geom size=".1" mass="{mass!r}"/><site name="p{i}" pos="0 0 -.1"/><site name="b{i}" pos="0 0 .1"/></body>'
        )
        pairs.append((f"m{i}", f"p{i}", f"b{i - 1}", f"a{i}"))
        isolators[f"a{i}"] = wr.Isolator(name=f"a{i}", axial=law)
    base = '<tuple name="base"><element objtype="body" objname="deck"/></tuple>'
    return wr.load_system(mjcf(world, custom=base + mounts(pairs)), isolators=isolators)


def path_through(points: Sequence[float], per_segment: int) -> np.ndarray:
    """Return samples of a path from 0 through turning points, straight between them, (1 + per_segment * n,)."""
    ends = [0.0, *points]
    legs = [np.linspace(a, b, per_segment + 1)[1:] for a, b in zip(ends[:-1], ends[1:], strict=True)]
    return np.concatenate([[0.0], *legs])


def steady_loop(law: Law, amplitude: float, cycles: int = 60) -> Loop:
    """Return the last of many cycles from +A to -A and back, whose memory of the beginning has gone."""
    lead = np.tile([amplitude, -amplitude], cycles)
    along = np.linspace(amplitude, -amplitude, 401)
    start = law.trace(np.concatenate([[0.0], lead, [amplitude]])).internal_states[-1]
    return law.trace(np.concatenate([along, along[-2::-1]]), initial_states=start)
