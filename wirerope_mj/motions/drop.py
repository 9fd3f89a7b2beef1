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
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions.motion import Said
from wirerope_mj.motions.phrases import SpokenMotion
from wirerope_mj.motions.shock_machines import ShockTableImpact

# axis and sign of the outward normals of the faces that land, by the words of a phrase
FACES = {
    "bottom": (2, -1), "top": (2, 1), "-z": (2, -1), "+z": (2, 1), "-x": (0, -1), "+x": (0, 1), "-y": (1, -1), "+y": (1, 1),
}  # fmt: skip
_LANDING = re.compile(
    r"\bonto\b(?:\s+the\b)?((?:[\s,]+(?:bottom|top|[-+][xyz]|and)\b)*)(?:\s+(face|side|edge|corner)\b)?", re.IGNORECASE
)
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
    faces = [FACES[word] for word in match[1].lower().replace(",", " ").split() if word != "and"]
    normal = dict(faces)  # axis: sign
    if len(normal) != len(faces) or len(faces) != _FACE_COUNTS.get((match[2] or "").lower(), len(faces) or -1):
        raise ValueError(f'"{short(text[match.start() :])}" says no face, edge of two faces or corner of three; {_HOW}.')
    up = ",".join(str(0 - normal.get(axis, 0)) for axis in range(3))
    return None, f"{text[: match.start()]} {up} {text[match.end() :]}"


@dataclass(frozen=True, kw_only=True)
class Drop(ShockTableImpact):
    """Free fall of the base from rest and its stop on a floor that does not give, as drop tests of cases have it.

    The base falls at -g for sqrt(2 h/g) and strikes at V = sqrt(2 g h), where its velocity becomes the rebound's, e V, at
    once. `direction` points up from the floor in the axes of the model: z for a drop onto the bottom, -x for one onto the +x
    face, the bisector of the faces for an edge or a corner. Gravity must point against it: `wirerope_mj.with_gravity`;
    scenarios see to it. A simulation begins unloaded, as a case in the air is, so that nothing swings while it falls and the
    drop is the velocity step V (1 + e). The base is translated: an edge that stays on the ground while the case turns about
    it is a `RotationalDrop`; what follows a rebound is left out.
    """

    kind: ClassVar[str] = "drop"
    phrases = (
        SpokenMotion(
            name="drop", example="300 mm onto bottom", summary="height of fall, and what lands: a face, edge or corner.",
            needs={"displacement": 1}, words={"rebound": ""}, begins=_onto_first,
            make=lambda shape, phrase, direction, *_: shape(
                drop_height=phrase.one("displacement"), rebound=phrase.named.get("rebound", 0.0), direction=direction,
            ),
        ),
    )  # fmt: skip

    pulse_duration: None = field(init=False, default=None)
    start: float = field(init=False, default=0.0)  #: an unloaded payload falls at once
    gravity: float = field(init=False, default=STANDARD_GRAVITY)
    fall: bool = field(init=False, default=True)

    @property
    def up(self) -> Array:
        """Unit vector from the floor, (3,)."""
        return self.unit

    @cached_property
    def _said(self) -> Said:
        """Describe the drop in a line, such as `drop 0.3 m onto bottom, 2.426 m/s`."""
        lands = [name for name, (axis, sign) in FACES.items() if sign * self.unit[axis] < -1e-9 and name not in ("-z", "+z")]
        sizes = np.abs(self.unit[np.abs(self.unit) > 1e-9])
        even = np.ptp(sizes) < 1e-9
        onto = " ".join(lands) + ("" if even else f", up along {direction_text(self.direction)}")
        back = f", rebound {self.rebound:.4g}" if self.rebound else ""
        text = f"drop {self.drop_height:.4g} m onto {onto}, {self.velocity_change:.4g} m/s{back}"
        return Said(text, ((self.start, "falls"), (self.impact, "lands")), shortest_time=np.inf)
