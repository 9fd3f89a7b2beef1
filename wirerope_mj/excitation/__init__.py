"""Base motion: pulses, steps, sines, sweeps and measured records; motions add with +."""

from wirerope_mj.excitation.harmonic import Sine, Sweep
from wirerope_mj.excitation.motion import BaseMotion, SumOfMotions
from wirerope_mj.excitation.pulses import HalfSine, Sawtooth, Trapezoid, VelocityStep
from wirerope_mj.excitation.record import Record, load_record
from wirerope_mj.excitation.restore import motion_from_dict

__all__ = [
    "BaseMotion",
    "HalfSine",
    "Record",
    "Sawtooth",
    "Sine",
    "SumOfMotions",
    "Sweep",
    "Trapezoid",
    "VelocityStep",
    "load_record",
    "motion_from_dict",
]
