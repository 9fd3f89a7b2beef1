"""Periodic motions of a system: shooting, branches, stability."""

from wirerope_mj.periodic.orbit import PeriodicOrbit as PeriodicOrbit
from wirerope_mj.periodic.orbit import periodic_orbit as periodic_orbit
