"""Equilibrium of a system under its own weight."""

from wirerope_mj.engine.statics.find import equilibrium as equilibrium
from wirerope_mj.engine.statics.loading import Equilibrium as Equilibrium
from wirerope_mj.engine.statics.loading import History as History
from wirerope_mj.engine.statics.loading import MountLoad as MountLoad
from wirerope_mj.engine.statics.payloads import model_warnings as model_warnings
from wirerope_mj.engine.statics.table import Sag as Sag
from wirerope_mj.engine.statics.table import StaticTable as StaticTable
from wirerope_mj.engine.statics.table import static_table as static_table
