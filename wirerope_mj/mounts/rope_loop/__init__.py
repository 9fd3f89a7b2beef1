"""Mechanics of a loop of wire rope between two bars, from its geometry; engine-free."""

from wirerope_mj.mounts.rope_loop.elastica import LoopState as LoopState
from wirerope_mj.mounts.rope_loop.elastica import RopeLoop as RopeLoop
from wirerope_mj.mounts.rope_loop.elastica import loop_positions as loop_positions
from wirerope_mj.mounts.rope_loop.elastica import rotational_stiffness as rotational_stiffness
from wirerope_mj.mounts.rope_loop.fitted import AxisCurves as AxisCurves
from wirerope_mj.mounts.rope_loop.fitted import CouplingFit as CouplingFit
from wirerope_mj.mounts.rope_loop.fitted import axis_curves as axis_curves
from wirerope_mj.mounts.rope_loop.fitted import fit_coupling as fit_coupling
from wirerope_mj.mounts.rope_loop.half_loop import LoopShape as LoopShape
from wirerope_mj.mounts.rope_loop.half_loop import loop_shape as loop_shape
