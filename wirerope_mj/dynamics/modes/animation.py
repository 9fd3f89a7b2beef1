"""Animation of mode shapes, one after the other, as a response that can be drawn."""

from dataclasses import dataclass
from importlib.metadata import version

import mujoco
import numpy as np

from wirerope_mj.dynamics.modes.rest import STATE, linearise
from wirerope_mj.dynamics.modes.result import Modes
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.histories import ColumnPlan, MemorySamples, Numerics
from wirerope_mj.engine.response.peaks import BodyPeaks, MountPeaks, Peak, Peaks, PointPeaks
from wirerope_mj.engine.simulation.recorder import scene_of
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array

ROWS = 36  # rows of a period: ten degrees each
PERIODS = 2  # periods that each mode is shown, one second long each
FRACTION = 0.5  # fraction of the height of the lowest mount by which the mount that moves most deflects in the picture
_DEFAULT = 0.05  # largest drawn deflection where no height is known [m]


@dataclass(frozen=True, kw_only=True)
class ModeAnimation:
    """Animated modes: their motions as a response, and when each begins."""

    modes: Modes
    starts: Array  # instant at which each mode begins [s], (n_modes,)
    amplitude: float  # drawn deflection amplitude of the mount that moves most [m]
    response: Response  # the motions, each from its largest displacement on; time is the animation's, not the mode's


def animated_modes(system: System, modes: Modes) -> ModeAnimation:
    """Animate one mode of `system` after the other, enlarged, about its position of rest; forces are those of small cycles."""
    rest = linearise(system, modes.equilibrium)
    heights = [m.isolator.geometry.height for m in system.mounts.values() if m.isolator.geometry is not None]
    known = [height for height in heights if height is not None]
    amplitude = FRACTION * min(known) if known else _DEFAULT
    subjects = system.assembly.subjects
    mounted = [(name, ()) for name in system.mounts]
    plan = ColumnPlan(bodies=subjects.body_names, points=subjects.point_names, mounts=mounted)
    model = system.model.__copy__()
    data = mujoco.MjData(model)
    mujoco.mj_setState(model, data, modes.equilibrium.state.values, STATE)
    at_rest = data.qpos.copy()
    columns = {name: column for column, name in enumerate(plan.names)}

    def part(name: str, size: int = 3) -> slice:
        return slice(columns[name], columns[name] + size)

    values = np.zeros((modes.frequencies.size * PERIODS * ROWS, len(plan.names)))
    stiffness = {name: mount.cycles(amplitude=np.zeros(3), frequency=1.0).real for name, mount in rest.mounts.items()}
    for row, line in enumerate(values):
        mode, phase = divmod(row, PERIODS * ROWS)
        swing = amplitude * np.cos(2.0 * np.pi * phase / ROWS)
        line[0] = row / ROWS
        data.qpos[:] = at_rest
        mujoco.mj_integratePos(model, data.qpos, swing * modes.shapes[:, mode], 1.0)
        mujoco.mj_kinematics(model, data)
        for name in plan.bodies:
            body = data.body(name)
            line[part(f"bodies/{name}/position/x")] = body.xipos
            line[part(f"bodies/{name}/orientation/w", 4)] = body.xquat
        for name, site in zip(plan.points, system.assembly.subjects.points, strict=True):
            line[part(f"points/{name}/position/x")] = data.site_xpos[site]
        for name, shape in modes.mounts.items():
            moved = swing * shape[mode]
            line[part(f"mounts/{name}/deflection/roll")] = rest.mounts[name].deflection + moved
            line[part(f"mounts/{name}/force/roll")] = stiffness[name] @ moved
    samples = MemorySamples(names=plan.names, values=values)
    parts = plan.parts(samples)
    bodies, points, mounts = (parts[name] for name in ("bodies", "points", "mounts"))
    response = Response(
        time=values[:, 0].copy(),
        **parts,
        peaks=Peaks(
            bodies={name: BodyPeaks(acceleration=_peak(body.acceleration)) for name, body in bodies.items()},
            points={
                name: PointPeaks(acceleration=_peak(p.acceleration), relative_displacement=_peak(p.relative_displacement))
                for name, p in points.items()
            },
            mounts={name: MountPeaks(deflection=_peak(m.deflection), force=_peak(m.force)) for name, m in mounts.items()},
        ),
        scene=scene_of(system), motion={}, events=(),
        numerics=Numerics(
            timestep=np.nan, accuracy=np.nan, error_estimate=np.nan, steps=0, callback="",
            versions={"mujoco": version("mujoco")},
        ),
        initial_state=modes.equilibrium.state,
        final_state=modes.equilibrium.state,
        samples=samples,
    )  # fmt: skip
    starts = PERIODS * np.arange(modes.frequencies.size, dtype=np.float64)
    return ModeAnimation(modes=modes, starts=starts, amplitude=amplitude, response=response)


def _peak(values: Array) -> Peak:
    """Find the extremes of vectors (n_t, 3); their instants are written as 0."""
    sizes = np.linalg.norm(values, axis=1)
    at = int(np.argmax(sizes))
    zero = np.zeros(3)
    return Peak(
        value=float(sizes[at]), time=0.0, vector=values[at],
        minimum=values.min(axis=0), minimum_time=zero, maximum=values.max(axis=0), maximum_time=zero,
    )  # fmt: skip
