"""Systems whose equations these are, as far as the model says."""

import mujoco
import numpy as np

from wirerope_mj.engine.kernel.equations import Equations, equations_of
from wirerope_mj.engine.system import System, once_per_system

_ENABLED = mujoco.mjtEnableBit.mjENBL_ENERGY | mujoco.mjtEnableBit.mjENBL_FWDINV


@once_per_system
def equations(system: System) -> Equations:
    """Return the equations of a system that the kernel's can be; made once."""
    return equations_of(system)


@once_per_system
def not_held(system: System) -> str:
    """Return which part of a model the kernel's equations do not hold, "" if there is none."""
    model, assembly = system.model, system.assembly
    counts = {
        "equality constraints": model.neq, "tendons": model.ntendon, "actuators of its own": model.nu - 1,
        "plugins": model.nplugin, "flexible bodies": model.nflex, "mocap bodies": model.nmocap,
        "gravity compensation": model.ngravcomp, "springs that yield": model.nplastic,
        "activations of its own": model.na - assembly.tables.user.n_states,
    }  # fmt: skip
    kinds, free = model.jnt_type, mujoco.mjtJoint.mjJNT_FREE
    held = {
        "ball joints": kinds == mujoco.mjtJoint.mjJNT_BALL, "dry friction in joints": model.dof_frictionloss > 0.0,
        "springs of floating bodies": (kinds == free) & (model.jnt_stiffness != 0.0),
        "springs or dampers that are not linear": [model.jnt_stiffnesspoly.any(), model.dof_dampingpoly.any()],
        "a medium around it": [model.opt.density, model.opt.viscosity],
        "options of MuJoCo's that change its steps": [model.opt.enableflags & ~_ENABLED],
    }  # fmt: skip
    parts = [name for name, number in counts.items() if number > 0]
    parts += [name for name, values in held.items() if np.any(values)]
    return f"the model has {', '.join(parts)}" if parts else ""
