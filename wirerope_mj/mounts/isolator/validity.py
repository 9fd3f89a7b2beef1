"""Range of validity: the cycles that the laws of an isolator were identified from, and what of a motion lies outside them."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.isolator.parts import Part

# What is said of cycles below the least tested ones: of three devices of 5 to 40 sliders, tested from 0.5 to 15 mm
# (`tests/slider_devices.py`)
BELOW = (
    "not judged: at a fifth of the least tested amplitude laws were up to 17 % low in frequency (7 % with three scales), and "
    "their damping was off by a tenth to several times"
)
SLACK = 0.05  # Ratio by which amplitudes may differ and count as one: strokes of one run at a rig differ by as much
# Half-range of an axis over its mount's largest, below which its force decides nothing that small cycles could change.
MOVING = 0.1
_MILLI = 1e3  # metres to millimetres
Pair = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class MeasuredRange(Part):
    """Cycles that were measured along one axis, each as its lowest and highest value."""

    amplitude: Pair  # half-ranges of the deflection [m], >= 0
    deflection: Pair  # ends of the deflection [m]
    frequency: Pair | None = None  # of the cycles [Hz], >= 0; None where the records have no time
    rate: Pair | None = None  # largest deflection rates of the cycles [m/s], >= 0; None in the same way

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, (low, high) in self.stated.items():
            if low > high:
                raise ValueError(f"`{name}` must be the lowest and then the highest, got {low:g} and {high:g}.")
            if name != "deflection" and low < 0.0:
                raise ValueError(f"`{name}` must be >= 0, got {low!r}.")

    @property
    def text(self) -> str:
        """The range as text: "0.5 to 10 mm amplitude between -10 and 10 mm"."""
        low, high = (f"{_MILLI * end:.3g}" for end in self.deflection)
        return f"{_span(self.amplitude, _MILLI)} mm amplitude between {low} and {high} mm"

    @property
    def pace(self) -> str:
        """How fast the cycles were, as text: "at 1 Hz, 3.1 to 63 mm/s"; "" where that is not known."""
        texts = [] if self.frequency is None else [f"{_span(self.frequency, 1.0)} Hz"]
        texts += [] if self.rate is None else [f"{_span(self.rate, _MILLI)} mm/s"]
        return f"at {', '.join(texts)}" if texts else ""

    def joined(self, other: "MeasuredRange | None") -> "MeasuredRange":
        """Return the range of both; a pace that one of them does not know is that of the other."""
        if other is None:
            return self
        mine, others = self.stated, other.stated
        known = {name: [one[name] for one in (mine, others) if name in one] for name in mine | others}
        ends = {name: (min(pair[0] for pair in both), max(pair[1] for pair in both)) for name, both in known.items()}
        return MeasuredRange(**ends)

    def outside(self, lowest: float, highest: float, *, small: bool) -> str:
        """Return how a motion between two deflections [m] leaves the range, as text; "" where it does not.

        If `small`, motions smaller than what was measured count.
        """
        half = 0.5 * (highest - lowest)
        room = SLACK * self.amplitude[1]
        beyond = half > self.amplitude[1] + room or (small and half < (1.0 - SLACK) * self.amplitude[0])
        if beyond:
            return f"±{_MILLI * half:.3g} mm (tested {_span(self.amplitude, _MILLI)} mm)"
        if lowest < self.deflection[0] - room or highest > self.deflection[1] + room:
            ends, tested = (
                [f"{round(_MILLI * end, 6) + 0.0:.3g}" for end in pair] for pair in ((lowest, highest), self.deflection)
            )
            return f"{ends[0]} to {ends[1]} mm (tested {tested[0]} to {tested[1]} mm)"
        return ""


@dataclass(frozen=True, kw_only=True)
class Validity(Part):
    """Range of validity along each axis; None where nothing is said of it."""

    roll: MeasuredRange | None = None
    shear: MeasuredRange | None = None
    axial: MeasuredRange | None = None

    def outside(self, lowest: Sequence[float] | Array, highest: Sequence[float] | Array, *, small: bool) -> dict[str, str]:
        """Return how a mount's motion leaves the ranges, as text by axis; nothing of the axes that stay inside.

        Deflections are those along roll, shear and axial [m], (3,). If `small`, small motions count along axes that move at
        least a tenth as far as the mount's farthest one.
        """
        pairs = zip(map(float, lowest), map(float, highest), strict=True)
        ends = dict(zip((item.name for item in fields(self)), pairs, strict=True))
        far = MOVING * max(high - low for low, high in ends.values())
        moving = {axis: high - low > far for axis, (low, high) in ends.items()}
        texts = {axis: one.outside(*ends[axis], small=small and moving[axis]) for axis, one in self.stated.items()}
        return {axis: text for axis, text in texts.items() if text}


def _span(pair: Pair, factor: float) -> str:
    low, high = (f"{factor * one:.3g}" for one in pair)
    return low if low == high else f"{low} to {high}"
