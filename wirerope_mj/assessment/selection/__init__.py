"""The vendors' worksheet: parts that carry a load and a shock by its closed formulas, for a first look.

What a part does in a model is computed by `wirerope_mj.studies.catalogue`.
"""

from wirerope_mj.assessment.selection.select import Candidate as Candidate
from wirerope_mj.assessment.selection.select import PartSelection as PartSelection
from wirerope_mj.assessment.selection.select import select_isolators as select_isolators
from wirerope_mj.assessment.selection.worksheet import Worksheet as Worksheet
from wirerope_mj.assessment.selection.worksheet import mode_text as mode_text
from wirerope_mj.assessment.selection.worksheet import shock_from_text as shock_from_text
