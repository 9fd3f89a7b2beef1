"""Base motion: shocks, sines, sweeps, random vibration and measured records; motions add with +."""

from wirerope_mj.motions.double_pulses import DoubleHalfSine, DoubleTriangle
from wirerope_mj.motions.drop import Drop, RotationalDrop
from wirerope_mj.motions.harmonic import Sine, Unbalance
from wirerope_mj.motions.motion import BaseMotion, SumOfMotions
from wirerope_mj.motions.payload_forces import Blow, ForceTable, HarmonicForce, PayloadForce
from wirerope_mj.motions.psd_lines import banded_lines, psd_from_g, psd_level, psd_rms
from wirerope_mj.motions.pulses import HalfSine, Sawtooth, StruckPlate, Trapezoid, VelocityStep
from wirerope_mj.motions.random_vibration import RandomVibration
from wirerope_mj.motions.records.measured import Measured, MeasuredChannel, load_measured
from wirerope_mj.motions.records.record import Record, load_record
from wirerope_mj.motions.registry import motion_from_dict
from wirerope_mj.motions.scaled import Scaled, Turned
from wirerope_mj.motions.ship_motion import ShipMotion
from wirerope_mj.motions.shock_machines import DecayingSine, ShockTableImpact
from wirerope_mj.motions.spectrum_match import SpectrumMatch, match_spectrum
from wirerope_mj.motions.sweep import Sweep
from wirerope_mj.motions.target_spectra import EN1998_TYPE_1, DesignSpectrum, ac156_spectrum, en1998_spectrum
from wirerope_mj.motions.vibration_lines import VibrationLines
