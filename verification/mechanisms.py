"""MuJoCo models with linear mounts against the same models with MuJoCo's own elements in the mounts' place.

The models are small ones written here in the style of what MuJoCo is used for (a jointed figure, a slider-crank that an
equality closes, things falling into a tray); they are nobody else's files. In the reference a mount is three actuators between
its sites, one along each axis, whose bias is -k length - c velocity, or a tendon that is a spring; MuJoCo's own integrator
steps it.
"""

import warnings
from collections.abc import Callable, Sequence

import mujoco
import numpy as np

import wirerope_mj as wr
from verification.case import Case, Comparison, series
from verification.models import mounts

STIFFNESS = {"roll": (9.0e3, 70.0), "shear": (1.2e4, 50.0), "axial": (2.5e4, 90.0)}
"""Spring [N/m] and damper [N s/m] along each axis of a mount."""

ISOTROPIC = {axis: (1.5e4, 0.0) for axis in STIFFNESS}

FIGURE = """
<body name="torso" pos="0 0 1.3"><freejoint/>
  <geom type="capsule" fromto="0 0 -.2 0 0 .25" size=".11" mass="28"/><geom type="sphere" pos="0 0 .42" size=".1" mass="4.5"/>
  <site name="p1" pos=".12 .1 -.3"/><site name="p2" pos=".12 -.1 -.3"/><site name="p3" pos="-.14 0 -.3" euler="0 20 30"/>
  <body pos="0 .2 .2"><joint type="ball" damping=".4"/><geom type="capsule" fromto="0 0 0 0 .05 -.28" size=".04" mass="2.1"/>
    <body pos="0 .05 -.28"><joint type="hinge" axis="0 1 0" range="-120 5" damping=".2" armature=".01"/>
      <geom type="capsule" fromto="0 0 0 .1 0 -.24" size=".035" mass="1.4"/><site name="point/hand" pos=".1 0 -.26"/></body>
  </body>
  <body pos="0 -.2 .2"><joint type="ball" damping=".4"/><geom type="capsule" fromto="0 0 0 0 -.05 -.28" size=".04" mass="2.1"/>
    <body pos="0 -.05 -.28"><joint type="hinge" axis="0 1 0" damping=".2" stiffness="3"/>
      <geom type="capsule" fromto="0 0 0 .1 0 -.24" size=".035" mass="1.4"/></body></body>
  <body pos="0 .1 -.25"><joint type="hinge" axis="0 1 0" damping="1" stiffness="20"/>
    <joint type="hinge" axis="1 0 0" damping="1"/>
    <geom type="capsule" fromto="0 0 0 .05 0 -.4" size=".06" mass="7"/>
    <body pos=".05 0 -.4"><joint type="hinge" axis="0 1 0" damping=".6" range="-2 140"/>
      <geom type="capsule" fromto="0 0 0 -.05 0 -.4" size=".05" mass="3.5"/><site name="point/foot" pos="-.05 0 -.45"/></body>
  </body>
  <body pos="0 -.1 -.25"><joint type="hinge" axis="0 1 0" damping="1" stiffness="20"/>
    <joint type="hinge" axis="1 0 0" damping="1"/>
    <geom type="capsule" fromto="0 0 0 .05 0 -.4" size=".06" mass="7"/>
    <body pos=".05 0 -.4"><joint type="hinge" axis="0 1 0" damping=".6" range="-2 140"/>
      <geom type="capsule" fromto="0 0 0 -.05 0 -.4" size=".05" mass="3.5"/></body></body>
</body>
"""
CRANK = """
<body name="frame" pos="0 0 .5"><freejoint/><geom type="box" size=".4 .2 .05" mass="30"/>
  <site name="p1" pos=".3 .15 -.1"/><site name="p2" pos=".3 -.15 -.1"/><site name="p3" pos="-.3 .15 -.1"/>
  <site name="p4" pos="-.3 -.15 -.1"/>
  <body pos="-.2 0 .12"><joint name="crank" type="hinge" axis="0 1 0" damping=".02"/>
    <geom type="box" pos=".06 0 0" size=".08 .02 .02" mass="1.6"/>
    <body name="rod" pos=".12 0 0"><joint type="hinge" axis="0 1 0"/>
      <geom type="box" pos=".16 0 0" size=".16 .015 .015" mass="1.1"/><site name="point/rod" pos=".32 0 0"/></body></body>
  <body name="piston" pos=".24 0 .12"><joint type="slide" axis="1 0 0" damping="2"/>
    <geom type="box" size=".04 .04 .04" mass="2.2"/><site name="point/piston"/></body>
</body>
"""
# as rigid as `load_system` makes what says no impedance
CRANK_LOOP = '<equality><connect body1="rod" body2="piston" anchor=".32 0 0" solimp="0.9999 0.9999"/></equality>'
PILE = """
<body name="tray" pos="0 0 .4"><freejoint/><geom type="box" size=".3 .3 .02" mass="12" contype="1" conaffinity="1"/>
  <geom type="box" pos=".3 0 .06" size=".02 .3 .06" mass="1" contype="1" conaffinity="1"/>
  <geom type="box" pos="-.3 0 .06" size=".02 .3 .06" mass="1" contype="1" conaffinity="1"/>
  <site name="p1" pos=".2 .2 -.1"/><site name="p2" pos=".2 -.2 -.1"/><site name="p3" pos="-.2 .2 -.1"/>
  <site name="p4" pos="-.2 -.2 -.1"/>
</body>
<body pos=".05 .02 .5"><freejoint/>
  <geom type="sphere" size=".06" mass="1.5" contype="1" conaffinity="1"/><site name="point/ball"/></body>
<body pos=".07 -.12 .56" euler="10 5 0"><freejoint/>
  <geom type="capsule" size=".04 .08" mass="1.2" contype="1" conaffinity="1"/><site name="point/capsule"/></body>
<body pos=".06 .03 .64" euler="4 8 20"><freejoint/>
  <geom type="box" size=".05 .06 .04" mass="2" contype="1" conaffinity="1"/><site name="point/box"/></body>
"""

