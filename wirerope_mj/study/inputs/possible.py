"""What can vary in a system and under a motion, as a person reads it before saying what does."""

from collections.abc import Iterable, Mapping

import numpy as np

from wirerope_mj.excitation import BaseMotion
from wirerope_mj.laws import Law
from wirerope_mj.study.inputs.quantities import WORLD
from wirerope_mj.system import System
from wirerope_mj.system.varied import moving_bodies

_AXES = ", ".join(WORLD)


def possible_lines(system: System, motion: BaseMotion) -> list[str]:
    """Return a line for every group of quantities that can vary: its name with NAME in place of mounts or bodies.

    Mounts whose laws have the same parameters stand together, with their values where these are equal.
    """
    lines = []
    for mounts, laws in _alike(system):
        lines.append(f"mounts {', '.join(mounts)}:")
        for axis, law in laws.items():
            values = ", ".join(f"{key} = {_text(value)}" for key, value in law.to_dict().items() if key != "law")
            values += " (what is 0 takes no factors)" if 0.0 in law.to_dict().values() else ""
            lines.append(f"  mount/NAME/{axis}/PARAMETER  {law.name}: {values}")
        spread = any(system.mounts[mount].isolator.spread is not None for mount in mounts)
        lines += ["  mount/NAME/spread  specimens"] if spread else []
    if system.mounts:
        lines.append(f"all mounts: mount/NAME/fitted, mount/NAME/failed, mount/NAME/position/AXIS of {_AXES} [m]")
        lines.append("  several: mount/m01,m05,-m04/position/x, those behind a minus moving the other way")
    model = system.model
    masses = [f"{body} {float(model.body(body).mass[0]):.4g} kg" for body in moving_bodies(model)]
    if masses:
        lines.append(f"bodies {', '.join(masses)}: body/NAME/mass, body/NAME/centre/AXIS of {_AXES} [m]")
    turned = ", motion/azimuth, motion/elevation [deg]" if _can_turn(system, motion) else ""
    lines.append(f"motion {motion.description}: motion/level{turned}")
    return lines


def _alike(system: System) -> Iterable[tuple[list[str], Mapping[str, Law]]]:
    """Yield the mounts that have the same laws, and these."""
    groups: dict[tuple[Law | None, ...], list[str]] = {}
    for name, mount in system.mounts.items():
        groups.setdefault(tuple(mount.isolator.axes.values()), []).append(name)
    for names in groups.values():
        axes = system.mounts[names[0]].isolator.axes
        yield names, {axis: law for axis, law in axes.items() if law is not None}


def _can_turn(system: System, motion: BaseMotion) -> bool:
    """Return whether the motion is along one line, and the base can be driven along all axes."""
    one_line = np.linalg.matrix_rank(motion.directions, tol=1e-9) == 1  # 1e-9: rounding of unit vectors
    return bool(one_line and np.linalg.matrix_rank(system.assembly.tables.drive) == len(WORLD))


def _text(value: object) -> str:
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_text, value))}]"
    return f"{value:.4g}" if isinstance(value, int | float) and not isinstance(value, bool) else str(value)
