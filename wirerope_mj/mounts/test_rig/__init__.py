"""The virtual cyclic test rig: loops of a law, what they measure, what an acquisition would see of them, and their files."""

from wirerope_mj.mounts.test_rig.cycles import load_cycles as load_cycles
from wirerope_mj.mounts.test_rig.cycles import steady_loops as steady_loops
from wirerope_mj.mounts.test_rig.measures import Transition as Transition
from wirerope_mj.mounts.test_rig.measures import hardening_overlap as hardening_overlap
from wirerope_mj.mounts.test_rig.measures import softening_to_hardening as softening_to_hardening
from wirerope_mj.mounts.test_rig.reading import load_cyclic_test as load_cyclic_test
from wirerope_mj.mounts.test_rig.reading import save_cyclic_test as save_cyclic_test
from wirerope_mj.mounts.test_rig.rig import CLOSURE as CLOSURE
from wirerope_mj.mounts.test_rig.rig import cyclic_test as cyclic_test
from wirerope_mj.mounts.test_rig.rig import measured as measured

read_cyclic_test = load_cyclic_test  # Earlier name of it
