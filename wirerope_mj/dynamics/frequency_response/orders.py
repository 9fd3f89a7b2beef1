"""Orders of a machine's speed: frequencies at which it excites, and resonances that lie among them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from wirerope_mj.dynamics.frequency_response.summary import LevelSummary
from wirerope_mj.foundation.arguments import positive

FASTEST = 1e6
"""Speed of a shaft [1/min], and order, at the most: ten times what turns and shakes."""


@dataclass(frozen=True, kw_only=True)
class OrderBand:
    """Frequencies [Hz] of an order between the lowest and the highest speed of a shaft."""

    order: float
    low: float
    high: float

    @property
    def label(self) -> str:
        """For instance `order 2`."""
        return f"order {self.order:g}"


def order_bands(orders: Sequence[float], speed_rpm: Sequence[float]) -> tuple[OrderBand, ...]:
    """Return the bands of orders at speeds [1/min], one or the ends of a range.

    Raises:
        ValueError: a number is not positive, or there are not one or two speeds.
    """
    if len(speed_rpm) not in (1, 2):
        raise ValueError(f"`--speed-rpm` takes one speed or two, the lowest and the highest, got {len(speed_rpm)}.")
    speeds = sorted(_within("--speed-rpm", speed) / 60.0 for speed in speed_rpm)
    return tuple(
        OrderBand(order=_within("--orders", order), low=order * speeds[0], high=order * speeds[-1]) for order in orders
    )


def _within(name: str, value: float) -> float:
    if positive(name, value) > FASTEST:
        raise ValueError(f"`{name}` must be at most {FASTEST:g}, got {value!r}.")
    return float(value)


def order_statements(bands: Sequence[OrderBand], findings: Sequence[LevelSummary]) -> Iterator[str]:
    """Yield for every band a sentence on the resonance peaks that lie in it."""
    for band in bands:
        there = [
            f"{peak.frequency:.2f} Hz at {summary.level.acceleration:.4g} m/s²"
            for summary in findings
            for peak in summary.peaks
            if band.low <= peak.frequency <= band.high and not peak.at_edge
        ]
        span = f"{band.low:.4g} Hz" if band.low == band.high else f"{band.low:.4g} to {band.high:.4g} Hz"
        yield f"{band.label.capitalize()}, {span}: " + (
            f"resonance at {', '.join(there)}." if there else "no resonance."
        )
