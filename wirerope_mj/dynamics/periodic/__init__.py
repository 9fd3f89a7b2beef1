"""Periodic motions of a system: shooting, branches, stability."""

from wirerope_mj.dynamics.periodic.branch import Branch as Branch
from wirerope_mj.dynamics.periodic.branch import Jump as Jump
from wirerope_mj.dynamics.periodic.branch import backbone as backbone
from wirerope_mj.dynamics.periodic.branch import resonances as resonances
from wirerope_mj.dynamics.periodic.follow import follow_branch as follow_branch
from wirerope_mj.dynamics.periodic.follow import periodic_orbit as periodic_orbit
from wirerope_mj.dynamics.periodic.orbit import HarmonicContent as HarmonicContent
from wirerope_mj.dynamics.periodic.orbit import PeriodicOrbit as PeriodicOrbit
from wirerope_mj.dynamics.periodic.orbit import harmonic_content as harmonic_content
