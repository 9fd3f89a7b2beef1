"""The rows of Enidine's table that state a loop: its geometry and what the catalogue says of it."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from wirerope_mj.errors import ModelError
from wirerope_mj.resources import catalogue_folder
from wirerope_mj.rope_loop.shape import LoopShape, loop_shape

TABLE = "enidine_wr.csv"
SOURCE = "ITT Enidine WR series catalogue ENI877R4, read from a public transcription"
MODES = ("compression", "45", "shear")
"""Loading modes of the table; shear stands for roll as well."""

_UNITS = {"-": 1.0, "mm": 1e-3, "N": 1.0, "N/mm": 1e3}


@dataclass(frozen=True, kw_only=True)
class VendorLoop:
    """One isolator of the table, SI units.

    Attributes:
        name: of the vendor.
        rope: diameter [m].
        loops: how many.
        width, height: of the unloaded isolator [m].
        bar: thickness of one bar [m].
        static_load, travel, vibration, shock: largest static load [N], largest deflection [m], stiffness of small vibration
            and mean stiffness over the travel [N/m], by mode.
    """

    name: str
    rope: float
    loops: float
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
    """Return the 50 rows that state geometry and all three modes, in their order.

    Raises:
        ModelError: the table cannot be read.
    """
    path = catalogue_folder() / "vendors" / TABLE
    try:
        lines = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
        rows = list(csv.DictReader(lines))
        return tuple(_loop(row) for row in rows if all(row.values()))
    except (OSError, ValueError, KeyError) as error:
        raise ModelError(f"{path}: cannot read this table of isolators: {error}. Install wirerope-mj again.") from error


def _loop(row: Mapping[str, str]) -> VendorLoop:
    """Return the isolator of one row; the header carries the units."""
    values: dict[str, float] = {}
    for heading, cell in row.items():
        name, _, unit = heading.partition(" [")
        if name != "part":
            values[name] = float(cell) * _UNITS[unit.removesuffix("]")]
    by_mode = {
        figure: {mode: values[f"{mode} {figure}"] for mode in MODES}
        for figure in ("static_load", "travel", "vibration", "shock")
    }
    return VendorLoop(
        name=row["part"],
        **{key: values[key] for key in ("rope", "loops", "width", "height", "bar")},
        **by_mode,  # type: ignore[arg-type]
    )
