"""The parts of Enidine's table that state their loops and all three loading modes."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from wirerope_mj.mounts.rope_loop import LoopShape, loop_shape
from wirerope_mj.mounts.vendor_parts.parts import MODES, SERIES, Series, VendorPart, vendor_parts

ENIDINE: Series = next(series for series in SERIES if series.file == "enidine_wr.csv")


@dataclass(frozen=True, kw_only=True)
class VendorLoop:
    """One isolator of the table, SI units.

    Attributes:
        rope: diameter [m].
        loops: their number.
        width, height: of the unloaded isolator [m].
        bar: thickness of one bar [m].
        static_load, travel, vibration, shock: largest static load [N], largest deflection [m], stiffness of small vibration
            and mean stiffness over the travel [N/m], by mode: compression, 45, and shear, which stands for roll as well.
    """

    name: str
    rope: float
    loops: int
    width: float
    height: float
    bar: float
    static_load: Mapping[str, float]
    travel: Mapping[str, float]
    vibration: Mapping[str, float]
    shock: Mapping[str, float]

    @property
    def shape(self) -> LoopShape:
        """The half loop of its envelope."""
        return loop_shape(height=self.height, width=self.width, bar=self.bar, rope=self.rope)


@cache
def vendor_loops() -> tuple[VendorLoop, ...]:
    """Return the 50 parts that state geometry and all three modes, in their order.

    Raises:
        ModelError: the table cannot be read.
    """
    loops = (_loop(part) for part in vendor_parts() if part.series is ENIDINE)
    return tuple(loop for loop in loops if loop is not None)


def _loop(part: VendorPart) -> VendorLoop | None:
    """Return a part's loops, None where the table leaves something out."""
    rope, loops, width, height, bar = part.rope, part.loops, part.width, part.height, part.bar
    if rope is None or loops is None or width is None or height is None or bar is None:
        return None

    names = ("static_load", "travel", "vibration", "shock")
    values = {name: {mode: getattr(part.modes[mode], name) for mode in MODES} for name in names}
    if any(value is None for by_mode in values.values() for value in by_mode.values()):
        return None
    return VendorLoop(name=part.name, rope=rope, loops=loops, width=width, height=height, bar=bar, **values)
