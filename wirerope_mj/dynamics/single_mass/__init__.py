"""One mass on one isolator axis, without an engine: harmonic balance and equivalent linearisation."""

from wirerope_mj.dynamics.single_mass.balance import HarmonicOrbit, harmonic_balance
from wirerope_mj.dynamics.single_mass.equivalent import equivalent_linear, simplified_peak
from wirerope_mj.dynamics.single_mass.harmonic_branch import HarmonicBranch, follow_harmonic_balance
