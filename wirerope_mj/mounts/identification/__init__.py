"""From cyclic tests to laws, engine-free."""

from wirerope_mj.mounts.identification.choice import LawComparison as LawComparison
from wirerope_mj.mounts.identification.choice import LawRow as LawRow
from wirerope_mj.mounts.identification.choice import MethodComparison as MethodComparison
from wirerope_mj.mounts.identification.choice import MethodRow as MethodRow
from wirerope_mj.mounts.identification.choice import compare_laws as compare_laws
from wirerope_mj.mounts.identification.choice import compare_methods as compare_methods
from wirerope_mj.mounts.identification.specimens import SpecimenFits as SpecimenFits
from wirerope_mj.mounts.identification.specimens import identify_specimens as identify_specimens
from wirerope_mj.mounts.identification.specimens import joint_spread as joint_spread
