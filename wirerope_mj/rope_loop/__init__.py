"""What a loop of wire rope between two bars does, from its geometry; engine-free."""

from wirerope_mj.rope_loop.elastica import LoopState as LoopState
from wirerope_mj.rope_loop.elastica import RopeLoop as RopeLoop
from wirerope_mj.rope_loop.shape import LoopShape as LoopShape
from wirerope_mj.rope_loop.shape import loop_shape as loop_shape
