"""Periodic motions of a system: shooting, branches, stability."""

from wirerope_mj.dynamics.periodic.branch import Branch, Jump, backbone, resonances
from wirerope_mj.dynamics.periodic.follow import follow_branch, periodic_orbit
from wirerope_mj.dynamics.periodic.orbit import HarmonicContent, PeriodicOrbit, harmonic_content
