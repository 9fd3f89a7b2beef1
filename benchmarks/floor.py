"""The floor of all benchmarks: 2000 kg on mounts of three uncoupled Bouc-Wen axes, on a driven deck, above its bump stops."""

from typing import Literal

import numpy as np
import numpy.typing as npt

import wirerope_mj as wr

MASS = 2000.0
INERTIA = (1600.0, 2750.0, 4200.0)
CENTRE = (0.15, -0.10, 0.25)  # of mass, from the middle of the mounts: off the middle, so that the floor rocks
ALPHA, Z_MAX, K = 2e5, 400.0, 1e5
AXIS = wr.BoucWen(alpha=ALPHA, beta=0.6 * ALPHA / Z_MAX, gamma=0.4 * ALPHA / Z_MAX, n=1.0, k=K)
ISOLATOR = wr.Isolator(name="bench", roll=AXIS, shear=AXIS, axial=AXIS)
MOUNT_HEIGHT = 0.1  # of the mounts' middle above the deck
STOP_GAP = 0.08

Mounts = Literal["wire rope", "linear springs", "none"]


def mount_positions(n_mounts: int) -> npt.NDArray[np.float64]:
    """Return the mounts' places in two rows along x, from the middle of them all [m], (n_mounts, 3)."""
    x = np.linspace(-1.8, 1.8, n_mounts // 2)
    return np.array([[place, side, 0.0] for place in x for side in (-1.2, 1.2)])


def floor_mjcf(n_mounts: int, mounts: Mounts = "wire rope") -> str:
    """Return the floor as MJCF, without gravity; only what holds it differs between the three kinds of `mounts`."""
    places = mount_positions(n_mounts) if mounts != "none" else np.zeros((0, 3))
    numbered = [(f"m{i + 1}", *place) for i, place in enumerate(places)]
    deck_sites = "".join(f'<site name="deck/{m}" pos="{x} {y} {MOUNT_HEIGHT}"/>' for m, x, y, _ in numbered)
    floor_sites = "".join(f'<site name="floor/{m}" pos="{x} {y} 0"/>' for m, x, y, _ in numbered)
    corners = [(x, y) for x in (-1.9, 1.9) for y in (-1.3, 1.3)]
    radius = 0.01
    height = STOP_GAP + radius - MOUNT_HEIGHT
    stops = "".join(
        f'<geom name="stop{i}" type="sphere" size="{radius}" pos="{x} {y} {height}" mass="0"/>'
        for i, (x, y) in enumerate(corners)
    )
    pairs = "".join(f'<pair geom1="stop{i}" geom2="plate" condim="1"/>' for i in range(len(corners)))
    return f"""<mujoco model="bench_floor">
  <option gravity="0 0 0" integrator="RK4" timestep="0.001" tolerance="1e-15"><flag autoreset="disable"/></option>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
    <body name="deck">
      <joint name="deck_x" type="slide" axis="1 0 0" armature="1e10"/>
      <joint name="deck_y" type="slide" axis="0 1 0" armature="1e10"/>
      <joint name="deck_z" type="slide" axis="0 0 1" armature="1e10"/>
      <geom name="plate" type="box" size="2.4 1.6 0.02" pos="0 0 -0.02" mass="1000"/>{deck_sites}
    </body>
    <body name="floor" pos="0 0 {MOUNT_HEIGHT}">
      <freejoint/>
      <inertial pos="{_text(CENTRE)}" mass="{MASS}" diaginertia="{_text(INERTIA)}"/>
      <geom name="frame" type="box" size="2.1 1.4 0.05" pos="0 0 0.2"/>{stops}{floor_sites}
    </body>
  </worldbody>
  <contact>{pairs}</contact>
  {_custom(numbered) if mounts == "wire rope" else _springs(numbered) if mounts == "linear springs" else ""}
</mujoco>"""


def _text(vector: tuple[float, ...]) -> str:
    return " ".join(str(value) for value in vector)


def _custom(numbered: list[tuple[str, float, float, float]]) -> str:
    tuples = "".join(
        f'<tuple name="mount/{m}"><element objtype="site" objname="floor/{m}"/>'
        f'<element objtype="site" objname="deck/{m}"/><element objtype="text" objname="isolator/bench"/></tuple>'
        for m, *_ in numbered
    )
    return f'<custom><text name="isolator/bench" data="bench.toml"/>{tuples}</custom>'


def _springs(numbered: list[tuple[str, float, float, float]]) -> str:
    """MuJoCo's own linear springs: three site transmissions per mount, the tangent of the Bouc-Wen axis as stiffness."""
    actuators = "".join(
        f'<general site="floor/{m}" refsite="deck/{m}" gear="{gear} 0 0 0" gaintype="fixed" gainprm="0" '
        f'biastype="affine" biasprm="0 {-(K + ALPHA)} 0"/>'
        for m, *_ in numbered
        for gear in ("1 0 0", "0 1 0", "0 0 1")
    )
    return f"<actuator>{actuators}</actuator>"
