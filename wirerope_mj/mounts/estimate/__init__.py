"""Isolators without a data sheet, estimated from their geometry by what known parts have in common; engine-free."""

from wirerope_mj.mounts.estimate.estimate import Band, LoopEstimate, estimate_loop, estimated_isolator
