"""The virtual cyclic test rig: loops of a law, their measures, their acquisition with noise, and their files."""

from wirerope_mj.mounts.test_rig.cycles import load_cycles, steady_loops
from wirerope_mj.mounts.test_rig.reading import load_cyclic_test, save_cyclic_test
from wirerope_mj.mounts.test_rig.rig import (
    CLOSURE,
    Transition,
    cyclic_test,
    hardening_overlap,
    measured,
    softening_to_hardening,
)

read_cyclic_test = load_cyclic_test  # Earlier name of it
