"""MJCF and isolators -> a compiled MuJoCo model with mounts."""

from wirerope_mj.engine.system.on_deck import load_on_deck, on_deck, with_flexible, with_gravity, with_rotation
from wirerope_mj.engine.system.system import (
    Changes,
    Mount,
    System,
    beyond_laws,
    load_system,
    mount_rates,
    once_per_system,
    shapes_at,
)
from wirerope_mj.engine.system.varied import varied
