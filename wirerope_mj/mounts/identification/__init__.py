"""Identification of laws from cyclic tests; engine-free."""

from wirerope_mj.mounts.identification.choice import (
    LawComparison,
    LawRow,
    MethodComparison,
    MethodRow,
    compare_laws,
    compare_methods,
)
from wirerope_mj.mounts.identification.specimens import SpecimenFits, identify_specimens, joint_spread
