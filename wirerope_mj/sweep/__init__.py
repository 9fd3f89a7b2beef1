"""Envelopes over frequency: a system shaken by a sweep, or by one steady sine after another."""

from wirerope_mj.sweep.continuous import frequency_sweep as frequency_sweep
from wirerope_mj.sweep.envelope import FrequencySweep as FrequencySweep
from wirerope_mj.sweep.stepped import stepped_sine as stepped_sine
