"""The vendors' tables: parts with load, travel and stiffnesses in compression, at 45 degrees, and in shear or roll."""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cache
from pathlib import Path

from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.foundation.table_files import number_in, read_header, rows_below
from wirerope_mj.foundation.units import FORCE_UNITS, LENGTH_UNITS, STIFFNESS_UNITS, in_si

MODES = ("compression", "45", "shear")  # Loading modes of the tables; shear stands for roll as well
_UNITS = {"-": 1.0, **LENGTH_UNITS, **FORCE_UNITS, **STIFFNESS_UNITS}


@dataclass(frozen=True, kw_only=True)
class Series:
    """A vendor's table."""

    file: str  # its name below `models/isolators/vendors`
    source: str  # the documents
    damping: float  # damping ratio that a fit aims at [-], within `damping_range`
    damping_range: tuple[float, float]  # of the series, as the vendor states it [-]


# The tables that ship; the damping ratios are those of the catalogue's fitted isolators.
SERIES = (
    Series(
        file="enidine_wr.csv", source="ITT Enidine WR series catalogue ENI877R4, read from a public transcription",
        damping=0.11, damping_range=(0.05, 0.15),
    ),
    Series(
        file="vmc_cb.csv", source="VMC/Aeroflex and Socitec CB data sheets, read from a public transcription",
        damping=0.20, damping_range=(0.15, 0.20),
    ),
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class ModeValues:
    """Values of one loading mode; None = not stated."""

    static_load: float | None = None  # largest static load [N]
    travel: float | None = None  # largest dynamic deflection [m]
    vibration: float | None = None  # stiffness of small vibration [N/m]
    shock: float | None = None  # mean stiffness over the travel [N/m]

    def scaled(self, fraction: float) -> "ModeValues":
        """Return the values with a fraction of the loops: load and stiffnesses in proportion, the same travel."""
        stated = {name: getattr(self, name) for name in ("static_load", "vibration", "shock")}
        return replace(self, **{name: fraction * value for name, value in stated.items() if value is not None})


@dataclass(frozen=True, kw_only=True)
class VendorPart:
    """One row of a vendor's table, in SI units."""

    name: str
    series: Series
    loops: int | None  # number of loops; None = not stated, as for the next four
    rope: float | None  # diameter of the rope [m]
    height: float | None  # unloaded [m]
    width: float | None  # across the bars [m]
    bar: float | None  # thickness of one bar [m]
    modes: Mapping[str, ModeValues]  # values by loading mode

    def with_loops(self, loops: int) -> "VendorPart":
        """Return the part with fewer loops: load and stiffness in proportion (the vendor's own rule).

        ValueError: the part has no more loops than that, or the vendor does not say how many.
        """
        if self.loops is None or not 0 < loops < self.loops:
            have = "an unknown number of" if self.loops is None else str(self.loops)
            raise ValueError(f"`loops` must be an integer > 0 below those of {self.name} ({have} loops), got {loops}.")
        modes = {mode: values.scaled(loops / self.loops) for mode, values in self.modes.items()}
        return replace(self, name=f"{self.name} ({loops} of {self.loops} loops)", loops=loops, modes=modes)


@cache
def vendor_parts() -> tuple[VendorPart, ...]:
    """Return the parts of all tables that ship, in their order."""
    folder = catalogue_folder() / "vendors"
    return tuple(part for series in SERIES for part in read_table(folder / series.file, series))


def read_table(path: Path, series: Series) -> list[VendorPart]:
    """Return the parts of a CSV table whose header carries the units, such as `compression travel [mm]`.

    Lines that begin with # are comments. ModelError names file, line, column and rule.
    """
    parts = []
    try:
        header = read_header(path, kind="table of isolators", example='"part, loops [-], height [mm]"')
        factors = {name: header.factor(i, _UNITS) for i, name in enumerate(header.names) if name != "part"}
        for _, location, cells in rows_below(header):
            row = dict(zip(header.names, cells, strict=True))
            values: dict[str, float | None] = {}
            for name, factor in factors.items():
                value = number_in(location, name, row[name]) if row[name] else None
                if value is not None and value <= 0.0:
                    raise RecordError(
                        f'{location}: "{row[name]}" in column "{name}" must be > 0, or empty if it is not stated.'
                    )
                values[name] = None if value is None else in_si(value, factor)
            loops, stated = values["loops"], [item.name for item in fields(ModeValues)]
            modes = {mode: ModeValues(**{name: values.get(f"{mode} {name}") for name in stated}) for mode in MODES}
            measures = {name: values.get(name) for name in ("rope", "height", "width", "bar")}
            count = None if loops is None else round(loops)
            parts.append(VendorPart(name=row["part"], series=series, loops=count, modes=modes, **measures))
    except RecordError as error:
        raise ModelError(str(error)) from None
    return parts
