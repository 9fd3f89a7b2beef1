"""A made-up response for the tests of what draws responses: smooth motion, exact kinematics, no engine."""

import numpy as np

from wirerope_mj.engine.response import Numerics, Peak, Response
from wirerope_mj.engine.response.histories import ColumnPlan, MemorySamples
from wirerope_mj.engine.response.peaks import BodyPeaks, MountPeaks, Peaks, PointPeaks
from wirerope_mj.engine.response.response import response_of
from wirerope_mj.engine.response.scene import Geom, Scene, SceneBody, SceneMount
from wirerope_mj.foundation.state import State
from wirerope_mj.views.recording.shapes import rotate

UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])
TRAVEL = {"compression": 0.04, "tension": 0.02, "shear": 0.045, "roll": 0.045}


def floor_response(
    *, mounts=8, equipment=2, rows=401, rate=1000.0, axial_only=False, travel=TRAVEL, base="deck", events=True
) -> Response:
    """A floor that rings down on a deck after a pulse at 50 ms: smooth made-up motion, exact kinematics."""
    time = np.arange(rows) / rate
    ring = np.where(time > 0.05, np.exp(-6.0 * (time - 0.05)), 0.0)[:, None]
    phase = 2.0 * np.pi * np.outer(np.maximum(time - 0.05, 0.0), [6.0, 7.0, 9.0])
    relative = np.array([0.02, 0.015, 0.035]) * ring * -np.sin(phase)
    relative *= [0.0, 0.0, 1.0] if axial_only else 1.0
    tilt = 0.004 * ring[:, 0] * np.sin(phase[:, 0]) * (not axial_only)
    turn = np.column_stack([np.cos(tilt / 2), np.sin(tilt / 2), 0 * tilt, 0 * tilt])
    pulse = np.where((time > 0.05) & (time < 0.061), np.sin(np.pi * (time - 0.05) / 0.011), 0.0)[:, None]
    moved = np.outer(np.maximum(time - 0.05, 0.0), [0.0, 0.0, 1.0]) * bool(base)
    position = {"deck": moved + [0.0, 0.0, -0.02], "floor": moved + relative + [0.0, 0.0, 0.16]}
    arms = {f"rack_{n}": np.array([0.5 * n - 0.5, 0.3, 0.6]) for n in range(equipment)}
    position |= {name: position["floor"] + rotate(turn, arm) for name, arm in arms.items()}
    if not base:
        del position["deck"]
    acceleration = -150.0 * relative + 100.0 * pulse * np.array([0.2, 0.1, 1.0])
    spots = [np.array([1.2 * (n % 4) - 1.8, 1.0 * (n // 4) - 1.0, 0.0445]) for n in range(mounts)]
    places = [f"m{n + 1:02d}" for n in range(mounts)]
    plan = ColumnPlan(bodies=list(position), points=["rack_top"], mounts=[(name, ("axial.z",)) for name in places])
    parts = [time[:, None], moved, np.diff(moved, axis=0, prepend=moved[:1]) * rate, 147.1 * pulse * np.ones(3)]
    zero = np.zeros((rows, 3))
    spin = np.outer(np.gradient(tilt, time), [1.0, 0.0, 0.0])
    for name, where in position.items():
        still = name == "deck"
        own = np.tile(UPRIGHT, (rows, 1)) if still else turn
        velocity = np.gradient(where, time, axis=0)
        parts += [where, own, velocity, zero if still else spin, parts[3] if still else acceleration, zero]
    velocity = np.gradient(position["floor"], time, axis=0)
    parts += [position["floor"], turn, velocity, spin, 1.3 * acceleration, zero, relative]
    peaks = Peaks(bodies={n: BodyPeaks(acceleration=peak(time, acceleration)) for n in position}, points={}, mounts={})
    peaks.points["rack_top"] = PointPeaks(
        acceleration=peak(time, 1.3 * acceleration), relative_displacement=peak(time, relative)
    )
    for number, (name, spot) in enumerate(zip(places, spots, strict=True)):
        arm = spot - [0.0, 0.0, 0.16]  # from the floor's centre of mass
        deflection = relative + rotate(turn, arm) - arm
        force = (deflection + 3e-3 * np.gradient(deflection, time, axis=0)) * [1e5, 1.2e5, 2e5] * (1.0 + 0.05 * number)
        force *= [0.0, 0.0, 1.0] if axial_only else 1.0
        parts += [deflection, force, 0.3 * force[:, 2:]]
        peaks.mounts[name] = MountPeaks(deflection=peak(time, deflection), force=peak(time, force))
    names, values = plan.names, np.concatenate(parts, axis=1)
    assert values.shape == (rows, len(names))
    return response_of(
        plan, MemorySamples(names, values), peaks=peaks,
        scene=floor_scene(position, arms, places, spots, travel, base),
        motion={"kind": "half-sine"}, events=[(0.05, "half-sine begins"), (0.061, "half-sine ends")] if events else [],
        numerics=Numerics(
            timestep=1e-3, accuracy=1e-4, error_estimate=2e-5, steps=rows, callback="native", versions={}
        ),
        initial_state=State(values=np.zeros(0), time=0.0), final_state=State(values=np.zeros(0), time=1.0),
    )  # fmt: skip


def peak(time, values) -> Peak:
    norm = np.linalg.norm(values, axis=1)
    low, high = values.argmin(axis=0), values.argmax(axis=0)
    return Peak(
        value=float(norm.max()), time=float(time[norm.argmax()]), vector=values[norm.argmax()], minimum=values.min(axis=0),
        minimum_time=time[low], maximum=values.max(axis=0), maximum_time=time[high],
    )  # fmt: skip


def box(name, size, rgba=(0.5, 0.5, 0.6, 1.0), shape="box") -> Geom:
    return Geom(name=name, shape=shape, size=np.array(size), position=np.zeros(3), orientation=UPRIGHT, rgba=np.array(rgba))


def floor_scene(position, arms, places, spots, travel, base) -> Scene:
    geoms = {"deck": [box("plate", [2.4, 1.6, 0.02])], "floor": [box("plate", [2.1, 1.3, 0.07], (0.8, 0.7, 0.5, 0.4))]}
    geoms |= {name: [box("", [0.2, 0.2, 0.5]), box("post", [0.05, 0.3, 0.0], shape="capsule")] for name in arms}
    bodies = [
        SceneBody(
            name=name, moves=True, on_base=name == base, position=where[0], orientation=UPRIGHT,
            geoms=tuple(geoms[name]),
        )
        for name, where in position.items()
    ]  # fmt: skip
    ground = box("ground", [0.0, 0.0, 0.1], shape="plane")
    bodies.insert(
        0,
        SceneBody(name="world", moves=False, on_base=False, position=np.zeros(3), orientation=UPRIGHT, geoms=(ground,)),
    )
    below = position[base][0] if base else np.zeros(3)
    mounts = [
        SceneMount(
            name=name, isolator="WR", payload_body="floor", base_body=base or "world", axes=np.eye(3),
            payload_point=spot - [0.0, 0.0, 0.16], base_point=spot - below, height=0.089, width=np.nan,
            static_load=np.nan, travel=travel,
        )
        for name, spot in zip(places, spots, strict=True)
    ]  # fmt: skip
    return Scene(name="test floor", base=base, bodies=tuple(bodies), mounts=tuple(mounts))
