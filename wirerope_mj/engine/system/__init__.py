"""MJCF and isolators -> a compiled MuJoCo model with mounts."""

from wirerope_mj.engine.system.changes import Changes as Changes
from wirerope_mj.engine.system.on_deck import load_on_deck as load_on_deck
from wirerope_mj.engine.system.on_deck import on_deck as on_deck
from wirerope_mj.engine.system.on_deck import with_flexible as with_flexible
from wirerope_mj.engine.system.system import Mount as Mount
from wirerope_mj.engine.system.system import System as System
from wirerope_mj.engine.system.system import beyond_laws as beyond_laws
from wirerope_mj.engine.system.system import load_system as load_system
from wirerope_mj.engine.system.system import mount_rates as mount_rates
from wirerope_mj.engine.system.system import once_per_system as once_per_system
from wirerope_mj.engine.system.system import shapes_at as shapes_at
from wirerope_mj.engine.system.varied import varied as varied
