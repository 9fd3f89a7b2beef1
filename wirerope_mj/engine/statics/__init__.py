"""Equilibrium of a system under its own weight."""

from wirerope_mj.engine.statics.find import equilibrium
from wirerope_mj.engine.statics.implausible import limit_doubts, model_warnings
from wirerope_mj.engine.statics.loading import Equilibrium, History, MountLoad
from wirerope_mj.engine.statics.table import Sag, StaticTable, at_rest, static_table
