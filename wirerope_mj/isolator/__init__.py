"""The isolator: three restoring-force laws, what they are rated for, and where they come from."""

from wirerope_mj.isolator.device import Isolator as Isolator
from wirerope_mj.isolator.files import find_isolator as find_isolator
from wirerope_mj.isolator.files import load_isolator as load_isolator
from wirerope_mj.isolator.parts import Geometry as Geometry
from wirerope_mj.isolator.parts import Limits as Limits
from wirerope_mj.isolator.parts import Provenance as Provenance
from wirerope_mj.isolator.parts import Rotation as Rotation
from wirerope_mj.isolator.parts import Spread as Spread
from wirerope_mj.isolator.parts import Travel as Travel
from wirerope_mj.isolator.stiffening import Stiffening as Stiffening
from wirerope_mj.isolator.tables import AXES as AXES
from wirerope_mj.isolator.tables import read_law as read_law
from wirerope_mj.laws import LoopCoupling as LoopCoupling
