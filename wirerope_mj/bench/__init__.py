"""The virtual cyclic test rig: loops of a law, what they measure, what an acquisition would see of them, and their files."""

from wirerope_mj.bench.acquisition import measured as measured
from wirerope_mj.bench.cycles import read_cycles as read_cycles
from wirerope_mj.bench.cycles import steady_loops as steady_loops
from wirerope_mj.bench.files import write_cyclic_test as write_cyclic_test
from wirerope_mj.bench.measures import Transition as Transition
from wirerope_mj.bench.measures import hardening_overlap as hardening_overlap
from wirerope_mj.bench.measures import softening_to_hardening as softening_to_hardening
from wirerope_mj.bench.reading import read_cyclic_test as read_cyclic_test
from wirerope_mj.bench.rig import CLOSURE as CLOSURE
from wirerope_mj.bench.rig import cyclic_test as cyclic_test
