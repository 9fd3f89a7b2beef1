"""Doubts about a job's load cases: a name that contradicts its motion's direction, and two cases that are the same."""

import re
from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from wirerope_mj.motions import BaseMotion
from wirerope_mj.runs.job_file import LoadCase

_VERTICAL = re.compile(r"verti[ck]al|\bheave\b", re.IGNORECASE)
_LEVEL = re.compile(
    r"horizontal|athwart|transverse?|lateral|longitudinal|fore[ -]and[ -]aft|\bsway\b|\bsurge\b|quer|l\u00e4ngs", re.IGNORECASE
)
_ALONG = 0.1  # of a unit vector, from which a motion has a part along an axis


def job_doubts(cases: Sequence[LoadCase]) -> Iterator[str]:
    """Yield a sentence on each load case whose name contradicts its motion's direction, and on each two that are the same."""
    for case in cases:
        upright, level = _VERTICAL.search(case.name), _LEVEL.search(case.name)
        moved = _axes(case.scenario.motion)
        if not moved.any() or bool(upright) == bool(level):
            continue
        if upright and not moved[2]:
            yield f"case {case.name!r} is called vertical, and its motion has no part along z: is its direction right?"
        elif level and not moved[:2].any():
            yield f"case {case.name!r} is called level, and its motion is along z alone: is its direction right?"
    for first, second in combinations(cases, 2):
        one, other = first.scenario, second.scenario
        if one.motion.to_dict() == other.motion.to_dict() and one.simulate == other.simulate:
            yield (
                f"cases {first.name!r} and {second.name!r} have one motion from one start, {one.motion.description}: was one "
                "copied, and its direction or level not changed?"
            )


def _axes(motion: BaseMotion) -> np.ndarray:
    """Tell along which axes a base is moved, (3,); forces of the payload move none."""
    rows = [row for part in motion.parts if not part.loaded_sites and not part.rotates for row in part.directions]
    return np.abs(np.array(rows).reshape(-1, 3)).max(axis=0, initial=0.0) > _ALONG
