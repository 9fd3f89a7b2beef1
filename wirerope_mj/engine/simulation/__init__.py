"""System + base motion -> Response."""

from wirerope_mj.engine.simulation.batch import BatchFailure, BatchResult, simulate_batch
from wirerope_mj.engine.simulation.simulate import simulate
