"""MJCF texts and systems that several tests use."""

import sys
import textwrap
from collections import Counter
from functools import partial

import numpy as np
import pytest

import wirerope_mj as wr


def calls(work):
    """Count the calls that something makes: of functions of Python as "call", and of built-in ones by their names."""
    counts = Counter()
    sys.setprofile(lambda frame, event, what: counts.update([what.__name__ if event == "c_call" else event]))
    try:
        work()
    finally:
        sys.setprofile(None)
    return counts


def tuples(mounts):
    """Return the <custom> elements of `mounts`: (name, payload site, base site, isolator) each."""
    isolators = dict.fromkeys(isolator for *_, isolator in mounts)
    lines = [f'<text name="isolator/{name}" data="{name}.toml"/>' for name in isolators]
    for name, payload, base, isolator in mounts:
        lines.append(
            f'<tuple name="mount/{name}"><element objtype="site" objname="{payload}"/>'
            f'<element objtype="site" objname="{base}"/><element objtype="text" objname="isolator/{isolator}"/></tuple>'
        )
    return "\n".join(lines)


def mjcf(world, mounts, *, gravity=0.0, custom="", other=""):
    """Return MJCF text of the bodies `world` and the mounts; gravity [m/s^2] points down."""
    return textwrap.dedent(f"""\
        <mujoco>
        <option gravity="0 0 {-gravity!r}"/>
        <default><geom contype="0" conaffinity="0"/></default>
        <worldbody>{world}</worldbody>
        <custom>{custom}{tuples(mounts)}</custom>
        {other}
        </mujoco>""")


def deck(sites, *, slides="xyz", inside=""):
    """Return a driven deck with slides and `sites` {name: extra attributes}."""
    axes = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}
    joints = "".join(f'<joint name="deck_{s}" type="slide" axis="{axes[s]}"/>' for s in slides)
    points = "".join(f'<site name="{name}" {attributes}/>' for name, attributes in sites.items())
    return f'<body name="deck">{joints}<geom size=".1" mass="5"/>{points}{inside}</body>'


def sdof_text(*, mass=3.5, gravity=0.0):
    """Return a mass on one vertical mount "m1", with isolator "a", on a driven deck; both have one vertical slide."""
    world = (
        deck({"b": 'pos="0 0 .2"'}, slides="z") + '<body name="mass" pos="0 0 .3"><joint name="mass_z" type="slide" '
        f'axis="0 0 1"/><geom size=".1" mass="{mass}"/><site name="p" pos="0 0 -.1"/></body>'
    )
    return mjcf(world, [("m1", "p", "b", "a")], gravity=gravity)


def sdof(law, *, mass=3.5, gravity=0.0):
    """Return the system of `sdof_text` with `law` along its axis."""
    isolators = {"a": wr.Isolator(name="a", axial=law)}
    return wr.load_system(sdof_text(mass=mass, gravity=gravity), isolators=isolators)


def rack_on_floor_text(*, gravity):
    """Return a chain of vertical slides: a rack of 3 kg on mount "m2" on a floor of 8 kg on mount "m1" on a driven deck.

    Their isolators are "rack" and "floor".
    """

    def stage(name, below, z, mass, site):
        inner = f'<site name="{site}" pos="0 0 .1"/>' if site else ""
        return (
            f'<body name="{name}" pos="0 0 {z}"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="{mass}"/>'
            f'<site name="{below}" pos="0 0 -.1"/>{inner}</body>'
        )

    world = deck({"b": 'pos="0 0 .2"'}, slides="z")
    world += stage("floor", "pf", 0.3, 8, "bf") + stage("rack", "pr", 0.5, 3, "")
    base = '<tuple name="base"><element objtype="body" objname="deck"/></tuple>'
    return mjcf(world, [("m1", "pf", "b", "floor"), ("m2", "pr", "bf", "rack")], gravity=gravity, custom=base)


def hysteresis(*, alpha, z_max, n=1.2, share=0.7):
    """Return alpha, beta, gamma, n of a Bouc-Wen law with a given bound z_max [N]; `share` of it is beta's."""
    total = alpha / z_max**n
    return {"alpha": alpha, "beta": share * total, "gamma": (1.0 - share) * total, "n": n}


def quiet(direction="z"):
    """Return a motion that begins long after every test has ended: the base rests."""
    return wr.HalfSine(peak=1.0, duration=0.011, direction=direction, start=1e3)


def rotation(quaternion):
    """Return rotation matrices (..., 3, 3) of unit quaternions (..., 4), w first."""
    w, x, y, z = np.moveaxis(np.asarray(quaternion), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def both_engines():
    """Return a fixture that lets all tests of a module simulate by the kernel where it holds, and again by MuJoCo."""

    @pytest.fixture(autouse=True, scope="module", params=["auto", "mujoco"])
    def engine(request):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(wr, "simulate", partial(wr.simulate, engine=request.param))
            yield request.param

    return engine
