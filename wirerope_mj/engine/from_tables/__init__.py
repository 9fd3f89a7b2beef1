"""A model from tables: mounts, masses, stops and points as rows of CSV or XLSX files, and the MJCF that they make."""

from wirerope_mj.engine.from_tables.layout import Layout, Mass, StopLaw
from wirerope_mj.engine.from_tables.mjcf import mjcf_of
from wirerope_mj.engine.from_tables.read import read_layout