POINTS = {
    "figure": {"1": (0.12, 0.1, 1.0), "2": (0.12, -0.1, 1.0), "3": (-0.14, 0.0, 1.0)},
    "crank": {"1": (0.3, 0.15, 0.4), "2": (0.3, -0.15, 0.4), "3": (-0.3, 0.15, 0.4), "4": (-0.3, -0.15, 0.4)},
    "pile": {"1": (0.2, 0.2, 0.3), "2": (0.2, -0.2, 0.3), "3": (-0.2, 0.2, 0.3), "4": (-0.2, -0.2, 0.3)},
}
LEANS = ("0 0 0", "25 0 10", "0 -35 40", "15 15 -60")
"""Orientation of the base sites: Euler angles in degrees."""


def _text(name: str, world: str, *, custom: str, joints: str, actuators: str = "", other: str = "") -> str:
    """Return the model: its deck with base sites, the bodies, and what stands for the mounts."""
    sites = "".join(
        f'<site name="b{i}" pos="{" ".join(map(str, at))}" euler="{LEANS[int(i) - 1]}"/>' for i, at in POINTS[name].items()
    )
    return (
        '<mujoco><compiler angle="degree"/><option integrator="RK4" gravity="0 0 -9.81" tolerance="1e-14"/>'
        '<default><geom contype="0" conaffinity="0"/></default><worldbody>'
        f'<body name="deck">{joints}<geom size=".05" mass="5"/>{sites}</body>{world}</worldbody>'
        f"<custom>{custom}</custom>{actuators}{other}</mujoco>"
    )


def _own_elements(name: str, laws: dict[str, tuple[float, float]]) -> str:
    """Return three actuators in the place of each mount: force along an axis of the base site."""
    lines = []
    for i in POINTS[name]:
        for column, (k, c) in enumerate(laws.values()):
            gear = ["0"] * 6
            gear[column] = "1"
            lines.append(
                f'<general site="p{i}" refsite="b{i}" gear="{" ".join(gear)}" gaintype="fixed" gainprm="0" '
                f'biastype="affine" biasprm="0 {-k!r} {-c!r}"/>'
            )
    return f"<actuator>{''.join(lines)}</actuator>"


