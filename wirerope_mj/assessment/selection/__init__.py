"""Selection of the catalogue part that carries a load and survives a shock: the vendors' worksheet, and parts simulated.

The worksheet needs no engine; `simulated` fits a part from its row and lets the simulation judge it.
"""

from wirerope_mj.assessment.selection.select import Candidate as Candidate
from wirerope_mj.assessment.selection.select import PartSelection as PartSelection
from wirerope_mj.assessment.selection.select import select_isolators as select_isolators
from wirerope_mj.assessment.selection.simulated import SimulatedShock as SimulatedShock
from wirerope_mj.assessment.selection.simulated import simulate_candidate as simulate_candidate
from wirerope_mj.assessment.selection.worksheet import Worksheet as Worksheet
from wirerope_mj.assessment.selection.worksheet import mode_text as mode_text
from wirerope_mj.assessment.selection.worksheet import shock_from_text as shock_from_text
