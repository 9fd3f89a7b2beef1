"""A response as a table for other programs."""

from collections.abc import Iterator, Sequence

from wirerope_mj.engine.response.histories import SampledColumns
from wirerope_mj.foundation.exports import Column, Exported

_UNITS = {
    "position": "m", "velocity": "m/s", "acceleration": "m/s^2", "displacement": "m", "relative_displacement": "m",
    "angular_velocity": "rad/s", "angular_acceleration": "rad/s^2", "deflection": "m", "force": "N", "gap": "m",
}  # fmt: skip


def exported_samples(samples: SampledColumns, about: dict[str, str]) -> Exported:
    """Return the samples as they are written: one column for each, called as in response.parquet."""
    names = samples.names

    def blocks() -> Iterator[Sequence[Column]]:
        for block in samples.blocks(0, len(names)):
            yield list(block.T)

    return Exported(
        names=names,
        units=[unit_of(name) for name in names],
        column=lambda number: samples.columns(number, number + 1)[:, 0],
        blocks=blocks,
        about=about,
    )


def unit_of(name: str) -> str:
    """Return the unit of a column: of internal states that of the hysteretic force."""
    parts = name.split("/")
    if name == "time":
        return "s"
    if parts[-2:-1] == ["state"]:
        return "N" if ".z" in parts[-1] else ""
    return next((_UNITS[part] for part in reversed(parts) if part in _UNITS), "")
