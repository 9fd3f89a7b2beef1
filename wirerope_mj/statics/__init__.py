"""Where a system rests under its own weight."""

from wirerope_mj.statics.find import equilibrium as equilibrium
from wirerope_mj.statics.result import Equilibrium as Equilibrium
from wirerope_mj.statics.result import History as History
from wirerope_mj.statics.result import MountLoad as MountLoad
