"""The vendors' worksheet: parts that carry a load and a shock by its closed formulas, for a first look.

What a part does in a model is computed by `wirerope_mj.studies.catalogue`.
"""

from wirerope_mj.assessment.selection.worksheet import (
    Candidate,
    PartSelection,
    Worksheet,
    mode_text,
    select_isolators,
    shock_from_text,
)
