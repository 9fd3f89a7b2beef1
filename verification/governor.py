"""The stiff flyball governor, problem A05 of the IFToMM library of multibody benchmarks.

A shaft that turns freely, a slider on it, two rods with balls hinged at its top, and a stiff spring and damper from the slider
to the middle of each rod. The governor itself has no mount: it stands beside a mass on a mount in a model that the library
loads and steps, so that what is checked is its stepping of a stiff mechanism with joints and tendons of MuJoCo.
"""

from functools import cache

import mujoco
import numpy as np
from scipy.integrate import solve_ivp

import wirerope_mj as wr
from verification.case import Case, Comparison, series, single_values
from verification.models import deck, mjcf, mounts

GRAVITY = 9.81
STIFFNESS, DAMPER, REST = 8.0e5, 4.0e4, 0.5
BALL, ROD, SLIDER, ARM = 5.0, 0.3, 3.0, 0.05
"""Masses [kg], of boxes of 3000 kg/m^3 but for the ball, and the distance of the hinges from the axis [m]."""

SPIN, ANGLE, HEIGHT = 2.0 * np.pi, np.radians(60.0), 0.5
"""Initial angular velocity of the shaft [rad/s], of the rods from the vertical, and of the slider above the foot [m]."""

ROD_INERTIA = np.array([ROD * (1.0 + 1e-4) / 12.0, ROD * (1.0 + 1e-4) / 12.0, ROD * 2e-4 / 12.0])
SLIDER_INERTIA = SLIDER * 0.02 / 12.0
SHAFT_INERTIA = ROD * 2e-4 / 12.0

STOP, INTERVAL = 10.0, 0.1
READ = {0.5: 0.743, 1.0: 0.502, 1.5: 0.740, 2.0: 0.507, 2.6: 0.740, 3.1: 0.502, 3.6: 0.743, 4.1: 0.501, 4.6: 0.743, 5.1: 0.502,
        5.6: 0.740, 6.1: 0.506, 7.7: 0.743, 8.7: 0.743, 9.7: 0.741}  # fmt: skip
"""Slider height [m] at corners of the printed reference polygon, which has one every 0.1 s; measured in the figure to the width
of its line, 0.002 m."""


def _rates(_: float, y: np.ndarray) -> list[float]:
    """Return the rates of slider height, rod angle, and their rates and the shaft's, from Lagrange's equations."""
    s, th, ds, dth, spin = y
    sin, cos = np.sin(th), np.cos(th)
    inertia = (
        SHAFT_INERTIA
        + SLIDER_INERTIA
        + 2.0 * (ROD * (ARM + 0.5 * sin) ** 2 + ROD_INERTIA[0] * sin**2 + ROD_INERTIA[2] * cos**2 + BALL * (ARM + sin) ** 2)
    )
    slope = 4.0 * cos * (0.5 * ROD * (ARM + 0.5 * sin) + (ROD_INERTIA[0] - ROD_INERTIA[2]) * sin + BALL * (ARM + sin))
    swing = 2.0 * (0.25 * ROD + ROD_INERTIA[0] + BALL)
    across, up = 0.5 * sin, 1.0 - 0.5 * cos - s
    length = np.hypot(across, up)
    by_th, by_s = 0.5 * (across * cos + up * sin) / length, -up / length
    force = STIFFNESS * (length - REST) + DAMPER * (by_th * dth + by_s * ds)
    return [
        ds,
        dth,
        -GRAVITY - 2.0 * force * by_s / SLIDER,
        (0.5 * slope * spin**2 - 2.0 * force * by_th - 2.0 * GRAVITY * (0.5 * ROD + BALL) * sin) / swing,
        -slope * dth * spin / inertia,
    ]


