"""Drops of a case that stops dead on the floor: freely onto a face, an edge or a corner, and about an edge on the floor."""

import math
import re
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np
from scipy.special import ellipj, ellipk, ellipkinc

from wirerope_mj.foundation.arguments import not_negative, one_of
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import direction_text
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import ranges
from wirerope_mj.motions.envelope import Envelope
from wirerope_mj.motions.motion import BaseMotion, Said
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
_HIGHEST = 10.0  # height [m] from which its unit is questioned: drop tests of cases end at 1.2, of containers at 9
_HOW = 'say what lands: "onto bottom", "onto -x", "onto bottom -x" (an edge), "onto bottom -x -y" (a corner)'


def _onto_first(text: str, _: Path) -> tuple[None, str]:
    """Replace the faces that land by the direction of the floor's blow; return None (no name stands first) and the text."""
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

    @property
    def doubt(self) -> str:
        """Question whether the height is in another unit, if it is above those of drop tests; else ""."""
        high = self.drop_height > _HIGHEST
        return f"it falls from {self.drop_height:.4g} m, higher than tests drop: is the height in mm?" if high else ""

    pulse_duration: None = field(init=False, default=None)
    start: float = field(init=False, default=0.0)  #: an unloaded payload falls at once
    gravity: float = field(init=False, default=STANDARD_GRAVITY)
    fall: bool = field(init=False, default=True)

    @property
    def up(self) -> Array:
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


# coordinate that turns (roll, pitch), its sign, and axis and sign of the edge that stays, by the side that is raised
_RAISED = {"-x": (1, 1.0, 0, 1.0), "+x": (1, -1.0, 0, -1.0), "-y": (0, -1.0, 1, 1.0), "+y": (0, 1.0, 1, -1.0)}


def _side_first(text: str, _: Path) -> tuple[str, str]:
    """Split the side that is raised, such as -x, off a phrase; return it and the remaining text."""
    words = text.split()
    sides = [word for word in words if word in _RAISED]
    if len(sides) != 1:
        raise ValueError(f'one side that is raised must stand there, {", ".join(_RAISED)}, got "{short(text)}".')
    words.remove(sides[0])
    return sides[0], " ".join(words)


