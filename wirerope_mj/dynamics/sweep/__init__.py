"""Envelopes over frequency: a system shaken by a sweep, or by one steady sine after another."""

from wirerope_mj.dynamics.sweep.envelope import FrequencySweep as FrequencySweep
from wirerope_mj.dynamics.sweep.envelope import load_frequency_sweep as load_frequency_sweep
from wirerope_mj.dynamics.sweep.sweeps import frequency_sweep as frequency_sweep
from wirerope_mj.dynamics.sweep.sweeps import stepped_sine as stepped_sine
