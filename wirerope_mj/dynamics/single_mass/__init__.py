"""One mass on one isolator axis, without an engine: harmonic balance and equivalent linearisation."""

from wirerope_mj.dynamics.single_mass.balance import HarmonicOrbit as HarmonicOrbit
from wirerope_mj.dynamics.single_mass.balance import harmonic_balance as harmonic_balance
from wirerope_mj.dynamics.single_mass.equivalent import simplified_peak as simplified_peak
from wirerope_mj.dynamics.single_mass.harmonic_branch import HarmonicBranch as HarmonicBranch
from wirerope_mj.dynamics.single_mass.harmonic_branch import follow_harmonic_balance as follow_harmonic_balance
from wirerope_mj.dynamics.single_mass.linearisation import equivalent_linear as equivalent_linear
