"""Durability: what a run, or random vibration, does to whatever tires. Counts cycles of responses; knows no material.

Exponent and constant of a fatigue curve N = C / A^b, A being the amplitude, are always said by who asks. Without a constant
damage is relative. Uses responses and motions, and the package rainflow for the counting.
"""

from wirerope_mj.assessment.durability.cycles import Cycles as Cycles
from wirerope_mj.assessment.durability.cycles import DamageSpectrum as DamageSpectrum
from wirerope_mj.assessment.durability.cycles import fatigue_damage_spectrum as fatigue_damage_spectrum
from wirerope_mj.assessment.durability.cycles import rainflow_cycles as rainflow_cycles
from wirerope_mj.assessment.durability.mounts import MountCycles as MountCycles
from wirerope_mj.assessment.durability.mounts import mount_cycles as mount_cycles
