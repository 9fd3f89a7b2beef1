"""Restoring-force laws of isolator axes: engine-free, one file with class and jitted kernel each."""

from wirerope_mj.mounts.laws.bouc_wen import BoucWen, Hysteresis, Normalised, Ozdemir
from wirerope_mj.mounts.laws.friction import EnhancedDryFriction, Masing
from wirerope_mj.mounts.laws.law import Law, is_law
from wirerope_mj.mounts.laws.loop import Loop
from wirerope_mj.mounts.laws.loop_plane import LoopBoucWen, LoopCoupling
from wirerope_mj.mounts.laws.ni import AsymmetricBoucWen, SymmetricBoucWen
from wirerope_mj.mounts.laws.own import OwnLaw
from wirerope_mj.mounts.laws.parallel import Parallel
from wirerope_mj.mounts.laws.plane import BiaxialBoucWen
from wirerope_mj.mounts.laws.registry import LAWS
from wirerope_mj.mounts.laws.softening import BoucWenBaberNoori, ScraggedBoucWen
from wirerope_mj.mounts.laws.stop import Stop
from wirerope_mj.mounts.laws.tabulated import Tabulated
from wirerope_mj.mounts.laws.timed import trace
from wirerope_mj.mounts.laws.vaiana_rosati import VaianaRosati
from wirerope_mj.mounts.laws.viscous import EquivalentViscous, KelvinVoigt, TinkerCutchins, Zener
from wirerope_mj.mounts.laws.wrapped import OnBracket, Smoothed, on_bracket

Law._trace = trace  # follows the kernels of all laws, which their common base cannot import