def _model() -> wr.System:
    """Return the governor and, beside it, a mass on a mount."""
    rods = ""
    for side, sign in (("a", 1), ("b", -1)):
        inertia = " ".join(f"{value!r}" for value in ROD_INERTIA.tolist())
        rods += (
            f'<body name="rod_{side}" pos="{sign * ARM} 0 1" euler="0 {-sign * float(np.degrees(ANGLE))!r} 0">'
            f'<joint type="hinge" axis="0 1 0"/><inertial pos="0 0 -.5" mass="{ROD}" diaginertia="{inertia}"/>'
            f'<site name="middle_{side}" pos="0 0 -.5"/>'
            f'<body pos="0 0 -1"><inertial pos="0 0 0" mass="{BALL}" diaginertia="1e-9 1e-9 1e-9"/></body></body>'
        )
    shaft = (
        '<body name="shaft"><joint name="shaft" type="hinge" axis="0 0 1"/>'
        f'<inertial pos="0 0 .5" mass="{ROD}" diaginertia="{ROD_INERTIA[0]} {ROD_INERTIA[0]} {SHAFT_INERTIA}"/>'
        f'<body name="slider" pos="0 0 {HEIGHT}"><joint type="slide" axis="0 0 1"/><inertial pos="0 0 0" mass="{SLIDER}" '
        f'diaginertia="{SLIDER_INERTIA} {SLIDER_INERTIA} {SLIDER_INERTIA}"/><site name="point/slider"/>'
        f'<site name="end_a" pos="{ARM} 0 0"/><site name="end_b" pos="{-ARM} 0 0"/></body>{rods}</body>'
    )
    tendons = "".join(
        f'<spatial stiffness="{STIFFNESS}" damping="{DAMPER}" springlength="{REST}"><site site="end_{side}"/>'
        f'<site site="middle_{side}"/></spatial>'
        for side in "ab"
    )
    world = deck({"b": 'pos="3 0 .2"'}, slides="z") + (
        '<body name="mass" pos="3 0 .3"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="10"/>'
        f'<site name="p" pos="0 0 -.1"/></body>{shaft}'
    )
    text = mjcf(world, custom=mounts([("m1", "p", "b", "a")]), other=f"<tendon>{tendons}</tendon>", gravity=GRAVITY)
    return wr.load_system(text, isolators={"a": wr.Isolator(name="a", axial=wr.KelvinVoigt(k=2e4, c=100.0))})


@cache
def _ours() -> np.ndarray:
    """Return the slider's height every 0.1 s [m], the shaft spinning freely from the first instant."""
    system = _model()
    data = mujoco.MjData(system.model)
    data.qvel[system.model.jnt_dofadr[system.model.joint("shaft").id]] = SPIN
    kind = mujoco.mjtState.mjSTATE_INTEGRATION
    values = np.empty(mujoco.mj_stateSize(system.model, kind))
    mujoco.mj_getState(system.model, data, values, kind)
    response = wr.simulate(
        system, wr.HalfSine(peak=1.0, duration=0.011, start=1e3, direction="z"), duration=STOP,
        initial=wr.State(values=values, time=0.0), timestep=1e-4, sample_rate=1.0 / INTERVAL,
    )  # fmt: skip
    return response.points["slider"].position[:, 2]


def _lagrange() -> Comparison:
    """Return the comparison of the slider's height with Lagrange's equations of three coordinates."""
    times = INTERVAL * np.arange(round(STOP / INTERVAL) + 1)
    start = [HEIGHT, ANGLE, 0.0, 0.0, SPIN]
    run = solve_ivp(_rates, (0.0, STOP), start, "LSODA", t_eval=times, rtol=1e-10, atol=1e-12)
    return series(run.y[0] - HEIGHT, _ours() - HEIGHT, "m")


def _figure() -> Comparison:
    """Return the comparison of the slider's height with the published reference."""
    found = _ours()
    pairs = {f"slider at {t:g} s": (height, found[round(t / INTERVAL)]) for t, height in READ.items()}
    return single_values(pairs, "m")


CASES = (
    Case(name="iftomm-a05-lagrange", title="Stiff flyball governor, A05 of the IFToMM benchmarks, over 10 s",
         compares="Rise of the slider at 101 instants; largest difference over the largest rise.",
         source="Lagrange's equations of slider, rods and shaft, integrated by SciPy's LSODA, in verification/governor.py",
         date="each run", bound=1e-6, run=_lagrange,
         reason="steps of 0.1 ms, for which the stiff damper asks, are short for all else; what is left grows over ten swings"),
    Case(name="iftomm-a05-published", title="The same governor beside the library's reference solution", kind="published",
         compares="Height of the slider at fifteen turning points over 10 s; largest relative difference.",
         source="M. Gonzalez, D. Dopico, U. Lugris, J. Cuadrado, Multibody Syst. Dyn. 16 (2006) 179, problem A05; its "
         "reference as drawn by L. Tagliapietra, M. Vivian, E. Ceseracciu and M. Reggiani, Multibody systems benchmark in "
         "OpenSim (2015)",
         date="2006", bound=4e-3, reason="the figure is read to 0.002 m of 0.5 m", run=_figure),
)  # fmt: skip
