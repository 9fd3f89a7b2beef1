"""Restoring-force laws of isolator axes: engine-free, one jitted kernel each."""

from wirerope_mj.laws.bouc_wen import BoucWen as BoucWen
from wirerope_mj.laws.bouc_wen import Ozdemir as Ozdemir
from wirerope_mj.laws.kelvin_voigt import KelvinVoigt as KelvinVoigt
from wirerope_mj.laws.law import Law as Law
from wirerope_mj.laws.loop import Loop as Loop
from wirerope_mj.laws.ni import AsymmetricBoucWen as AsymmetricBoucWen
from wirerope_mj.laws.ni import SymmetricBoucWen as SymmetricBoucWen

LAWS: dict[str, type[Law]] = {
    law.name: law for law in (BoucWen, Ozdemir, AsymmetricBoucWen, SymmetricBoucWen, KelvinVoigt)
}
"""The laws by the name that an isolator file calls them."""