@dataclass(frozen=True, kw_only=True)
class RotationalDrop(BaseMotion):
    """Rotational edge drop of a case (ISTA; MIL-STD-810, method 516), as a rigid box whose mass fills it evenly.

    The edge opposite to the raised one stays on the floor. The case is lifted slowly, held, and let go; it turns about that
    edge as a pendulum that falls from rest, and stops dead as it lands flat. With p = atan(height / length), the angle of its
    diagonal D, x = angle + p + 90 deg, counted from straight down, obeys

        x'' = -W^2 sin x,    W^2 = 3 g / (2 D),    sin(x / 2) = k sn(W t + K(k)),    k = sin(x_0 / 2)

    The case stands centred over the base's own origin; contents that move by much while it falls turn it faster or slower.
    """

    kind: ClassVar[str] = "rotational-drop"
    phrases = (
        SpokenMotion(
            name="rotational-drop", example="300 mm -x length 800 mm height 600 mm",
            summary="the side -x is raised by 300 mm and let go, the opposite edge stays on the floor; length of the case "
            'between both, its height; "below 50 mm": of its bottom below the base\'s origin.',
            needs={"displacement": 1}, words=dict.fromkeys(("length", "height", "below"), "displacement"),
            needed_words=("length", "height"), begins=_side_first, directed=False,
            make=lambda shape, phrase, _direction, _number, raised: shape(
                drop_height=phrase.one("displacement"), raised=raised, length=phrase.named["length"],
                height=phrase.named["height"], below=phrase.named.get("below", 0.0),
            ),
        ),
    )  # fmt: skip

    drop_height: float  #: height of the raised edge [m]
    raised: str  #: side that is raised: "-x", "+x", "-y" or "+y"
    length: float  #: length of the case from the edge that stays to the raised one [m]
    height: float  #: height of the case [m]
    below: float = 0.0  #: height of the base's own origin over the case's bottom [m]
    lift: float = 2.0  #: time within which it is lifted [s]
    hold: float = 1.0  #: time for which it is held before it is let go [s]
    gravity: float = STANDARD_GRAVITY
    duration: float = field(init=False, repr=False)

    def __post_init__(self) -> None:
        for name in ("drop_height", "length", "height", "gravity"):
            if (value := ranges.level(name, getattr(self, name))) < 0.0:
                raise ValueError(f"`{name}` must be > 0, got {value!r}.")
        one_of("raised", self.raised, tuple(_RAISED))
        self._set(below=not_negative("below", self.below), lift=ranges.length("lift", self.lift))
        self._set(hold=ranges.length("hold", self.hold))
        most = self.length * math.cos(self._diagonal)
        if self.drop_height >= most:
            raise ValueError(
                f"`drop_height` must be below {most:.4g} m, where a case {self.length:g} m long and {self.height:g} m high "
                f"topples over the other way, got {self.drop_height:g}."
            )
        self._set(duration=self._landing)

    @property
    def _diagonal(self) -> float:
        return math.atan2(self.height, self.length)

    @property
    def tilt(self) -> float:
        """Angle from which the case is released [rad]."""
        return math.asin(self.drop_height / self.length)

    @cached_property
    def _pendulum(self) -> tuple[float, float, float]:
        """Modulus k, complete elliptic integral K(k) and rate W [rad/s] of the fall, as in the class's equations."""
        modulus = math.sin(0.5 * (self.tilt + self._diagonal + 0.5 * math.pi))
        rate = math.sqrt(1.5 * self.gravity / math.hypot(self.length, self.height))
        return modulus, float(ellipk(modulus**2)), rate

    @cached_property
    def _landing(self) -> float:
        k, quarter, rate = self._pendulum
        down = math.asin(math.sin(0.5 * (self._diagonal + 0.5 * math.pi)) / k)
        return self.lift + self.hold + float(quarter - ellipkinc(down, k**2)) / rate

    @property
    def rotates(self) -> bool:
        return True

    @property
    def centre(self) -> tuple[float, float, float]:
        """Middle of the edge that stays on the floor, from the base's own origin [m]."""
        _, _, axis, sign = _RAISED[self.raised]
        place = [0.0, 0.0, 0.0 - self.below]
        place[axis] = 0.5 * sign * self.length
        return place[0], place[1], place[2]

    @property
    def up(self) -> Array:
        return np.array([0.0, 0.0, 1.0])

    @property
    def initial(self) -> str:
        """State in which a simulation begins: "settled", on the floor."""
        return "settled"

    @property
    def directions(self) -> Array:
        """All directions, (3, 3): the base's origin goes round the edge."""
        return np.eye(3)

    @property
    def landing_rate(self) -> float:
        """Angular velocity with which the case lands [rad/s]."""
        return -float(self._fall(np.array([self._landing]), 1)[0])

    @property
    def velocity_jumps(self) -> tuple[tuple[float, Array], ...]:
        """The stop of the base's origin as the case lands; its rotation stops with it."""
        coordinate, sign, *_ = _RAISED[self.raised]
        spin = np.zeros(3)
        spin[coordinate] = -sign * self.landing_rate
        return ((self._landing, -np.cross(spin, -np.array(self.centre))),)

    def _fall(self, t: Array, order: int) -> Array:
        """Return the case's angle during the fall (order 0) or its derivatives (1, 2), (n_t,)."""
        k, quarter, rate = self._pendulum
        sn, cn, *_ = ellipj(rate * (t - self.lift - self.hold) + quarter, k**2)
        x = 2.0 * np.arcsin(k * sn)
        if order == 0:
            return np.asarray(x - self._diagonal - 0.5 * math.pi)
        return np.asarray(2.0 * k * rate * cn if order == 1 else -(rate**2) * np.sin(x))

    def _derivative(self, t: Array, order: int) -> Array:
        return np.zeros((t.size, 3))  # the edge stays

    def _angles(self, t: Array, order: int) -> Array:
        """Return roll, pitch and yaw (order 0) or derivatives (1, 2) of the case, lifted, held, let go and flat, (n_t, 3)."""
        lifted = Envelope(start=0.0, stop=math.inf, rise=self.lift, fall=0.0).derivatives(t)[order]
        let_go = self.lift + self.hold
        angle = np.where(t < let_go, self.tilt * lifted, self._fall(np.clip(t, let_go, self._landing), order))
        coordinate, sign, *_ = _RAISED[self.raised]
        angles = np.zeros((t.size, 3))
        angles[:, coordinate] = sign * np.where(t < self._landing, angle, 0.0)
        return angles

    @cached_property
    def _said(self) -> Said:
        """Describe the drop in a line, such as `rotational drop 0.3 m of -x, case 0.8 m long 0.6 m high, ..`."""
        text = (
            f"rotational drop {self.drop_height:.4g} m of {self.raised}, case {self.length:.4g} m long {self.height:.4g} m "
            f"high, {self.landing_rate:.4g} rad/s at landing"
        )
        events = ((0.0, "lifted"), (self.lift, "held"), (self.lift + self.hold, "let go"), (self._landing, "lands"))
        return Said(text, events, shortest_time=math.inf)
