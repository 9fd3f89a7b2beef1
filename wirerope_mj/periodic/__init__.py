"""Periodic motions of a system: shooting, branches, stability."""

from wirerope_mj.periodic.branch import Bifurcation as Bifurcation
from wirerope_mj.periodic.branch import Branch as Branch
from wirerope_mj.periodic.follow import follow_branch as follow_branch
from wirerope_mj.periodic.orbit import PeriodicOrbit as PeriodicOrbit
from wirerope_mj.periodic.orbit import periodic_orbit as periodic_orbit