def _tendons(name: str, k: float) -> str:
    """Return a spring without length in the place of each mount, the same in all directions."""
    springs = "".join(
        f'<spatial springlength="0" stiffness="{k!r}"><site site="p{i}"/><site site="b{i}"/></spatial>' for i in POINTS[name]
    )
    return f"<tendon>{springs}</tendon>"


def _plain(text: str, sites: Sequence[str], stop: float, step: float, every: int) -> np.ndarray:
    """Return where sites are, stepped by MuJoCo alone, (n_t, n, 3) [m]."""
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.timestep = step
    data = mujoco.MjData(model)
    numbers = [model.site(site).id for site in sites]
    mujoco.mj_forward(model, data)
    rows = [data.site_xpos[numbers].copy()]
    for count in range(1, round(stop / step) + 1):
        mujoco.mj_step(model, data)
        if count % every == 0:
            mujoco.mj_kinematics(model, data)
            rows.append(data.site_xpos[numbers].copy())
    return np.array(rows)


def _compare(
    name: str, world: str, points: Sequence[str], *, stop: float, step: float, tendon: bool = False, other: str = ""
) -> Comparison:
    """Return the comparison of where points are after release from the modelled geometry under gravity."""
    laws = ISOTROPIC if tendon else STIFFNESS
    slides = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1"))
    base = '<tuple name="base"><element objtype="body" objname="deck"/></tuple>'
    custom = base + mounts([(f"m{i}", f"p{i}", f"b{i}", "a") for i in POINTS[name]])
    roll, shear, axial = (wr.KelvinVoigt(k=k, c=c) for k, c in laws.values())
    isolator = wr.Isolator(name="a", roll=roll, shear=shear, axial=axial)
    system = wr.load_system(_text(name, world, custom=custom, joints=slides, other=other), isolators={"a": isolator})
    every = 10
    quiet = wr.HalfSine(peak=1.0, duration=0.011, start=1e3, direction="z")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", wr.AccuracyWarning)  # of contacts, whose stiffness is the same on both sides here
        response = wr.simulate(
            system, quiet, duration=stop, initial="unloaded", timestep=step, sample_rate=1.0 / (every * step)
        )
    own = "" if tendon else _own_elements(name, laws)
    extra = _tendons(name, ISOTROPIC["axial"][0]) if tendon else ""
    reference = _text(name, world, custom="", joints="", actuators=own, other=other + extra)
    expected = _plain(reference, [f"point/{point}" for point in points], stop, step, every)
    found = np.stack([response.points[point].position for point in points], axis=1)
    return series(expected - expected[0], found - expected[0], "m")


def _case(name: str, title: str, run: Callable[[], Comparison], bound: float, reason: str) -> Case:
    """Return a case of this file."""
    return Case(
        name=name, title=title,
        compares="Positions of marked points after release under gravity; largest difference over the largest displacement.",
        source=f"MuJoCo {mujoco.__version__.split('.')[0]} stepping the same model with its own elements in the mounts' place",
        date="each run", bound=bound, reason=reason, run=run,
    )  # fmt: skip


SAME_METHOD = "both take the same Runge-Kutta steps of one model: what is left is rounding, grown by the motion"

CASES = (
    _case("mjcf-figure-actuators", "A jointed figure on three leaning mounts, against site actuators",
          lambda: _compare("figure", FIGURE, ("hand", "foot"), stop=1.0, step=2.5e-4), 1e-10, SAME_METHOD),
    _case("mjcf-figure-tendons", "The same figure on three springs equal in all directions, against spatial tendons",
          lambda: _compare("figure", FIGURE, ("hand", "foot"), stop=1.0, step=2.5e-4, tendon=True), 1e-10, SAME_METHOD),
    _case("mjcf-crank-equality", "A slider-crank closed by an equality constraint, on four leaning mounts",
          lambda: _compare("crank", CRANK, ("rod", "piston"), stop=1.0, step=2.5e-4, other=CRANK_LOOP), 1e-10, SAME_METHOD),
    _case("mjcf-pile-contacts", "A ball, a capsule and a box falling into a tray on four leaning mounts",
          lambda: _compare("pile", PILE, ("ball", "capsule", "box"), stop=0.6, step=2.5e-4), 1e-8,
          "both take the same Runge-Kutta steps; rounding grows at every contact that begins"),
)  # fmt: skip
