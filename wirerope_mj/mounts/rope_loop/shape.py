"""The centre line of half a rope loop, unloaded, as straight segments and arcs."""

import math
from dataclasses import dataclass

import numpy as np

from wirerope_mj.foundation.arguments import finite, not_negative, positive

# Size of an isolator over the diameter of its rope, at most: those that are sold have 5 to 15, and ten times that is slack.
LARGEST_LOOP = 1000.0


@dataclass(frozen=True, kw_only=True)
class LoopShape:
    """The unloaded centre line of the half loop on the side of positive roll; the other half is its mirror image.

    It begins in the base's bar at roll = `arm`, goes out of the bar in the direction `start` and ends in the payload's bar
    at the same distance `arm` from that bar's middle. Both ends are clamped. Angles are counted from the roll axis towards
    the axial axis.
    """

    # length [m] and natural curvature [1/m] of each segment, from the base's bar to the payload's bar
    segments: tuple[tuple[float, float], ...]
    start: float = 0.0  # direction of the rope where it leaves the base's bar [rad]
    arm: float = 0.0  # distance of the clamped ends from the middle of their bars [m]

    def __post_init__(self) -> None:
        if not self.segments or not all(
            0.0 < length < math.inf and math.isfinite(bend) for length, bend in self.segments
        ):
            raise ValueError(
                f"`segments` must be pairs of a length > 0 [m] and a finite curvature, got {self.segments!r}."
            )
        not_negative("arm", self.arm)
        finite("start", self.start)

    @property
    def length(self) -> float:
        """Length of free rope of the half loop [m]."""
        return sum(length for length, _ in self.segments)

    @property
    def span(self) -> tuple[float, float]:
        """Distance of the two clamped ends in roll and axial direction, unloaded [m]."""
        direction, total = self.start, np.zeros(2)
        for length, curvature in self.segments:
            turned = length * curvature
            middle = direction + 0.5 * turned
            # The chord of an arc; sinc keeps the straight segment a limit and not a case.
            total += length * np.sinc(0.5 * turned / math.pi) * np.array([math.cos(middle), math.sin(middle)])
            direction += turned
        return float(total[0]), float(total[1])

    def taut(self, roll: float = 0.0) -> float:
        """Return the axial deflection [m] at which the inextensible rope of one half is a straight line; NaN if none is."""
        across, along = self.span
        rest = self.length**2 - (abs(across) + abs(roll)) ** 2
        return math.sqrt(rest) - along if rest >= 0.0 else math.nan

    @classmethod
    def ring(cls, radius: float) -> "LoopShape":
        """Return the half of a circular ring [m] that is clamped in two points, the textbook case."""
        return cls(segments=((math.pi * radius, 1.0 / radius),))


def loop_shape(*, height: float, width: float, bar: float, rope: float) -> LoopShape:
    """Return the half loop of an isolator from its envelope [m]: unloaded height over both bars, width over the ropes.

    The rope leaves both bars level and half way up their thickness, so that the centre line rises by `height` - `bar`; it
    reaches (`width` - `rope`) / 2 to the side. The roundest line through these points is a stadium: a half circle between two
    straight level segments where the loop is wider than high (all 50 parts of Enidine's table with known bars are), and two
    quarter circles with a straight upright segment between them where it is not. The straight segments begin in the middle of
    the bar: no vendor states how much of them the bar holds.

    Raises:
        ValueError: an argument is not a finite number > 0, a bar is thinner than its rope, or no loop is left between them.
    """
    for name, value in {"height": height, "width": width, "bar": bar, "rope": rope}.items():
        if positive(name, value) > LARGEST_LOOP * rope:
            raise ValueError(
                f"`{name}` must be at most {LARGEST_LOOP:g} times the `rope` of {rope:g} m, got {value:g} m."
            )
    if bar < rope:
        raise ValueError(f"`bar` must be at least as thick as the `rope` that it holds, {rope:g} m, got {bar:g} m.")
    rise, reach = height - bar, 0.5 * (width - rope)
    if rise <= rope or bar >= 0.5 * height:
        raise ValueError(
            f"`height` of {height:g} m leaves no loop between two bars of {bar:g} m and {rope:g} m of rope."
        )
    if reach <= rope:
        raise ValueError(f"`width` of {width:g} m leaves no loop of a rope of {rope:g} m.")
    radius = min(0.5 * rise, reach)
    arc, level, upright = 0.5 * math.pi * radius, reach - radius, rise - 2.0 * radius
    segments = ((level, 0.0), (arc, 1.0 / radius), (upright, 0.0), (arc, 1.0 / radius), (level, 0.0))
    return LoopShape(segments=tuple(segment for segment in segments if segment[0] > 1e-9 * rise))
