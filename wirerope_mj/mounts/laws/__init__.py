"""Restoring-force laws of isolator axes: engine-free, one file with class and jitted kernel each."""

from wirerope_mj.mounts.laws.baber_noori import BoucWenBaberNoori as BoucWenBaberNoori
from wirerope_mj.mounts.laws.bouc_wen import BoucWen as BoucWen
from wirerope_mj.mounts.laws.bouc_wen import Ozdemir as Ozdemir
from wirerope_mj.mounts.laws.friction import EnhancedDryFriction as EnhancedDryFriction
from wirerope_mj.mounts.laws.friction import Masing as Masing
from wirerope_mj.mounts.laws.hysteresis import Hysteresis as Hysteresis
from wirerope_mj.mounts.laws.hysteresis import Normalised as Normalised
from wirerope_mj.mounts.laws.law import Law as Law
from wirerope_mj.mounts.laws.loop import Loop as Loop
from wirerope_mj.mounts.laws.loop_plane import LoopBoucWen as LoopBoucWen
from wirerope_mj.mounts.laws.loop_plane import LoopCoupling as LoopCoupling
from wirerope_mj.mounts.laws.ni import AsymmetricBoucWen as AsymmetricBoucWen
from wirerope_mj.mounts.laws.ni import SymmetricBoucWen as SymmetricBoucWen
from wirerope_mj.mounts.laws.own import OwnLaw as OwnLaw
from wirerope_mj.mounts.laws.parallel import Parallel as Parallel
from wirerope_mj.mounts.laws.plane import BiaxialBoucWen as BiaxialBoucWen
from wirerope_mj.mounts.laws.scragged import ScraggedBoucWen as ScraggedBoucWen
from wirerope_mj.mounts.laws.semi_empirical import EquivalentViscous as EquivalentViscous
from wirerope_mj.mounts.laws.semi_empirical import TinkerCutchins as TinkerCutchins
from wirerope_mj.mounts.laws.stop import Stop as Stop
from wirerope_mj.mounts.laws.tabulated import Tabulated as Tabulated
from wirerope_mj.mounts.laws.timed import trace
from wirerope_mj.mounts.laws.vaiana_rosati import VaianaRosati as VaianaRosati
from wirerope_mj.mounts.laws.viscoelastic import KelvinVoigt as KelvinVoigt
from wirerope_mj.mounts.laws.viscoelastic import Zener as Zener
from wirerope_mj.mounts.laws.wrapped import OnBracket as OnBracket
from wirerope_mj.mounts.laws.wrapped import Smoothed as Smoothed
from wirerope_mj.mounts.laws.wrapped import on_bracket as on_bracket

# The laws by the name that an isolator file calls them.
LAWS: dict[str, type[Law]] = {
    law.name: law
    for law in (
        BoucWen, Ozdemir, AsymmetricBoucWen, SymmetricBoucWen, BoucWenBaberNoori, ScraggedBoucWen, VaianaRosati,
        EnhancedDryFriction, Masing, TinkerCutchins, EquivalentViscous, KelvinVoigt, Zener, Stop, Tabulated,
    )
}  # fmt: skip
Law._trace = trace  # follows the kernels of all laws, which their common base cannot import
