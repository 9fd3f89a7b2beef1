"""Durability: fatigue damage of a run or of random vibration. Counts cycles of responses; knows no material.

Exponent and constant of a fatigue curve N = C / A^b, A being the amplitude, are always given by the caller. Without a constant
damage is relative. Uses responses and motions, and the package rainflow for the counting.
"""

from wirerope_mj.assessment.durability.cycles import Cycles, DamageSpectrum, fatigue_damage_spectrum, rainflow_cycles
from wirerope_mj.assessment.durability.mission import MountCycles, mount_cycles
