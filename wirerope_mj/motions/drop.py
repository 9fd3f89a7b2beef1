"""The drop: a case falls freely from a height onto a face, an edge or a corner, and stops dead on the floor."""

import re
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import direction_text
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.motions.motion import Said
from wirerope_mj.motions.phrases import START, SpokenMotion
from wirerope_mj.motions.shock_machines import ShockTableImpact

# outward normals of the faces that land, by the words of a phrase
FACES = {
    "bottom": (0, 0, -1), "top": (0, 0, 1), "-z": (0, 0, -1), "+z": (0, 0, 1),
    "-x": (-1, 0, 0), "+x": (1, 0, 0), "-y": (0, -1, 0), "+y": (0, 1, 0),
}  # fmt: skip
_LANDING = re.compile(r"\bonto\b((?:\s+(?:(?:bottom|top|[-+][xyz])\b,?|and))*)(?:\s+(face|side|edge|corner)\b)?")
_FACE_COUNTS = {"face": 1, "side": 1, "edge": 2, "corner": 3}  # number of faces that meet
_HOW = 'say what lands: "onto bottom", "onto -x", "onto bottom -x" (an edge), "onto bottom -x -y" (a corner)'


def _onto_first(text: str, _: Path) -> tuple[None, str]:
    """Replace the faces that land by the direction in which the floor strikes; nothing comes before the phrase."""
    match = _LANDING.search(text)
    if match is None:
        signed = [part for part in text.split() if part[:1] in ("+", "-") and part[1:] in ("x", "y", "z")]
        if signed or set(text.split()) & {"x", "y"}:
            raise ValueError(f'a direction may be that of the fall or that of the blow; {_HOW}. "z" is a drop onto the bottom.')
        return None, text
    faces = [FACES[word.strip(",")] for word in match[1].split() if word != "and"]
    x, y, z = (-sum(face[axis] for face in faces) for axis in range(3))
    if sum(map(abs, (x, y, z))) != len(faces) or len(faces) != _FACE_COUNTS.get(match[2], len(faces) or -1):
        raise ValueError(f'"{short(match[0].strip())}" is no face, edge of two faces or corner of three; {_HOW}.')
    return None, f"{text[: match.start()]} {x},{y},{z} {text[match.end() :]}"


@dataclass(frozen=True, kw_only=True)
class Drop(ShockTableImpact):
    """Free fall of the base from rest and its stop on a floor that does not give, as drop tests of cases have it.

    The base falls at -g for sqrt(2 h/g) and strikes at V = sqrt(2 g h), where its velocity becomes the rebound's, e V, at
    once. `direction` points up from the floor in the axes of the model: z for a drop onto the bottom, -x for one onto the +x
    face, the bisector of the faces for an edge or a corner. Gravity must point against it: `wirerope_mj.with_gravity`;
    scenarios see to it. A simulation begins unloaded, as a case in the air is, so that nothing swings while it falls and the
    drop is the velocity step V (1 + e). The base is translated: an edge that stays on the ground while the case turns about
    it is none of this, nor is what follows a rebound.
    """

    kind: ClassVar[str] = "drop"
    phrases = (
        SpokenMotion(
            name="drop", example="300 mm onto bottom", summary="height of fall, and what lands: a face, edge or corner.",
            needs={"displacement": 1}, words=START | {"rebound": ""}, begins=_onto_first,
            make=lambda shape, phrase, direction, *_: shape(
                drop_height=phrase.one("displacement"), rebound=phrase.named.get("rebound", 0.0), direction=direction,
                start=phrase.start,
            ),
        ),
    )  # fmt: skip

    pulse_duration: None = field(init=False, default=None)
    fall: bool = field(init=False, default=True)

    @property
    def up(self) -> Array:
        """Unit vector from the floor, (3,)."""
        return self.unit

    @cached_property
    def _said(self) -> Said:
        """Describe the drop in a line, such as `drop 0.3 m onto bottom, 2.426 m/s`."""
        signs = np.sign(self.unit) * (np.abs(self.unit) > 1e-9)
        lands = [name for name, face in list(FACES.items())[:2] + list(FACES.items())[4:] if np.dot(face, signs) < 0.0]
        even = np.ptp(np.abs(self.unit[signs != 0.0])) < 1e-9
        onto = " ".join(lands) + ("" if even else f", up along {direction_text(self.direction)}")
        back = f", rebound {self.rebound:.4g}" if self.rebound else ""
        begins = f" at {self.start:.4g} s" if self.start else ""
        text = f"drop {self.drop_height:.4g} m onto {onto}, {self.velocity_change:.4g} m/s{back}{begins}"
        return Said(text, ((self.start, "falls"), (self.impact, "lands")), shortest_time=np.inf)
