"""How stiff must a frame between shock table and isolator be for "rigid" to hold within 5 %?

A half-sine, or a sudden velocity, strikes the table, where its accelerometer would sit; the isolator stands on the frame.
"""

from math import pi
from pathlib import Path
from xml.etree import ElementTree

import wirerope_mj as wr

MODEL = Path(__file__).resolve().parents[1] / "models" / "shock_table_frame.xml"


def scenario(
    *,
    frame_hz: float = 80.0,
    frame_damping: float = 0.02,
    frame_mass: float = 20.0,
    level_g: float = 20.0,
    pulse_ms: float = 11.0,
    velocity: float | None = None,
    duration: float = 0.6,
    callback: str = "native",
) -> wr.Scenario:
    """Return the shock of one mass on one mount on a frame.

    Args:
        frame_hz: natural frequency of the frame alone on the table [Hz]; its stiffness follows.
        frame_damping: damping ratio of the frame alone [-].
        frame_mass: mass of the frame that moves [kg].
        level_g: peak acceleration of the half-sine [g].
        pulse_ms: length of the half-sine [ms].
        velocity: sudden velocity of the table [m/s], instead of the half-sine.
        duration: simulated time [s].
        callback: what makes the mount force: native or python.
    """
    for name, value, low, high in (
        ("frame_hz", frame_hz, 0.1, 20e3), ("frame_damping", frame_damping, 0.0, 10.0), ("frame_mass", frame_mass, 0.01, 1e5)
    ):  # fmt: skip
        if not low <= value <= high:
            raise ValueError(f"`{name}` must be from {low:g} to {high:g}, got {value!r}.")
    if velocity is not None:
        motion: wr.VelocityStep | wr.HalfSine = wr.VelocityStep(velocity=velocity, direction="z", start=0.05)
    else:
        peak = level_g * wr.STANDARD_GRAVITY
        motion = wr.HalfSine(peak=peak, duration=1e-3 * pulse_ms, direction="z", start=0.05)
    model, omega = ElementTree.fromstring(MODEL.read_text(encoding="utf-8")), 2.0 * pi * frame_hz
    for joint in model.iterfind(".//joint[@name='frame_z']"):
        joint.set("stiffness", f"{frame_mass * omega**2!r}")
        joint.set("damping", f"{2.0 * frame_damping * frame_mass * omega!r}")
    for inertial in model.iterfind(".//body[@name='frame']/inertial"):
        inertial.set("mass", f"{frame_mass!r}")
    text = ElementTree.tostring(model, encoding="unicode")
    simulate = {"duration": duration, "sample_rate": 4000.0, "callback": callback}
    return wr.Scenario(question=__doc__ or "", model=text, motion=motion, simulate=simulate)
