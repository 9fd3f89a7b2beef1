"""System + base motion -> Response."""

from wirerope_mj.engine.simulation.batch import BatchFailure as BatchFailure
from wirerope_mj.engine.simulation.batch import BatchResult as BatchResult
from wirerope_mj.engine.simulation.batch import simulate_batch as simulate_batch
from wirerope_mj.engine.simulation.simulate import simulate as simulate
