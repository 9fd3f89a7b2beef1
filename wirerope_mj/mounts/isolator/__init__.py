"""The isolator: three restoring-force laws, what they are rated for, and where they come from."""

from wirerope_mj.mounts.isolator.device import Isolator as Isolator
from wirerope_mj.mounts.isolator.parts import Bracket as Bracket
from wirerope_mj.mounts.isolator.parts import Geometry as Geometry
from wirerope_mj.mounts.isolator.parts import Limits as Limits
from wirerope_mj.mounts.isolator.parts import Provenance as Provenance
from wirerope_mj.mounts.isolator.parts import Rotation as Rotation
from wirerope_mj.mounts.isolator.parts import Spread as Spread
from wirerope_mj.mounts.isolator.parts import Stiffening as Stiffening
from wirerope_mj.mounts.isolator.parts import Travel as Travel
from wirerope_mj.mounts.isolator.tables import AXES as AXES
from wirerope_mj.mounts.isolator.tables import read_law as read_law
from wirerope_mj.mounts.isolator.validity import MeasuredRange as MeasuredRange
from wirerope_mj.mounts.isolator.validity import Validity as Validity
from wirerope_mj.mounts.laws import LoopCoupling as LoopCoupling
