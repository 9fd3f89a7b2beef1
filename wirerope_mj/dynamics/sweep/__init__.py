"""Envelopes over frequency: a system shaken by a sweep, or by one steady sine after another."""

from wirerope_mj.dynamics.sweep.envelope import FrequencySweep, load_frequency_sweep
from wirerope_mj.dynamics.sweep.sweeps import frequency_sweep, stepped_sine
