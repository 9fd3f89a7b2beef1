"""Isolators without a data sheet, estimated from their geometry by what known parts have in common; engine-free."""

from wirerope_mj.mounts.estimate.estimate import Band as Band
from wirerope_mj.mounts.estimate.estimate import LoopEstimate as LoopEstimate
from wirerope_mj.mounts.estimate.estimate import estimate_loop as estimate_loop
from wirerope_mj.mounts.estimate.estimate import estimated_isolator as estimated_isolator
from wirerope_mj.mounts.estimate.trends import LoopValues as LoopValues
from wirerope_mj.mounts.estimate.trends import check_vendor_loops as check_vendor_loops
