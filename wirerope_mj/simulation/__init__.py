"""System + base motion -> Response."""

from wirerope_mj.simulation.simulate import simulate as simulate
