"""Mechanics of a loop of wire rope between two bars, from its geometry; engine-free."""

from wirerope_mj.mounts.rope_loop.elastica import (
    AxisCurves,
    LoopState,
    RopeLoop,
    axis_curves,
    fit_coupling,
    loop_positions,
    rotational_stiffness,
)
from wirerope_mj.mounts.rope_loop.half_loop import LoopShape, loop_shape
