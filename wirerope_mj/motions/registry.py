"""The registry of motions: every class, by the name under which it is stored and by the phrases that say it.

A motion joins by its line in `REGISTERED`, whose order is that of commands' options and of messages.
"""

from dataclasses import replace
from functools import partial

from wirerope_mj.motions.double_pulses import DoubleHalfSine, DoubleTriangle
from wirerope_mj.motions.drop import Drop
from wirerope_mj.motions.harmonic import Sine, Sweep
from wirerope_mj.motions.motion import BaseMotion, SumOfMotions
from wirerope_mj.motions.payload_forces import Blow, ForceTable, HarmonicForce
from wirerope_mj.motions.phrases import SpokenMotion
from wirerope_mj.motions.pulses import HalfSine, Sawtooth, Trapezoid, VelocityStep
from wirerope_mj.motions.random_vibration import RandomVibration
from wirerope_mj.motions.records.record import Record
from wirerope_mj.motions.scaled import Scaled, Turned
from wirerope_mj.motions.shock_machines import DecayingSine, ShockTableImpact
from wirerope_mj.motions.spectrum_match import SpectrumMatch
from wirerope_mj.motions.target_spectra import DesignSpectrum
from wirerope_mj.motions.unbalance import Unbalance
from wirerope_mj.motions.underwater import StruckPlate
from wirerope_mj.motions.vibration_lines import VibrationLines

REGISTERED: tuple[type[BaseMotion] | type[DesignSpectrum] | type[SpectrumMatch], ...] = (
    HalfSine,
    Sawtooth,
    Trapezoid,
    VelocityStep,
    DesignSpectrum,  # stored as its double half-sine
    DoubleHalfSine,
    DoubleTriangle,
    Drop,
    ShockTableImpact,
    DecayingSine,
    StruckPlate,
    Sine,
    Sweep,
    RandomVibration,
    VibrationLines,
    SpectrumMatch,  # stored as its lines
    Unbalance,
    HarmonicForce,
    Blow,
    ForceTable,
    Record,
    Scaled,
    Turned,
    SumOfMotions,
)
# The motions by the name under which they are stored.
BY_KIND: dict[str, type[BaseMotion]] = {motion.kind: motion for motion in REGISTERED if issubclass(motion, BaseMotion)}
# The phrases by their names, of the base and then of forces on the payload, each with its own motion to make.
SPOKEN_MOTIONS: dict[str, SpokenMotion] = {
    form.name: replace(form, make=partial(form.make, motion)) for motion in REGISTERED for form in motion.phrases
}
