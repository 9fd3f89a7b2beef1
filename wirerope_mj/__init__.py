"""Shock and vibration of equipment and floors on wire-rope isolators.

Laws and isolators, MuJoCo models whose mounts have hysteresis, base motions, simulation, and the view of a run in rerun.
"""

from wirerope_mj.bench import cyclic_test as cyclic_test
from wirerope_mj.bench import read_cyclic_test as read_cyclic_test
from wirerope_mj.bench import write_cyclic_test as write_cyclic_test
from wirerope_mj.errors import ConvergenceError as ConvergenceError
from wirerope_mj.errors import ModelError as ModelError
from wirerope_mj.errors import RecordError as RecordError
from wirerope_mj.errors import SimulationError as SimulationError
from wirerope_mj.errors import WireRopeError as WireRopeError
from wirerope_mj.excitation import HalfSine as HalfSine
from wirerope_mj.excitation import Sawtooth as Sawtooth
from wirerope_mj.excitation import Sine as Sine
from wirerope_mj.excitation import Sweep as Sweep
from wirerope_mj.excitation import Trapezoid as Trapezoid
from wirerope_mj.excitation import VelocityStep as VelocityStep
from wirerope_mj.excitation import load_record as load_record
from wirerope_mj.identification.identify import Identification as Identification
from wirerope_mj.identification.identify import identify as identify
from wirerope_mj.isolator import Geometry as Geometry
from wirerope_mj.isolator import Isolator as Isolator
from wirerope_mj.isolator import Limits as Limits
from wirerope_mj.isolator import Provenance as Provenance
from wirerope_mj.isolator import Spread as Spread
from wirerope_mj.isolator import Travel as Travel
from wirerope_mj.isolator import load_isolator as load_isolator
from wirerope_mj.laws import AsymmetricBoucWen as AsymmetricBoucWen
from wirerope_mj.laws import BoucWen as BoucWen
from wirerope_mj.laws import BoucWenBaberNoori as BoucWenBaberNoori
from wirerope_mj.laws import EnhancedDryFriction as EnhancedDryFriction
from wirerope_mj.laws import EquivalentViscous as EquivalentViscous
from wirerope_mj.laws import KelvinVoigt as KelvinVoigt
from wirerope_mj.laws import Loop as Loop
from wirerope_mj.laws import Masing as Masing
from wirerope_mj.laws import Ozdemir as Ozdemir
from wirerope_mj.laws import SymmetricBoucWen as SymmetricBoucWen
from wirerope_mj.laws import TinkerCutchins as TinkerCutchins
from wirerope_mj.laws import VaianaRosati as VaianaRosati
from wirerope_mj.laws import Zener as Zener
from wirerope_mj.recording import record_rerun as record_rerun
from wirerope_mj.response import Peak as Peak
from wirerope_mj.response import Response as Response
from wirerope_mj.response import load_response as load_response
from wirerope_mj.runfolder import run_scenario as run_scenario
from wirerope_mj.scenario import Scenario as Scenario
from wirerope_mj.simulation import simulate as simulate
from wirerope_mj.state import State as State
from wirerope_mj.statics import equilibrium as equilibrium
from wirerope_mj.sweep import FrequencySweep as FrequencySweep
from wirerope_mj.sweep import frequency_sweep as frequency_sweep
from wirerope_mj.sweep import stepped_sine as stepped_sine
from wirerope_mj.system import Mount as Mount
from wirerope_mj.system import System as System
from wirerope_mj.system import load_system as load_system
from wirerope_mj.units import STANDARD_GRAVITY as STANDARD_GRAVITY
