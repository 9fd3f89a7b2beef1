"""Periodic motions of a system: shooting, branches, stability."""

from wirerope_mj.dynamics.periodic.branch import Bifurcation as Bifurcation
from wirerope_mj.dynamics.periodic.branch import Branch as Branch
from wirerope_mj.dynamics.periodic.branch import Jump as Jump
from wirerope_mj.dynamics.periodic.find import periodic_orbit as periodic_orbit
from wirerope_mj.dynamics.periodic.follow import follow_branch as follow_branch
from wirerope_mj.dynamics.periodic.harmonics import HarmonicContent as HarmonicContent
from wirerope_mj.dynamics.periodic.harmonics import harmonic_content as harmonic_content
from wirerope_mj.dynamics.periodic.orbit import PeriodicOrbit as PeriodicOrbit
from wirerope_mj.dynamics.periodic.resonance import Backbone as Backbone
from wirerope_mj.dynamics.periodic.resonance import Resonance as Resonance
from wirerope_mj.dynamics.periodic.resonance import backbone as backbone
from wirerope_mj.dynamics.periodic.resonance import resonances as resonances
